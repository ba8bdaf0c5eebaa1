#include "souple/host/clock.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple::host {

Clock::Clock(const ClockOptions& options) : longest_step_(options.longest_step) {
  if (!(longest_step_ > 0))
    throw Error(fmt::format("clock: longest_step is {} s, expected more than 0", longest_step_));
  dt_ = std::min(dt_, longest_step_);
}

Tick Clock::frame(double time, double dt) {
  if (!std::isfinite(time)) return Tick::nothing;
  const bool first = !knows_time_, went_on = first || time > time_, went_back = !first && time < time_;
  time_ = time;
  knows_time_ = true;
  const bool sound = std::isfinite(dt) && dt > 0;
  if (sound) dt_ = std::min(dt, longest_step_);
  if (went_back) return Tick::reset;
  return went_on && sound ? Tick::step : Tick::nothing;
}

void Clock::start_at(double time) {
  if (!std::isfinite(time)) throw Error("clock: start_at: the time is not finite");
  time_ = time;
  knows_time_ = true;
}

void Clock::forget() {
  knows_time_ = false;
}

}  // namespace souple::host
