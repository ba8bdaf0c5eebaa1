#include "souple/geometry/measures.h"
#include "tests/physics/elastic_case.h"
#include "tests/physics/linear_elasticity.h"
#include "tests/physics/validation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

// A bar of neo-Hookean tets, clamped at one end, under its own weight: 0.5 x 0.1 x 0.1 m, E = 1 MPa, nu =
// 0.3, 1000 kg/m^3. Gravity is weak, so that the tip sinks by about 1 % of the length.

namespace souple::test_physics_elastic_cantilever {

constexpr double E = 1e6, nu = 0.3, density = 1000, gravity = 1;
const Vec3d size{0.5, 0.1, 0.1};

/// Timoshenko beam under a uniform load q: w = q L^4 / (8 E I) + q L^2 / (2 k G A), k of a rectangle by
/// Cowper 1966.
double timoshenko() {
  const double area = size.y * size.z, q = density * gravity * area, L = size.x;
  const double I = size.z * size.y * size.y * size.y / 12, G = E / (2 * (1 + nu));
  const double k = 10 * (1 + nu) / (12 + 11 * nu);
  return q * std::pow(L, 4) / (8 * E * I) + q * L * L / (2 * k * G * area);
}

bool is_held(const Vec3d& x) {
  return x.x < -size.x / 2 + 1e-9;
}

/// Mean deflection of the end face, by linear finite elements with the world's lumped loads [m].
double tip_of_finite_elements(const TetMesh& mesh) {
  std::vector<bool> held;
  std::vector<Vec3d> force;
  const std::vector<double> mass = lumped_masses(mesh, density);
  for (std::size_t v = 0; v < mass.size(); ++v) {
    held.push_back(is_held(mesh.positions[v]));
    force.push_back({0, -gravity * mass[v], 0});
  }
  const std::vector<Vec3d> u = solve_linear_elasticity(mesh, E, nu, held, force);
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < u.size(); ++v)
    if (mesh.positions[v].x > size.x / 2 - 1e-9) sum -= u[v].y, ++count;
  return sum / count;
}

/// Mean deflection of the end face in a simulation [m]: steps of a tenth of the time in which sound crosses a
/// cell, near critical drag.
double tip_of_world(const TetMesh& mesh, int cells) {
  const double cell = size.y / cells, speed = std::sqrt(E / density);
  const double slowest = 1.015 * speed * size.y / (size.x * size.x);  // of a clamped beam [rad/s]
  World world(static_case(50, 2, 1.6 * slowest, gravity));
  const ObjectId bar = world.add_soft_body(mesh, {.young_modulus = static_cast<float>(E),
                                                  .poisson_ratio = static_cast<float>(nu),
                                                  .density = static_cast<float>(density)});
  std::vector<std::uint32_t> held;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (is_held(mesh.positions[v])) held.push_back(v);
  world.pin(bar, vertices(held));
  const double dt = 50 * 0.1 * cell / speed;
  const int frames = static_cast<int>(std::ceil(0.3 / slowest / dt));
  return -settle(
      world, dt, frames,
      [&] { return mean_over(world, bar, mesh.positions, &Vec3d::x, size.x / 2, &Vec3d::y, size.x); }, 1e-3);
}

struct Tip {
  double simulated, elements;
};

Tip bend(int cells) {
  const TetMesh mesh = tet_bar(5 * cells, cells, cells, size);
  const Tip tip{tip_of_world(mesh, cells), tip_of_finite_elements(mesh)};
  validate_relative("cantilever tet bar",
                    fmt::format("tip [m], {0} x {0} cells against finite elements", cells), tip.simulated,
                    tip.elements, 0.02);
  return tip;
}

TEST(Cantilever, TipIsThatOfFiniteElements) {
  bend(2);
}

// Linear tets lock: the tip deflection of a mesh of cell size c is w - a c^p, p near 2. Three meshes give w,
// p and a.
TEST(Cantilever, ConvergesToTimoshenkoSlow) {
  const Tip coarse = bend(2), middle = bend(4), fine = bend(6);
  // (fine - middle) / (middle - coarse) = (6^-p - 4^-p) / (4^-p - 2^-p), by bisection.
  const auto ratio = [](double p) {
    return (std::pow(4, -p) - std::pow(6, -p)) / (std::pow(2, -p) - std::pow(4, -p));
  };
  const double wanted = (fine.simulated - middle.simulated) / (middle.simulated - coarse.simulated);
  double low = 0.5, high = 4;
  for (int k = 0; k < 60; ++k) (ratio((low + high) / 2) > wanted ? low : high) = (low + high) / 2;
  const double shrink = std::pow(4.0 / 6.0, low);
  const double limit = fine.simulated + (fine.simulated - middle.simulated) * shrink / (1 - shrink);
  validate_relative("cantilever tet bar", "tip [m], extrapolated, against Timoshenko", limit, timoshenko(),
                    0.05);
  state("cantilever tet bar", "order of convergence", low);

  Curves curves("cantilever tet bar", "cells through the section", "tip [m]");
  curves.add("simulated", {2, 4, 6}, {coarse.simulated, middle.simulated, fine.simulated});
  curves.add("theory: finite elements", {2, 4, 6}, {coarse.elements, middle.elements, fine.elements});
  curves.add("theory: Timoshenko", {2, 6}, {timoshenko(), timoshenko()});
}

}  // namespace souple::test_physics_elastic_cantilever
