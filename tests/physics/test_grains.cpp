#include "tests/physics/collision_cases.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace souple::test_physics_grains {

constexpr double g = 9.81f;

struct Slide {
  double traveled = 0;      // m in 2 s
  double acceleration = 0;  // m/s^2, over the second second
};

// A grain released on a plane inclined by `angle`.
Slide slide(double angle, double mu, const Settings& settings, Curves* curves = nullptr,
            const std::string& series = {}) {
  World world(settings);
  const auto sine = static_cast<float>(std::sin(angle)), cosine = static_cast<float>(std::cos(angle));
  world.add_collider(Plane{.normal = {sine, cosine, 0}}, {.friction = static_cast<float>(mu)});
  GrainsMaterial stone = grain_of_mass(1, 0.05f);
  stone.friction = static_cast<float>(mu);
  stone.rolling_friction = 10;  // slides and does not roll: see test_rolling.cpp
  const Vec3d start[] = {{0.05 * static_cast<double>(sine), 0.05 * static_cast<double>(cosine), 0}};
  const ObjectId body = world.add_grains(start, stone);
  const Vec3d down{static_cast<double>(cosine), -static_cast<double>(sine), 0};
  double speed_at_one = 0;
  for (int frame = 1; frame <= 120; ++frame) {
    EXPECT_TRUE(world.step(1.0 / 60).ok());
    if (frame == 60) speed_at_one = dot(world.momentum(body), down);
    if (curves != nullptr)
      curves->add(series, frame / 60.0, dot(world.center_of_mass(body) - start[0], down));
  }
  const double mass = world.total_mass(body);
  return {dot(world.center_of_mass(body) - start[0], down),
          (dot(world.momentum(body), down) - speed_at_one) / mass};
}

TEST(InclinedPlane, SticksBelowTheFrictionAngleAndSlidesAbove) {
  const std::string name = "inclined plane";
  Curves curves(name, "time [s]", "way down the slope [m]");
  for (const double mu : {0.2, 0.5, 1.0}) {
    const double steep = std::atan(1.2 * mu), steeper = std::atan(2 * mu), gentle = std::atan(0.95 * mu);
    for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd}) {
      const Settings settings{.substeps = 10, .iterations = mode == Mode::small_steps ? 1 : 4, .mode = mode};
      const bool drawn = mode == Mode::small_steps && mu == 0.5;
      const std::string at = "mu = " + detail::number(mu) + ", " + mode_name(mode) + ": ";
      const Slide stuck = slide(gentle, mu, settings, drawn ? &curves : nullptr, "tan = 0.95 mu");
      validate_below(name, at + "creep at tan = 0.95 mu in 2 s [m]", std::fabs(stuck.traveled), 1e-3);
      for (const double angle : {steep, steeper}) {
        const double expected = g * (std::sin(angle) - mu * std::cos(angle));
        const std::string slope = angle == steep ? "tan = 1.2 mu" : "tan = 2 mu";
        const Slide slides = slide(angle, mu, settings, drawn ? &curves : nullptr, slope);
        validate_relative(name, at + "acceleration at " + slope + " [m/s^2]", slides.acceleration, expected,
                          0.02);
        if (drawn)
          for (int k = 0; k <= 40; ++k) curves.add("theory: " + slope, k / 20.0, expected / 2 * k * k / 400);
      }
    }
  }
}

// A grain dropped from 1 m: height of its first bounce over the height of the drop.
double bounce(double e, const Settings& settings, Curves* curves = nullptr, const std::string& series = {}) {
  World world(settings);
  world.add_collider(Plane{}, {.restitution = static_cast<float>(e)});
  const ObjectId ball = world.add_grains(std::vector<Vec3d>{{0, 1.05, 0}}, grain_of_mass(1, 0.05f));
  double top = 0;
  for (int frame = 1; frame <= 120; ++frame) {
    EXPECT_TRUE(world.step(1.0 / 60).ok());
    const double y = world.center_of_mass(ball).y - 0.05;
    const double v = world.momentum(ball).y / world.total_mass(ball);
    if (curves != nullptr) curves->add(series, frame / 60.0, y);
    // The frames miss the apex: from its current position the ball still rises by v^2 / 2g.
    if (v > 0) top = std::max(top, y + v * v / (2 * g));
  }
  return top;
}

TEST(Bounce, HeightIsTheSquareOfTheRestitution) {
  const std::string name = "bounce, 1 m drop, 20 substeps";
  Curves curves(name, "time [s]", "height [m]");
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const double e : {0.0, 0.5, 0.9}) {
      const Settings settings{.substeps = 20, .iterations = mode == Mode::small_steps ? 1 : 4, .mode = mode};
      const bool drawn = mode == Mode::small_steps;
      const std::string series = e == 0.0 ? "e = 0" : e == 0.5 ? "e = 0.5" : "e = 0.9";
      const double ratio = bounce(e, settings, drawn ? &curves : nullptr, series);
      const std::string quantity = series + ", " + mode_name(mode) + ": height ratio";
      if (e > 0) validate_relative(name, quantity, ratio, e * e, 0.02);
      if (e == 0) validate_below(name, quantity, ratio, 0.01);
      if (!drawn || e == 0) continue;
      const double fallen = std::sqrt(2 / g), up = e * g * fallen;  // s, m/s
      for (int i = 0; i <= 50; ++i) {
        const double t = 2 * up / g * i / 50;
        curves.add("theory: first bounce", fallen + t, up * t - g / 2 * t * t);
      }
      curves.lift("theory: first bounce");
    }
}

// Grains are solid balls that rotate: I = 2/5 m r^2. Friction acts at the point of contact, and rolling friction is a
// moment of at most mu_r r N.

constexpr double radius = 0.05;

struct Surface {
  const char* name;
  void (*add)(World&, float mu);
};
const Surface surfaces[] = {
    {"plane", [](World& world, float mu) { world.add_collider(Plane{}, {.friction = mu}); }},
    {"box",
     [](World& world, float mu) {
       world.add_collider(Box{.center = {0, -1, 0}, .half_extents = {20, 1, 1}}, {.friction = mu});
     }},
    {"mesh", [](World& world,
                float mu) { world.add_obstacle(grid(41, 5, 20), {.thickness = 1e-4f, .friction = mu}); }},
};

struct Motion {
  double speed, surface_speed;  // of the center and, by rotation, of the surface [m/s]
};

// Speeds after 1 s. Rolling: m a = m g sin - F, 2/5 m r alpha = F - mu_r N, a = r alpha; it slides if F > mu N.
Motion theory(double tangent, double mu, double mu_r, double normal) {
  if (tangent <= std::min(mu, mu_r)) return {0, 0};
  if (mu_r < tangent && (2 * tangent + 5 * mu_r) / 7 <= mu) {
    const double speed = 5.0 / 7 * (tangent - mu_r) * normal;
    return {speed, speed};
  }
  return {(tangent - mu) * normal, std::max(0.0, 2.5 * (mu - mu_r) * normal)};
}

Motion roll(const Surface& surface, const Settings& settings, double slope, float mu, float mu_r) {
  Settings sloped = settings;
  sloped.gravity = {float(g * std::sin(slope)), float(-g * std::cos(slope)), 0};
  World world(sloped);
  surface.add(world, mu);
  const ObjectId ball = world.add_grains(std::vector<Vec3d>{{0.33, radius, 0.01}},
                                         {.radius = float(radius), .friction = mu, .rolling_friction = mu_r});
  EXPECT_TRUE(run(world, 60, 1.0 / 60));
  return {double(world.velocities(ball)[0].x), -double(world.angular_velocities(ball)[0].z) * radius};
}

TEST(Rolling, BallRollsSlidesOrStaysOnASlope) {
  const std::string name = "ball on a slope";
  for (const Surface& surface : surfaces)
    for (const double degrees : {10.0, 30.0, 50.0})
      for (const float mu : {0.2f, 0.5f})
        for (const float mu_r : {0.0f, 0.05f, 0.3f, 5.0f}) {
          const double slope = degrees * pi / 180, normal = g * std::cos(slope);
          const Motion expected = theory(std::tan(slope), double(mu), double(mu_r), normal);
          const Motion found = roll(surface, {}, slope, mu, mu_r);
          const std::string what = std::string(surface.name) + ", " + detail::number(degrees) +
                                   " degrees, mu " + detail::number(double(mu)) + ", mu_r " +
                                   detail::number(double(mu_r));
          EXPECT_NEAR(found.speed, expected.speed, 0.02 * expected.speed + 2e-3) << what;
          EXPECT_NEAR(found.surface_speed, expected.surface_speed, 0.02 * expected.surface_speed + 2e-3)
              << what;
          if (surface.name != std::string("plane") || mu < 0.5f || mu_r > 0.1f) continue;
          validate_relative(name,
                            detail::number(degrees) + " degrees, rolling friction " +
                                detail::number(double(mu_r)) + ": speed after 1 s [m/s]",
                            found.speed, expected.speed, 0.02);
        }
}

// Without rolling friction it would roll on for ever. From rolling at v it stops after 7/10 v^2 / (mu_r g).
TEST(Rolling, FrictionStopsABall) {
  const std::string name = "ball stopped by rolling friction";
  for (const Surface& surface : surfaces)
    for (const float mu_r : {0.05f, 0.2f}) {
      World world;
      surface.add(world, 0.8f);
      const Vec3d start[] = {{0.33, radius, 0.01}};
      const ObjectId ball =
          world.add_grains(start, {.radius = float(radius), .friction = 0.8f, .rolling_friction = mu_r},
                           {.velocity = {2, 0, 0}});
      world.set_angular_velocities(ball, std::vector<Vec3f>{{0, 0, float(-2 / radius)}});
      EXPECT_TRUE(run(world, 600, 1.0 / 60));
      validate_relative(
          name,
          std::string(surface.name) + ", rolling friction " + detail::number(double(mu_r)) + ": way [m]",
          double(world.positions(ball)[0].x) - start[0].x, 0.7 * 4 / (double(mu_r) * g), 0.02);
      EXPECT_LT(length(world.velocities(ball)[0]), 1e-4f);
      EXPECT_LT(length(world.angular_velocities(ball)[0]), 1e-3f);
    }
}

Vec3d angular_momentum(const World& world, ObjectId grains, double r) {
  Vec3d sum;
  const auto x = world.positions(grains), v = world.velocities(grains),
             spin = world.angular_velocities(grains);
  const double mass = world.total_mass(grains) / double(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += (cross(Vec3d(x[i]), Vec3d(v[i])) + Vec3d(spin[i]) * (0.4 * r * r)) * mass;
  return sum;
}

// Two balls that spin and hit each other off center in free space. A contact conserves angular momentum up to the
// motion of one substep, so the error falls with the length of substeps.
TEST(Rolling, GrazingBallsKeepMomentumAndAngularMomentum) {
  const std::string name = "two spinning balls that graze";
  for (const double other_radius : {radius, 0.4 * radius})
    for (const float mu_r : {0.0f, 0.3f})
      for (const int substeps : {10, 100}) {
        World world({.substeps = substeps, .gravity = {}});
        GrainsMaterial material{.friction = 0.4f, .rolling_friction = mu_r, .restitution = 0.5f};
        const auto add = [&](double r, const Vec3d& at, const Vec3f& velocity, const Vec3f& spin) {
          material.radius = float(r);
          const ObjectId ball = world.add_grains({&at, 1}, material, {.velocity = velocity});
          world.set_angular_velocities(ball, {&spin, 1});
          return ball;
        };
        const ObjectId one = add(radius, {-0.2, 0.4 * (radius + other_radius), 0}, {1, 0, 0}, {5, 20, 30});
        const ObjectId other = add(other_radius, {0.2, 0, 0.01}, {-1, 0.1f, 0}, {-10, 4, 25});
        const auto momentum = [&] { return world.momentum(one) + world.momentum(other); };
        const auto angular = [&] {
          return angular_momentum(world, one, radius) + angular_momentum(world, other, other_radius);
        };
        const auto energy = [&] { return world.kinetic_energy(one) + world.kinetic_energy(other); };
        const Vec3d momentum_before = momentum(), angular_before = angular();
        const double energy_before = energy(), mass = world.total_mass(other);
        EXPECT_TRUE(run(world, 30, 1.0 / 60));
        EXPECT_GT(length(world.angular_velocities(other)[0] - Vec3f{-10, 4, 25}), 2.f) << "they touched";
        EXPECT_LT(energy(), energy_before);
        EXPECT_LT(length(momentum() - momentum_before), 1e-5 * mass);
        validate_below(name,
                       "radii 1 : " + detail::number(other_radius / radius) + ", " +
                           detail::number(substeps) + " substeps, rolling friction " +
                           detail::number(double(mu_r)) + ": change of angular momentum over m r v",
                       length(angular() - angular_before) / (mass * (radius + other_radius)), 0.2 / substeps);
      }
}

// Rolling friction also resists spinning about the normal, relative to the collider: a turntable carries a ball at its
// center with it.
TEST(Rolling, TurntableTurnsABall) {
  World world;
  const auto turning = [](double t) { return Transform{.rotation = Quatd::from_euler_xyz({0, 3 * t, 0})}; };
  world.add_collider(Box{.center = {0, -1, 0}, .half_extents = {1, 1, 1}},
                     {.friction = 1, .motion = ColliderMotion::callback(turning)});
  const Vec3d start[] = {{0, radius, 0}};
  const ObjectId ball = world.add_grains(start, {.radius = float(radius), .rolling_friction = 0.2f});
  EXPECT_TRUE(run(world, 60, 1.0 / 60));
  EXPECT_LT(length(world.angular_velocities(ball)[0] - Vec3f{0, 3, 0}), 0.01f);
  EXPECT_LT(length(world.velocities(ball)[0]), 1e-3f);
}

// Not a step of a free ball changes its spin.
TEST(Rolling, FreeSpinKeepsItsBits) {
  World world({.gravity = {}});
  const ObjectId ball = world.add_grains(std::vector<Vec3d>{{0, 0, 0}}, {.radius = 0.0371f});
  const Vec3f spin[] = {{1.234f, -17.3f, 0.01f}};
  world.set_angular_velocities(ball, spin);
  EXPECT_TRUE(run(world, 100, 1.0 / 60));
  EXPECT_EQ(world.angular_velocities(ball)[0], spin[0]);
}

// The plate of Zhou, Xu, Yu and Zulli 2002, "An experimental and numerical study of the angle of repose of coarse
// spheres" (Powder Technology 125). Spheres fill a box 20 diameters thick, and its side walls vanish. Spheres beyond
// the plate fall off, and the rest is a heap between front and rear wall. Their fit has lengths in mm and equal
// friction of grains and walls. mu_s is the coefficient of sliding; the moment arm of rolling friction is mu_r r:
//   angle = 68.61 mu_s^(0.27 + 0.22) (mu_r r)^(0.06 + 0.12) d^-0.2 degrees
constexpr double diameter = 0.01;

double angle_of_zhou(double mu, double mu_r) {
  const double mm = 1000;
  return 68.61 * std::pow(mu, 0.49) * std::pow(mu_r * diameter / 2 * mm, 0.18) *
         std::pow(diameter * mm, -0.2);
}

struct Repose {
  double mu, mu_r;
  int layers, substeps;
};

struct Plate {
  static constexpr int half_width = 16, thickness = 20;  // diameters
  World world;
  ObjectId grains;

  explicit Plate(const Repose& repose) : world({.substeps = repose.substeps, .iterations = 2}) {
    constexpr double half = half_width * diameter, front = thickness * diameter / 2;
    const ColliderOptions rough{.friction = float(repose.mu)};
    const auto size = [](double x) { return float(x); };
    world.add_collider(Box{.center = {0, -0.02f, 0}, .half_extents = {size(half), 0.02f, size(front)}},
                       rough);
    world.add_collider(Plane{.normal = {0, 0, 1}, .offset = -size(front)}, rough);
    world.add_collider(Plane{.normal = {0, 0, -1}, .offset = -size(front)}, rough);
    world.add_collider(Plane{.offset = -0.16f}, {.friction = 1});
    const ColliderId sides[] = {
        world.add_collider(Plane{.normal = {1, 0, 0}, .offset = -size(half)}, rough),
        world.add_collider(Plane{.normal = {-1, 0, 0}, .offset = -size(half)}, rough)};
    grains = world.add_grains(lattice(repose.layers), {.radius = float(diameter / 2),
                                                       .density = 2500,
                                                       .friction = float(repose.mu),
                                                       .rolling_friction = float(repose.mu_r)});
    EXPECT_TRUE(run(world, 40, 1.0 / 60));
    for (const ColliderId side : sides) world.remove(side);
    EXPECT_TRUE(run(world, 150, 1.0 / 60));
  }

  // A loose lattice, disturbed so that it becomes a random packing.
  static std::vector<Vec3d> lattice(int layers) {
    constexpr int half_thickness = thickness / 2;
    constexpr double spacing = 1.12 * diameter, half = (half_width - 0.6) * diameter,
                     front = (half_thickness - 0.6) * diameter;
    std::uint32_t state = 1;
    const auto noise = [&] {
      state = state * 1664525u + 1013904223u;
      return 0.1 * diameter * (double(state >> 8) / (1 << 24) - 0.5);
    };
    std::vector<Vec3d> centers;
    for (int y = 0; y < layers; ++y)
      for (double x = -half; x <= half; x += spacing)
        for (double z = -front; z <= front; z += spacing)
          centers.push_back({x + noise(), diameter * 0.6 + y * spacing + noise(), z + noise()});
    return centers;
  }

  // Slope of the line through the tops of columns one diameter wide and a quarter of the thickness deep, without the
  // summit and the foot.
  double angle() const {
    constexpr int columns = half_width, slices = 4, slots = 2 * columns * slices;
    std::vector<double> top(slots, 0.0);
    for (const Vec3f& x : world.positions(grains)) {
      if (x.y < 0 || std::fabs(double(x.x)) >= columns * diameter) continue;
      const int column = int(std::floor(double(x.x) / diameter)) + columns;
      const int slice = std::clamp(int((double(x.z) / (thickness * diameter) + 0.5) * slices), 0, slices - 1);
      double& highest = top[std::size_t(column * slices + slice)];
      highest = std::max(highest, double(x.y) + diameter / 2);
    }
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t k = 0; k < top.size(); ++k) {
      const std::size_t column = k / slices;
      const double x = std::fabs(double(column) + 0.5 - columns) * diameter;
      if (x < 0.2 * columns * diameter || x > 0.85 * columns * diameter) continue;
      n += 1, sx += x, sy += top[k], sxx += x * x, sxy += x * top[k];
    }
    return std::atan((sx * sy - n * sxy) / (n * sxx - sx * sx)) * 180 / pi;
  }
};

void expect_angle_of_repose(const Repose& repose) {
  const std::string name = "angle of repose", rolling = "rolling friction " + detail::number(repose.mu_r);
  Curves curves(name, "coefficient of sliding friction", "angle of repose [degrees]");
  const double angle = Plate(repose).angle();
  validate(name,
           "friction " + detail::number(repose.mu) + ", " + rolling + ", " + std::to_string(repose.substeps) +
               " substeps [degrees]",
           angle, angle_of_zhou(repose.mu, repose.mu_r), 4);
  curves.add(rolling + ", " + std::to_string(repose.substeps) + " substeps", repose.mu, angle);
}

TEST(SandPile, AngleOfRepose) {
  Curves curves("angle of repose", "coefficient of sliding friction", "angle of repose [degrees]");
  for (const double mu_r : {0.1, 0.2})
    for (int k = 3; k <= 14; ++k)
      curves.add("theory: Zhou et al. 2002, rolling friction " + detail::number(mu_r), 0.05 * k,
                 angle_of_zhou(0.05 * k, mu_r));
  expect_angle_of_repose({0.4, 0.2, 13, 10});
}

class AngleOfRepose : public ::testing::TestWithParam<Repose> {};

TEST_P(AngleOfRepose, OfSpheresSlow) {
  expect_angle_of_repose(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Everything, AngleOfRepose,
                         ::testing::Values(Repose{0.2, 0.1, 10, 20}, Repose{0.2, 0.2, 10, 20},
                                           Repose{0.4, 0.1, 12, 20}, Repose{0.6, 0.2, 16, 20}));

// Columns of regular packings fall, whatever the friction: grains that could not roll stood at 80 degrees.
TEST(SandPile, RegularPackingsFall) {
  constexpr double d = 0.02;
  for (const bool hexagonal : {false, true})
    for (const float mu : {0.3f, 0.6f, 1.0f}) {
      World world({.iterations = 2});
      world.add_collider(Plane{}, {.friction = 1});
      std::uint32_t state = 1;
      const auto noise = [&] {
        state = state * 1664525u + 1013904223u;
        return 0.01 * d * (double(state >> 8) / (1 << 24) - 0.5);
      };
      std::vector<Vec3d> centers;
      for (int y = 0; y < 15; ++y)
        for (int x = 0; x < 6; ++x)
          for (int z = 0; z < 6; ++z) {
            const double shift = 0.5 * (z % 2) + 0.5 * (y % 2), third = (y % 2) / 3.0;
            const Vec3d at = hexagonal
                                 ? Vec3d{x + shift, y * std::sqrt(2.0 / 3), (z + third) * std::sqrt(0.75)}
                                 : Vec3d{double(x), double(y), double(z)};
            centers.push_back(Vec3d{at.x - 3, at.y + 0.5, at.z - 3} * d + Vec3d{noise(), 0, noise()});
          }
      const ObjectId grains = world.add_grains(centers, {.radius = float(d / 2), .friction = mu});
      EXPECT_GT(std::atan(test::slope_of_heap(world, grains, d / 2)) * 180 / pi, 79);
      EXPECT_TRUE(run(world, 180, 1.0 / 60));
      validate_below("regular packings of grains fall",
                     std::string(hexagonal ? "hexagonal" : "cubic") + ", friction " +
                         detail::number(double(mu)) + ": slope after 3 s [degrees]",
                     std::atan(test::slope_of_heap(world, grains, d / 2)) * 180 / pi, 20);
    }
}

// Test of the measure: points throughout a cone.
TEST(SandPile, SlopeIsThatOfACone) {
  std::vector<Vec3d> cone;
  for (int x = -40; x <= 40; ++x)
    for (int y = 0; y <= 40; ++y)
      for (int z = -40; z <= 40; ++z)
        if (y + 0.5 <= 0.5 * (40 - std::hypot(x, z))) cone.push_back({0.01 * x, 0.01 * (y + 0.5), 0.01 * z});
  World world;
  const ObjectId grains = world.add_grains(cone, {.radius = 0.001f});
  EXPECT_NEAR(test::slope_of_heap(world, grains, 0), 0.5, 0.02);
}

/// A closed tank that swings along x, 4 times a second, with keyframes as a script computes them: sin(2 pi) is -2e-16.
ColliderMotion swing(double offset) {
  std::vector<PoseKey> keys;
  for (int k = 0; k <= 24; ++k)
    keys.push_back({k / 96.0, {0.1 * std::sin(2 * pi * k / 24) + offset * k, 0, 0}, {}});
  return ColliderMotion::keyframes(std::move(keys), true);
}

// The tank moves on at 2.5 m/s where the loop restarts, by more than a grain in a substep.
TEST(LoopedTank, KeepsItsSand) {
  const Vec3d size{0.3, 0.25, 0.2};
  World world;
  const ObjectId tank = world.add_obstacle(box(size, 1), {}, {.pose = swing(0)});
  const ObjectId sand =
      world.add_grains(fill({-0.14, -0.115, -0.09}, {0.14, 0, 0.09}, 0.02), {.radius = 0.01f});
  for (int frame = 0; frame < 32; ++frame) EXPECT_FALSE(world.step(1.0 / 60).has(Flag::jumped));
  const double shift = world.positions(tank)[0].x + size.x / 2;
  for (const Vec3f& x : world.positions(sand)) {
    EXPECT_LT(std::fabs(x.x - shift), size.x / 2);
    EXPECT_LT(std::fabs(x.y), size.y / 2);
    EXPECT_LT(std::fabs(x.z), size.z / 2);
  }
}

TEST(LoopedTank, AJumpIsTold) {
  World world;
  world.add_obstacle(box({0.3, 0.25, 0.2}, 1), {}, {.pose = swing(1e-3)}, {.name = "tank"});
  world.add_collider(Sphere{}, {.name = "ball", .motion = swing(1e-3)});
  int told = 0;
  for (int frame = 1; frame <= 20; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    if (!report.has(Flag::jumped)) continue;
    ++told;
    EXPECT_NE(report.message.find("tank: a looped motion restarts"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find("ball: a looped motion restarts"), std::string::npos) << report.message;
  }
  EXPECT_EQ(told, 1);
}

}  // namespace souple::test_physics_grains
