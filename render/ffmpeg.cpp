#include "render/ffmpeg.h"

#include "souple/error.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <spawn.h>
#include <string_view>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include <fmt/core.h>

namespace souple::render {

namespace fs = std::filesystem;

namespace {

constexpr int poll_milliseconds = 100;

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

}  // namespace

bool has_ffmpeg() {
  return !find_program("ffmpeg").empty();
}

std::string error_text(int number) {
  return std::generic_category().message(number);
}

Ffmpeg::Ffmpeg(const std::vector<std::string>& arguments, const Interrupted& interrupted)
    : log_(std::tmpfile()), interrupted_(interrupted) {
  const fs::path program = find_program("ffmpeg");
  if (program.empty()) {
    throw Error(
        "films are made by the program ffmpeg, which is not on the PATH: install the Debian package "
        "ffmpeg, "
        "or write single pictures into a folder instead");
  }
  // Writing to an ffmpeg that has ended is an error for a socket, but a signal for a pipe. This holds however the
  // program handles SIGPIPE.
  std::array<int, 2> ends{-1, -1};
  if (log_ == nullptr || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    const int why = errno;
    close_log();
    throw Error("ffmpeg cannot be started: " + error_text(why));
  }
  input_ = ends[0];
  const int failure = spawn(program.string(), arguments, ends[1]);
  close(ends[1]);
  if (failure != 0) {
    close_input();
    close_log();
    throw Error(program.string() + " cannot be started: " + error_text(failure));
  }
}

Ffmpeg::~Ffmpeg() {
  if (process_ > 0) {
    end();
    close_input();
    wait();
  }
  close_log();
}

bool Ffmpeg::write(std::span<const std::uint8_t> bytes) {
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

std::string Ffmpeg::finish() {
  close_input();
  const int status = wait();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  std::string line = last_line();
  if (!line.empty()) return line;
  if (hung_) return "it did nothing for two seconds after the interrupt, and was ended";
  return WIFSIGNALED(status) ? fmt::format("it was ended by signal {}", WTERMSIG(status))
                             : fmt::format("exit code {}", WEXITSTATUS(status));
}

int Ffmpeg::spawn(const std::string& program, const std::vector<std::string>& arguments, int input) {
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

int Ffmpeg::wait() {
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
void Ffmpeg::end() {
  kill(-process_, SIGKILL);
}

/// Processor time that ffmpeg has used; 0 where the system does not tell.
double Ffmpeg::seconds_used() const {
  clockid_t clock{};
  timespec used{};
  if (clock_getcpuclockid(process_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// Whether ffmpeg has neither read nor computed for two seconds since the interrupt; if so, ends it.
bool Ffmpeg::hangs() {
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
std::string Ffmpeg::last_line() {
  std::string line, found;
  std::rewind(log_);
  for (int c = std::fgetc(log_); c != EOF; c = std::fgetc(log_)) {
    if (c != '\n') line += static_cast<char>(c);
    if (c == '\n' && !line.empty()) found = std::exchange(line, {});
  }
  return line.empty() ? found : line;
}

void Ffmpeg::close_input() {
  if (input_ >= 0) close(input_);
  input_ = -1;
}

void Ffmpeg::close_log() {
  if (log_ != nullptr) std::fclose(log_);
  log_ = nullptr;
}

}  // namespace souple::render
