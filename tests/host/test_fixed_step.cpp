#include "souple/host/fixed_step.h"
#include "tests/expect_error.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::host::test_host_fixed_step {

TEST(FixedStep, MakesTheStepsThatFramesOfAnyLengthNeed) {
  for (const double rate : {24.0, 60.0, 75.0, 144.0}) {
    FixedStep clock(1.0 / 60);
    int steps = 0;
    for (int frame = 0; frame < static_cast<int>(10 * rate); ++frame) {
      steps += clock.advance(1 / rate);
      EXPECT_GE(clock.fraction(), 0);
      EXPECT_LT(clock.fraction(), 1 + 1e-9);
      EXPECT_NEAR(steps * clock.step() + clock.fraction() * clock.step(), (frame + 1) / rate, 1e-7);
    }
    EXPECT_NEAR(steps, 600, 1) << rate;
    EXPECT_EQ(clock.dropped(), 0);
  }
}

TEST(FixedStep, OfFramesOfItsOwnLengthMakesOneEach) {
  FixedStep clock(1.0 / 60);
  for (int frame = 0; frame < 10'000; ++frame) ASSERT_EQ(clock.advance(1.0 / 60), 1) << frame;
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

}  // namespace souple::host::test_host_fixed_step
