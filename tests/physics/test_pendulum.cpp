#include "tests/physics/motion.h"
#include "tests/physics/validation.h"
#include "tests/rigid/one_body.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_pendulum {

constexpr double g = 9.81f;

double elliptic_period(double theta0, double L) {
  return 4 * std::sqrt(L / g) * complete_elliptic(std::sin(theta0 / 2));
}

// sin(theta/2) = k sn(K - t sqrt(g/L)), k = sin(theta0/2): the angle at t after a release at theta0. sn by
// descending Landen steps: phi_N = 2^N a_N u, sin(2 phi_{n-1} - phi_n) = c_n / a_n sin(phi_n).
double elliptic_angle(double theta0, double L, double t) {
  constexpr int N = 6;
  const double k = std::sin(theta0 / 2);
  double a[N + 1] = {1}, c[N + 1] = {k}, b = std::cos(theta0 / 2);
  for (int n = 0; n < N; ++n) {
    a[n + 1] = (a[n] + b) / 2;
    c[n + 1] = (a[n] - b) / 2;
    b = std::sqrt(a[n] * b);
  }
  const double K = pi / (2 * a[N]);
  double phi = std::ldexp(a[N], N) * (K - t * std::sqrt(g / L));
  for (int n = N; n > 0; --n) phi = (phi + std::asin(c[n] / a[n] * std::sin(phi))) / 2;
  return 2 * std::asin(k * std::sin(phi));
}

struct Swing {
  double period = 0;  // s, the first full period: until the angle's rate next falls through zero
  double peak = 0;    // rad, the angle at that time
};

// 1 kg at 1 m from a pinned particle, one rigid distance constraint, released at theta0 from the vertical.
Swing swing(double theta0, const Settings& settings, double dt, Curves* curves = nullptr,
            const std::string& series = {}) {
  World world(settings);
  const Vec3d points[] = {{0, 0, 0}, {std::sin(theta0), -std::cos(theta0), 0}};
  const ObjectId bob = world.add_grains(points, grain_of_mass(1));
  world.pin(bob, vertices({0}));
  world.connect(std::vector<std::pair<VertexRef, VertexRef>>{{{bob, 0}, {bob, 1}}}, -1);
  double rate_before = -1, angle_before = theta0;
  for (int frame = 1; frame * dt < 4; ++frame) {
    world.step(dt);
    const Vec3d x(world.positions(bob)[1]), v(world.velocities(bob)[1]);
    const double angle = std::atan2(x.x, -x.y);
    const double rate = (v.x * -x.y + x.x * v.y) / dot(x, x);
    if (curves != nullptr) curves->add(series, frame * dt, angle * 180 / pi);
    if (rate_before > 0 && rate <= 0) {
      // Between the two frames the rate is linear, so the angle is a parabola.
      const double share = rate_before / (rate_before - rate);
      return {(frame - 1 + share) * dt, angle_before + 0.5 * rate_before * share * dt};
    }
    rate_before = rate;
    angle_before = angle;
  }
  return {};
}

TEST(Pendulum, PeriodIsTheEllipticIntegral) {
  const std::string name = "pendulum, L = 1 m, 20 substeps";
  Curves curves(name, "time [s]", "angle [degrees]");
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const int degrees : {5, 60, 90}) {
      const double theta0 = degrees * pi / 180;
      const Settings settings{.substeps = 20, .mode = mode};
      const bool drawn = mode == Mode::small_steps;
      const std::string angle = std::to_string(degrees) + " degrees";
      const Swing first = swing(theta0, settings, 1.0 / 60, drawn ? &curves : nullptr, angle);
      const double expected = elliptic_period(theta0, 1);
      if (drawn) {
        for (int i = 0; i <= 100; ++i)
          curves.add("theory: elliptic integral", i * expected / 100,
                     elliptic_angle(theta0, 1, i * expected / 100) * 180 / pi);
        curves.lift("theory: elliptic integral");
      }
      validate_relative(name, angle + ", " + mode_name(mode) + ": period [s]", first.period, expected,
                        degrees == 90 ? 0.01 : 0.005);
    }
}

TEST(Pendulum, AmplitudeLossHalvesWithTheStep) {
  const std::string name = "pendulum, amplitude loss at 90 degrees";
  Curves curves(name, "h [ms]", "angle lost in the first period [degrees]");
  double before = 0;
  for (const int substeps : {10, 20, 40, 80}) {
    const double lost = pi / 2 - swing(pi / 2, {.substeps = substeps}, 1.0 / 60).peak;
    const std::string at = std::to_string(substeps) + " substeps";
    state(name, at + ": lost in the first period [degrees]", lost * 180 / pi);
    curves.add("measured", 1000.0 / 60 / substeps, lost * 180 / pi);
    if (before > 0)
      validate_relative(name, at + ": loss at half as many substeps / loss", before / lost, 2, 0.1);
    before = lost;
  }
  const double coarsest = 1000.0 / 60 / 10;
  curves.add("theory: a line through the finest", {0, coarsest}, {0, 8 * before * 180 / pi});
}

enum class Swinging { link, rope, cloth };

/// Adds a pendulum of 1 m that hangs from the origin at 40 degrees.
ObjectId add_swinging(World& world, Swinging what) {
  const double angle = 40 * pi / 180;
  const Vec3d down{std::sin(angle), -std::cos(angle), 0}, ends[] = {{0, 0, 0}, down};
  if (what == Swinging::cloth) {
    TriangleMesh mesh = grid(20, 20, 1);
    for (Vec3d& x : mesh.positions) x = down * (x.z + 0.5) + Vec3d{0, 0, x.x};
    const ObjectId cloth = world.add_cloth(mesh, material::cotton);
    world.pin(cloth, in_box({-0.01f, -0.01f, -1}, {0.01f, 0.01f, 1}));
    return cloth;
  }
  const ObjectId object = what == Swinging::rope
                              ? world.add_rope(ends, 20, {.radius = 0.005f, .young_modulus = 1e9f})
                              : world.add_grains(ends, grain_of_mass(1));
  world.pin(object, vertices({0}));
  if (what == Swinging::link)
    world.connect(std::vector<std::pair<VertexRef, VertexRef>>{{{object, 0}, {object, 1}}}, -1);
  return object;
}

/// Parts of the energy above the lowest state that are lost after 3 s and 10 s.
struct Lost {
  double after_3 = 0, after_10 = 0;
};
Lost swing_and_lose(Swinging what, Settings settings) {
  settings.wind.air_density = 0;
  World world(settings);
  const ObjectId object = add_swinging(world, what);
  const double low = -world.total_mass(object) * g * length(world.center_of_mass(object));
  const double start = world.potential_energy(object) - low;
  const auto lost = [&] {
    return 1 - (world.kinetic_energy(object) + world.potential_energy(object) - low) / start;
  };
  EXPECT_TRUE(run(world, 180, 1.0 / 60));
  const double after_3 = lost();
  EXPECT_TRUE(run(world, 420, 1.0 / 60));
  return {after_3, lost()};
}

// The figures of docs/integrators.md. The integrators differ in the forces from outside alone: gravity has no say in
// what a swing loses.
TEST(Pendulum, LosesLittleAtDefaultSettings) {
  const std::string name = "swings from 40 degrees";
  const auto lose = [&](Swinging what, const std::string& words, const Settings& settings) {
    const Lost lost = swing_and_lose(what, settings);
    state(name, words + ": energy lost after 3 s [%]", 100 * lost.after_3);
    state(name, words + ": after 10 s [%]", 100 * lost.after_10);
    return lost;
  };
  SolverSettings sweeps;
  sweeps.kind = SolverKind::gauss_seidel;
  for (const auto& [integrator, word] : {std::pair{Integrator::semi_implicit, "semi_implicit"},
                                         {Integrator::explicit_euler, "explicit_euler"},
                                         {Integrator::implicit_euler, "implicit_euler"}}) {
    const Lost lost = lose(Swinging::link, std::string("1 link, ") + word, {.integrator = integrator});
    EXPECT_LT(std::abs(lost.after_3), 0.01) << word;
    EXPECT_LT(std::abs(lost.after_10), 0.03) << word;
  }
  for (const int substeps : {10, 20, 40}) {
    const std::string at = ", " + std::to_string(substeps) + " substeps";
    const double coarser = 10.0 / substeps;
    EXPECT_LT(lose(Swinging::link, "1 link" + at, {.substeps = substeps}).after_10, 0.03 * coarser);
    EXPECT_NEAR(
        lose(Swinging::link, "1 link, gauss_seidel" + at, {.substeps = substeps, .solver = sweeps}).after_3,
        0.06 * coarser, 0.01 * coarser);
    EXPECT_LT(lose(Swinging::rope, "rope of 20 segments" + at, {.substeps = substeps}).after_10,
              0.06 * coarser);
    EXPECT_LT(lose(Swinging::cloth, "cotton of 20 x 20" + at, {.substeps = substeps}).after_3,
              0.03 + 0.12 * coarser);
  }
}

// A link that whirls loses at most 0.2 omega^2 h of its energy per second, however fast it turns in a substep.
TEST(Pendulum, WhirlsAsLongAsItSwings) {
  for (const Swinging what : {Swinging::link, Swinging::rope})
    for (const double angle : {0.01, 0.033, 0.1}) {  // per substep
      const Settings settings{.gravity = {}, .wind = {.air_density = 0}};
      World world(settings);
      const ObjectId object = add_swinging(world, what);
      const double h = 1.0 / 60 / settings.substeps, omega = angle / h;
      std::vector<Vec3f> velocities;
      for (const Vec3f& x : world.positions(object))
        velocities.push_back(Vec3f(cross(Vec3d{0, 0, omega}, Vec3d(x))));
      world.set_velocities(object, velocities);
      EXPECT_TRUE(run(world, 3, 1.0 / 60));
      const double before = world.kinetic_energy(object);
      EXPECT_TRUE(run(world, 12, 1.0 / 60));
      const double rate = std::log(before / world.kinetic_energy(object)) / 0.2;
      EXPECT_LT(std::abs(rate), 0.2 * omega * omega * h) << static_cast<int>(what) << ", " << angle << " rad";
    }
}

// 10 m from the origin and small steps: a swing of 0.01 rad must not freeze (floats have a resolution of 1e-6
// m there).
TEST(Pendulum, SwingsFarFromTheOrigin) {
  World world({.substeps = 20});
  const Vec3d points[] = {{10, 10, 0}, {10 + std::sin(0.01), 10 - std::cos(0.01), 0}};
  const ObjectId bob = world.add_grains(points, grain_of_mass(1));
  world.pin(bob, vertices({0}));
  world.connect(std::vector<std::pair<VertexRef, VertexRef>>{{{bob, 0}, {bob, 1}}}, -1);
  const double T = elliptic_period(0.01, 1);
  const std::string name = "pendulum of 0.01 rad, 10 m from the origin";
  Curves curves(name, "time [s]", "angle [mrad]");
  double lowest = 1, highest = -1;
  for (int frame = 1; frame < 130; ++frame) {
    world.step(T / 120);
    const double x = world.center_of_mass(bob).x * 2 - 20;
    lowest = std::min(lowest, x);
    if (frame > 90) highest = std::max(highest, x);
    curves.add("theory: elliptic integral", frame * T / 120, 1000 * elliptic_angle(0.01, 1, frame * T / 120));
    if (frame % 4 == 0) curves.add("simulated", frame * T / 120, 1000 * std::asin(x));
  }
  validate_relative(name, "largest displacement on the opposite side [m]", lowest, -std::sin(0.01), 0.02);
  validate_relative(name, "position after one period [m]", highest, std::sin(0.01), 0.02);
}

}  // namespace souple::test_physics_pendulum
