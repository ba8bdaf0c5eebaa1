#include "app/progress.h"

#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

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
  char text[64];
  if (bytes < 1e3) {
    std::snprintf(text, sizeof(text), "%.0f bytes", bytes);
    return text;
  }
  const char* unit = bytes < 1e6 ? "kB" : bytes < 1e9 ? "MB" : "GB";
  const double value = bytes / (bytes < 1e6 ? 1e3 : bytes < 1e9 ? 1e6 : 1e9);
  std::snprintf(text, sizeof(text), value < 10 ? "%.1f %s" : "%.0f %s", value, unit);
  return text;
}

std::string duration_text(double seconds) {
  char text[64];
  const long long whole = std::llround(seconds);
  if (whole < 60) {
    std::snprintf(text, sizeof(text), "%lld s", whole);
  } else if (whole < 3600) {
    std::snprintf(text, sizeof(text), "%lld min %02lld s", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof(text), "%lld h %02lld min", whole / 3600, whole / 60 % 60);
  }
  return text;
}

}  // namespace souple::app
