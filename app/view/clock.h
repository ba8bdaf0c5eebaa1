#pragma once

namespace souple::viewer {

/// Turns real time into steps of equal length. Time that the simulation cannot keep up with is dropped. The simulation
/// then runs slower than real time, by the factor `speed`, instead of falling further and further behind.
class Clock {
 public:
  /// Adds real time that has passed. [s]
  void tick(double seconds);
  /// Returns whether a step of dt [s] is due; if so, subtracts it from the time that is due.
  bool consume(double dt);
  /// Drops the time that is still due.
  void drop();
  /// Resets all measurements, as after a pause.
  void restart() { *this = Clock(); }

  /// Simulated time over real time in the last half second or so; 1 is real time.
  double speed() const { return speed_; }

 private:
  void measure();

  double due_ = 0;
  double real_ = 0, simulated_ = 0;  // since the last measurement
  double speed_ = 1;
};

}  // namespace souple::viewer
