#pragma once

// Valid C++17, as every header of this folder.

namespace souple::host {

/// What a frame of the host means for the simulation.
enum class Tick {
  nothing,  ///< its time stands: the host is paused, or only draws again
  step,     ///< its time went on: one step by `Clock::dt`
  reset     ///< its time went back: to the start
};

struct ClockOptions {
  /// No step is longer than this, however long the host was busy with other things. [s]
  double longest_step = 0.1;
};

/// Reads a host's animation time. Hosts ask for a frame at every repaint, also when they are paused, and hand
/// out a positive length of the frame even then; so:
///
/// - Only a time that changed makes a step: one, however far it went.
/// - The step is as long as the frame is said to be, never the difference of two times: there are hosts whose
///   clock goes by twice the frame's length (Radium 1.5), and a difference of floats is another in each
///   frame.
/// - A time that went back is a reset, and no step. So is the end of a time window that loops, and each frame
///   of one that plays backwards: give the host a window without end.
/// - The first frame is a step, whether the host plays or not: its time has left nothing behind it to be
///   compared with. `start_at` says where it stands when that is not meant.
/// - A time that is no number, or a frame's length that is none or not positive, does nothing.
class Clock {
 public:
  /// Throws Error unless the longest step is positive.
  explicit Clock(const ClockOptions& options = {});

  /// The host's time now, and the length of this frame. [s]
  Tick frame(double time, double dt);
  /// Of the last frame whose length was sound, at most the longest step; 1/60 before there was one. [s]
  double dt() const { return dt_; }

  /// The host's time stands here [s]: the first frame is a step only if it is later. Throws Error when it is
  /// not finite.
  void start_at(double time);
  /// As if made anew: the next frame is the first.
  void forget();

 private:
  double longest_step_;
  double time_ = 0;
  bool knows_time_ = false;
  double dt_ = 1.0 / 60;
};

}  // namespace souple::host
