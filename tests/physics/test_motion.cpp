#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_motion {

// 1 kg on a spring of 1 m and k N/m, below a pinned particle.
struct Oscillator {
  World world;
  ObjectId mass;

  Oscillator(const Settings& settings, double k, double stretch, float damping_time = 0) : world(settings) {
    mass = world.add_grains(std::vector<Vec3d>{{0, 0, 0}, {0, -1 - stretch, 0}}, grain_of_mass(1));
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

// --- spin ----------------------------------------------------------------------------------------

// Best fit of the angular velocity about z: sum m (r x v) / sum m r^2.
double spin_of(const World& world, ObjectId body) {
  const Vec3d center = world.center_of_mass(body);
  const auto x = world.positions(body), v = world.velocities(body);
  Vec3d mean;
  for (const Vec3f& velocity : v) mean += Vec3d(velocity) / static_cast<double>(v.size());
  double momentum = 0, inertia = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3d r = Vec3d(x[i]) - center, u = Vec3d(v[i]) - mean;
    momentum += r.x * u.y - r.y * u.x;
    inertia += r.x * r.x + r.y * r.y;
  }
  return momentum / inertia;
}

enum class Body { shape_matching, links, bar, cube, cotton, lattice };

std::string name_of(Body kind) {
  constexpr const char* names[] = {"shape matching", "rigid links", "bar", "cube", "cotton", "lattice"};
  return names[static_cast<std::size_t>(kind)];
}

ObjectId add_body(World& world, Body kind, const Vec3f& velocity) {
  const ObjectOptions thrown{.velocity = velocity, .angular_velocity = {0, 0, static_cast<float>(2 * pi)}};
  const SoftBodyMaterial stiff{.young_modulus = 1e6f, .density = 200};
  switch (kind) {
    case Body::shape_matching:
      return world.add_soft_body(
          tet_bar(3, 3, 3, {0.3, 0.3, 0.3}),
          {.young_modulus = 1e12f, .poisson_ratio = 0.3f, .model = SoftBodyModel::shape_matching}, thrown);
    case Body::bar:
      return world.add_soft_body(tet_bar(6, 2, 2, {0.6, 0.2, 0.2}), stiff, thrown);
    case Body::cube:
      return world.add_soft_body(tet_bar(3, 3, 3, {0.3, 0.3, 0.3}), stiff, thrown);
    case Body::lattice:
      return world.add_soft_body(sphere(2, 0.2), stiff, LatticeOptions{}, thrown);
    case Body::cotton: {
      ObjectOptions upright = thrown;
      upright.transform.rotation = Quatd::from_axis_angle({1, 0, 0}, pi / 2);
      return world.add_cloth(grid(8, 8, 0.5), material::cotton, upright);
    }
    case Body::links:
      break;
  }
  const Vec3d corners[] = {{0.2, 0, 0}, {-0.1, 0.1 * std::sqrt(3.0), 0}, {-0.1, -0.1 * std::sqrt(3.0), 0}};
  const ObjectId body = world.add_grains(corners, grain_of_mass(1), thrown);
  world.connect(
      std::vector<std::pair<VertexRef, VertexRef>>{
          {{body, 0}, {body, 1}}, {{body, 1}, {body, 2}}, {{body, 2}, {body, 0}}},
      -1);
  return body;
}

TEST(Spin, OfAFreeBodyLasts) {
  const std::string name = "free rigid-like body spinning at 2 pi rad/s";
  Curves curves(name, "time [s]", "angular velocity [rad/s]");
  for (const Body kind :
       {Body::shape_matching, Body::links, Body::bar, Body::cube, Body::cotton, Body::lattice}) {
    const Vec3d velocity{0.6, 0.8, 0};
    World world({.gravity = {}, .wind = {.air_density = 0}});
    const ObjectId body = add_body(world, kind, Vec3f(velocity));
    const Vec3d start = world.center_of_mass(body);
    const double energy = world.kinetic_energy(body);
    double worst = 0, astray = 0, most = 1;
    for (int frame = 1; frame <= 180; ++frame) {
      EXPECT_TRUE(world.step(1.0 / 60).ok());
      const double t = frame / 60.0;
      const double spin = spin_of(world, body);
      worst = std::max(worst, std::fabs(spin / (2 * pi) - 1));
      astray = std::max(astray, length(world.center_of_mass(body) - start - velocity * t));
      most = std::max(most, world.kinetic_energy(body) / energy);
      if (frame % 10 == 0) curves.add(name_of(kind), t, spin);
    }
    validate_below(name, name_of(kind) + ": relative error of angular velocity", worst, 0.003);
    validate_below(name, name_of(kind) + ": distance of the center of mass from its line [m]", astray, 1e-3);
    validate_below(name, name_of(kind) + ": kinetic energy gained over the first", most - 1, 1e-3);
    EXPECT_GT(world.kinetic_energy(body), 0.95 * energy) << name_of(kind);
  }
}

// Balls that are tied to a rope spin with it. The ends of the rope touch the balls: contacts there would pull at the ties.
TEST(Spin, OfBallsOnARopeLasts) {
  for (const std::uint32_t segments : {4, 8, 12}) {
    World world({.gravity = {}, .wind = {.air_density = 0}});
    const auto w = static_cast<float>(2 * pi);
    const Vec3d ends[] = {{-0.4, 0, 0}, {0.4, 0, 0}};
    const ObjectId rope = world.add_rope(ends, segments, {}, {.angular_velocity = {0, 0, w}});
    ObjectId balls[2];
    for (const std::size_t k : {0, 1}) {
      const float side = k == 0 ? -1 : 1;
      ObjectOptions options{.velocity = {0, side * 0.45f * w, 0}, .angular_velocity = {0, 0, w}};
      options.transform.translation = {0.45 * static_cast<double>(side), 0, 0};
      balls[k] = world.add_rigid_body(Sphere{{}, 0.05f}, {.density = 2000}, options);
      world.add_tie(rope, balls[k], {.point = ends[k]});
    }
    for (int frame = 0; frame < 600; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
    const RigidBodyState a = world.rigid_body(balls[0]), b = world.rigid_body(balls[1]);
    const Vec3d r = b.pose.translation - a.pose.translation;
    EXPECT_NEAR(cross(r, b.velocity - a.velocity).z / length_squared(r), 2 * pi, 0.003 * 2 * pi) << segments;
  }
}

// --- energy --------------------------------------------------------------------------------------

// A cube of 0.2 m, stretched by 10 % along x and released. Its energy relative to the start at each frame of
// 2 s.
std::vector<double> ring(SoftBodyModel model, const Settings& settings) {
  World world(settings);
  const ObjectId body = world.add_soft_body(
      tet_bar(4, 4, 4, {0.2, 0.2, 0.2}),
      {.young_modulus = 2e3f, .poisson_ratio = 0.3f, .density = 1000, .damping_time = 0, .model = model});
  std::vector<Vec3f> x(world.positions(body).begin(), world.positions(body).end());
  for (Vec3f& p : x) p.x *= 1.1f;
  world.set_positions(body, x);
  const double start = world.elastic_energy();
  std::vector<double> energy;
  for (int frame = 1; frame <= 60; ++frame) {
    if (!world.step(1.0 / 60).ok()) return {std::nan("")};
    energy.push_back((world.kinetic_energy(body) + world.elastic_energy()) / start);
  }
  return energy;
}

TEST(ElasticBody, NeverGainsEnergyAndLosesLessInSmallerSteps) {
  const std::string name = "unforced elastic body";
  Curves curves(name, "time [s]", "energy / its start");
  for (const SoftBodyModel model : {SoftBodyModel::neo_hookean, SoftBodyModel::springs})
    for (const Mode mode : {Mode::small_steps, Mode::xpbd}) {
      const std::string what = std::string(model == SoftBodyModel::springs ? "springs, " : "neo-Hookean, ") +
                               mode_name(mode) + ", ";
      double before = 2;
      for (const int substeps : {5, 20, 80}) {
        if (mode == Mode::xpbd && substeps > 20) continue;
        const int iterations = mode == Mode::xpbd ? 4 : 1;
        const std::vector<double> energy =
            ring(model, {.substeps = substeps, .iterations = iterations, .mode = mode, .gravity = {}});
        const std::string at = what + std::to_string(substeps) + " substeps";
        validate_below(name, at + ": largest energy", *std::max_element(energy.begin(), energy.end()), 1.01);
        // Loss over the first quarter second; later, little energy remains.
        const double lost = 1 - energy[14];
        state(name, at + ": lost in 0.25 s", lost);
        // A quarter of the step: the loss must vanish with it.
        if (before < 2) {
          validate_below(name, at + ": loss / loss at four times the step", lost / before, 0.6);
        }
        before = lost;
        if (mode == Mode::small_steps)
          for (std::size_t i = 0; i < energy.size(); ++i)
            curves.add(at, static_cast<double>(i + 1) / 60, energy[i]);
      }
    }
}

// --- free fall -----------------------------------------------------------------------------------

struct Fall {
  double x_error = 0, v_error = 0;  // maxima over the fall, relative to the distance and speed of the fall
};

// Closed form of the scheme, v_n = -g n h and x_n = -g h^2 n (n + 1) / 2.
Fall fall(int steps, double h, Curves& curves) {
  World world({.substeps = 1});
  const Vec3d origin[] = {Vec3d{}};
  const ObjectId stone = world.add_grains(origin, grain_of_mass(1));
  const double g = -static_cast<double>(world.settings().gravity.y);
  const std::string series = "h = 1/" + std::to_string(std::lround(1 / h)) + " s";
  Fall result;
  for (int n = 1; n <= steps; ++n) {
    world.step(h);
    const double v = -g * n * h;
    const double x = -g * h * h * n * (n + 1) / 2;
    const double x_error = std::fabs(world.center_of_mass(stone).y - x) / std::fabs(x);
    const double v_error = std::fabs(world.momentum(stone).y - v) / std::fabs(v);
    result.x_error = std::max(result.x_error, x_error);
    result.v_error = std::max(result.v_error, v_error);
    if (n % (steps / 100) == 0) curves.add(series, n * h, std::max(x_error, 1e-9));
  }
  return result;
}

TEST(FreeFall, FollowsTheDiscreteClosedForm) {
  const std::string name = "free fall";
  Curves curves(name, "time [s]", "relative error of the fallen height (log)");
  const Fall long_steps = fall(1000, 1.0 / 60, curves);
  validate_below(name, "1000 x 1/60 s: x", long_steps.x_error, 1e-4);
  validate_below(name, "1000 x 1/60 s: v", long_steps.v_error, 1e-4);
  const Fall short_steps = fall(10000, 1.0 / 600, curves);
  validate_below(name, "10,000 x 1/600 s: x", short_steps.x_error, 1e-4);
  validate_below(name, "10,000 x 1/600 s: v", short_steps.v_error, 1e-4);
}

// --- a free body ---------------------------------------------------------------------------------

enum class Make { links, springs, solid };
std::string words(Make make) {
  return make == Make::links ? "rigid links" : make == Make::springs ? "tet springs" : "neo-Hookean";
}

std::vector<Vec3d> lattice_points(double spacing) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) points.push_back({i * spacing, j * spacing, k * spacing});
  return points;
}

// 5 x 5 x 5 particles, 0.4 m wide, thrown at 1 m/s without gravity. They have rigid links along the edges of the
// lattice, or are an elastic solid of E = 1e5 Pa.
struct Lattice {
  World world;
  ObjectId body;

  Lattice(Make make, int substeps, const Vec3d& at = {}, float spin = 0)
      : world({.substeps = substeps, .gravity = {}}) {
    const ObjectOptions thrown{
        .transform = {.translation = at}, .velocity = {0.8f, 0.6f, 0}, .angular_velocity = {0, 0, spin}};
    if (make == Make::links) {
      const std::vector<Vec3d> points = lattice_points(0.1);
      body = world.add_grains(points, grain_of_mass(0.01), thrown);
      std::vector<std::pair<VertexRef, VertexRef>> links;
      for (std::uint32_t a = 0; a < points.size(); ++a)
        for (std::uint32_t b = a + 1; b < points.size(); ++b)
          if (length(points[a] - points[b]) < 0.11) links.push_back({{body, a}, {body, b}});
      world.connect(links, -1);
    } else {
      const auto model = make == Make::springs ? SoftBodyModel::springs : SoftBodyModel::neo_hookean;
      body = world.add_soft_body(tet_bar(4, 4, 4, {0.4, 0.4, 0.4}),
                                 {.young_modulus = 1e5f, .poisson_ratio = 0.3f, .model = model}, thrown);
    }
  }
};

// Maximum over the run. All particles move alike, so sum m|v| is the momentum itself.
double momentum_error(Make make, int substeps, Curves& curves) {
  Lattice lattice(make, substeps);
  const Vec3d start = lattice.world.momentum(lattice.body);
  const std::string series = words(make) + ", " + std::to_string(substeps) + " substeps";
  double worst = 0;
  for (int frame = 1; frame <= 600; ++frame) {
    if (!lattice.world.step(1.0 / 60).ok()) return std::nan("");
    const double error = length(lattice.world.momentum(lattice.body) - start) / length(start);
    worst = std::max(worst, error);
    if (frame % 10 == 0) curves.add(series, frame / 60.0, std::max(error, 1e-9));
  }
  return worst;
}

TEST(FreeLattice, KeepsItsMomentum) {
  const std::string name = "free 5 x 5 x 5 lattice";
  Curves curves(name, "time [s]", "lost momentum, relative to sum m|v| (log)");
  const auto error = [&](Make make, int substeps) { return momentum_error(make, substeps, curves); };
  for (const int substeps : {10, 50}) {
    const std::string at = ", " + std::to_string(substeps) + " substeps";
    validate_below(name, "rigid links" + at, error(Make::links, substeps), 1e-5);
    validate_below(name, "tet springs" + at, error(Make::springs, substeps), 1e-5);
  }
  validate_below(name, "neo-Hookean, 10 substeps", error(Make::solid, 10), 1e-5);
  // The noise of 320 tets' strains over 30,000 substeps.
  validate_below(name, "neo-Hookean, 50 substeps", error(Make::solid, 50), 1.2e-5);
}

// --- far from the origin, and at other rates -----------------------------------------------------

struct Trajectory {
  std::vector<std::vector<Vec3d>> frames;  // at 30 Hz, relative to the start [m]
  double fastest = 0;                      // m/s
};

Trajectory trajectory(const Vec3d& at, int rate) {
  Lattice lattice(Make::solid, 600 / rate, at, 1);  // rotating, hence strained
  Trajectory result;
  for (int frame = 1; frame <= 5 * rate; ++frame) {
    EXPECT_TRUE(lattice.world.step(1.0 / rate).ok());
    if (frame % (rate / 30) != 0) continue;
    result.frames.emplace_back();
    for (const Vec3f& x : lattice.world.positions(lattice.body))
      result.frames.back().push_back(Vec3d(x) - at);
    for (const Vec3f& v : lattice.world.velocities(lattice.body))
      result.fastest = std::max(result.fastest, static_cast<double>(length(v)));
  }
  return result;
}

double largest_difference(const Trajectory& a, const Trajectory& b, const std::string& series,
                          Curves& curves) {
  double worst = 0;
  EXPECT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t frame = 0; frame < a.frames.size(); ++frame) {
    double here = 0;
    for (std::size_t i = 0; i < a.frames[frame].size(); ++i)
      here = std::max(here, length(a.frames[frame][i] - b.frames[frame][i]));
    worst = std::max(worst, here);
    if (frame % 3 == 0) curves.add(series, static_cast<double>(frame + 1) / 30, std::max(here, 1e-9));
  }
  return worst;
}

TEST(FreeLattice, MovesAlikeEverywhere) {
  const std::string name = "the same lattice far from the origin";
  Curves curves(name, "time [s]", "distance to the run at the origin [m] (log)");
  curves.add("bound", {0, 5}, {1e-4, 1e-4});
  const Trajectory here = trajectory({}, 60);
  for (const double distance : {10.0, 1000.0}) {
    const Trajectory there = trajectory({distance, 0, 0}, 60);
    const std::string at = std::to_string(std::lround(distance)) + " m";
    const double difference = largest_difference(here, there, at, curves);
    validate_below(name, at + ": difference [m]", difference, 1e-4);
    validate_below(name, at + ": fastest particle [m/s]", there.fastest, 2);
  }
}

TEST(FreeLattice, MovesAlikeAtEveryFrameRate) {
  const std::string name = "the same lattice at other frame rates";
  Curves curves(name, "time [s]", "distance to the run at 60 Hz [m], 1e-9 is 0 (log)");
  curves.add("bound", {0, 5}, {1e-4, 1e-4});
  const Trajectory reference = trajectory({}, 60);
  for (const int rate : {30, 120}) {
    const std::string at = std::to_string(rate) + " Hz";
    const double difference = largest_difference(reference, trajectory({}, rate), at, curves);
    validate_below(name, at + ": difference to 60 Hz [m]", difference, 1e-4);
  }
}

}  // namespace souple::test_physics_motion
