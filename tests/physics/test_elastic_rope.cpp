#include "tests/physics/elastic_case.h"
#include "tests/physics/validation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

// E A and E I of a rope, as bar and beam: 1 m long, 2 cm thick.

namespace souple::test_physics_elastic_rope {

constexpr double L = 1, radius = 0.01, density = 1000;
constexpr double area = pi * radius * radius;

/// Hanging from one end: a bar under its own weight grows by rho g L^2 / (2 E). The curve is the displacement
/// of each particle.
double hang(double E, std::uint32_t segments, Curves& curves) {
  const double speed = std::sqrt(E / density);
  World world(static_case(20, 3, pi * speed / L, 9.81));
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 0}, {0, -L, 0}}, segments,
                                       {.radius = static_cast<float>(radius),
                                        .young_modulus = static_cast<float>(E),
                                        .density = static_cast<float>(density)});
  world.pin(rope, vertices({0}));
  const auto sunk = [&](std::uint32_t i) {
    return -L * i / segments - static_cast<double>(world.positions(rope)[i].y);
  };
  const double elongation =
      settle(world, 20 * 0.2 * L / segments / speed, 20, [&] { return sunk(segments); });
  for (std::uint32_t i = 0; i <= segments; ++i)
    curves.add(fmt::format("E = {:g} Pa", E), L * i / segments, 1000 * sunk(i));
  return elongation;
}

TEST(Rope, HangsLongerByItsWeightOverEA) {
  const std::string name = "rope hanging by one end", theory = "theory: rho g (L s - s^2/2) / E";
  Curves curves(name, "s, distance from the upper end [m]", "sunk by [mm]");
  for (const double E : {1e6, 1e7}) {
    const double expected = density * 9.81 * L * L / (2 * E);
    for (int i = 0; i <= 50; ++i) {
      const double s = L * i / 50;
      curves.add(theory, s, 1000 * density * 9.81 / E * (L * s - s * s / 2));
    }
    curves.lift(theory);
    validate_relative(name, fmt::format("elongation [m], E = {:g} Pa", E), hang(E, 32, curves), expected,
                      0.02);
  }
}

/// Clamped level by its first two particles: a beam of length l = L - segment / 2. The bend at the second
/// particle represents half a segment on either side, so the beam is clamped in the middle of the first
/// segment. Small loads: w = q l^4 / (8 E I).
double droop(double EI, std::uint32_t segments, double wanted, Curves& curves) {
  const double q = density * area, segment = L / segments, l = L - segment / 2;
  const double gravity = wanted * 8 * EI / (q * std::pow(l, 4));
  const double slowest = 3.516 * std::sqrt(EI / q) / (l * l);          // [rad/s]
  const double fastest = 4 * std::sqrt(EI / q) / (segment * segment);  // of a zigzag
  const double E =
      40 * EI / (area * segment * segment);  // stretches ten times less than it bends, and is no faster
  World world(static_case(100, 3, 1.6 * slowest, gravity));
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 0}, {L, 0, 0}}, segments,
                                       {.radius = static_cast<float>(radius),
                                        .young_modulus = static_cast<float>(E),
                                        .density = static_cast<float>(density),
                                        .bending_stiffness = static_cast<float>(EI)});
  world.pin(rope, vertices({0, 1}));
  const double dt = 100 * 0.3 / fastest;
  const int frames = static_cast<int>(std::ceil(0.3 / slowest / dt));
  const double tip = settle(
      world, dt, frames, [&] { return -static_cast<double>(world.positions(rope)[segments].y); }, 1e-3);
  for (const Vec3f& x : world.positions(rope))
    curves.add(fmt::format("E I = {:g} N m^2", EI), static_cast<double>(x.x) - segment / 2,
               1000 * static_cast<double>(x.y));
  return tip;
}

TEST(Rope, CantileverBendsByEI) {
  const std::string name = "rope as a cantilever";
  const double wanted = 0.01, l = L - L / 32 / 2;
  Curves curves(name, "s, distance from the clamp [m]", "height [mm]");
  for (int i = 0; i <= 50; ++i) {
    const double s = l * i / 50, r = s / l;
    curves.add("theory: -q s^2 (6 l^2 - 4 l s + s^2) / (24 E I)", s,
               -1000 * wanted * r * r * (6 - 4 * r + r * r) / 3);
  }
  for (const double EI : {1e-3, 0.1})
    validate_relative(name, fmt::format("tip [m], E I = {:g} N m^2", EI), droop(EI, 32, wanted, curves),
                      wanted, 0.02);
}

}  // namespace souple::test_physics_elastic_rope
