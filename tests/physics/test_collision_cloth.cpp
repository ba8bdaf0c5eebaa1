#include "tests/physics/collision_cases.h"

#include <algorithm>

#include <gtest/gtest.h>

// Cloth on supports, folded, knotted and twisted: no edge passes through a triangle.

namespace souple::test_physics_collision_cloth {

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

}  // namespace souple::test_physics_collision_cloth
