#include "render/film.h"

#include "render/ffmpeg.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/write_error.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace souple::render {

namespace fs = std::filesystem;

namespace {

/// "flag.mp4" -> "flag.part.mkv"
fs::path part_of(const fs::path& file, const char* extension) {
  return file.parent_path() / (file.stem().string() + ".part" + extension);
}

/// An argument that ffmpeg takes as a file, whatever its characters (-x.mp4, a:b.mp4).
std::string file_argument(const fs::path& file) {
  return "file:" + file.string();
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string size_text(int width, int height) {
  return fmt::format("{}x{}", width, height);
}

/// Detects failure now, not after minutes of work.
void require_writable(const fs::path& file) {
  std::FILE* const opened = std::fopen(file.c_str(), "wb");
  if (opened == nullptr) throw WriteError(file.string() + ": cannot be written: " + error_text(errno));
  std::fclose(opened);
}

enum class Kind { mp4, gif, webp, none };

Kind kind_of(const fs::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".mp4") return Kind::mp4;
  if (extension == ".gif") return Kind::gif;
  return extension == ".webp" ? Kind::webp : Kind::none;
}

/// Encodes one picture and discards the result. Throws Error when this ffmpeg cannot.
void require_webp_encoder(const fs::path& file) {
  constexpr int side = 16;
  Ffmpeg ffmpeg({"-f", "rawvideo", "-pixel_format", "rgba", "-video_size", size_text(side, side), "-i",
                 "pipe:0", "-c:v", "libwebp_anim", "-f", "null", "-"});
  ffmpeg.write(std::vector<std::uint8_t>(std::size_t{4} * side * side, 255));
  if (const std::string why = ffmpeg.finish(); !why.empty()) {
    throw Error(
        file.string() + ": this ffmpeg has no working encoder libwebp_anim (" + why +
        "): install an ffmpeg with libwebp, such as the Debian package ffmpeg, or write an .mp4 or a .gif");
  }
}

}  // namespace

bool is_film(const fs::path& file) {
  return kind_of(file) != Kind::none;
}

double highest_rate(const fs::path& film) {
  // Browsers show a picture of a .gif for at least 2/100 s. They delay a .webp with pictures of 1/100 s or less.
  const Kind kind = kind_of(film);
  if (kind == Kind::gif) return 50;
  return kind == Kind::webp ? 60 : std::numeric_limits<double>::infinity();
}

struct Film::Impl {
  fs::path file;
  double rate;
  Interrupted interrupted;
  std::uint64_t max_bytes;  ///< of a .webp; 0: any
  Kind kind;
  int width = 0, height = 0;            ///< size of the first picture
  int film_width = 0, film_height = 0;  ///< size of the pictures for ffmpeg
  std::uint64_t added = 0;
  bool finished = false;
  fs::path part;  ///< ffmpeg's output while pictures are added: an .mp4, or all pictures without loss
  std::vector<fs::path> temporary_files;  ///< removed at the end in any case
  std::unique_ptr<Ffmpeg> ffmpeg;
  Image padded;

  Impl(fs::path file_, double rate_, Interrupted interrupted_, std::uint64_t max_bytes_)
      : file(std::move(file_)),
        rate(rate_),
        interrupted(std::move(interrupted_)),
        max_bytes(max_bytes_),
        kind(kind_of(file)) {
    if (!(std::isfinite(rate) && rate > 0))
      throw Error(fmt::format("{}: a film needs a frame rate above 0, not {:.9g}", file.string(), rate));
    if (max_bytes > 0 && kind != Kind::webp)
      throw Error(file.string() + ": only a film .webp is made to fit into a number of bytes");
    if (kind == Kind::none) throw Error(file.string() + ": a film is .mp4, .gif or .webp");
    if (rate > highest_rate(file))
      throw Error(fmt::format("{}: {:g} pictures a second; expected at most {:g}", file.string(), rate,
                              highest_rate(file)));
    if (std::error_code error; fs::is_directory(file, error))
      throw Error(file.string() + ": is a folder; expected the name of a film");
    if (!has_ffmpeg()) Ffmpeg({});  // throws Error that names the package
    if (kind == Kind::webp) require_webp_encoder(file);
    if (const fs::path folder = file.parent_path(); !folder.empty()) create_folder(folder);
    part = part_of(file, kind == Kind::mp4 ? ".mp4" : ".mkv");
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

  void start() {
    const int side = kind == Kind::mp4 ? 2 : 1;  // H.264 stores colors for 2 x 2 pixels
    film_width = (width + side - 1) / side * side;
    film_height = (height + side - 1) / side * side;
    std::vector<std::string> arguments =
        words(fmt::format("-f rawvideo -pixel_format rgba -video_size {} -framerate {:.9g} -i pipe:0 -an "
                          "-fflags +bitexact -flags:v +bitexact",
                          size_text(film_width, film_height), rate));
    // A .gif has one palette and a .webp one quality, known only after the last picture: until then, pictures are
    // stored without loss.
    const std::vector<std::string> encoding =
        words(kind == Kind::mp4 ? "-vf scale=out_color_matrix=bt709:out_range=tv -pix_fmt yuv420p "
                                  "-c:v libx264 -crf 18 -color_range tv -colorspace bt709 "
                                  "-color_primaries bt709 -color_trc iec61966-2-1 -movflags +faststart -f mp4"
                                : "-pix_fmt bgr0 -c:v ffv1 -f matroska");
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
    if (added++ == 0) start();
    if (!ffmpeg->write(frame_of(image))) fail(ffmpeg->finish());
  }

  [[noreturn]] void fail(const std::string& why) {
    finished = true;
    ffmpeg.reset();
    throw WriteError(file.string() + ": ffmpeg failed: " + why);
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
    if (const std::string why = ffmpeg->finish(); !why.empty()) fail(why);
    ffmpeg.reset();
    const fs::path whole = kind == Kind::gif ? make_gif() : kind == Kind::webp ? make_webp() : part;
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

  /// Bytes of the film at a quality from 0 to 100.
  std::uint64_t encode_webp(const fs::path& webp, int quality) {
    run_to_end({"-i", file_argument(part), "-c:v", "libwebp_anim", "-quality", fmt::format("{}", quality),
                "-compression_level", "4", "-loop", "0", "-fflags", "+bitexact", "-f", "webp",
                file_argument(webp)});
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(webp, error);
    if (error) throw WriteError(webp.string() + ": cannot be read: " + error.message());
    return bytes;
  }

  /// At the highest quality, up to 90, that fits into `max_bytes`, found by bisection.
  fs::path make_webp() {
    constexpr int usual = 75, highest = 90;
    fs::path webp = part_of(file, ".webp");
    temporary_files.push_back(webp);
    const int first = max_bytes == 0 ? usual : highest;
    if (encode_webp(webp, first) <= max_bytes || max_bytes == 0) return webp;
    if (const std::uint64_t least = encode_webp(webp, 0); least > max_bytes) {
      throw WriteError(fmt::format(
          "{}: {} pictures of {} have {} bytes at the lowest quality, more than the {} allowed: choose "
          "fewer pictures, a smaller size or more bytes",
          file.string(), added, size_text(width, height), least, max_bytes));
    }
    int fits = 0, encoded = 0, too_many = highest;
    while (fits + 1 < too_many) {
      encoded = (fits + too_many) / 2;
      (encode_webp(webp, encoded) <= max_bytes ? fits : too_many) = encoded;
    }
    if (encoded != fits) encode_webp(webp, fits);
    return webp;
  }
};

Film::Film(fs::path file, double frame_rate, Interrupted interrupted, std::uint64_t max_bytes)
    : impl_(std::make_unique<Impl>(std::move(file), frame_rate, std::move(interrupted), max_bytes)) {}

Film::~Film() = default;

void Film::add(const Image& image) {
  impl_->add(image);
}

void Film::finish() {
  impl_->finish();
}

}  // namespace souple::render
