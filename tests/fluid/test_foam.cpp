#include "souple/fluid/density_solver.h"
#include "souple/fluid/foam.h"
#include "souple/fluid/foam_bodies.h"
#include "tests/count_allocations.h"
#include "tests/fluid/fluid_arrays.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_foam {

using test::FluidArrays;

constexpr float d = 0.02f, dt = 1.0f / 60;
constexpr Vec3f gravity{0, -9.81f, 0};

void no_walls(std::span<const Vec3f>, std::span<Vec3f>, std::span<Vec3f>) {}

Foam::Report step(Foam& foam, FluidArrays& fluid, const FoamParameters& parameters = {}) {
  static std::uint64_t seed = 0;
  const FluidView view = fluid.view();
  return foam.step(
      {.fluid = view, .particle = fluid.order.order(), .gravity = gravity, .dt = dt, .seed = ++seed},
      parameters, no_walls, *fluid.threads);
}

/// A pool of 20 x 16 x 20 spacings with a uniform velocity, its middle column at x = z = 10 d.
FluidArrays pool(const Vec3f& velocity) {
  FluidArrays fluid(test::block_of(20, 16, 20, d, 0.1f), d, 1000, 0);
  fluid.set_velocities([&](const Vec3f&) { return velocity; });
  return fluid;
}

TEST(Foam, APoolAtRestMakesNone) {
  FluidArrays fluid = pool({});
  test::Random random(1);
  fluid.set_velocities([&](const Vec3f&) { return Vec3f(random.point(-0.01, 0.01)); });
  Foam foam;
  for (int s = 0; s < 10; ++s) EXPECT_EQ(step(foam, fluid).made, 0);
  EXPECT_EQ(foam.size(), 0);
}

TEST(Foam, SprayFallsFreely) {
  FluidArrays fluid = pool({});
  Foam foam;
  foam.add({0.2f, 1, 0.2f}, {1, 3, 0}, 2);
  for (int s = 0; s < 30; ++s) EXPECT_EQ(step(foam, fluid).spray, 1);
  EXPECT_LT(length(foam.positions()[0] - Vec3f(0.7f, 1 + 1.5f - 0.125f * 9.81f, 0.2f)), 1e-4f);
  EXPECT_LT(length(foam.velocities()[0] - Vec3f(1, 3 - 0.5f * 9.81f, 0)), 1e-4f);
}

TEST(Foam, MovesWithTheSurfaceAndDissolves) {
  FluidArrays fluid = pool({0.1f, 0, 0.05f});
  Foam foam;
  const Vec3f start(10 * d, 16 * d, 10 * d);
  foam.add(start, {}, 0.5f);
  for (int s = 0; s < 29; ++s) {
    EXPECT_EQ(step(foam, fluid).foam, 1);
    const float t = float(s + 1) * dt;
    EXPECT_LT(length(foam.positions()[0] - start - Vec3f(0.1f, 0, 0.05f) * t), 1e-5f);
  }
  step(foam, fluid);
  step(foam, fluid);
  EXPECT_EQ(foam.size(), 0);
}

// Bubbles rise at buoyancy g / drag relative to the fluid; at the surface they become foam.
TEST(Foam, BubblesRise) {
  FluidArrays fluid = pool({0.1f, 0, 0});
  Foam foam;
  foam.add({8 * d, 4 * d, 10 * d}, {}, 1);
  for (int s = 0; s < 20; ++s) EXPECT_EQ(step(foam, fluid).bubbles, 1);
  const FoamParameters usual;
  EXPECT_NEAR(foam.velocities()[0].y, usual.buoyancy * 9.81f / usual.drag, 1e-3f);
  EXPECT_NEAR(foam.velocities()[0].x, 0.1f, 1e-3f);
  for (int s = 0; s < 30; ++s) step(foam, fluid);
  EXPECT_EQ(foam.kinds()[0], FoamKind::foam);
  EXPECT_NEAR(foam.positions()[0].y, 16 * d, d);
}

// Colliding streams trap air; separating streams do not.
TEST(Foam, StreamsThatMeetMakeIt) {
  for (const float speed : {3.0f, -3.0f}) {
    FluidArrays fluid = pool({});
    fluid.set_velocities([&](const Vec3f& x) { return Vec3f(x.x < 10 * d ? speed : -speed, 0, 0); });
    Foam foam;
    const auto report = step(foam, fluid, {.wave_crest_rate = 0});
    if (speed > 0) {
      EXPECT_GT(report.made, 100);
      for (const Vec3f& x : foam.positions()) EXPECT_LT(std::abs(x.x - 10 * d), 6 * d);
    } else {
      EXPECT_EQ(report.made, 0);
    }
  }
}

// A crest is a curved surface with outward flow; a flat surface has none.
TEST(Foam, CrestsMakeIt) {
  const auto made = [](const Vec3f& velocity, const std::vector<Vec4f>& particles) {
    FluidArrays fluid(particles, d, 1000, 0);
    fluid.set_velocities([&](const Vec3f&) { return velocity; });
    Foam foam;
    return step(foam, fluid, {.trapped_air_rate = 0, .wave_crest = {1, 4}}).made;
  };
  const Vec3f slope = Vec3f(3, 3, 0);
  EXPECT_GT(made(slope, test::block_of(20, 8, 8, d)), 0);  // out of an edge
  const std::vector<Vec4f> wide = test::block_of(30, 6, 30, d, 0.1f);
  FluidArrays flat(wide, d, 1000, 0);
  flat.set_velocities([](const Vec3f& x) {
    return std::max(std::abs(x.x - 15 * d), std::abs(x.z - 15 * d)) < 10 * d ? Vec3f(0, 4, 0) : Vec3f();
  });
  Foam foam;
  EXPECT_EQ(step(foam, flat, {.trapped_air_rate = 0, .wave_crest = {1, 4}}).made, 0);
}

/// For water of half a meter: more foam, at lower speeds.
constexpr FoamParameters small_scale{
    .trapped_air = {5, 20}, .wave_crest = {1, 4}, .energy = {0.125f, 3}, .life = {1, 4}};

/// A dam break: a block of 20 x 20 x 8 spacings in a box of 40 x 8.
struct DamBreak {
  static constexpr int nx = 20, ny = 20, nz = 8, width = 40;
  std::unique_ptr<Threads> threads;
  DensitySolver solver{d, {}};
  std::vector<Vec4f> positions = test::block_of(nx, ny, nz, d), x, v;
  std::vector<Vec3f> velocity, slopes;
  Foam foam;
  Foam::Report report;
  std::uint64_t seed = 0;

  explicit DamBreak(int thread_count)
      : threads(make_threads(Threading::pool, thread_count)),
        x(positions.size() + 1),
        v(positions.size() + 1),
        velocity(positions.size()),
        slopes(positions.size()) {
    for (Vec4f& p : positions) p.w = 1 / (1000 * d * d * d);
  }
  struct Box : FixedBoundary {
    explicit Box(const Smoothing& s) : smoothing(s) {}
    const Smoothing& smoothing;
    BoundarySums sample(std::size_t, const Vec3f& at) const {
      const float distance[] = {at.x, width * d - at.x, at.y, at.z, nz * d - at.z};
      const Vec3f normal[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
      BoundarySums sums;
      float left = 1;
      for (int a = 0; a < 5; ++a) {
        const Smoothing::Wall wall = smoothing.wall(distance[a]);
        sums.slope = sums.slope * (1 - wall.value) + normal[a] * (wall.slope * left);
        left *= 1 - wall.value;
      }
      sums.value = 1 - left;
      return sums;
    }
  };
  static void keep_in(Vec3f& at, Vec3f& speed) {
    const Vec3f low{0, 0, 0}, high{width * d, 100, nz * d};
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < low[axis]) at[axis] = low[axis], speed[axis] = std::max(speed[axis], 0.0f);
      if (at[axis] > high[axis]) at[axis] = high[axis], speed[axis] = std::min(speed[axis], 0.0f);
    }
  }
  void substep(float h) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      velocity[i] += gravity * h;
      Vec3f at = positions[i].xyz() + velocity[i] * h;
      keep_in(at, velocity[i]);
      positions[i].set_xyz(at);
    }
    solver.set_positions(positions, *threads);
    Box box{solver.smoothing()};
    solver.solve(box, *threads);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const std::uint32_t i = solver.order()[k];
      x[k] = solver.positions()[k];
      positions[i].set_xyz(x[k].xyz());
      velocity[i] += solver.moved()[k] * (1 / h);
      v[k] = {velocity[i].x, velocity[i].y, velocity[i].z, 0};
    }
    x.back() = {1e15f, 1e15f, 1e15f, 0};
  }
  void frame(const FoamParameters& parameters) {
    for (int s = 0; s < 6; ++s) substep(dt / 6);
    const Box box{solver.smoothing()};
    for (std::size_t k = 0; k < positions.size(); ++k) slopes[k] = box.sample(k, x[k].xyz()).slope;
    const FluidView view{x, v, solver.neighbors(), solver.smoothing()};
    const auto keep_all_in = [](auto, std::span<Vec3f> at, std::span<Vec3f> speed) {
      for (std::size_t k = 0; k < at.size(); ++k) keep_in(at[k], speed[k]);
    };
    report = foam.step({.fluid = view,
                        .particle = solver.order(),
                        .wall_slopes = slopes,
                        .gravity = gravity,
                        .dt = dt,
                        .seed = ++seed},
                       parameters, keep_all_in, *threads);
  }
};

// Foam appears at the impact on the far wall, not before; all particles stay in the box and within the limit.
TEST(Foam, ADamBreakFoamsWhenItHitsTheWall) {
  DamBreak dam(2);
  FoamParameters parameters = small_scale;
  parameters.max_particles = 3000;
  std::size_t before = 0, after = 0, largest = 0, thinned = 0;
  Foam::Report seen;
  for (int f = 0; f < 70; ++f) {
    dam.frame(parameters);
    if (f < 12) before += dam.report.made;
    if (f >= 12 && f < 24) after += dam.report.made;
    largest = std::max(largest, dam.foam.size());
    thinned += dam.report.thinned;
    seen.spray = std::max(seen.spray, dam.report.spray);
    seen.foam = std::max(seen.foam, dam.report.foam);
    seen.bubbles = std::max(seen.bubbles, dam.report.bubbles);
    ASSERT_EQ(dam.report.spray + dam.report.foam + dam.report.bubbles, dam.foam.size());
    for (const Vec3f& at : dam.foam.positions()) {
      Vec3f in = at, speed{};
      DamBreak::keep_in(in, speed);
      ASSERT_LT(length(in - at), 0.5f * d) << f;
    }
  }
  EXPECT_GT(after, 4 * before);
  EXPECT_GT(seen.spray, 20);
  EXPECT_GT(seen.foam, 100);
  EXPECT_GT(seen.bubbles, 100);
  EXPECT_EQ(largest, parameters.max_particles);
  EXPECT_GT(thinned, 0);
}

TEST(Foam, AllocatesNothingWhenWarm) {
  FluidArrays fluid = pool({0.1f, 0, 0});
  Foam foam;
  for (int k = 0; k < 100; ++k) foam.add({0.1f, 0.05f * float(k % 8), 0.2f}, {}, 100);
  step(foam, fluid);
  const long before = test::allocations();
  step(foam, fluid);
  EXPECT_EQ(test::allocations(), before);
}

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

}  // namespace souple::test_fluid_foam
