#pragma once

// Valid C++17, like all headers of this folder.

namespace souple::host {

/// Effect of a host frame on the simulation.
enum class Tick {
  nothing,  ///< host time unchanged: the host is paused, or only redraws
  step,     ///< host time increased: one step of `Clock::dt`
  reset     ///< host time decreased: return to the start
};

struct ClockOptions {
  /// Upper limit of a step, for frames during which the host was busy. [s]
  double longest_step = 0.1;
};

/// Interprets a host's animation time. Hosts request a frame at every repaint, also while paused, and report
/// a positive frame length even then. Therefore:
///
/// - Only a changed time causes a step: exactly one, however large the change.
/// - The step has the reported frame length, never the difference of two times. Some hosts advance their
///   clock
///   by twice the frame length (Radium 1.5), and a difference of floats varies from frame to frame.
/// - A decreased time is a reset without a step. The end of a looping time window and each frame of backward
///   playback are resets too: configure the host with an endless window.
/// - The first frame is a step, even if the host is paused, because there is no earlier time to compare with.
///   `start_at` prevents this step.
/// - A time or a frame length that is not finite, or a frame length <= 0, has no effect.
class Clock {
 public:
  /// Throws Error unless the longest step is positive.
  explicit Clock(const ClockOptions& options = {});

  /// Processes a frame: the host's current time and the frame's length. [s]
  Tick frame(double time, double dt);
  /// Length of the last frame with a valid length, at most longest_step; 1/60 before the first one. [s]
  double dt() const { return dt_; }

  /// Sets the host's current time [s]: the first frame is a step only if its time is later. Throws Error if
  /// the time is not finite.
  void start_at(double time);
  /// Returns to the initial state: the next frame is the first.
  void forget();

 private:
  double longest_step_;
  double time_ = 0;
  bool knows_time_ = false;
  double dt_ = 1.0 / 60;
};

}  // namespace souple::host
