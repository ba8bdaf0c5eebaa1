#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace souple::app {

/// One line that is rewritten on a terminal: frame, ms/frame, time left. Prints nothing when stderr is no
/// terminal.
class Progress {
 public:
  Progress(std::string name, std::uint64_t frames, std::uint64_t done_before, bool quiet);
  /// Erases the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void frame_done(std::uint64_t frame);
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;

  std::string name_;
  std::uint64_t frames_, first_;
  bool shown_;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// "850 bytes", "12 MB", "4.0 GB"
std::string bytes_text(double bytes);

/// "4 s", "2 min 05 s", "1 h 12 min"
std::string duration_text(double seconds);

}  // namespace souple::app
