#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>
#include <string>

// Grains are solid balls that rotate: I = 2/5 m r^2. Friction acts at the point of contact, and rolling friction is a
// moment of at most mu_r r N.

namespace souple::test_physics_rolling {

constexpr double g = 9.81f, radius = 0.05;

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
  const Vec3d start[] = {{0.33, radius, 0.01}};
  const ObjectId ball =
      world.add_grains(start, {.radius = float(radius), .friction = mu, .rolling_friction = mu_r});
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
      const Vec3f spin[] = {{0, 0, float(-2 / radius)}};
      world.set_angular_velocities(ball, spin);
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
  const Vec3d start[] = {{0, 0, 0}};
  const ObjectId ball = world.add_grains(start, {.radius = 0.0371f});
  const Vec3f spin[] = {{1.234f, -17.3f, 0.01f}};
  world.set_angular_velocities(ball, spin);
  EXPECT_TRUE(run(world, 100, 1.0 / 60));
  EXPECT_EQ(world.angular_velocities(ball)[0], spin[0]);
}

}  // namespace souple::test_physics_rolling
