#pragma once

#include "render/gl/api.h"
#include "render/renderer.h"

#include <chrono>
#include <vector>

namespace souple::render {

/// Measures the time of each pass. Inactive, it does nothing; active, it calls glFinish at the end of each
/// pass.
class PassClock {
 public:
  void start(std::vector<PassTime>* times) {
    times_ = times;
    if (times_ != nullptr) glFinish();
    last_ = Clock::now();
  }
  /// Assigns the time since the last call to pass `name`; times of equal names are summed.
  void done(const char* name) {
    if (times_ == nullptr) return;
    glFinish();
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    for (PassTime& time : *times_) {
      if (time.pass != name) continue;
      time.seconds += seconds;
      return;
    }
    times_->push_back({name, seconds});
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<PassTime>* times_ = nullptr;
  Clock::time_point last_{};
};

}  // namespace souple::render
