#include "app/view/clock.h"

#include <algorithm>

namespace souple::viewer {

void Clock::tick(double seconds) {
  if (!(seconds > 0)) return;
  due_ += seconds;
  real_ += seconds;
  measure();
}

bool Clock::consume(double dt) {
  // A step is due once half of its time has passed: otherwise a screen of 59.94 Hz would skip one now and
  // then.
  if (due_ < 0.5 * dt) return false;
  due_ -= dt;
  simulated_ += dt;
  return true;
}

void Clock::drop() {
  due_ = std::min(due_, 0.0);
}

void Clock::measure() {
  constexpr double window = 0.5;  // s
  if (real_ < window) return;
  speed_ = simulated_ / real_;
  real_ = simulated_ = 0;
}

}  // namespace souple::viewer
