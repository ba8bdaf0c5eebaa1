#pragma once

namespace souple::viewer {

/// Turns real time into steps of one length. Whatever cannot be kept up with is dropped: the simulation then
/// runs slower than real time, and `speed` says how much, instead of falling ever further behind.
class Clock {
 public:
  /// Real time has passed. [s]
  void tick(double seconds);
  /// Whether a step of dt [s] is due; if so, it counts as made.
  bool take(double dt);
  /// Gives up what is still due.
  void drop();
  /// Forgets everything, as after a pause.
  void restart() { *this = Clock(); }

  /// Simulated over real time, of the last half second or so; 1 is real time.
  double speed() const { return speed_; }

 private:
  void measure();

  double due_ = 0;
  double real_ = 0, simulated_ = 0;  // since the last measure
  double speed_ = 1;
};

}  // namespace souple::viewer
