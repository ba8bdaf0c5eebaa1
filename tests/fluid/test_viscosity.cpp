#include "souple/fluid/viscosity.h"
#include "tests/count_allocations.h"
#include "tests/fluid/fluid_arrays.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_fluid_viscosity {

using test::FluidArrays;

constexpr float d = 0.01f, density = 1000;

/// A periodic box of 16^3 particles, inside a shell of its own copies eight spacings thick: a shear wave in
/// it has no end.
struct Periodic {
  static constexpr int n = 16, shell = 8, all = n + 2 * shell;
  FluidArrays fluid;
  std::vector<std::uint32_t> copy_of;  // by sorted index

  explicit Periodic(float mu, float jitter, SmoothingShape shape = SmoothingShape::wendland)
      : fluid(positions(jitter), d, density, mu, 2, shape) {
    std::vector<std::uint32_t> sorted_index(fluid.size());
    for (std::uint32_t k = 0; k < fluid.size(); ++k) sorted_index[fluid.order.order()[k]] = k;
    const auto inner = [](std::uint32_t i) { return (i + n - shell) % n + shell; };
    for (const std::uint32_t i : fluid.order.order())
      copy_of.push_back(
          sorted_index[inner(i % all) + all * (inner(i / all % all) + all * inner(i / all / all))]);
  }
  static std::vector<Vec4f> positions(float jitter) {
    const std::vector<Vec4f> box = test::block_of(n, n, n, d, jitter);
    std::vector<Vec4f> result;
    const auto wrap = [](int i) { return (i + n - shell) % n; };
    const auto shift = [&](int i) { return float(i - wrap(i)) * d; };
    for (int z = 0; z < all; ++z)
      for (int y = 0; y < all; ++y)
        for (int x = 0; x < all; ++x) {
          const Vec4f& p = box[std::size_t(wrap(x) + n * (wrap(y) + n * wrap(z)))];
          result.push_back({p.x + shift(x), p.y + shift(y), p.z + shift(z), 0});
        }
    return result;
  }
  float wave_number() const { return 2 * float(pi) / (float(n) * d); }
  Vec3f wave(const Vec3f& x) const { return {0, std::sin(wave_number() * x.x), 0}; }
  /// Amplitude of the wave.
  double amplitude() const {
    double sum = 0, whole = 0;
    for (std::uint32_t k = 0; k < fluid.size(); ++k) {
      if (copy_of[k] != k) continue;
      const Vec3f w = wave(fluid.x[k].xyz());
      sum += double{dot(fluid.v[k].xyz(), w)};
      whole += double{dot(w, w)};
    }
    return sum / whole;
  }
  /// The decay rate over nu k^2, measured over a number of substeps of h seconds.
  template <class Apply>
  double rate(float h, int substeps, const Apply& apply) {
    fluid.set_velocities([&](const Vec3f& x) { return wave(x); });
    for (int s = 0; s < substeps; ++s) {
      apply(fluid.view(), h);
      for (std::uint32_t k = 0; k < fluid.size(); ++k) fluid.v[k] = fluid.v[copy_of[k]];
    }
    const double nu = double{fluid.v[0].w} / double{density}, k = double{wave_number()};
    return -std::log(amplitude()) / (double(substeps) * double{h} * nu * k * k);
  }
};

constexpr auto shape = SmoothingShape::wendland;

// v ~ exp(-nu k^2 t) sin(k x), on a lattice and on a jittered one, for any substep.
TEST(Viscosity, LetsAWaveOfShearDecayAtItsRate) {
  for (const float jitter : {0.0f, 0.2f}) {
    for (const float nu : {1e-6f, 1e-3f, 4e-3f}) {
      Periodic box(nu * density, jitter);
      for (const float h : {1e-3f, 5e-3f})
        EXPECT_NEAR(box.rate(h, 20,
                             [&](const FluidView& fluid, float step) {
                               Xsph(shape).apply(fluid, {}, step, *box.fluid.threads);
                             }),
                    1, 0.07)
            << nu << ' ' << h;
    }
    for (const float nu : {4e-3f, 0.1f, 0.25f}) {
      Periodic box(nu * density, jitter);
      const float h = 2e-3f;
      const double rate = box.rate(h, 8, [&](const FluidView& fluid, float step) {
        const auto report =
            ImplicitViscosity(shape, {.tolerance = 1e-3f}).apply(fluid, {}, step, *box.fluid.threads);
        EXPECT_LE(report.iterations, 35);
        EXPECT_LE(report.residual, 1e-3f);
      });
      // An implicit substep divides by 1 + h nu k^2; the exact wave decays by exp(-h nu k^2).
      const double once = double{h} * double{nu} * double{box.wave_number()} * double{box.wave_number()};
      EXPECT_NEAR(std::expm1(rate * once) / once, 1, 0.1) << nu;
    }
  }
}

TEST(Xsph, HasTheSameRateWithAllKernels) {
  for (const SmoothingShape other :
       {SmoothingShape::poly6_spiky, SmoothingShape::cubic_spline, SmoothingShape::wide_wendland}) {
    Periodic box(1, 0, other);
    EXPECT_NEAR(box.rate(2e-3f, 20,
                         [&](const FluidView& fluid, float step) {
                           Xsph(other).apply(fluid, {}, step, *box.fluid.threads);
                         }),
                1, 0.07);
  }
}

/// A disordered block of the given viscosity [Pa s]; one side has a hundredth of it.
FluidArrays disorder(float mu) {
  FluidArrays fluid(test::block_of(12, 12, 12, d, 0.2f), d, density, mu, 2);
  test::Random random(3);
  fluid.set_velocities([&](const Vec3f&) { return Vec3f(random.point(-1, 1)); });
  for (std::size_t k = 0; k < fluid.size(); ++k)
    if (fluid.x[k].x > 0.06f) fluid.v[k].w *= 0.01f;
  return fluid;
}

TEST(Viscosity, KeepsMomentumAndLosesEnergy) {
  for (const float mu : {1.0f, 300.0f}) {
    FluidArrays fluid = disorder(mu);
    const double size = double(fluid.size()) * double{fluid.mass};
    const Vec3d linear = fluid.momentum(), angular = fluid.angular_momentum();
    const double energy = fluid.energy();
    const auto report = Viscosity().apply(fluid.view(), {}, 5e-3f, *fluid.threads);
    EXPECT_EQ(report.iterations > 0, mu > 1);
    EXPECT_LT(report.residual, 0.011f);
    EXPECT_LT(fluid.energy(), 0.9 * energy);
    EXPECT_LT(length(fluid.momentum() - linear) / size, 1e-6);
    // Forces of the implicit solve are central; XSPH forces are not.
    const double turned = length(fluid.angular_momentum() - angular) / (size * 12 * double{d});
    if (mu > 1)
      EXPECT_LT(turned, 1e-6);
    else
      EXPECT_LT(turned, 0.01);
  }
}

// A rotating drop of honey keeps rotating: it has no strain.
TEST(ImplicitViscosity, LetsADropTurn) {
  FluidArrays fluid(test::ball_of(8 * d, d), d, density, 100);
  fluid.set_velocities([](const Vec3f& x) { return cross(Vec3f(0, 5, 0), x); });
  const double energy = fluid.energy();
  for (int s = 0; s < 20; ++s) ImplicitViscosity(shape, {}).apply(fluid.view(), {}, 2e-3f, *fluid.threads);
  EXPECT_NEAR(fluid.energy() / energy, 1, 1e-4);
}

/// A film of 8 layers on an inclined floor, or on a floor that moves at 1 m/s without gravity.
struct Film {
  FluidArrays fluid;
  std::vector<Vec4f> walls;

  Film(float mu, float floor_speed) : fluid(test::block_of(40, 8, 10, d), d, density, mu) {
    for (std::size_t k = 0; k < fluid.size(); ++k)
      walls.push_back({floor_speed, 0, 0, fluid.smoothing.wall(fluid.x[k].y).value});
  }
  void run(float gravity, float h, int substeps) {
    Viscosity viscosity(shape, {.tolerance = 1e-3f});
    for (int s = 0; s < substeps; ++s) {
      for (std::size_t k = 0; k < fluid.size(); ++k) fluid.v[k].x += gravity * h;
      viscosity.apply(fluid.view(), walls, h, *fluid.threads);
    }
  }
  /// Mean speed of a layer far from the ends.
  double speed(int layer) const {
    double sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < fluid.size(); ++k) {
      if (int(fluid.x[k].y / d) != layer || std::abs(fluid.x[k].x - 0.2f) > 3 * d) continue;
      sum += double{fluid.v[k].x};
      ++count;
    }
    return sum / count;
  }
};

// Nusselt's film: u(y) = g / nu (H y - y^2 / 2), at rest at the floor.
TEST(Viscosity, AFilmDoesNotSlipOnTheFloor) {
  for (const float h : {2e-4f, 1e-2f}) {  // explicit and implicit
    const float nu = 0.04f, gravity = 2;
    Film film(nu * density, 0);
    film.run(gravity, h, int(0.5f / h));  // H^2 / nu = 0.16 s
    for (int layer = 0; layer < 8; ++layer) {
      const double y = (layer + 0.5) * double{d}, H = 8 * double{d};
      const double wanted = double{gravity} / double{nu} * (H * y - 0.5 * y * y);
      EXPECT_NEAR(film.speed(layer) / wanted, 1, 0.1) << h << ' ' << layer;
    }
  }
}

TEST(Viscosity, AFloorThatMovesTakesTheFilmAlong) {
  Film film(100, 1);
  film.run(0, 1e-2f, 50);
  EXPECT_NEAR(film.speed(7), 1, 0.02);
}

TEST(Viscosity, AllocatesNothingWhenWarm) {
  FluidArrays fluid = disorder(300);
  Viscosity viscosity;
  viscosity.apply(fluid.view(), {}, 5e-3f, *fluid.threads);
  const long before = test::allocations();
  viscosity.apply(fluid.view(), {}, 5e-3f, *fluid.threads);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace souple::test_fluid_viscosity
