#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/collision/segment_triangle/every_test.h"

#include <array>
#include <set>

// Settings::segment_test selects the ray test of a world's ray casts against meshes.

namespace souple::test::test_segment_triangle_setting {

struct Ball {
  World world;
  ObjectId id;

  Ball() : id(world.add_cloth(sphere(3, 1), material::cotton)) {}
  void choose(SegmentTest test) {
    Settings settings = world.settings();
    settings.segment_test = test;
    world.set_settings(settings);
  }
  /// Number of rays without a hit, of those from inside to every corner and to the middle of every edge.
  int leaks() const {
    const auto x = world.positions(id);
    const Vec3f from{0.1f, 0.2f, -0.3f};
    int count = 0;
    const auto shoot = [&](const Vec3f& target) { count += !world.ray_cast(from, target - from).found; };
    for (const Vec3f& corner : x) shoot(corner);
    for (const Triangle& t : world.triangles(id)) shoot((x[t[0]] + x[t[1]]) * 0.5f);
    return count;
  }
};

TEST(SegmentTestSetting, EveryTestFindsTheSameTriangle) {
  Ball ball;
  ball.choose(SegmentTest::watertight);
  const Hit expected = ball.world.ray_cast({3, 0.2f, 0.1f}, {-1, 0, 0});
  ASSERT_TRUE(expected.found);
  for (const auto& [name, test] : segment_test_names) {
    ball.choose(test);
    const Hit hit = ball.world.ray_cast({3, 0.2f, 0.1f}, {-1, 0, 0});
    ASSERT_TRUE(hit.found) << name;
    EXPECT_EQ(hit.triangle, expected.triangle) << name;
    EXPECT_NEAR(hit.distance, expected.distance, 1e-12) << name;
  }
}

TEST(SegmentTestSetting, TheDefaultLetsNoRayOut) {
  EXPECT_EQ(Ball().leaks(), 0);
}

/// All are right, but each rounds in its own way.
TEST(SegmentTestSetting, IsWhatRaysAreTestedBy) {
  Ball ball;
  const auto distances = [&](SegmentTest test) {
    ball.choose(test);
    std::array<double, 50> found{};
    for (std::size_t i = 0; i < found.size(); ++i)
      found[i] = ball.world.ray_cast({3, 0.01f * static_cast<float>(i), 0.1f}, {-1, 0, 0}).distance;
    return found;
  };
  std::set<std::array<double, 50>> different;
  for (const auto& [name, test] : segment_test_names) different.insert(distances(test));
  EXPECT_GT(different.size(), 2u);
}

}  // namespace souple::test::test_segment_triangle_setting
