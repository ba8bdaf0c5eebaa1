#include "souple/error.h"
#include "tests/constraints/small_body.h"
#include "tests/expect_error.h"

#include <string>

#include <gtest/gtest.h>

namespace souple::test_constraints_neo_hookean {

constexpr Mode modes[] = {Mode::small_steps, Mode::xpbd, Mode::pbd};

std::string describe(Mode mode, double young_modulus, int iterations, int substeps) {
  return "mode " + std::to_string(static_cast<int>(mode)) + ", E " + std::to_string(young_modulus) + ", " +
         std::to_string(iterations) + " iterations, " + std::to_string(substeps) + " substeps";
}

/// Runs `check(mode, E, iterations, substeps)` for all combinations of these settings.
template <class Check>
void for_every_setting(Check check) {
  for (const Mode mode : modes)
    for (const double young_modulus : {1e4, 1e5, 1e6, 1e7})
      for (const int iterations : {1, 5, 20})
        for (const int substeps : {1, 5, 20}) {
          // 60 % of the time: for the softest and the stiffest alone.
          if (iterations * substeps == 400 && young_modulus > 1e4 && young_modulus < 1e7) continue;
          SCOPED_TRACE(describe(mode, young_modulus, iterations, substeps));
          check(mode, young_modulus, iterations, substeps);
        }
}

/// Energy density of the two rows at a deformation gradient F. [Pa]
double energy_density(const Mat3d& F, double young_modulus, double poisson_ratio) {
  const Vec3d x[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto alpha = NeoHookean::compliance(young_modulus, poisson_ratio, 1);
  const Vec3d moved[4] = {{}, F * x[1], F * x[2], F * x[3]};
  double C[2];
  Vec3d gradient[2][4];
  NeoHookean::evaluate(moved, converted<NeoHookean, double>(NeoHookean::from_rest(x)), C, gradient);
  return 0.5 * (C[0] * C[0] / static_cast<double>(alpha[0]) + C[1] * C[1] / static_cast<double>(alpha[2]));
}

// The rows give the energy of Macklin and Müller 2021, mu/2 (I - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2,
// for any deformation that is not crushed.
TEST(NeoHookean, IsTheStableNeoHookeanEnergy) {
  const double E = 2e5, nu = 0.4, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  Random random(3);
  int checked = 0;
  for (int n = 0; n < 2000; ++n) {
    const double amount = n % 2 == 0 ? 0.02 : 0.6;
    Mat3d F = Mat3d::identity();
    for (Vec3d& column : F.column) column += random.vector() * amount;
    const double I = frobenius_squared(F), J = determinant(F);
    if (I < 1) continue;
    const double expected = mu / 2 * (I - 3) - mu * (J - 1) + (lambda + mu) / 2 * (J - 1) * (J - 1);
    EXPECT_NEAR(energy_density(F, E, nu), expected, 1e-6 * expected + 1e-9 * mu);
    ++checked;
  }
  EXPECT_GT(checked, 1500);
}

// Stretched along x with free sides: sigma = E strain, and the sides contract by nu strain, also for nu = 0.
TEST(NeoHookean, SmallStretchHasYoungsModulusAndPoissonsRatio) {
  const double E = 1e6, strain = 1e-3;
  for (const double nu : {0.0, 0.17, 0.3, 0.45, 0.49}) {
    const auto energy = [&](double along, double across) {
      return energy_density(Mat3d::diagonal({1 + along, 1 + across, 1 + across}), E, nu);
    };
    // Transverse strain of minimum energy, by golden section search.
    const auto relaxed = [&](double along) {
      double low = -along, high = along;
      const double golden = (std::sqrt(5.0) - 1) / 2;
      for (int k = 0; k < 60; ++k) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        if (energy(along, a) < energy(along, b)) {
          high = b;
        } else {
          low = a;
        }
      }
      return (low + high) / 2;
    };
    const double across = relaxed(strain);
    EXPECT_NEAR(-across / strain, nu, 0.003) << "nu " << nu;
    EXPECT_NEAR(2 * energy(strain, across) / (strain * strain), E, 0.003 * E) << "nu " << nu;
  }
}

// A bar of cubes, solved by projection, is stretched between its end faces.
TEST(NeoHookean, BarInTension) {
  const SoftMaterial material{.young_modulus = 1e5, .poisson_ratio = 0.3, .density = 1000};
  const std::uint32_t nx = 6, ny = 2, nz = 2;
  const double cell = 0.1, area = 0.04;
  SmallBody<NeoHookean> body = tet_bar(nx, ny, nz, cell, material);
  const auto corner = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return (i * (ny + 1) + j) * (nz + 1) + k;
  };
  // The end faces are pinned at the given strain and contract transversely according to nu. The interior and
  // the sides are free and relax. So the solution is uniform, and exact for linear tets.
  const double strain = 0.005, across = -material.poisson_ratio * strain;
  for (std::uint32_t j = 0; j <= ny; ++j)
    for (std::uint32_t k = 0; k <= nz; ++k)
      for (const std::uint32_t i : {0u, nx}) {
        const Vec3d x = body.at(corner(i, j, k));
        body.move_to(corner(i, j, k), {x.x * (1 + strain), x.y * (1 + across), x.z * (1 + across)});
        body.pin(corner(i, j, k));
      }
  for (int frame = 0; frame < 600; ++frame) {
    body.step(1 / 60.0f, 10, 1, Mode::small_steps);
    for (std::size_t i = 0; i < body.size(); ++i) body.set_velocity(i, body.velocity(i) * 0.9);
  }
  const double height = body.at(corner(3, 2, 1)).y - body.at(corner(3, 0, 1)).y;
  EXPECT_NEAR((height / (2 * cell) - 1) / strain, -material.poisson_ratio, 0.02 * material.poisson_ratio);
  EXPECT_NEAR(body.at(corner(3, 1, 1)).x, 3 * cell * (1 + strain), 1e-4 * cell);

  // The stress, by the energy of the bar: E/2 strain^2 per volume.
  double energy = 0;
  const auto& set = body.projector.set();
  for (std::size_t n = 0; n < set.size(); ++n) {
    Vec3d x[4];
    for (std::size_t i = 0; i < 4; ++i) x[i] = body.at(set.indices(n)[i]);
    double C[2];
    Vec3d gradient[2][4];
    NeoHookean::evaluate(x, converted<NeoHookean, double>(set.params(n)), C, gradient);
    energy += 0.5 * (C[0] * C[0] / static_cast<double>(set.compliance(n)[0]) +
                     C[1] * C[1] / static_cast<double>(set.compliance(n)[2]));
  }
  const double volume = area * static_cast<double>(nx) * cell;
  EXPECT_NEAR(energy / volume, 0.5 * material.young_modulus * strain * strain,
              0.02 * 0.5 * material.young_modulus * strain * strain);
}

// A bar whose particles start displaced by up to 1 % of a cell along each axis oscillates. Its kinetic energy
// never exceeds that of the first 20 frames.
TEST(NeoHookean, FreeBarSlightlyOutOfShapeCalms) {
  for_every_setting([](Mode mode, double young_modulus, int iterations, int substeps) {
    const double size = 0.1;
    SmallBody<NeoHookean> body = tet_bar(2, 1, 1, size, {.young_modulus = young_modulus});
    Random random(5);
    for (std::size_t i = 0; i < body.size(); ++i)
      body.move_to(i, body.at(i) + random.vector() * (0.01 * size));
    double at_first = 0, later = 0;
    for (int frame = 0; frame < 120; ++frame) {
      body.step(1 / 60.0f, substeps, iterations, mode);
      double& largest = frame < 20 ? at_first : later;
      largest = std::fmax(largest, body.kinetic_energy());
      ASSERT_LT(worst_volume_error(body), 0.1);
    }
    EXPECT_LE(later, 1.01 * at_first);
    EXPECT_LT(worst_volume_error(body), 0.005);
  });
}

// A cantilever under its weight: with all settings, its kinetic energy stays below the potential energy of
// its fall.
TEST(NeoHookean, LoadedBarIsCalmInEverySetting) {
  for_every_setting([](Mode mode, double young_modulus, int iterations, int substeps) {
    const double size = 0.05, length = 3 * size;
    SmallBody<NeoHookean> body = tet_bar(3, 1, 1, size, {.young_modulus = young_modulus});
    body.gravity = {0, -9.81f, 0};
    double mass = 0;
    for (std::size_t i = 0; i < 4; ++i) body.pin(i);
    for (std::size_t i = 0; i < body.size(); ++i) mass += body.mass(i);
    for (int frame = 0; frame < 120; ++frame) {
      body.step(1 / 60.0f, substeps, iterations, mode);
      ASSERT_LT(body.kinetic_energy(), mass * 9.81 * length);
      ASSERT_LT(worst_volume_error(body), 1.5);  // one iteration per 1/60 s is far from converged
    }
  });
}

// A rotating body neither swells nor accelerates.
TEST(NeoHookean, SpinningTetKeepsItsVolume) {
  SmallBody<NeoHookean> body = single_tet(0.1, {.young_modulus = 1e6});
  for (std::size_t i = 0; i < body.size(); ++i)
    body.set_velocity(i, cross(Vec3d{0, 0, 6}, body.at(i) - Vec3d{0.03, 0.03, 0.03}));
  const double before = body.kinetic_energy();
  for (int frame = 0; frame < 120; ++frame) {
    body.step(1 / 60.0f, 20, 1, Mode::small_steps);
    ASSERT_LT(worst_volume_error(body), 0.005);
  }
  EXPECT_LE(body.kinetic_energy(), 1.01 * before);
  EXPECT_GT(body.kinetic_energy(), 0.5 * before);
}

struct Crushed {
  const char* name;
  Vec3d (*map)(const Vec3d&);
};
constexpr Crushed crushed_shapes[] = {
    {"mirrored",
     [](const Vec3d& x) {
       return Vec3d{x.x, x.y, -x.z};
     }},
    {"negated", [](const Vec3d& x) { return -x; }},
    {"flat",
     [](const Vec3d& x) {
       return Vec3d{x.x, x.y, 0};
     }},
    {"flat and inverted",
     [](const Vec3d& x) {
       return Vec3d{x.x, x.y, -0.001 * x.z};
     }},
    {"a line",
     [](const Vec3d& x) {
       return Vec3d{x.x, 0, 0};
     }},
    {"a point",
     [](const Vec3d&) {
       return Vec3d{0.3, 0, 0};
     }},
};

TEST(NeoHookean, CrushedBodiesRecover) {
  for (const Crushed& shape : crushed_shapes)
    for (const bool bar : {false, true})
      for (const Mode mode : {Mode::small_steps, Mode::pbd})
        for (const double poisson_ratio : {0.0, 0.3, 0.45}) {
          SCOPED_TRACE(std::string(shape.name) + (bar ? ", bar, " : ", tet, ") + describe(mode, 1e6, 1, 10) +
                       ", nu " + std::to_string(poisson_ratio));
          const SoftMaterial material{.young_modulus = 1e6, .poisson_ratio = poisson_ratio};
          SmallBody<NeoHookean> body = bar ? tet_bar(3, 2, 1, 0.1, material) : single_tet(0.1, material);
          for (std::size_t i = 0; i < body.size(); ++i) body.move_to(i, shape.map(body.at(i)));
          for (int frame = 0; frame < 240; ++frame) body.step(1 / 60.0f, 10, 1, mode);
          EXPECT_LT(worst_volume_error(body), 0.01);
          EXPECT_TRUE(std::isfinite(body.kinetic_energy()));
        }
}

// The relative sag of a cantilever whose E is proportional to its size does not depend on the size.
TEST(NeoHookean, SagDoesNotDependOnSize) {
  double expected = 0;
  for (const double size : {1.0, 1e-3, 1e-2, 100.0}) {
    SmallBody<NeoHookean> body = tet_bar(4, 1, 1, size, {.young_modulus = 5e6 * size});
    body.gravity = {0, -9.81f, 0};
    for (std::size_t i = 0; i < 4; ++i) body.pin(i);
    const auto unit = static_cast<float>(std::sqrt(size));  // time scales with sqrt(size / g)
    for (int frame = 0; frame < 200; ++frame) {
      body.step(unit / 60, 4, 4, Mode::xpbd);
      for (std::size_t i = 0; i < body.size(); ++i) body.set_velocity(i, body.velocity(i) * 0.9);
    }
    const double sag = -body.at(16).y / size;
    if (size == 1.0) expected = sag;
    EXPECT_GT(sag, 0.01);
    EXPECT_NEAR(sag, expected, 0.01 * expected) << "size " << size;
  }
}

TEST(NeoHookean, RefusesWhatIsNoMaterialOrNoTet) {
  EXPECT_THROW(NeoHookean::compliance(1e5, 0.5, 1), Error);
  EXPECT_THROW(NeoHookean::compliance(1e5, -0.1, 1), Error);
  expect_error([] { NeoHookean::compliance(1e5, -1e-9, 1); },
               {"Poisson's ratio is -1e-09", "a number from 0 to below 0.5"});
  EXPECT_THROW(NeoHookean::compliance(0, 0.3, 1), Error);
  EXPECT_THROW(NeoHookean::compliance(1e5, NAN, 1), Error);
  const Vec3d flat[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_THROW(NeoHookean::from_rest(flat), Error);
  const Vec3d inside_out[4] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
  EXPECT_THROW(NeoHookean::from_rest(inside_out), Error);
}

}  // namespace souple::test_constraints_neo_hookean
