#pragma once

#include "render/renderer.h"

#include <chrono>
#include <epoxy/gl.h>
#include <vector>

namespace souple::render {

/// Says how long each pass took. Off, it does nothing; on, OpenGL finishes all work at the end of each pass.
class PassClock {
 public:
  void start(std::vector<PassTime>* times) {
    times_ = times;
    if (times_ != nullptr) glFinish();
    last_ = Clock::now();
  }
  /// What was drawn since the last call was pass `name`; of several with one name the sum is kept.
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
