#include "souple/mesh_files/reader_process.h"

#include "souple/error.h"
#include "souple/mesh_files/assimp_formats.h"
#include "souple/mesh_files/mesh_message.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/core.h>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace souple::mesh_detail {

namespace fs = std::filesystem;

namespace {

constexpr const char* program_name = "souple-mesh-reader";

/// Folders of the shared library that holds this function, if it is one, and of the program.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> folders;
  std::error_code error;
  Dl_info module{};
  static const char here = 0;
  if (dladdr(&here, &module) != 0 && module.dli_fname != nullptr) {
    const fs::path file = fs::canonical(module.dli_fname, error);
    if (!error) folders.push_back(file.parent_path());
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path());
  return folders;
}

bool is_program(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0;
}

fs::path find_reader(const fs::path& mesh) {
  if (const char* const stated = std::getenv("SOUPLE_MESH_READER")) {
    if (is_program(stated)) return stated;
    throw Error(
        fmt::format("{}: the environment variable SOUPLE_MESH_READER names \"{}\", expected the program {}",
                    mesh.string(), stated, program_name));
  }
  std::vector<fs::path> places;
  for (const fs::path& folder : own_folders()) {
    places.push_back(folder / program_name);
    for (const char* const above : {"..", "../.."})
      places.push_back(folder / above / SOUPLE_LIBEXEC / program_name);
  }
  places.emplace_back(SOUPLE_MESH_READER_PATH);
  for (const fs::path& place : places) {
    if (is_program(place)) return place;
  }
  throw Error(
      fmt::format("{}: the program {}, which reads this format, is missing, expected {} or beside this "
                  "program; the environment "
                  "variable SOUPLE_MESH_READER may name it",
                  mesh.string(), program_name, places.back().string()));
}

/// A pipe whose ends other programs do not inherit.
class Pipe {
 public:
  Pipe() {
#if defined(__linux__)
    opened_ = pipe2(ends_.data(), O_CLOEXEC) == 0;
#else
    opened_ = pipe(ends_.data()) == 0;
    for (const int end : ends_)
      if (opened_) fcntl(end, F_SETFD, FD_CLOEXEC);
#endif
  }
  ~Pipe() {
    if (opened_) close(ends_[0]);
    close_writer();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool opened() const {
    return opened_;
  }
  int reader() const {
    return ends_[0];
  }
  int writer() const {
    return ends_[1];
  }
  void close_writer() {
    if (opened_ && ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
  bool opened_ = false;
};

/// The running reader; ended by the destructor at the latest.
class Process {
 public:
  Process(const fs::path& program, std::vector<std::string> words, int output) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 34)
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
#endif
    // The caller may block or ignore signals that are to end the reader.
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    failure_ = posix_spawn(&id_, program.c_str(), &files, &attributes, arguments.data(), environ);
    if (failure_ != 0) id_ = -1;
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
  }
  ~Process() {
    if (id_ < 0) return;
    kill(id_, SIGKILL);
    wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int failure() const {
    return failure_;
  }

  /// How the process ended, as waitpid says; 0 where the caller's program has taken it (an own SIGCHLD handler).
  int wait() {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = waitpid(id_, &status, 0);
    } while (ended < 0 && errno == EINTR);
    id_ = -1;
    return ended < 0 ? 0 : status;
  }

 private:
  pid_t id_ = -1;
  int failure_ = 0;
};

enum class Heard { all, too_late, too_much };

/// Reads until the other end is closed.
Heard hear(int pipe, std::uint64_t seconds, std::string& message) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  std::vector<char> buffer(std::size_t(1) << 16);
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return Heard::too_late;
    pollfd watched{pipe, POLLIN, 0};
    const int ready = poll(&watched, 1, int(std::min<std::int64_t>(left, 1000)));
    if (ready < 0 && errno != EINTR) return Heard::all;
    if (ready <= 0) continue;
    const ssize_t count = read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return Heard::all;
    if (message.size() + std::size_t(count) > reader_memory) return Heard::too_much;
    message.append(buffer.data(), std::size_t(count));
  }
}

[[noreturn]] void fail_late(const fs::path& mesh, std::uint64_t seconds) {
  throw Error(fmt::format(
      "{}: assimp takes more than {} s to read it; a file of another format may do, such as OBJ, or a lower "
      "frame rate or one object of an animation",
      mesh.string(), seconds));
}

void check_end(const fs::path& mesh, int status, std::uint64_t seconds) {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL) fail_late(mesh, seconds);
    throw Error(
        fmt::format("{}: assimp crashes on it (signal {}); the file is damaged, was made to do that, or "
                    "holds what assimp cannot read, such "
                    "as a glTF skin without inverseBindMatrices",
                    mesh.string(), WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) != 0) {
    throw Error(fmt::format("{}: assimp fails on it ({} ended with exit code {}); the file is damaged",
                            mesh.string(), program_name, WEXITSTATUS(status)));
  }
}

}  // namespace

std::string run_mesh_reader(const fs::path& mesh, const std::vector<std::string>& arguments) {
  const fs::path program = find_reader(mesh);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(mesh, error);
  const std::uint64_t seconds = reader_seconds(error ? 0 : size, !arguments.empty());
  // A machine that is busy gives the reader a part of its time only.
  constexpr std::uint64_t wall_clock_factor = 6;

  Pipe pipe;
  const auto fail_start = [&](int reason) {
    throw Error(
        fmt::format("{}: cannot start {}: {}", mesh.string(), program.string(), std::strerror(reason)));
  };
  if (!pipe.opened()) fail_start(errno);
  std::vector<std::string> words = {program.string(), fs::absolute(mesh).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  Process process(program, std::move(words), pipe.writer());
  if (process.failure() != 0) fail_start(process.failure());
  pipe.close_writer();
  std::string message;
  const Heard heard = hear(pipe.reader(), wall_clock_factor * seconds, message);
  if (heard == Heard::too_late) fail_late(mesh, wall_clock_factor * seconds);
  if (heard == Heard::too_much) throw Error(mesh.string() + ": is too large to be read with assimp");
  check_end(mesh, process.wait(), seconds);
  return message;
}

}  // namespace souple::mesh_detail
