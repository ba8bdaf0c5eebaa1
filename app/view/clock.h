#pragma once

namespace souple::viewer {

/// Converts real time to steps of constant length. Time that the simulation cannot keep up with is dropped:
/// the simulation then runs slower than real time by the factor `speed`, instead of lagging ever further
/// behind.
class Clock {
 public:
  /// Adds elapsed real time. [s]
  void tick(double seconds);
  /// Whether a step of dt [s] is due; if so, counts it as done.
  bool take(double dt);
  /// Drops the time that is still due.
  void drop();
  /// Resets the clock, for example after a pause.
  void restart() { *this = Clock(); }

  /// Ratio of simulated to real time over about the last half second; 1 is real time.
  double speed() const { return speed_; }

 private:
  void measure();

  double due_ = 0;
  double real_ = 0, simulated_ = 0;  // since the last measurement [s]
  double speed_ = 1;
};

}  // namespace souple::viewer
