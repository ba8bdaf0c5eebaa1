#include "render/film.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/write_error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <span>
#include <spawn.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace souple::render {

namespace fs = std::filesystem;

namespace {

/// Path of a program in the folders of PATH, first to last. Empty if no folder contains it.
fs::path find_program(const char* name) {
  const char* listed = std::getenv("PATH");
  const std::string_view folders = listed != nullptr ? listed : "/usr/bin:/bin";
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    fs::path file = fs::path(folders.substr(begin, end - begin)) / name;
    std::error_code error;
    // An empty entry would mean the working folder, from which no program should be run unintentionally.
    if (end > begin && fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0) return file;
    begin = end + 1;
  }
  return {};
}

std::string reason(int number) {
  return std::generic_category().message(number);
}

/// A running ffmpeg that reads from this process. Its arguments are passed unchanged, without a shell.
class Ffmpeg {
 public:
  explicit Ffmpeg(const std::vector<std::string>& arguments, const Film::Interrupted& interrupted = {})
      : log_(std::tmpfile()), interrupted_(interrupted) {
    const fs::path program = find_program("ffmpeg");
    if (program.empty()) {
      throw Error(
          "films are made by the program ffmpeg, which is not on the PATH: install the Debian package "
          "ffmpeg, "
          "or write single pictures into a folder instead");
    }
    // A socket instead of a pipe: writing to an ffmpeg that has ended is then an error rather than a signal,
    // however the program handles SIGPIPE.
    std::array<int, 2> ends{-1, -1};
    if (log_ == nullptr || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
      const int why = errno;
      close_log();
      throw Error("ffmpeg cannot be started: " + reason(why));
    }
    input_ = ends[0];
    const int failure = spawn(program.string(), arguments, ends[1]);
    close(ends[1]);
    if (failure != 0) {
      close_input();
      close_log();
      throw Error(program.string() + " cannot be started: " + reason(failure));
    }
  }
  ~Ffmpeg() {
    if (process_ > 0) {
      end();
      close_input();
      wait();
    }
    close_log();
  }
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// False when ffmpeg accepts no more data: `finish` then returns the reason.
  bool write(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) {
        sent_ += static_cast<std::uint64_t>(sent);
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
        continue;
      }
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
      if (hangs()) return false;
      pollfd ready{input_, POLLOUT, 0};
      poll(&ready, 1, interrupted_ ? poll_milliseconds : -1);
    }
    return true;
  }

  /// Closes ffmpeg's input and waits. Empty on success, else ffmpeg's last message.
  std::string finish() {
    close_input();
    const int status = wait();
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
    std::string line = last_line();
    if (!line.empty()) return line;
    if (hung_) return "it did nothing for two seconds after the interrupt, and was ended";
    return WIFSIGNALED(status) ? fmt::format("it was ended by signal {}", WTERMSIG(status))
                               : fmt::format("exit code {}", WEXITSTATUS(status));
  }

 private:
  int spawn(const std::string& program, const std::vector<std::string>& arguments, int input) {
    std::vector<std::string> command{program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(command.size() + 1);
    for (std::string& word : command) argv.push_back(word.data());
    argv.push_back(nullptr);

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, fileno(log_), STDERR_FILENO);
    // Its own process group: Ctrl-C in the terminal reaches only this program, which then finishes the film.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int failure = posix_spawn(&process_, program.c_str(), &files, &attributes, argv.data(), environ);
    if (failure != 0) process_ = -1;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return failure;
  }

  int wait() {
    int status = 0;
    for (;;) {
      const pid_t ended = waitpid(process_, &status, interrupted_ && !hung_ ? WNOHANG : 0);
      if (ended == process_ || (ended < 0 && errno != EINTR)) break;
      if (ended == 0 && !hangs()) poll(nullptr, 0, 5);
    }
    process_ = -1;
    return status;
  }

  /// With the programs that it started, where it is a script.
  void end() { kill(-process_, SIGKILL); }

  /// Processor time that ffmpeg has used; 0 where the system does not tell.
  double seconds_used() const {
    clockid_t clock{};
    timespec used{};
    if (clock_getcpuclockid(process_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }

  /// Whether ffmpeg has neither read nor computed for two seconds since the interrupt; if so, ends it.
  bool hangs() {
    if (!interrupted_ || !interrupted_()) return false;
    const auto now = std::chrono::steady_clock::now();
    const std::pair done{sent_, seconds_used()};
    if (!last_done_ || *last_done_ != done) {
      last_done_ = done;
      last_change_ = now;
    }
    if (now - last_change_ < std::chrono::seconds(2)) return false;
    hung_ = true;
    end();
    return true;
  }

  /// The last line of ffmpeg's messages.
  std::string last_line() {
    std::string line, found;
    std::rewind(log_);
    for (int c = std::fgetc(log_); c != EOF; c = std::fgetc(log_)) {
      if (c != '\n') line += static_cast<char>(c);
      if (c == '\n' && !line.empty()) found = std::exchange(line, {});
    }
    return line.empty() ? found : line;
  }

  void close_input() {
    if (input_ >= 0) close(input_);
    input_ = -1;
  }
  void close_log() {
    if (log_ != nullptr) std::fclose(log_);
    log_ = nullptr;
  }

  static constexpr int poll_milliseconds = 100;

  std::FILE* log_;  ///< a file, not a pipe: it never fills up
  Film::Interrupted interrupted_;
  std::uint64_t sent_ = 0;                                     // bytes that ffmpeg has read or will read
  std::optional<std::pair<std::uint64_t, double>> last_done_;  // bytes sent and processor time
  std::chrono::steady_clock::time_point last_change_;          // of last_done_
  bool hung_ = false;                                          // ended by `hangs`
  int input_ = -1;
  pid_t process_ = -1;
};

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// "flag.mp4" -> "flag.part.mkv"
fs::path part_of(const fs::path& file, const char* extension) {
  return file.parent_path() / (file.stem().string() + ".part" + extension);
}

/// An argument that ffmpeg takes as a file, whatever its characters (-x.mp4, a:b.mp4).
std::string file_argument(const fs::path& file) {
  return "file:" + file.string();
}

std::string size_text(int width, int height) {
  return fmt::format("{}x{}", width, height);
}

std::string number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", number);
  return text;
}

/// Detects failure now, not after minutes of work.
void require_writable(const fs::path& file) {
  std::FILE* const opened = std::fopen(file.c_str(), "wb");
  if (opened == nullptr) throw WriteError(file.string() + ": cannot be written: " + reason(errno));
  std::fclose(opened);
}

}  // namespace

bool has_ffmpeg() {
  return !find_program("ffmpeg").empty();
}

bool is_film(const fs::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".mp4" || extension == ".gif";
}

struct Film::Impl {
  enum class Kind { mp4, gif, pictures };

  fs::path file;
  double rate;
  Interrupted interrupted;
  Kind kind = Kind::pictures;
  int width = 0, height = 0;            ///< size of the first picture
  int film_width = 0, film_height = 0;  ///< size of the pictures for ffmpeg
  std::uint64_t added = 0;
  bool finished = false;
  fs::path part;  ///< ffmpeg's output while pictures are added: the film, or for a .gif all pictures
  std::vector<fs::path> temporary_files;  ///< removed at the end in any case
  std::unique_ptr<Ffmpeg> ffmpeg;
  Image padded;

  Impl(fs::path file_, double rate_, Interrupted interrupted_)
      : file(std::move(file_)), rate(rate_), interrupted(std::move(interrupted_)) {
    if (!(std::isfinite(rate) && rate > 0))
      throw Error(file.string() + ": a film needs a frame rate above 0, not " + number_text(rate));
    if (is_film(file)) kind = lower_extension(file) == ".gif" ? Kind::gif : Kind::mp4;
    if (kind == Kind::pictures) {
      create_folder(file);
      return;
    }
    if (std::error_code error; fs::is_directory(file, error))
      throw Error(file.string() + ": is a folder; expected the name of a film");
    if (!has_ffmpeg()) Ffmpeg({});  // throws Error that names the package
    if (const fs::path folder = file.parent_path(); !folder.empty()) create_folder(folder);
    part = part_of(file, kind == Kind::gif ? ".mkv" : ".mp4");
    temporary_files.push_back(part);
    require_writable(part);
  }
  ~Impl() {
    try {
      if (added > 0) finish();
    } catch (const std::exception&) {
    }
    ffmpeg.reset();
    std::error_code error;
    for (const fs::path& temporary_file : temporary_files) fs::remove(temporary_file, error);
  }

  /// Step between the pictures of a .gif.
  std::uint64_t stride() const {
    constexpr double fastest_gif = 50;  // browsers show a picture for at least 2/100 s
    return kind == Kind::gif ? static_cast<std::uint64_t>(std::ceil(rate / fastest_gif - 1e-9)) : 1;
  }

  void start() {
    const int side = kind == Kind::mp4 ? 2 : 1;  // H.264 stores colors for 2 x 2 pixels
    film_width = (width + side - 1) / side * side;
    film_height = (height + side - 1) / side * side;
    std::vector<std::string> arguments{"-f",
                                       "rawvideo",
                                       "-pixel_format",
                                       "rgba",
                                       "-video_size",
                                       size_text(film_width, film_height),
                                       "-framerate",
                                       number_text(rate / static_cast<double>(stride())),
                                       "-i",
                                       "pipe:0",
                                       "-an",
                                       "-fflags",
                                       "+bitexact",
                                       "-flags:v",
                                       "+bitexact"};
    const std::vector<std::string> mp4{"-vf",
                                       "scale=out_color_matrix=bt709:out_range=tv",
                                       "-pix_fmt",
                                       "yuv420p",
                                       "-c:v",
                                       "libx264",
                                       "-crf",
                                       "18",
                                       "-color_range",
                                       "tv",
                                       "-colorspace",
                                       "bt709",
                                       "-color_primaries",
                                       "bt709",
                                       "-color_trc",
                                       "iec61966-2-1",
                                       "-movflags",
                                       "+faststart",
                                       "-f",
                                       "mp4"};
    // A .gif has one palette, known only after the last picture: until then, pictures are stored without
    // loss.
    const std::vector<std::string> lossless{"-pix_fmt", "bgr0", "-c:v", "ffv1", "-f", "matroska"};
    const std::vector<std::string>& encoding = kind == Kind::mp4 ? mp4 : lossless;
    arguments.insert(arguments.end(), encoding.begin(), encoding.end());
    arguments.push_back(file_argument(part));
    ffmpeg = std::make_unique<Ffmpeg>(arguments, interrupted);
  }

  /// The picture; if the film is larger, with the last column and row repeated.
  std::span<const std::uint8_t> frame_of(const Image& image) {
    if (film_width == width && film_height == height) return image.pixels;
    Image grown(film_width, film_height);
    for (int y = 0; y < film_height; ++y) {
      const std::uint8_t* const row = image.at(0, std::min(y, height - 1));
      const std::uint8_t* const row_end = row + std::ptrdiff_t{4} * width;
      std::uint8_t* const end = std::copy(row, row_end, grown.at(0, y));
      if (film_width > width) std::copy(row_end - 4, row_end, end);
    }
    padded = std::move(grown);
    return padded.pixels;
  }

  void add(const Image& image) {
    if (finished) throw Error(file.string() + ": the film is finished");
    if (image.width < 1 || image.height < 1) throw Error(file.string() + ": a picture has no pixels");
    if (added == 0) {
      width = image.width;
      height = image.height;
    }
    if (image.width != width || image.height != height) {
      throw Error(file.string() + ": the film began with pictures of " + size_text(width, height) +
                  " pixels; one of " + size_text(image.width, image.height) + " cannot follow");
    }
    const std::uint64_t index = added++;
    if (kind == Kind::pictures) {
      write_png(file / picture_name(index + 1), image);
      return;
    }
    if (index == 0) start();
    if (index % stride() == 0 && !ffmpeg->write(frame_of(image))) fail(ffmpeg->finish());
  }

  std::string picture_name(std::uint64_t number) const {
    char text[32];
    std::snprintf(text, sizeof(text), "_%04llu.png", static_cast<unsigned long long>(number));
    const fs::path folder = file.has_filename() ? file : file.parent_path();  // "films/" has the name films
    return folder.lexically_normal().filename().string() + text;
  }

  [[noreturn]] void fail(const std::string& why) {
    finished = true;
    ffmpeg.reset();
    throw Error(file.string() + ": ffmpeg failed: " + why);
  }

  void run_to_end(const std::vector<std::string>& arguments) {
    ffmpeg = std::make_unique<Ffmpeg>(arguments, interrupted);
    if (const std::string why = ffmpeg->finish(); !why.empty()) fail(why);
    ffmpeg.reset();
  }

  void finish() {
    if (finished) return;
    if (added == 0) throw Error(file.string() + ": a film needs a picture");
    finished = true;
    if (kind == Kind::pictures) return;
    if (const std::string why = ffmpeg->finish(); !why.empty()) fail(why);
    ffmpeg.reset();
    const fs::path whole = kind == Kind::gif ? make_gif() : part;
    std::error_code error;
    fs::rename(whole, file, error);
    if (error) throw WriteError(file.string() + ": cannot be written: " + error.message());
  }

  /// Two passes: the best palette for all pictures, then the film in its colors.
  fs::path make_gif() {
    const fs::path colors = part_of(file, ".png");
    fs::path gif = part_of(file, ".gif");
    temporary_files.push_back(colors);
    temporary_files.push_back(gif);
    run_to_end({"-i", file_argument(part), "-vf", "palettegen=stats_mode=full:reserve_transparent=0",
                "-frames:v", "1", "-update", "1", "-fflags", "+bitexact", file_argument(colors)});
    run_to_end({"-i", file_argument(part), "-f", "image2", "-pattern_type", "none", "-i",
                file_argument(colors), "-filter_complex",
                "[0:v][1:v]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle", "-fflags", "+bitexact",
                "-f", "gif", file_argument(gif)});
    return gif;
  }
};

Film::Film(fs::path file, double frame_rate, Interrupted interrupted)
    : impl_(std::make_unique<Impl>(std::move(file), frame_rate, std::move(interrupted))) {}

Film::~Film() = default;

void Film::add(const Image& image) {
  impl_->add(image);
}

void Film::finish() {
  impl_->finish();
}

}  // namespace souple::render
