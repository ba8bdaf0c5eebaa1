#include "tests/physics/collision_cases.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

// A ball of grains at 200 m/s, 17 cm per substep, passes through nothing. However fast objects are, memory is bounded by
// their meshes: motions that contacts cannot follow are shortened, and the step says so.

namespace souple::test_physics_collision_surfaces {

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
  World world{{.wind = {.air_density = 0}}};
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

// Cloth on supports, folded, knotted and twisted: no edge passes through a triangle.

using test::Support;
using test::Watched;

constexpr Support supports[] = {Support::ball, Support::ring, Support::corner};

// Final shape: the left edge lies over the right part, and most of the cloth is above the floor.
void drape_fold_and_look(int n, Support support, int every) {
  test::DrapeAndFold scene = test::drape_and_fold(n, support);
  World& world = scene.world;
  const int frames = static_cast<int>(scene.end * 60), before = static_cast<int>(scene.fold_at * 60);
  Watched watched = test::run_without_crossings(world, before, every);
  ASSERT_EQ(watched.crossings, 0u) << test::support_name(support) << ", frame " << watched.first_crossed;
  const auto edge_x = [&] {
    double sum = 0;
    for (int row = 0; row < n; ++row)
      sum += double(world.positions(scene.cloth)[static_cast<std::size_t>(row * n)].x) / n;
    return sum;
  };
  const double laid = edge_x();
  watched = test::run_without_crossings(world, frames - before, every);
  EXPECT_EQ(watched.crossings, 0u) << test::support_name(support) << ", frame "
                                   << before + watched.first_crossed;
  EXPECT_TRUE(watched.ok);
  EXPECT_GT(edge_x(), laid + 0.2) << test::support_name(support);
  for (const Vec3f& x : world.positions(scene.cloth)) {
    EXPECT_GT(x.y, -1e-3f);
    if (support == Support::ball) {
      EXPECT_GT(length(x - Vec3f{0, 0.25f, 0}), 0.249f);
    }
  }
}

TEST(ClothCollisions, DrapedAndFoldedNothingPasses) {
  for (const Support support : supports) drape_fold_and_look(29, support, 1);
}

class LargeCloth : public ::testing::TestWithParam<Support> {};
TEST_P(LargeCloth, NothingPassesSlow) {
  drape_fold_and_look(100, GetParam(), 1);
}
INSTANTIATE_TEST_SUITE_P(Slow, LargeCloth, ::testing::ValuesIn(supports),
                         [](const auto& one) { return test::support_name(one.param); });

// It fell from 2 m and lies on the floor.
void drop_and_look(int n, double seconds, int every) {
  test::Heap heap = test::sheet_on_edge(n);
  const Watched watched = test::run_without_crossings(heap.world, static_cast<int>(seconds * 60), every);
  EXPECT_EQ(watched.crossings, 0u) << "frame " << watched.first_crossed;
  EXPECT_TRUE(watched.ok);
  EXPECT_LT(heap.world.center_of_mass(heap.cloth).y, 0.2);
  for (const Vec3f& x : heap.world.positions(heap.cloth)) EXPECT_GT(x.y, -1e-3f);
}

TEST(ClothCollisions, ASheetFallsInAHeapAndNeverPassesThroughItself) {
  drop_and_look(40, 1.2, 1);
}

TEST(ClothCollisions, ALargeHeapNeverPassesItselfSlow) {
  drop_and_look(200, 1.2, 1);
}

void twist_and_look(int around, double turns, double seconds) {
  test::TwistedTube scene = test::twisted_tube(around, turns, seconds);
  const Watched watched = test::run_without_crossings(scene.world, static_cast<int>((seconds + 0.5) * 60));
  EXPECT_EQ(watched.crossings, 0u) << "frame " << watched.first_crossed;
  EXPECT_TRUE(watched.ok);
  // Each ring of its middle third is far narrower than the tube was.
  const auto x = scene.world.positions(scene.tube);
  const std::size_t ring = static_cast<std::size_t>(around), rings = x.size() / ring;
  const std::size_t from = rings / 3, to = 2 * rings / 3, count = (to - from) * ring;
  double mean = 0;
  for (std::size_t k = from; k < to; ++k) {
    Vec3d middle;
    for (std::size_t i = 0; i < ring; ++i) middle += Vec3d(x[k * ring + i]) / double(ring);
    for (std::size_t i = 0; i < ring; ++i)
      mean += length(Vec3d(x[k * ring + i]) - middle) / static_cast<double>(count);
  }
  EXPECT_LT(mean, 0.045);
}

TEST(ClothCollisions, ATubeTwistedByTurnsNeverPassesThroughItself) {
  twist_and_look(14, 3, 2.5);
}

TEST(ClothCollisions, TenTurnsOfATubePassNothingSlow) {
  twist_and_look(16, 10, 8);
}

// Part of the left strip still lies to the right of part of the right strip: they hold each other.
void pull_and_look(int across, double pull, double seconds) {
  test::Knot knot = test::reef_knot(across, pull);
  World& world = knot.world;
  ASSERT_EQ(test::crossings(world), 0u);
  const Watched watched = test::run_without_crossings(world, static_cast<int>(seconds * 60));
  EXPECT_EQ(watched.crossings, 0u) << "frame " << watched.first_crossed;
  EXPECT_LT(watched.largest_strain, 0.4);
  double left = -9, right = 9;
  for (const Vec3f& x : world.positions(knot.left)) left = std::max(left, double(x.x));
  for (const Vec3f& x : world.positions(knot.right)) right = std::min(right, double(x.x));
  EXPECT_GT(left, right + 0.02);
  // The ends separated until the reef knot held.
  EXPECT_LT(world.center_of_mass(knot.left).x, -0.9);
  EXPECT_GT(world.center_of_mass(knot.right).x, 0.6);
}

TEST(ClothCollisions, AKnotHoldsWhenItsEndsArePulled) {
  pull_and_look(5, 2, 4);
}

TEST(ClothCollisions, AFinerKnotHoldsWhenPulledSlow) {
  pull_and_look(7, 1, 6);
}

}  // namespace souple::test_physics_collision_surfaces
