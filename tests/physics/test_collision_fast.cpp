#include "tests/physics/collision_cases.h"

#include <gtest/gtest.h>

// A ball of grains at 200 m/s, 17 cm per substep, passes through nothing.

namespace souple {
namespace {

using test::ShotAt;

void shoot_and_look(ShotAt what, int n, int grains) {
  test::Shot shot = test::shot_at(what, n, grains, 200);
  World& world = shot.world;
  std::size_t contacts = 0;
  for (int frame = 1; frame <= 30; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    contacts += report.contacts;
    ASSERT_EQ(test::grains_that_passed(shot), 0u) << "frame " << frame;
    ASSERT_EQ(test::crossing_counter_of(world).crossings(), 0u) << "frame " << frame;
  }
  EXPECT_GT(contacts, 0u);
  EXPECT_GT(world.momentum(shot.grains).y, -0.1 * 200 * world.total_mass(shot.grains));
}

// Result of the checks when nothing stops the grains.
TEST(Shots, GrainsThatPassAreCounted) {
  test::Shot shot = test::shot_at(ShotAt::cloth, 10, 30, 200);
  EXPECT_EQ(test::grains_that_passed(shot), 0u);
  shot.world.teleport(shot.grains, {.translation = {0, -1, 0}});
  EXPECT_EQ(test::grains_that_passed(shot), 30u);
}

TEST(Shots, NoGrainPassesACloth) {
  shoot_and_look(ShotAt::cloth, 24, 200);
}

TEST(Shots, NoGrainPassesASoftBodyOfOneLayer) {
  shoot_and_look(ShotAt::layer, 16, 300);
}

TEST(Shots, NoGrainPassesAFineClothSlow) {
  shoot_and_look(ShotAt::cloth, 40, 400);
}

}  // namespace
}  // namespace souple
