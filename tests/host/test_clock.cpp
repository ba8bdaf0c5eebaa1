#include "souple/host/clock.h"
#include "souple/host/fixed_step.h"
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

TEST(FixedStep, MakesTheStepsThatFramesOfAnyLengthNeed) {
  for (const double rate : {24.0, 60.0, 75.0, 144.0}) {
    FixedStep clock(1.0 / 60);
    int steps = 0;
    for (int i = 0; i < static_cast<int>(10 * rate); ++i) {
      steps += clock.advance(1 / rate);
      EXPECT_GE(clock.fraction(), 0);
      EXPECT_LT(clock.fraction(), 1 + 1e-9);
      EXPECT_NEAR(steps * clock.step() + clock.fraction() * clock.step(), (i + 1) / rate, 1e-7);
    }
    EXPECT_NEAR(steps, 600, 1) << rate;
    EXPECT_EQ(clock.dropped(), 0);
  }
}

TEST(FixedStep, OfFramesOfItsOwnLengthMakesOneEach) {
  FixedStep clock(1.0 / 60);
  for (int i = 0; i < 10'000; ++i) ASSERT_EQ(clock.advance(1.0 / 60), 1) << i;
}

TEST(FixedStep, DropsWhatIsTooMuch) {
  FixedStep clock(0.01, 3);
  EXPECT_EQ(clock.advance(1.005), 3);
  EXPECT_NEAR(clock.dropped(), 0.97, 1e-9);
  EXPECT_NEAR(clock.fraction(), 0.5, 1e-6);
  EXPECT_EQ(clock.advance(0), 0);
  EXPECT_EQ(clock.advance(-1), 0);
  EXPECT_EQ(clock.advance(std::numeric_limits<double>::infinity()), 0);
  EXPECT_EQ(clock.advance(std::nan("")), 0);
  clock.restart();
  EXPECT_EQ(clock.fraction(), 0);
  expect_error([] { FixedStep(0); }, {"fixed step", "positive"});
  expect_error([] { FixedStep(0.1, 0); }, {"at least one"});
}

TEST(InterpolatedPositions, LieBetweenTheLastTwoStates) {
  InterpolatedPositions motion;
  const Vec3f first[] = {{0, 0, 0}, {1, 1, 1}}, second[] = {{2, 0, 0}, {1, 3, 1}};
  motion.take(first, 2);
  Vec3f out[2];
  motion.write(0.5, out);
  EXPECT_EQ(out[1], first[1]);  // a jump, not from nowhere
  motion.take(second, 2);
  struct Vertex {
    Vec3f position;
    float u, v;
  } vertices[2] = {{{}, 7, 8}, {{}, 9, 10}};
  motion.write(0.25, vertices, sizeof(Vertex));
  EXPECT_EQ(vertices[0].position, (Vec3f{0.5f, 0, 0}));
  EXPECT_EQ(vertices[1].position, (Vec3f{1, 1.5f, 1}));
  EXPECT_EQ(vertices[1].v, 10);
  motion.restart();
  motion.take(first, 2);
  motion.write(0, out);
  EXPECT_EQ(out[1], first[1]);
}

}  // namespace souple::host::test_host_clock
