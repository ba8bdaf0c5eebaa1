#include "tests/count_allocations.h"
#include "tests/rigid/convex_pairs.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace souple::test_rigid_manifold_random {

using test::Random;

/// Two random shapes that overlap or are near each other.
struct RandomPair {
  ConvexShape a, b;
  BodyPose pose_a, pose_b;
  double tolerance;  // of depth and separation: of the choice of the axis, and of points beside a face [m]

  explicit RandomPair(Random& random) : a(test::random_shape(random, 1)), b(test::random_shape(random, 1)) {
    pose_a = test::random_pose(random, 3);
    const double reach = a.outer_radius + b.outer_radius;
    pose_b = test::random_pose(random, 1);
    pose_b.position = pose_a.position + test::random_unit(random) * random.uniform(0.2, 1) * reach;
    tolerance = axis_tolerance(a, b) + 2 * 5e-4 * std::min(a.outer_radius, b.outer_radius);
  }
  double largest_separation(Random& random, int random_axes) const {
    return test::largest_separation(a, pose_a, b, pose_b, random, random_axes);
  }
};

constexpr double margin = 0.3;

TEST(RandomManifolds, MovingByTheSeparationMakesShapesJustTouch) {
  Random random(1);
  int touching = 0, apart = 0, none = 0;
  double largest_error = 0;
  for (int i = 0; i < 10000; ++i) {
    RandomPair pair(random);
    const Manifold m = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, margin);
    if (m.count == 0) {
      ++none;
      continue;
    }
    const double separation = test::least_separation(m);
    ++(separation < 0 ? touching : apart);
    ASSERT_NEAR(length(m.normal), 1, 1e-12);
    pair.pose_a.position -= m.normal * separation;
    // The normal itself separates them, and no axis separates them by more.
    const double along = test::separation_along(pair.a, pair.pose_a, pair.b, pair.pose_b, m.normal);
    ASSERT_NEAR(along, 0, pair.tolerance) << "pair " << i;
    const double largest = pair.largest_separation(random, 200);
    ASSERT_LE(largest, pair.tolerance) << "pair " << i << ", separation " << separation;
    largest_error = std::max({largest_error, std::abs(along), largest});
  }
  EXPECT_GT(touching, 3000);
  EXPECT_GT(apart, 1000);
  RecordProperty("largest_error", fmt::format("{:g}", largest_error));
}

TEST(RandomManifolds, ADepthIsTheLeastByWhichSomeAxisSeparates) {
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const RandomPair pair(random);
    const Manifold m = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, margin);
    const double largest = pair.largest_separation(random, 200);
    if (m.count == 0) {
      // Some axis separates cores by the margin: of the sampled ones, or the one between the closest points.
      ASSERT_GT(largest, 0) << "pair " << i;
    } else {
      ASSERT_NEAR(test::least_separation(m), std::max(largest, test::least_separation(m)), pair.tolerance)
          << "pair " << i;
    }
  }
}

TEST(RandomManifolds, AreNoneOnlyBeyondTheMargin) {
  Random random(8);
  int none = 0;
  for (int i = 0; i < 2000; ++i) {
    const RandomPair pair(random);
    const double near = 0.02;
    if (test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, near).count > 0) continue;
    ++none;
    // With a larger margin there are points, farther than the smaller one.
    const Manifold m = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, 10);
    ASSERT_GT(m.count, 0) << "pair " << i;
    ASSERT_GT(test::least_separation(m), near - pair.tolerance) << "pair " << i;
    // The points are those at which the shapes are nearest: no axis separates by more.
    ASSERT_LE(pair.largest_separation(random, 200), test::least_separation(m) + 1e-9) << "pair " << i;
    const double along = test::separation_along(pair.a, pair.pose_a, pair.b, pair.pose_b, m.normal);
    ASSERT_NEAR(along, test::least_separation(m), pair.tolerance) << "pair " << i;
  }
  EXPECT_GT(none, 500);
}

TEST(RandomManifolds, OfMovingShapesDoNotDependOnTheCacheBeyondTheTolerance) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    RandomPair pair(random);
    const Vec3d toward = normalized(pair.pose_b.position - pair.pose_a.position),
                axis = test::random_unit(random);
    AxisCache cache;
    for (int step = 0; step < 50; ++step) {
      pair.pose_a.position += toward * 0.005;
      pair.pose_a.rotation = normalized(Quatd::from_axis_angle(axis, 0.01) * pair.pose_a.rotation);
      const Manifold m = find_manifold(pair.a, pair.pose_a, pair.b, pair.pose_b, margin, cache);
      const Manifold fresh = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, margin);
      ASSERT_EQ(m.count > 0, fresh.count > 0) << "pair " << i << " step " << step;
      if (m.count == 0) continue;
      // Depth along the normal: a face leaves out points beyond its sides, so those found may be less deep.
      const auto depth = [&](const Manifold& found) {
        return test::separation_along(pair.a, pair.pose_a, pair.b, pair.pose_b, found.normal);
      };
      ASSERT_NEAR(depth(m), depth(fresh), pair.tolerance) << "pair " << i << " step " << step;
    }
  }
}

TEST(RandomManifolds, AreSymmetric) {
  Random random(3);
  int same_points = 0, all = 0;
  for (int i = 0; i < 5000; ++i) {
    const RandomPair pair(random);
    const Manifold m = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, margin);
    const Manifold w = test::find_fresh(pair.b, pair.pose_b, pair.a, pair.pose_a, margin);
    ASSERT_EQ(m.count > 0, w.count > 0) << "pair " << i;
    if (m.count == 0) continue;
    ++all;
    ASSERT_NEAR(test::least_separation(m), test::least_separation(w), pair.tolerance) << "pair " << i;
    if (length(m.normal + w.normal) < 1e-6 && m.count == w.count) ++same_points;
  }
  EXPECT_GT(same_points, 0.99 * all);
}

TEST(RandomManifolds, PointsLieOnBothSurfaces) {
  Random random(5);
  for (int i = 0; i < 3000; ++i) {
    const RandomPair pair(random);
    const Manifold m = test::find_fresh(pair.a, pair.pose_a, pair.b, pair.pose_b, margin);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k) {
      const ManifoldPoint& p = m.points[k];
      const Vec3d on_a = pair.pose_a.point(p.on_a), on_b = pair.pose_b.point(p.on_b);
      ASSERT_NEAR(length(on_a - on_b - m.normal * p.separation), 0, pair.tolerance) << "pair " << i;
      // Within the shapes.
      for (int j = 0; j < 20; ++j) {
        const Vec3d n = test::random_unit(random);
        ASSERT_LE(dot(n, on_a), test::reach(pair.a, pair.pose_a, n) + pair.tolerance) << "pair " << i;
        ASSERT_LE(dot(n, on_b), test::reach(pair.b, pair.pose_b, n) + pair.tolerance) << "pair " << i;
      }
    }
  }
}

TEST(RandomManifolds, OfAllSizesAreAlike) {
  for (const double scale : {1e-3, 100.0}) {
    Random random(6), same(6);
    for (int i = 0; i < 500; ++i) {
      const ConvexShape a = test::random_shape(random, 1), large_a = test::random_shape(same, scale);
      const ConvexShape b = test::random_shape(random, 1), large_b = test::random_shape(same, scale);
      const BodyPose pose_a = test::random_pose(random, 0.5), pose_b = test::random_pose(random, 1.5);
      BodyPose large_pose_a = test::random_pose(same, 0.5), large_pose_b = test::random_pose(same, 1.5);
      large_pose_a.position *= scale, large_pose_b.position *= scale;
      const Manifold m = test::find_fresh(a, pose_a, b, pose_b, margin);
      const Manifold large = test::find_fresh(large_a, large_pose_a, large_b, large_pose_b, margin * scale);
      ASSERT_EQ(m.count, large.count) << "pair " << i;
      if (m.count == 0) continue;
      ASSERT_LT(length(m.normal - large.normal), 1e-6) << "pair " << i;
      ASSERT_NEAR(test::least_separation(large) / scale, test::least_separation(m), 1e-6) << "pair " << i;
    }
  }
}

TEST(RandomManifolds, AllocateNothing) {
  Random random(7);
  std::vector<RandomPair> pairs;
  pairs.reserve(500);
  for (int i = 0; i < 500; ++i) pairs.emplace_back(random);
  const long before = test::allocations();
  int points = 0;
  for (const RandomPair& pair : pairs) {
    AxisCache cache;
    for (int repeat = 0; repeat < 2; ++repeat) {
      points += find_manifold(pair.a, pair.pose_a, pair.b, pair.pose_b, margin, cache).count;
    }
    points += find_manifold(pair.a, pair.pose_a, Plane{}, pair.pose_b, margin).count;
    points += find_manifold(pair.a, pair.pose_a, ContactTriangle{{{{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}}}},
                            pair.pose_b, margin, cache)
                  .count;
  }
  EXPECT_EQ(test::allocations() - before, 0);
  EXPECT_GT(points, 500);
}

}  // namespace souple::test_rigid_manifold_random
