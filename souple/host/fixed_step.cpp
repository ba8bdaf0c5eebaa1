#include "souple/host/fixed_step.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/core.h>

namespace souple::host {

FixedStep::FixedStep(double step, int most_steps) : step_(step), most_steps_(most_steps) {
  if (!(step > 0) || !std::isfinite(step))
    throw Error(fmt::format("fixed step: a step of {} s, expected a positive finite length", step));
  if (most_steps < 1)
    throw Error(fmt::format("fixed step: at most {} steps a frame, expected at least one", most_steps));
}

int FixedStep::advance(double frame) {
  // Frames of 1/60 s, rounded, must make one step each of 1/60 s.
  constexpr double rounding = 1e-9;
  if (frame > 0 && std::isfinite(frame)) left_ += frame;
  const double due = std::floor(left_ / step_ + rounding);
  const int steps = static_cast<int>(std::min(due, static_cast<double>(most_steps_)));
  dropped_ += (due - steps) * step_;
  left_ = std::max(left_ - due * step_, 0.0);
  return steps;
}

void InterpolatedPositions::take(const Vec3f* positions, std::size_t count) {
  const bool jump = now_.size() != count;
  std::swap(before_, now_);
  now_.assign(positions, positions + count);
  if (jump) before_ = now_;
}

void InterpolatedPositions::write(double fraction, void* vertices, std::size_t stride) const {
  const float s = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  auto* out = static_cast<unsigned char*>(vertices);
  for (std::size_t i = 0; i < now_.size(); ++i, out += stride) {
    const Vec3f x = before_[i] + (now_[i] - before_[i]) * s;
    std::memcpy(out, &x, sizeof x);
  }
}

}  // namespace souple::host
