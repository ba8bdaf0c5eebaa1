#include "app/progress.h"

#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

#include <fmt/core.h>

namespace souple::app {

Progress::Progress(std::string name, std::uint64_t frames, std::uint64_t done_before, bool quiet)
    : name_(std::move(name)),
      frames_(frames),
      first_(done_before),
      shown_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\033[K", stderr);
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::frame_done(std::uint64_t frame) {
  constexpr auto pause = std::chrono::milliseconds(100);
  const Clock::time_point now = Clock::now();
  if (!shown_ || now - last_ < pause) return;
  last_ = now;
  const double each = seconds() / static_cast<double>(frame - first_);
  const std::string left = duration_text(each * static_cast<double>(frames_ - frame));
  std::fprintf(stderr, "\r\033[K%s: frame %llu of %llu, %.1f ms/frame, %s left", name_.c_str(),
               static_cast<unsigned long long>(frame), static_cast<unsigned long long>(frames_), each * 1e3,
               left.c_str());
  std::fflush(stderr);
}

std::string bytes_text(double bytes) {
  if (bytes < 1e3) return fmt::format("{:.0f} bytes", bytes);
  const char* unit = bytes < 1e6 ? "kB" : bytes < 1e9 ? "MB" : "GB";
  const double value = bytes / (bytes < 1e6 ? 1e3 : bytes < 1e9 ? 1e6 : 1e9);
  return fmt::format("{:.{}f} {}", value, value < 10 ? 1 : 0, unit);
}

std::string duration_text(double seconds) {
  const long long whole = std::llround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace souple::app
