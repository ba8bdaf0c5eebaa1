#include "tests/physics/collision_cases.h"

#include <string>

#include <gtest/gtest.h>

// A ball of grains at 200 m/s, 17 cm per substep, passes through nothing. However fast objects are, memory is bounded by
// their meshes: motions that contacts cannot follow are shortened, and the step says so.

namespace souple::test_physics_collision_fast {

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
    ASSERT_EQ(test::crossings(world), 0u) << "frame " << frame;
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

/// A held sheet of 1 m, another one half a meter above it that flies down at `speed`.
struct TwoSheets {
  World world;
  ObjectId low, high;
};

TwoSheets two_sheets(double speed, bool held) {
  TwoSheets scene;
  const TriangleMesh sheet = grid(24, 24, 1);
  scene.low = scene.world.add_cloth(sheet, material::cotton, {.name = "low"});
  if (held) scene.world.pin(scene.low, all());
  scene.high = scene.world.add_cloth(sheet, material::cotton,
                                     {.name = "high",
                                      .transform = {.translation = {0.02, 0.5, 0.01}},
                                      .velocity = Vec3f{0.1f, -1, 0.05f} * static_cast<float>(speed),
                                      .self_collision = SelfCollision::surfaces});
  return scene;
}

std::size_t memory_after_two_frames(double speed) {
  TwoSheets scene = two_sheets(speed, true);
  for (int frame = 0; frame < 2; ++frame) {
    const StepReport& report = scene.world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << report.message;
    EXPECT_EQ(test::crossings(scene.world), 0u) << speed << " m/s, frame " << frame;
  }
  return MemoryReport::total(scene.world.memory().simulation);
}

TEST(FastSheets, MemoryDoesNotFollowTheSpeed) {
  const std::size_t calm = memory_after_two_frames(1);
  for (const double speed : {30.0, 100.0, 1e3, 1e4, 1e6})
    EXPECT_LT(memory_after_two_frames(speed), 10 * calm + (std::size_t{16} << 20)) << speed << " m/s";
}

TEST(FastSheets, AShortenedMotionIsReportedWithObjectAndSpeed) {
  TwoSheets scene = two_sheets(1e5, true);
  const StepReport& report = scene.world.step(1.0 / 60);
  EXPECT_TRUE(report.has(Flag::shortened_motion));
  EXPECT_NE(report.message.find("'high' moves at 1.01e+05 m/s"), std::string::npos) << report.message;
  EXPECT_FALSE(two_sheets(10, true).world.step(1.0 / 60).has(Flag::shortened_motion));
}

TEST(FastSheets, ObjectsThatFlyTogetherKeepTheirSpeed) {
  TwoSheets scene = two_sheets(0, false);
  for (const ObjectId sheet : {scene.low, scene.high}) {
    const std::vector<Vec3f> velocities(scene.world.positions(sheet).size(), {3e4f, 0, 4e4f});
    scene.world.set_velocities(sheet, velocities);
  }
  for (int frame = 0; frame < 3; ++frame)
    EXPECT_FALSE(scene.world.step(1.0 / 60).has(Flag::shortened_motion)) << scene.world.report().message;
  EXPECT_NEAR(scene.world.momentum(scene.low).x / scene.world.total_mass(scene.low), 3e4, 1);
}

TEST(FastSheets, ADrivenObstacleLagsAndCatchesUp) {
  World world;
  world.add_cloth(grid(14, 14, 1), material::cotton, {.self_collision = SelfCollision::surfaces});
  // 6 m/s, then 3.6 m within one frame.
  const ObjectId ball = world.add_obstacle(
      sphere(2, 0.2), {},
      {.pose = ColliderMotion::keyframes(
           {{0, {0, 0.5, 0}}, {1.0 / 60, {0, 0.4, 0}}, {2.0 / 60, {0, -3.2, 0}}, {1, {0, -3.6, 0}}})});
  bool shortened = false;
  for (int frame = 0; frame < 20; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    shortened = shortened || report.has(Flag::shortened_motion);
    if (!shortened) {
      ASSERT_EQ(test::crossings(world), 0u) << "frame " << frame;
    }
  }
  EXPECT_TRUE(shortened);
  Vec3d center;
  for (const Vec3f& x : world.positions(ball))
    center += Vec3d(x) / static_cast<double>(world.positions(ball).size());
  EXPECT_NEAR(center.y, -3.2 - 0.4 * (18.0 / 58), 0.01);
}

// A ball of 16 kg at 50 m/s stretches the cloth to several times its size, but does not pass.
TEST(FastBall, AClothPinnedAtItsCornersHoldsAt50MetersPerSecond) {
  World world;
  const int n = 16;
  const ObjectId sheet = world.add_cloth(grid(n, n, 1), material::cotton,
                                         {.name = "sheet", .self_collision = SelfCollision::surfaces});
  world.pin(sheet, vertices({0, n - 1, n * (n - 1), n * n - 1}));
  const ObjectId ball = world.add_soft_body(
      tet_ball(2, 2, 0.15), material::rubber,
      {.name = "ball", .transform = {.translation = {0, 0.3, 0}}, .velocity = {0, -50, 0}});
  EXPECT_GT(world.total_mass(ball), 10);
  for (int frame = 1; frame <= 12; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    ASSERT_EQ(test::crossings(world), 0u) << "frame " << frame;
  }
}

}  // namespace souple::test_physics_collision_fast
