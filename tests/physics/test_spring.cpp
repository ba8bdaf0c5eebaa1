#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <cmath>

namespace souple::test_physics_spring {

// 1 kg on a spring of 1 m and k N/m, below a pinned particle.
struct Oscillator {
  World world;
  ObjectId mass;

  Oscillator(const Settings& settings, double k, double stretch, float damping_time = 0) : world(settings) {
    const Vec3d points[] = {{0, 0, 0}, {0, -1 - stretch, 0}};
    mass = world.add_grains(points, grain_of_mass(1));
    world.pin(mass, vertices({0}));
    auto spring = std::make_unique<SetProjector<Distance>>();
    spring->add({world.particle(mass, 0), world.particle(mass, 1)}, {1.0f}, {static_cast<float>(1 / k)},
                damping_time);
    world.add_projector(std::move(spring));
  }
  double stretch() const { return -1 - static_cast<double>(world.positions(mass)[1].y); }
};

struct Oscillation {
  double period = 0, decay = 0;  // s, 1/s
};

// Over ten periods, from the times at which the stretch falls through zero and the speeds then.
Oscillation oscillate(double omega, const Settings& settings, double h, Curves* curves, double tau = 0) {
  Oscillator spring(settings, omega * omega, 0.1, static_cast<float>(tau));
  double before = spring.stretch(), first = 0, first_speed = 0;
  int crossings = 0;
  for (int n = 1; n < 1000000; ++n) {
    spring.world.step(h);
    const double now = spring.stretch();
    if (curves != nullptr && n * h * omega < 4 * pi) curves->add("measured", n * h * omega, now);
    if (before > 0 && now <= 0) {
      const double t = (n - 1 + before / (before - now)) * h;
      const double speed = (before - now) / h;
      if (crossings == 0) first = t, first_speed = speed;
      if (++crossings == 11) return {(t - first) / 10, std::log(first_speed / speed) / (t - first)};
    }
    before = now;
  }
  return {};
}

// Implicit Euler on a linear spring: each step multiplies the complex amplitude by 1 / (1 - i omega h). So
// the period is longer by omega h / atan(omega h) = 1 + (omega h)^2/3, and the amplitude decays at omega^2
// h/2, to lowest order.
TEST(Spring, PeriodAndDecayFollowTheScheme) {
  const std::string name = "compliant spring";
  const double h = 1.0 / 600;
  Curves curves(name, "omega t", "stretch [m] at omega h = 0.1");
  for (int k = 0; k <= 400; ++k) {
    const double t = 4 * pi * k / 400;
    curves.add("theory: decaying at omega^2 h/2", t,
               0.1 * std::exp(-0.05 * t) * std::cos(t * std::atan(0.1) / 0.1));
  }
  for (const double omega_h : {0.1, 0.05, 0.02})
    for (const int iterations : {1, 5, 20}) {
      const double omega = omega_h / h;
      const Settings settings{.substeps = 1, .iterations = iterations, .mode = Mode::xpbd, .gravity = {}};
      const bool drawn = omega_h == 0.1 && iterations == 1;
      const Oscillation measured = oscillate(omega, settings, h, drawn ? &curves : nullptr);
      const std::string at = "omega h = " +
                             std::string(omega_h == 0.1    ? "0.1"
                                         : omega_h == 0.05 ? "0.05"
                                                           : "0.02") +
                             ", " + std::to_string(iterations) + " iterations: ";
      validate_relative(name, at + "period error", measured.period * omega / (2 * pi) - 1,
                        omega_h * omega_h / 3, 0.1);
      validate_relative(name, at + "decay [1/s]", measured.decay, omega * omega * h / 2, 0.05);
    }
}

// Kelvin-Voigt damping of time tau adds omega^2 tau/2 to the decay of the scheme.
TEST(Spring, DampingTimeAddsItsDecay) {
  const std::string name = "decay of a damped spring";
  const double h = 1.0 / 6000, omega = 30;
  for (const Mode mode : {Mode::small_steps, Mode::xpbd})
    for (const int iterations : {1, 5})
      for (const double tau : {0.001, 0.005}) {
        const Settings settings{.substeps = 1, .iterations = iterations, .mode = mode, .gravity = {}};
        const Oscillation measured = oscillate(omega, settings, h, nullptr, tau);
        const std::string at = std::string(mode_name(mode)) + ", " + std::to_string(iterations) +
                               " iterations, tau = " + std::to_string(static_cast<int>(1000 * tau)) + " ms: ";
        validate_relative(name, at + "decay [1/s]", measured.decay, omega * omega * (h + tau) / 2, 0.03);
      }
}

TEST(Spring, SagsByItsWeightWithDampingOn) {
  const std::string name = "sag of a damped spring";
  Curves curves(name, "time [s]", "stretch [mm]");
  const double k = 1000, expected = 9.81 / k;
  curves.add("theory: at rest, m g / k", {0, 1}, {1000 * expected, 1000 * expected});
  for (const Mode mode : {Mode::small_steps, Mode::xpbd})
    for (const int iterations : {1, 5, 20}) {
      Oscillator spring({.substeps = 10, .iterations = iterations, .mode = mode}, k, 0, 0.02f);
      const std::string at = std::string(mode_name(mode)) + ", " + std::to_string(iterations) + " iterations";
      for (int frame = 1; frame <= 300; ++frame) {
        spring.world.step(1.0 / 60);
        if (frame <= 60) curves.add(at, frame / 60.0, 1000 * spring.stretch());
      }
      validate_relative(name, at + " [m]", spring.stretch(), expected, 0.001);
    }
}

}  // namespace souple::test_physics_spring
