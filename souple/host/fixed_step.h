#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <vector>

// Steps of constant length under frames of any length. Valid C++17.

namespace souple::host {

/// Turns the frames of a game into steps of constant length and keeps the remaining time for the next frame.
///
///   for (int n = clock.advance(frame_seconds); n > 0; --n) step(clock.step());
///   draw(motion.at(clock.fraction()));
class FixedStep {
 public:
  /// `step`: length of a step [s]. `most_steps`: limit for one frame. A world that is slower than real time then runs
  /// in slow motion instead of falling further behind with each frame. Throws Error unless both are positive and
  /// finite.
  explicit FixedStep(double step = 1.0 / 60, int most_steps = 4);

  /// Adds a frame's length [s], and returns the number of steps to make now. A length that is not finite or
  /// negative counts as 0.
  int advance(double frame);
  double step() const { return step_; }  ///< s
  /// Part of the next step that has passed, in [0, 1): positions to show lie between the last two steps.
  double fraction() const { return left_ / step_; }
  /// Time that `most_steps` dropped so far [s].
  double dropped() const { return dropped_; }
  void restart() { left_ = dropped_ = 0; }

 private:
  double step_;
  int most_steps_;
  double left_ = 0, dropped_ = 0;
};

/// The positions of an object after the last two steps, and those between. Call `take` once after each step.
class InterpolatedPositions {
 public:
  /// Copies `count` positions. The first call, and one with another count, sets both states: a jump, as after a
  /// teleport or a reset.
  void take(const Vec3f* positions, std::size_t count);
  /// Forgets the earlier state: the next `take` is a jump.
  void restart() { now_.clear(); }
  /// Writes the positions at `fraction` of the way from the last but one state to the last, in [0, 1]. The array has
  /// `size()` vertices, `stride` bytes apart: a vertex buffer, whatever else a vertex holds.
  void write(double fraction, void* vertices, std::size_t stride = sizeof(Vec3f)) const;
  std::size_t size() const { return now_.size(); }

 private:
  std::vector<Vec3f> before_, now_;
};

}  // namespace souple::host
