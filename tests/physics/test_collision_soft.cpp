#include "tests/physics/collision_cases.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

// Soft bodies in a glass: they stay inside it and outside each other, and come to rest.

namespace souple::test_physics_collision_soft {

// Test of the measure: the intersection of two equal balls is a lens.
TEST(BallsInAGlass, SharedVolumeIsThatOfALens) {
  World world;
  const TetMesh ball = tet_ball(3, 3, 0.5);
  std::vector<ObjectId> balls{world.add_soft_body(ball)};
  balls.push_back(world.add_soft_body(ball, {}, {.transform = {.translation = {0.6, 0, 0}}}));
  const double r = 0.5, d = 0.6, lens = pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12;
  EXPECT_NEAR(test::shared_volume(world, balls, ball), lens / (4 * pi / 3 * r * r * r), 0.01);
}

void drop_and_look(int count, double seconds, int every, double calm) {
  test::Glass glass = test::balls_in_glass(count);
  World& world = glass.world;
  double drop = 0, shared = 0;
  const auto energy = [&] {
    double sum = 0;
    for (const ObjectId ball : glass.balls) sum += world.kinetic_energy(ball);
    return sum;
  };
  const int frames = static_cast<int>(seconds * 60);
  for (int frame = 1; frame <= frames; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    drop = std::max(drop, energy());
    if (frame % every != 0) continue;
    ASSERT_EQ(test::crossing_counter_of(world).crossings(), 0u) << "frame " << frame;
    shared = std::max(shared, test::shared_volume(world, glass.balls, glass.ball));
  }
  EXPECT_LT(shared, 0.01);
  EXPECT_LT(energy(), 1e-4 * drop);
  double top = 0;
  for (const ObjectId ball : glass.balls) {
    top = std::max(top, test::top_speed(world, ball));
    for (const Vec3f& x : world.positions(ball)) {
      EXPECT_GT(double(x.y), 0.03) << "below the bottom";
      EXPECT_LT(double(x.y), 0.03 + glass.height) << "above the rim";
      EXPECT_LT(std::hypot(double(x.x), double(x.z)), glass.radius) << "beyond the wall";
    }
  }
  EXPECT_LT(top, calm);
}

TEST(BallsInAGlass, StayInItAndComeToRest) {
  drop_and_look(12, 3, 2, 0.01);
}

TEST(BallsInAGlass, FiftyStayInItAndComeToRestSlow) {
  drop_and_look(50, 30, 10, 0.05);
}

// With the default settings the solver moves the lower bodies by more than a millimeter back and forth in
// each substep. Contacts must exist before that; otherwise they alternate and the heap vibrates at 1 m/s.
TEST(BallsInAGlass, AHeapDoesNotTrembleWithFewSubsteps) {
  test::Glass glass = test::balls_in_glass(20, {});
  double drop = 0;
  const auto energy = [&] {
    double sum = 0;
    for (const ObjectId ball : glass.balls) sum += glass.world.kinetic_energy(ball);
    return sum;
  };
  for (int frame = 0; frame < 4 * 60; ++frame) {
    glass.world.step(1.0 / 60);
    drop = std::max(drop, energy());
  }
  EXPECT_LT(energy(), 1e-4 * drop);
  for (const ObjectId ball : glass.balls) EXPECT_LT(test::top_speed(glass.world, ball), 0.3);
}

}  // namespace souple::test_physics_collision_soft
