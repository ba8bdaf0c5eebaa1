#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

// The numbers of docs/integrators.md. Every field acts on one particle of 1 kg, with one substep per step.

namespace souple::test_physics_integrators {

constexpr Integrator every_integrator[] = {Integrator::semi_implicit, Integrator::explicit_euler,
                                           Integrator::implicit_euler};

const char* words(Integrator integrator) {
  switch (integrator) {
    case Integrator::semi_implicit:
      return "semi-implicit";
    case Integrator::explicit_euler:
      return "explicit";
    case Integrator::implicit_euler:
      return "implicit";
  }
  return "";
}

struct Particle {
  World world;
  ObjectId id;

  Particle(Integrator integrator, const Vec3f& gravity, float drag, const Vec3d& at, const Vec3f& velocity)
      : world({.substeps = 1, .integrator = integrator, .gravity = gravity, .drag = drag}) {
    const Vec3d point[] = {at};
    id = world.add_grains(point, grain_of_mass(1), {.velocity = velocity});
  }
  void spring(double k) {  // f = -k x
    const auto stiffness = static_cast<float>(k);
    world.add_force_field(
        [stiffness](const Vec3f& x, const Vec3f&, float, double) { return x * -stiffness; });
  }
  double x() const { return world.center_of_mass(id).x; }
  double y() const { return world.center_of_mass(id).y; }
  double v() const { return world.momentum(id).x / world.total_mass(id); }
};

// --- a stiff force, f = -k x ---------------------------------------------------------------------

// 1/2 v^2 + 1/2 omega^2 x^2 after `steps`, relative to the start; released at x = 1 m.
double spring_energy(Integrator integrator, double omega_h, int steps, Curves* curves = nullptr) {
  const double h = 0.01, omega = omega_h / h;
  Particle particle(integrator, {}, 0, {1, 0, 0}, {});
  particle.spring(omega * omega);
  double energy = 1;
  for (int n = 1; n <= steps; ++n) {
    if (!particle.world.step(h).ok()) return HUGE_VAL;
    energy = particle.x() * particle.x() + particle.v() * particle.v() / (omega * omega);
    if (curves != nullptr) curves->add(words(integrator), n * omega_h / (2 * pi), energy);
    if (energy > 1e6) break;
  }
  return energy;
}

// The omega h above which the energy grows a thousandfold in 1000 steps.
double stability_limit(Integrator integrator) {
  double low = 0.01, high = 100;
  for (int i = 0; i < 20; ++i) {
    const double middle = std::sqrt(low * high);
    (spring_energy(integrator, middle, 1000) > 1000 ? high : low) = middle;
  }
  return low;
}

// Semi-implicit: stable, symplectic, up to omega h = 2. Explicit: |z|^2 = 1 + (omega h)^2 per step, so a
// thousandfold in 1000 steps already at omega h = 0.083. Implicit: |z|^2 = 1 / (1 + (omega h)^2), always
// stable.
TEST(Integrators, StabilityOnAStiffForce) {
  const std::string name = "integrators on a stiff force";
  Curves curves(name, "periods", "energy / its start (log)");
  for (const Integrator integrator : every_integrator) spring_energy(integrator, 0.1, 630, &curves);
  validate_relative(name, "semi-implicit: largest stable omega h", stability_limit(Integrator::semi_implicit),
                    2, 0.01);
  validate_relative(name, "explicit: omega h of a thousandfold energy in 1000 steps",
                    stability_limit(Integrator::explicit_euler), std::sqrt(std::pow(1000, 0.001) - 1), 0.01);
  validate_below(name, "implicit: energy at omega h = 100 after 100 steps",
                 spring_energy(Integrator::implicit_euler, 100, 100), 1e-6);
}

TEST(Integrators, EnergyDriftOnASpring) {
  const std::string name = "integrators, energy drift";
  Curves curves(name, "omega h (log)", "|energy change| over one period (log)");
  for (const double omega_h : {0.01, 0.02, 0.05, 0.1, 0.2}) {
    const int steps = static_cast<int>(std::lround(2 * pi / omega_h));
    for (const Integrator integrator : every_integrator) {
      const double drift = spring_energy(integrator, omega_h, steps) - 1;
      curves.add(words(integrator), omega_h, std::fabs(drift));
      if (omega_h != 0.01) continue;
      // To lowest order the energy grows or falls by (omega h)^2 per step; that of the symplectic scheme only
      // oscillates by omega h.
      const std::string quantity =
          std::string(words(integrator)) + ", omega h = 0.01: change over one period";
      const double expected = 2 * pi * omega_h;
      if (integrator == Integrator::semi_implicit) validate(name, quantity, drift, 0, 1e-3);
      if (integrator == Integrator::explicit_euler)
        validate_relative(name, quantity, drift, std::exp(expected) - 1, 0.02);
      if (integrator == Integrator::implicit_euler)
        validate_relative(name, quantity, drift, std::exp(-expected) - 1, 0.02);
    }
  }
}

// --- the same force on a cloth and a soft body ---------------------------------------------------

// 1/2 v^2 + 1/2 omega^2 z^2 of the mean motion after `frames` frames, relative to the start. The elasticity of
// the object does not resist a motion in which all its particles take part alike.
double energy_of_mean_motion(World& world, ObjectId object, double omega, int frames) {
  Settings settings = world.settings();
  settings.gravity = {};
  world.set_settings(settings);
  world.teleport(object, {.translation = {0, 0, 1}});
  const auto k = static_cast<float>(omega * omega);
  world.add_force_field([k](const Vec3f& x, const Vec3f&, float mass, double) {
    return Vec3f{0, 0, -k * mass * x.z};
  });
  const auto energy = [&] {
    const double z = world.center_of_mass(object).z, v = world.momentum(object).z / world.total_mass(object);
    return v * v + omega * omega * z * z;
  };
  const double before = energy();
  EXPECT_TRUE(run(world, frames, 1.0 / 60));
  return energy() / before;
}

TEST(Integrators, ActOnClothAndSoftBodiesAsOnAParticle) {
  constexpr double omega_h = 0.1, h = 1.0 / 600;
  constexpr int frames = 10, steps = 100;
  for (const bool soft_body : {false, true})
    for (const Integrator integrator : every_integrator) {
      World world({.integrator = integrator});
      const ObjectId object = soft_body ? world.add_soft_body(tet_bar(5, 2, 2, {0.5, 0.2, 0.2}))
                                        : world.add_cloth(grid(12, 12, 0.5));
      const double left = energy_of_mean_motion(world, object, omega_h / h, frames);
      const double growth = std::pow(1 + omega_h * omega_h, steps);
      const double expected = integrator == Integrator::semi_implicit    ? 1
                              : integrator == Integrator::explicit_euler ? growth
                                                                         : 1 / growth;
      const double bound = integrator == Integrator::semi_implicit ? omega_h : 0.01;
      EXPECT_NEAR(left, expected, bound * expected)
          << words(integrator) << (soft_body ? ", soft body" : ", cloth");
    }
}

// --- drag, f = -c m v ----------------------------------------------------------------------------

double speed_left(Integrator integrator, double drag_h, int steps, Curves* curves = nullptr) {
  const double h = 0.01;
  Particle particle(integrator, {}, static_cast<float>(drag_h / h), {}, {1, 0, 0});
  for (int n = 1; n <= steps; ++n) {
    if (!particle.world.step(h).ok()) return HUGE_VAL;
    if (curves != nullptr) curves->add(words(integrator), n * drag_h, particle.v());
  }
  return particle.v();
}

// Both explicit forms multiply the speed by 1 - c h per step and diverge above c h = 2; implicit divides it
// by 1 + c h.
TEST(Integrators, Drag) {
  const std::string name = "integrators on drag";
  Curves curves(name, "c t", "speed / its start, c h = 0.5");
  for (int k = 0; k <= 100; ++k) curves.add("theory: exp(-c t)", 0.05 * k, std::exp(-0.05 * k));
  for (const Integrator integrator : every_integrator) {
    speed_left(integrator, 0.5, 10, &curves);
    const bool implicit = integrator == Integrator::implicit_euler;
    for (const double drag_h : {0.1, 0.5, 1.9, 2.1, 10.0}) {
      const double factor = implicit ? 1 / (1 + drag_h) : 1 - drag_h;
      validate_relative(
          name, std::string(words(integrator)) + ", c h = " + detail::number(drag_h) + ": left after 4 steps",
          speed_left(integrator, drag_h, 4), std::pow(factor, 4), 1e-3);
    }
  }
}

// --- gravity -------------------------------------------------------------------------------------

// x_n = -g h^2 (n^2 + s n) / 2 with s = 1 (semi-implicit and implicit) or -1 (explicit): an error of g h t /
// 2, of either sign.
TEST(Integrators, Gravity) {
  const std::string name = "integrators on gravity";
  Curves curves(name, "h [ms]", "height too low after 1 s [m]");
  for (const Integrator integrator : every_integrator)
    for (const int rate : {60, 120, 300, 600, 1200}) {
      Particle particle(integrator, {0, -9.81f, 0}, 0, {}, {});
      EXPECT_TRUE(run(particle.world, rate, 1.0 / rate));
      const double too_low = -9.81 / 2 - particle.y();
      const double sign = integrator == Integrator::explicit_euler ? -1 : 1;
      curves.add(words(integrator), 1000.0 / rate, too_low);
      validate_relative(name,
                        std::string(words(integrator)) + ", h = 1/" + std::to_string(rate) +
                            " s: height deficit after 1 s [m]",
                        too_low, sign * 9.81 / rate / 2, 0.01);
    }
}

// --- cost ----------------------------------------------------------------------------------------

// 10,000 falling particles in a force field f = -x, minimum of 20 steps.
TEST(Integrators, Cost) {
  const std::string name = "integrators, cost";
  Curves curves(name, "integrator", "integration [ns per particle and substep]");
  std::vector<double> spent;
  for (const Integrator integrator : every_integrator) {
    World world({.substeps = 10, .integrator = integrator, .drag = 0.1f});
    std::vector<Vec3d> points;
    points.reserve(10000);
    for (int i = 0; i < 10000; ++i) points.push_back({i * 0.1, 0, 0});
    world.add_grains(points, grain_of_mass(1));
    world.add_force_field([](const Vec3f& p, const Vec3f&, float, double) { return -p; });
    double least = HUGE_VAL;
    for (int n = 0; n < 20; ++n) {
      world.step(1.0 / 60);
      least = std::min(least, world.report().milliseconds[static_cast<std::size_t>(Stage::integrate)]);
    }
    const double nanoseconds = least * 1e6 / 10 / 10000;
    state(name, std::string(words(integrator)) + ": stage of integration [ns per particle and substep]",
          nanoseconds);
    curves.add(words(integrator), 0, nanoseconds);
    spent.push_back(nanoseconds);
  }
  EXPECT_GT(spent[2], 2 * spent[0]);  // Newton's method evaluates the field several times
}

}  // namespace souple::test_physics_integrators
