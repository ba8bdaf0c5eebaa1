#include "souple/host/clock.h"
#include "tests/expect_error.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace souple::host::test_host_clock {

constexpr double frame = 1.0 / 60;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(HostClock, StepsOnlyWhenTheTimeWentOn) {
  Clock clock;
  clock.start_at(2);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(clock.frame(2, frame), Tick::nothing);  // paused, with a positive dt
  EXPECT_EQ(clock.frame(2 + frame, frame), Tick::step);
  EXPECT_EQ(clock.frame(2 + frame, frame), Tick::nothing);
  EXPECT_EQ(clock.frame(2 + 2 * frame, frame), Tick::step);
}

/// Radium's clock goes by twice the frame's length: a step is still as long as the frame, and one a frame.
TEST(HostClock, AStepIsAsLongAsTheFrame) {
  Clock clock;
  double time = 0, simulated = 0;
  for (int i = 0; i < 60; ++i) {
    time += 2 * frame;
    ASSERT_EQ(clock.frame(time, frame), Tick::step);
    simulated += clock.dt();
  }
  EXPECT_NEAR(simulated, 1, 1e-12);
  EXPECT_EQ(clock.dt(), frame);  // to the bit, not a difference of times
}

TEST(HostClock, TheFirstFrameStepsThoughNothingPlays) {
  Clock clock;
  EXPECT_EQ(clock.frame(0, frame), Tick::step);
  EXPECT_EQ(clock.frame(0, frame), Tick::nothing);
  clock.forget();
  EXPECT_EQ(clock.frame(0, frame), Tick::step);
  clock.start_at(7);
  EXPECT_EQ(clock.frame(7, frame), Tick::nothing);
  clock.start_at(3);
  EXPECT_EQ(clock.frame(4, frame), Tick::step);
}

TEST(HostClock, TimeThatGoesBackIsAReset) {
  Clock clock;
  EXPECT_EQ(clock.frame(0.5, frame), Tick::step);
  EXPECT_EQ(clock.frame(0, frame), Tick::reset);
  EXPECT_EQ(clock.frame(0, frame), Tick::nothing);
  EXPECT_EQ(clock.frame(frame, frame), Tick::step);
  // A window that plays to and fro: a reset in each frame of the way back.
  EXPECT_EQ(clock.frame(3, frame), Tick::step);
  EXPECT_EQ(clock.frame(2, frame), Tick::reset);
  EXPECT_EQ(clock.frame(1, frame), Tick::reset);
  EXPECT_EQ(clock.frame(2, frame), Tick::step);
}

TEST(HostClock, AHostThatWasBusyMakesOneStepOfSoundLength) {
  Clock clock({0.05});
  EXPECT_EQ(clock.frame(30, 30), Tick::step);
  EXPECT_EQ(clock.dt(), 0.05);
  EXPECT_EQ(clock.frame(31, 0.02), Tick::step);
  EXPECT_EQ(clock.dt(), 0.02);
}

TEST(HostClock, NumbersThatAreNoneDoNothing) {
  Clock clock;
  EXPECT_EQ(clock.frame(nan, frame), Tick::nothing);
  EXPECT_EQ(clock.frame(0, nan), Tick::nothing);
  for (const double dt : {0.0, -1.0, std::numeric_limits<double>::infinity()})
    EXPECT_EQ(clock.frame(1, dt), Tick::nothing) << dt;
  EXPECT_TRUE(clock.dt() > 0);
  EXPECT_EQ(clock.frame(nan, frame), Tick::nothing);
  EXPECT_EQ(clock.frame(1, frame), Tick::nothing);  // the time is known since
  EXPECT_EQ(clock.frame(1.5, frame), Tick::step);
  expect_error([&] { clock.start_at(nan); }, {"not finite"});
  expect_error([] { Clock({0}); }, {"longest_step", "0"});
  expect_error([] { Clock({nan}); }, {"longest_step"});
}

}  // namespace souple::host::test_host_clock
