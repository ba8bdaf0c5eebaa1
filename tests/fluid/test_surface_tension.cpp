#include "souple/fluid/density_solver.h"
#include "souple/fluid/surface_tension.h"
#include "souple/fluid/viscosity.h"
#include "tests/count_allocations.h"
#include "tests/fluid/fluid_arrays.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_surface_tension {

constexpr float d = 0.001f, density = 1000, sigma = 0.072f;

/// Water without gravity, with or without a floor at y = 0.
struct Drop {
  std::unique_ptr<Threads> threads;
  DensitySolver solver;
  SurfaceTension tension;
  Viscosity viscosity;
  float adhesion, nu;  // -, m^2/s
  float h = 0.8f * SurfaceTension::max_substep(sigma, density, d);
  std::vector<Vec4f> positions, x, v;
  std::vector<Vec3f> velocity;
  std::vector<NearWall> walls;
  std::vector<Vec4f> friction;
  double rms_speed = 0;  // after the pressure solve, before the forces it will balance [m/s]

  /// `adhesion` below 0: no floor.
  Drop(std::vector<Vec4f> particles, float adhesion_, float nu_, int thread_count = 2,
       SmoothingShape shape = SmoothingShape::wendland)
      : threads(make_threads(Threading::pool, thread_count)),
        solver(d, {.shape = shape}),
        tension(shape),
        viscosity(shape),
        adhesion(adhesion_),
        nu(nu_),
        positions(std::move(particles)),
        x(positions.size() + 1),
        v(positions.size() + 1),
        velocity(positions.size()) {
    for (Vec4f& p : positions) p.w = 1 / mass();
    if (adhesion >= 0) walls.resize(positions.size()), friction.resize(positions.size());
  }
  static float mass() { return density * d * d * d; }
  struct Floor : FixedBoundary {
    explicit Floor(const Drop& which) : drop(which) {}
    const Drop& drop;
    BoundarySums sample(std::size_t, const Vec3f& at) const {
      if (drop.walls.empty()) return {};
      const Smoothing::Wall wall = drop.solver.smoothing().wall(at.y);
      return {wall.value, {0, wall.slope, 0}};
    }
  };
  /// Radius of a ball with the volume of all particles [m].
  double radius() const { return std::cbrt(0.75 / pi * double(positions.size())) * double{d}; }
  void substep() {
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i].set_xyz(positions[i].xyz() + velocity[i] * h);
    solver.set_positions(positions, *threads);
    Floor floor{*this};
    solver.solve(floor, *threads);
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const std::uint32_t i = solver.order()[k];
      x[k] = solver.positions()[k];
      positions[i].set_xyz(x[k].xyz());
      velocity[i] += solver.moved()[k] * (1 / h);
      v[k] = {velocity[i].x, velocity[i].y, velocity[i].z, nu * density};
      if (!walls.empty()) {
        walls[k] = {{0, 1, 0}, x[k].y};
        friction[k] = {0, 0, 0, solver.smoothing().wall(x[k].y).value};
      }
    }
    double squared = 0;
    for (const Vec3f& at : velocity) squared += double{dot(at, at)};
    rms_speed = std::sqrt(squared / double(velocity.size()));
    x.back() = {1e15f, 1e15f, 1e15f, 0};
    const FluidView fluid{x, v, solver.neighbors(), solver.smoothing()};
    tension.apply(fluid, walls, {sigma, std::max(adhesion, 0.0f)}, h, *threads);
    viscosity.apply(fluid, friction, h, *threads);
    for (std::size_t k = 0; k < positions.size(); ++k) velocity[solver.order()[k]] = v[k].xyz();
  }
  void run(float seconds) {
    for (int s = 0; s < int(seconds / h); ++s) substep();
  }
  Vec3d center() const {
    Vec3d sum{};
    for (const Vec4f& p : positions) sum += Vec3d(p.xyz());
    return sum * (1 / double(positions.size()));
  }
  /// Mean pressure in the inner half [Pa].
  double pressure() const {
    const Vec3d c = center();
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < positions.size(); ++k) {
      if (length(Vec3d(x[k].xyz()) - c) > 0.5 * radius()) continue;
      sum -= double{solver.lambda()[k]} / double{solver.smoothing().volume() * h * h};
      ++count;
    }
    return sum / count;
  }
  /// Standard deviation of the radius over its mean, in 300 directions: the radius is that of the outermost
  /// particle within a spacing of the ray.
  double roughness() const {
    const Vec3d c = center();
    double sum = 0, squared = 0;
    for (int a = 0; a < 300; ++a) {
      const double y = 1 - 2 * (a + 0.5) / 300, turn = a * 2.39996323, r = std::sqrt(1 - y * y);
      const Vec3d ray(r * std::cos(turn), y, r * std::sin(turn));
      double farthest = 0;
      for (const Vec4f& p : positions) {
        const Vec3d from = Vec3d(p.xyz()) - c;
        const double along = dot(from, ray);
        if (length_squared(from - ray * along) < double{d} * double{d}) farthest = std::max(farthest, along);
      }
      farthest += 0.5 * double{d};
      sum += farthest / 300, squared += farthest * farthest / 300;
    }
    return std::sqrt(squared - sum * sum) / sum;
  }
  /// Elongation along y, a second moment [m^2].
  double length_over_width() const {
    double sum = 0;
    for (const Vec4f& p : positions) sum += double{p.y * p.y - 0.5f * (p.x * p.x + p.z * p.z)};
    return sum / double(positions.size());
  }
  /// Angle between the floor and the drop's surface, inside the drop, from a spherical cap of equal height
  /// and width [degrees].
  double contact_angle() const {
    double top = 0, squared = 0;
    int count = 0;
    const Vec3d c = center();
    for (const Vec4f& p : positions) {
      top = std::max(top, double{p.y} + 0.5 * double{d});
      if (p.y > d) continue;
      const double dx = double{p.x} - c.x, dz = double{p.z} - c.z;
      squared += dx * dx + dz * dz;
      ++count;
    }
    return 2 * std::atan(top / std::sqrt(2 * squared / count)) * 180 / pi;
  }
};

std::vector<Vec4f> moved(std::vector<Vec4f> particles, const Vec3f& by) {
  for (Vec4f& p : particles) p.set_xyz(p.xyz() + by);
  return particles;
}

TEST(SurfaceTension, ACubeBecomesABall) {
  constexpr float half = -10 * d;
  Drop drop(moved(test::block_of(20, 20, 20, d), {half, half, half}), -1, 3e-5f);
  EXPECT_GT(drop.radius(), 12 * double{d});
  EXPECT_GT(drop.roughness(), 0.1);
  drop.run(0.15f);
  EXPECT_LT(drop.roughness(), 0.03);
  EXPECT_LT(length(drop.center()), 1e-3 * double{d});
}

// p = p0 + 2 sigma / R.
TEST(SurfaceTension, PressesASmallDropMoreByLaplacesLaw) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (const float spacings : {6.0f, 7.5f, 10.0f, 14.0f}) {
    Drop drop(test::ball_of(spacings * d, d), -1, 3e-5f);
    drop.run(0.05f);
    double pressure = 0;
    for (int s = 0; s < 100; ++s) {
      drop.substep();
      pressure += drop.pressure() / 100;
    }
    const double bend = 1 / drop.radius();
    n += 1, sx += bend, sy += pressure, sxx += bend * bend, sxy += bend * pressure,
        syy += pressure * pressure;
  }
  const double across = n * sxx - sx * sx, slope = (n * sxy - sx * sy) / across;
  const double fit = slope * slope * across / (n * syy - sy * sy);
  EXPECT_GT(fit, 0.95);
  EXPECT_NEAR(slope / (2 * double{sigma}), 1, 0.2);
}

// An elongated drop oscillates: omega^2 = 8 sigma / (rho R^3) (Rayleigh 1879).
TEST(SurfaceTension, ADropSwingsAsRayleighSays) {
  std::vector<Vec4f> egg = test::ball_of(10 * d, d);
  for (Vec4f& p : egg) p.set_xyz({p.x * 0.945f, p.y * 1.12f, p.z * 0.945f});
  for (const SmoothingShape shape : {SmoothingShape::wendland, SmoothingShape::poly6_spiky,
                                     SmoothingShape::cubic_spline, SmoothingShape::wide_wendland}) {
    Drop drop(egg, -1, 1e-6f, 2, shape);
    double crossings[2] = {}, last = 1;
    int found = 0;
    for (int s = 0; s < 1000 && found < 2; ++s) {
      drop.substep();
      const double now = drop.length_over_width();
      if (now * last < 0) crossings[found++] = (s - now / (now - last)) * double{drop.h};
      last = now;
    }
    ASSERT_EQ(found, 2);
    const double omega = pi / (crossings[1] - crossings[0]);
    const double R = drop.radius();
    EXPECT_NEAR(omega / std::sqrt(8 * double{sigma} / (double{density} * R * R * R)), 1, 0.1);
  }
}

// More adhesion gives a flatter drop, and the drop comes to rest.
TEST(SurfaceTension, ADropMeetsTheFloorAtItsAngle) {
  for (const double degrees : {150.0, 110.0, 70.0}) {
    const float adhesion = SurfaceTension::adhesion_of(float(degrees * pi / 180));
    Drop drop(moved(test::ball_of(8 * d, d), {0, 8 * d, 0}), adhesion, 1e-4f);
    drop.run(0.3f);
    EXPECT_NEAR(drop.contact_angle(), degrees, 8);
    EXPECT_LT(drop.rms_speed, 0.05 * std::sqrt(double{sigma} / double{density * d}));
  }
}

TEST(SurfaceTension, KeepsMomentum) {
  test::FluidArrays fluid(test::block_of(10, 10, 10, d, 0.2f), d, density, 0);
  SurfaceTension tension;
  tension.apply(fluid.view(), {}, {sigma, 1}, 1, *fluid.threads);
  double largest = 0;
  for (std::size_t k = 0; k < fluid.size(); ++k)
    largest += double{length(fluid.v[k].xyz())} * double{fluid.mass};
  EXPECT_GT(largest, 0);
  EXPECT_LT(length(fluid.momentum()) / largest, 1e-6);
}

TEST(SurfaceTension, AllocatesNothingWhenWarm) {
  test::FluidArrays fluid(test::block_of(10, 10, 10, d), d, density, 0);
  const std::vector<NearWall> walls(fluid.size(), {{0, 1, 0}, d});
  SurfaceTension tension;
  tension.apply(fluid.view(), walls, {}, 1e-4f, *fluid.threads);
  const long before = test::allocations();
  tension.apply(fluid.view(), walls, {}, 1e-4f, *fluid.threads);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace souple::test_fluid_surface_tension
