#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace souple::render {

/// Whether the program ffmpeg can be found on PATH.
bool has_ffmpeg();

/// The system's words for an error number.
std::string error_text(int number);

/// A running ffmpeg that reads from this process. Its arguments are passed unchanged, without a shell.
class Ffmpeg {
 public:
  /// Whether the user has asked to stop.
  using Interrupted = std::function<bool()>;

  /// Throws Error when ffmpeg is missing (and names its package) or cannot be started. Once `interrupted` returns
  /// true, an ffmpeg that neither reads nor computes for two seconds is ended.
  explicit Ffmpeg(const std::vector<std::string>& arguments, const Interrupted& interrupted = {});
  /// Ends an ffmpeg that still runs.
  ~Ffmpeg();
  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;

  /// False when ffmpeg accepts no more data: `finish` then returns the reason.
  bool write(std::span<const std::uint8_t> bytes);

  /// Closes ffmpeg's input and waits. Empty on success, else ffmpeg's last message.
  std::string finish();

 private:
  int spawn(const std::string& program, const std::vector<std::string>& arguments, int input);
  int wait();
  void end();
  double seconds_used() const;
  bool hangs();
  std::string last_line();
  void close_input();
  void close_log();

  std::FILE* log_;  ///< a file, not a pipe: it never fills up
  Interrupted interrupted_;
  std::uint64_t sent_ = 0;                                     // bytes that ffmpeg has read or will read
  std::optional<std::pair<std::uint64_t, double>> last_done_;  // bytes sent and processor time
  std::chrono::steady_clock::time_point last_change_;          // of last_done_
  bool hung_ = false;                                          // ended by `hangs`
  int input_ = -1;
  pid_t process_ = -1;
};

}  // namespace souple::render
