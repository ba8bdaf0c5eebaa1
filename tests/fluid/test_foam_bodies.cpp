#include "souple/fluid/foam_bodies.h"
#include "tests/fluid/fluid_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_foam_bodies {

constexpr float gap = 0.002f;

/// A square of two triangles in the plane y = height, one meter wide, that rises by `rise`.
void add_square(FoamBodies& bodies, float height, float rise) {
  const auto corner = [&](float x, float z, float y) { return Vec3f(x, y, z); };
  for (const bool first : {true, false}) {
    std::array<Vec3f, 3> start, end;
    for (const bool moved : {false, true}) {
      const float y = height + (moved ? rise : 0);
      (moved ? end : start) =
          first ? std::array{corner(-0.5f, -0.5f, y), corner(-0.5f, 0.5f, y), corner(0.5f, 0.5f, y)}
                : std::array{corner(-0.5f, -0.5f, y), corner(0.5f, 0.5f, y), corner(0.5f, -0.5f, y)};
    }
    bodies.add(start, end, gap);
  }
}

struct Paths {
  std::vector<Vec3f> start, end;
};

/// Paths up to three meters long that start on one side of the plane y = 0.
Paths paths(int side) {
  test::Random random(4);
  Paths result;
  for (int k = 0; k < 4000; ++k) {
    const Vec3d from = random.point(-0.4, 0.4), path = random.point(-1, 1);
    result.start.push_back(Vec3f(Vec3d(from.x, side * (0.003 + std::abs(from.y)), from.z)));
    result.end.push_back(result.start.back() + Vec3f(path * std::pow(3.0, 1 - k % 8)));
  }
  return result;
}

// A particle that ends on the opposite side must have passed the sheet's edge.
TEST(FoamBodies, NothingGoesThroughASheetThatMoves) {
  const auto threads = make_threads(Threading::pool, 2);
  for (const int side : {1, -1})
    for (const float rise : {0.0f, 0.3f, -0.3f}) {
      FoamBodies bodies;
      add_square(bodies, 0, rise);
      bodies.build(*threads);
      Paths w = paths(side);
      const std::vector<Vec3f> wanted = w.end;
      bodies.keep_out(w.start, w.end, *threads);
      int stopped = 0;
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        // The crossing of the path and the sheet's plane, if any.
        const float before = w.start[k].y, after = w.end[k].y - rise;
        if (before * after < 0) {
          const float t = before / (before - after);
          const Vec3f at = w.start[k] + (w.end[k] - w.start[k]) * t;
          EXPECT_GT(std::max(std::abs(at.x), std::abs(at.z)), 0.499f) << k;
        } else if (std::max(std::abs(w.end[k].x), std::abs(w.end[k].z)) < 0.5f) {
          EXPECT_GT(std::abs(after), 0.99f * gap) << k;
        }
        if (!(w.end[k] == wanted[k])) ++stopped;
      }
      EXPECT_GT(stopped, 150);
    }
}

// A roof of two sheets that join at an angle: no particle escapes through the edge.
TEST(FoamBodies, NothingGetsThroughAnEdge) {
  const auto threads = make_threads(Threading::pool, 2);
  FoamBodies bodies;
  const Vec3f ridge[2]{{0, 0.2f, -5}, {0, 0.2f, 5}};
  for (const float side : {-1.0f, 1.0f}) {
    const std::array<Vec3f, 3> a{ridge[0], ridge[1], Vec3f(5 * side, -4.8f, 5)},
        b{ridge[0], Vec3f(5 * side, -4.8f, 5), Vec3f(5 * side, -4.8f, -5)};
    bodies.add(a, a, gap);
    bodies.add(b, b, gap);
  }
  bodies.build(*threads);
  test::Random random(7);
  Paths w;
  for (int k = 0; k < 2000; ++k) {
    const Vec3d from = random.point(-0.05, 0.05);
    w.start.push_back(Vec3f(from));
    w.end.push_back(Vec3f(from + random.point(-1, 1) * 2 + Vec3d{0, 1, 0}));
  }
  bodies.keep_out(w.start, w.end, *threads);
  for (const Vec3f& x : w.end) EXPECT_LT(x.y + std::abs(x.x), 0.2f) << x.x << " " << x.y << " " << x.z;
}

TEST(FoamBodies, WhatMeetsNothingStaysAsItIs) {
  const auto threads = make_threads(Threading::pool, 1);
  FoamBodies bodies;
  add_square(bodies, 10, 0);
  bodies.build(*threads);
  Paths w = paths(1);
  const std::vector<Vec3f> wanted = w.end;
  bodies.keep_out(w.start, w.end, *threads);
  EXPECT_EQ(w.end, wanted);
}

}  // namespace souple::test_fluid_foam_bodies
