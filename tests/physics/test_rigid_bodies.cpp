#include "souple/souple.h"
#include "tests/physics/validation.h"
#include "tests/rigid/one_body.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// Rigid bodies and joints of a world with default settings, a frame of 1/60 s: what docs/validation.md shows of them. The
// parts below, body by body and joint by joint, are tested in tests/rigid.

namespace souple::test_physics_rigid_bodies {

constexpr double frame = 1.0 / 60;
constexpr double g = 9.81;

/// Times at which a signal changes its sign, interpolated.
struct SignChanges {
  double before = 0, time_before = 0;
  std::vector<double> times{};

  void see(double time, double value) {
    if (before * value < 0) times.push_back(time - (time - time_before) * value / (value - before));
    before = value, time_before = time;
  }
  /// Mean time between two successive changes.
  double interval() const { return (times.back() - times.front()) / static_cast<double>(times.size() - 1); }
};

// --- free spin ---------------------------------------------------------------------------------------

/// Euler's equations of a free body in its principal axes: I dw/dt = (I w) x w.
Vec3d spin_change(const Vec3d& I, const Vec3d& w) {
  const Vec3d moment = cross({I.x * w.x, I.y * w.y, I.z * w.z}, w);
  return {moment.x / I.x, moment.y / I.y, moment.z / I.z};
}

/// By the classic Runge-Kutta method, 1000 steps a frame.
Vec3d spin_after_a_frame(const Vec3d& I, Vec3d w) {
  const double h = frame / 1000;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d a = spin_change(I, w), b = spin_change(I, w + a * (h / 2)),
                c = spin_change(I, w + b * (h / 2)), d = spin_change(I, w + c * h);
    w += (a + b * 2 + c * 2 + d) * (h / 6);
  }
  return w;
}

double energy_of(const Vec3d& I, const Vec3d& w) {
  return (I.x * w.x * w.x + I.y * w.y * w.y + I.z * w.z * w.z) / 2;
}

// The intermediate axis of a box is unstable: it turns round again and again (Dzhanibekov's effect).
TEST(RigidBodyPhysics, ASpinAboutTheMiddleAxisFlips) {
  const std::string name = "rigid box that spins about its middle axis";
  Curves curves(name, "time [s]", "angular velocity about the middle axis [rad/s]");
  World world({.gravity = {}, .threads = 1});
  const ObjectId box = world.add_rigid_body(Box{.half_extents = {0.3f, 0.2f, 0.1f}});
  world.set_body_velocity(box, {}, {0.03f, 6, 0.02f});
  const auto spin = [&] {
    const RigidBodyState state = world.rigid_body(box);
    return rotate(conjugate(state.pose.rotation), state.angular_velocity);
  };
  const Vec3d I = world.rigid_body(box).inertia, start = spin();
  int middle = 0;
  for (int k = 1; k < 3; ++k) middle = std::abs(start[k]) > std::abs(start[middle]) ? k : middle;
  Vec3d theory = start;
  SignChanges expected, measured;
  double energy_error = 0;
  for (int i = 1; i <= 3600; ++i) {
    world.step(frame);
    theory = spin_after_a_frame(I, theory);
    const Vec3d w = spin();
    energy_error = std::max(energy_error, std::abs(energy_of(I, w) / energy_of(I, start) - 1));
    expected.see(i * frame, theory[middle]), measured.see(i * frame, w[middle]);
    if (i > 1200) continue;
    curves.add("theory, Euler's equations", i * frame, theory[middle]);
    if (i % 6 == 0) curves.add("simulation, 10 substeps", i * frame, w[middle]);
  }
  ASSERT_GT(expected.times.size(), 5u);
  ASSERT_GT(measured.times.size(), 5u);
  validate_relative(name, "time between flips in 60 s [s]", measured.interval(), expected.interval(), 0.02);
  validate_below(name, "largest relative error of the energy in 60 s", energy_error, 0.01);
}

// Every particle of a box that does not turn moves alike, and so do their roundings.
TEST(RigidBodyPhysics, ABoxFallsFreely) {
  World world({.threads = 1});
  const ObjectId box = world.add_rigid_body(Box{.half_extents = {0.1f, 0.1f, 0.1f}});
  for (int i = 0; i < 120; ++i) world.step(frame);
  validate_relative("rigid box that falls freely", "speed after 2 s [m/s]",
                    -double{world.rigid_body(box).velocity.y}, 2 * g, 1e-4);
}

// --- contacts ----------------------------------------------------------------------------------------

struct Solid {
  const char* name;
  Shape shape;
  double height;  ///< of the center of mass when it lies on the floor [m]
};

std::vector<Solid> solids() {
  return {{"box", Box{.half_extents = {0.1f, 0.1f, 0.1f}}, 0.1},
          {"ball", Sphere{.radius = 0.1f}, 0.1},
          {"standing cylinder", Cylinder{.radius = 0.1f, .half_height = 0.1f}, 0.1}};
}

TEST(RigidBodyPhysics, ABounceRisesToTheSquareOfItsRestitution) {
  const std::string name = "rigid bodies that bounce from 1 m";
  Curves curves(name, "restitution", "height after the bounce [m]");
  for (double e = 0; e <= 1.001; e += 0.05) curves.add("theory, e^2", e, e * e);
  for (const Solid& solid : solids()) {
    for (const double e : {0.3, 0.5, 0.8, 1.0}) {
      World world({.threads = 1});
      world.add_collider(Plane{}, {.restitution = static_cast<float>(e)});
      const ObjectId body = world.add_rigid_body(solid.shape, {.restitution = static_cast<float>(e)},
                                                 {.transform = {.translation = {0, 1 + solid.height, 0}}});
      double highest = 0;
      bool fell = false;
      for (int i = 0; i < 100; ++i) {
        world.step(frame);
        const RigidBodyState state = world.rigid_body(body);
        fell = fell || state.velocity.y > 0;
        if (fell) highest = std::max(highest, state.pose.translation.y - solid.height);
        if (fell && state.velocity.y < 0) break;
      }
      curves.add(solid.name, e, highest);
      validate_relative(name, std::string(solid.name) + ", e = " + detail::number(e) + ": height [m]",
                        highest, e * e, 0.02);
    }
  }
}

TEST(RigidBodyPhysics, ABoxSlidesByCoulombsLaw) {
  const std::string name = "rigid box on a slope of 0.4 rad";
  Curves curves(name, "friction coefficient", "acceleration [m/s^2]");
  const double angle = 0.4, limit = std::tan(angle);
  const auto theory = [&](double mu) { return g * std::max(0.0, std::sin(angle) - mu * std::cos(angle)); };
  for (double mu = 0; mu <= 0.601; mu += 0.01) curves.add("theory", mu, theory(mu));
  for (const double mu : {0.0, 0.1, 0.2, 0.3, 0.4, 0.41, 0.44, 0.5, 0.6}) {
    World world({.threads = 1});
    const auto friction = static_cast<float>(mu);
    world.add_collider(Plane{.normal = Vec3f(Vec3d{std::sin(angle), std::cos(angle), 0})},
                       {.friction = friction});
    const ObjectId box = world.add_rigid_body(
        Box{.half_extents = {0.1f, 0.05f, 0.1f}}, {.friction = friction},
        {.transform = {.translation = {0.05 * std::sin(angle), 0.05 * std::cos(angle), 0},
                       .rotation = Quatd::from_axis_angle({0, 0, 1}, -angle)}});
    for (int i = 0; i < 60; ++i) world.step(frame);
    const double early = length(world.rigid_body(box).velocity);
    for (int i = 0; i < 60; ++i) world.step(frame);
    const double a = length(world.rigid_body(box).velocity) - early;
    curves.add("simulation", mu, a);
    const std::string quantity = "friction " + detail::number(mu) + ": acceleration [m/s^2]";
    if (mu < limit)
      validate_relative(name, quantity, a, theory(mu), 0.02);
    else
      validate_below(name, quantity, std::abs(a), 1e-3);
  }
}

/// How far the top of a stack of ten boxes on the floor moves from second 1 to `seconds` [m].
double drift_of_a_stack(double growth, double seconds) {
  World world({.threads = 1});
  world.add_collider(Plane{});
  ObjectId top{};
  double floor = 0;
  for (int i = 0; i < 10; ++i) {
    const double half = 0.05 * std::pow(growth, i / 9.0);
    top = world.add_rigid_body(Box{.half_extents = Vec3f(Vec3d{half, half, half})}, {},
                               {.transform = {.translation = {0, floor + half, 0}}});
    floor += 2 * half;
  }
  for (double t = 0; t < 1; t += frame) world.step(frame);
  const Vec3d early = world.rigid_body(top).pose.translation;
  for (double t = 1; t < seconds; t += frame) world.step(frame);
  return length(world.rigid_body(top).pose.translation - early);
}

TEST(RigidBodyPhysics, AStackStands) {
  const std::string name = "stack of ten rigid boxes, 10 s";
  for (const double growth : {0.2, 1.0, 5.0}) {
    validate_below(name,
                   "edges that grow " + detail::number(growth) + " times to the top: drift of the top [m]",
                   drift_of_a_stack(growth, 10), 1e-3);
  }
}

// --- joints ------------------------------------------------------------------------------------------

/// Period of a pendulum relative to small swings.
double period_factor(double amplitude) {
  return 2 / pi * complete_elliptic(std::sin(amplitude / 2));
}

TEST(RigidBodyPhysics, APendulumSwingsWithItsPeriod) {
  const std::string name = "rigid rod on a hinge";
  Curves curves(name, "amplitude [degrees]", "period [s]");
  const double half = 0.5, thin = 0.02;
  // I = m (L^2 + w^2) / 12 + m (L / 2)^2, T = 2 pi sqrt(I / (m g L / 2))
  const double small = 2 * pi * std::sqrt(((half * half + thin * thin) / 3 + half * half) / (g * half));
  for (double a = 1; a <= 150; a += 1)
    curves.add("theory, elliptic integral", a, small * period_factor(a * pi / 180));
  for (const double degrees : {5.0, 30.0, 60.0, 90.0, 120.0, 150.0}) {
    const double amplitude = degrees * pi / 180;
    World world({.threads = 1});
    const ObjectId rod = world.add_rigid_body(
        Box{.half_extents = {static_cast<float>(thin), static_cast<float>(half), static_cast<float>(thin)}},
        {},
        {.transform = {.translation = {half * std::sin(amplitude), -half * std::cos(amplitude), 0},
                       .rotation = Quatd::from_axis_angle({0, 0, 1}, amplitude)}});
    world.add_joint({}, rod, joint::Hinge{}, {.axis = {0, 0, 1}});
    SignChanges passes;
    for (int i = 1; i <= 1200; ++i) {
      world.step(frame);
      passes.see(i * frame, world.rigid_body(rod).pose.translation.x);
    }
    const double period = 2 * passes.interval();
    curves.add("simulation", degrees, period);
    validate_relative(name, "amplitude of " + detail::number(degrees) + " degrees: period [s]", period,
                      small * period_factor(amplitude), 0.02);
  }
}

TEST(RigidBodyPhysics, AMassOnASpringSwingsWithItsPeriod) {
  const std::string name = "rigid body on a slider's spring";
  Curves curves(name, "stiffness [N/m] (log)", "period [s] (log)");
  const double mass = 2;
  for (const double k : {20.0, 200.0, 2000.0}) {
    World world({.gravity = {}, .threads = 1});
    const ObjectId body = world.add_rigid_body(Sphere{.radius = 0.1f}, {}, {.given_mass = {.mass = mass}});
    world.add_joint({}, body, joint::Slider{.translation = {.spring = joint::Spring{.compliance = 1 / k}}});
    world.set_body_velocity(body, {1, 0, 0}, {});
    SignChanges passes;
    passes.before = 1;
    for (int i = 1; i <= 600; ++i) {
      world.step(frame);
      passes.see(i * frame, world.rigid_body(body).pose.translation.x);
    }
    const double expected = 2 * pi * std::sqrt(mass / k), period = 2 * passes.interval();
    curves.add("theory, 2 pi sqrt(m / k)", k, expected), curves.add("simulation", k, period);
    validate_relative(name, detail::number(k) + " N/m: period [s]", period, expected, 0.02);
  }
}

/// By how much a hanging chain of 100 hinged links of 0.05 m is longer than its links, relative, in 1 s of swinging.
double stretch_of_a_chain(double load) {
  World world({.threads = 1});
  constexpr int links = 100;
  const double half = 0.025;
  JointSide before{};
  for (int i = 0; i < links; ++i) {
    const ObjectId link = world.add_rigid_body(
        Box{.half_extents = {static_cast<float>(half), 0.01f, 0.01f}}, {},
        {.transform = {.translation = {(2 * i + 1) * half, 0, 0}}, .given_mass = {.mass = 0.01}});
    world.add_joint(before, link, joint::Hinge{}, {.point = {2 * i * half, 0, 0}, .axis = {0, 0, 1}});
    before = link;
  }
  const double end = 2 * links * half;
  const ObjectId ball = world.add_rigid_body(
      Sphere{.radius = 0.1f}, {},
      {.transform = {.translation = {end, -0.1, 0}}, .given_mass = {.mass = 0.01 * load}});
  world.add_joint(before, ball, joint::Ball{}, {.point = {end, 0, 0}});
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame);
    double gaps = 0;
    for (const JointId joint : world.joints()) gaps += world.joint_report(joint).distance_error;
    worst = std::max(worst, gaps / end);
  }
  return worst;
}

TEST(RigidBodyPhysics, AChainOfHingesCarriesAHeavyBall) {
  const std::string name = "swinging chain of 100 hinges with a ball at its end";
  Curves curves(name, "mass of the ball over that of a link (log)", "sum of the gaps over the length (log)");
  for (const double load : {1.0, 10.0, 100.0, 1000.0}) {
    const double stretch = stretch_of_a_chain(load);
    curves.add("simulation", load, stretch), curves.add("bound", load, 0.01);
    validate_below(name, detail::number(load) + " times a link's mass: gaps over length", stretch, 0.01);
  }
}

TEST(RigidBodyPhysics, AtwoodsMachineAcceleratesAsItsMassesSay) {
  const std::string name = "Atwood's machine";
  Curves curves(name, "mass of b over mass of a", "acceleration of b [m/s^2]");
  const auto theory = [](double r) { return g * (r - 1) / (r + 1); };
  for (double r = 1; r <= 10; r += 0.1) curves.add("theory, g (b - a) / (a + b)", r, theory(r));
  for (const double ratio : {1.5, 2.0, 4.0, 10.0}) {
    World world({.threads = 1});
    const auto weight = [&](double x, double mass) {
      return world.add_rigid_body(Sphere{.radius = 0.05f}, {},
                                  {.transform = {.translation = {x, 0, 0}}, .given_mass = {.mass = mass}});
    };
    const ObjectId a = weight(-0.5, 1), b = weight(0.5, ratio);
    world.add_joint(a, b, joint::Pulley{.wheel_a = {-0.5, 20, 0}, .wheel_b = {0.5, 20, 0}, .length = 40},
                    {.point = {-0.5, 0, 0}, .point_b = Vec3d{0.5, 0, 0}});
    for (int i = 0; i < 60; ++i) world.step(frame);
    const double measured = -world.rigid_body(b).velocity.y;
    curves.add("simulation", ratio, measured);
    validate_relative(name, "masses 1 to " + detail::number(ratio) + ": speed after 1 s [m/s]", measured,
                      theory(ratio), 0.02);
  }
}

}  // namespace souple::test_physics_rigid_bodies
