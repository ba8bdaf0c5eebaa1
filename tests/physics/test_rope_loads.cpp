#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

// Ropes of 1 m that carry up to a thousand times their mass, with default settings: 10 substeps of one iteration.

namespace souple::test_physics_rope_loads {

constexpr double L = 1, E = 1e9, radius = 0.005;

struct Loaded {
  World world;
  ObjectId rope, load;
  std::uint32_t segments;
  double mass;    ///< of the load [kg]
  double theory;  ///< elongation at rest

  double worst_strain() {
    double worst = 0;
    const auto x = world.positions(rope);
    for (std::size_t i = 1; i < x.size(); ++i)
      worst = std::max(worst, static_cast<double>(length(x[i] - x[i - 1])) * segments / L - 1);
    return worst;
  }
  double fastest() {
    float fastest = 0;
    for (const Vec3f& v : world.velocities(rope)) fastest = std::max(fastest, length(v));
    return static_cast<double>(fastest);
  }
  double tip(int axis) { return static_cast<double>(world.positions(rope)[segments][axis]); }
};

/// Hangs at `angle` from the vertical; the load, `ratio` times the rope's mass, is joined to its end. A load without
/// contacts: it is wider than a segment.
Loaded load(Settings settings, std::uint32_t segments, double ratio, double angle = 0, Target top = {}) {
  World world(settings);
  const Vec3d end{L * std::sin(angle), -L * std::cos(angle), 0}, path[] = {{0, 0, 0}, end};
  const ObjectId rope =
      world.add_rope(path, segments, {.radius = static_cast<float>(radius), .young_modulus = E});
  world.pin(rope, vertices({0}), std::move(top));
  const double own = world.total_mass(rope), mass = ratio * own;
  const ObjectId weight = world.add_grains({&end, 1}, grain_of_mass(mass));
  world.set_collision_groups(weight, 0, 0);
  const std::pair<VertexRef, VertexRef> tie[] = {{{rope, segments}, {weight, 0}}};
  world.connect(tie, 0);
  const double theory = (mass + own / 2) * 9.81 / (E * pi * radius * radius);
  return {std::move(world), rope, weight, segments, mass, theory};
}

TEST(RopeLoad, StretchesTheRopeByItsWeightAtAnyMassRatio) {
  const std::string name = "rope of 1 m carrying many times its mass, 10 x 1";
  for (const std::uint32_t segments : {50u, 1000u}) {
    for (const double ratio : {1.0, 100.0, 1000.0}) {
      Loaded rope = load({.drag = 2}, segments, ratio);
      ASSERT_TRUE(run(rope.world, 240, 1.0 / 60));
      validate_relative(name,
                        fmt::format("{} segments, load {:g} times its mass: elongation", segments, ratio),
                        -rope.tip(1) / L - 1, rope.theory, 0.02);
      EXPECT_LT(rope.fastest(), 1e-3);
    }
  }
}

/// Largest distance of the tip from the vertical in the third of the swings that begins after five seconds [m].
struct Swing {
  double amplitude = 0, worst_strain = 0;
};
Swing swing(const Settings& settings, double ratio) {
  Loaded rope = load(settings, 50, ratio, 0.7);
  Swing result;
  for (int frame = 0; frame < 438; ++frame) {
    EXPECT_TRUE(rope.world.step(1.0 / 60).ok());
    if (frame > 288) result.amplitude = std::max(result.amplitude, std::abs(rope.tip(0)));
    result.worst_strain = std::max(result.worst_strain, rope.worst_strain());
  }
  return result;
}

// Released at 40 degrees, it never stretches more than a pendulum's tension 3 m g - 2 m g cos 40 and a jump of the load.
TEST(RopeLoad, SwingsAsLongAsWithTenTimesTheSubsteps) {
  const std::string name = "rope of 50 segments, load swinging for 7.3 s";
  for (const double ratio : {1.0, 1000.0}) {
    const Swing coarse = swing({}, ratio), fine = swing({.substeps = 100}, ratio);
    const std::string of = fmt::format("load {:g} times its mass: ", ratio);
    validate_relative(name, of + "amplitude with 10 substeps, relative to 100",
                      coarse.amplitude / fine.amplitude, 1, 0.01);
    EXPECT_LT(coarse.amplitude, std::sin(0.7) * (1.006 + 0.03 * ratio / 1000));  // converged: 1.0055, 1.007
    EXPECT_LT(coarse.worst_strain, 2.5 * load({}, 50, ratio).theory);
  }
  SolverSettings sweeps;
  sweeps.kind = SolverKind::gauss_seidel;
  validate_relative(name, "load 1 times its mass: amplitude, relative to gauss_seidel with 100 substeps",
                    swing({}, 1).amplitude / swing({.substeps = 100, .solver = sweeps}, 1).amplitude, 1,
                    0.03);
}

// The upper end is moved by half a meter in 50 ms; the load jumps, the rope slackens and is caught.
TEST(RopeLoad, IsJerked) {
  const Target top = [](std::uint32_t, double t) {
    return Vec3d{0.5 * std::clamp((t - 0.5) / 0.05, 0.0, 1.0), 0, 0};
  };
  for (const double ratio : {1.0, 100.0, 1000.0}) {
    Loaded rope = load({}, 50, ratio, 0, top);
    double fastest = 0, worst = 0;
    for (int frame = 0; frame < 300; ++frame) {
      ASSERT_TRUE(rope.world.step(1.0 / 60).ok());
      fastest = std::max(fastest, rope.fastest()), worst = std::max(worst, rope.worst_strain());
    }
    EXPECT_LT(fastest, 15) << ratio;
    EXPECT_LT(worst, 0.3) << ratio;
    EXPECT_LT(rope.worst_strain(), 0.001 + 3 * rope.theory) << ratio;
  }
}

// Crumpled into a random walk and thrown, one end held.
TEST(RopeLoad, IsThrown) {
  Settings settings;
  World world(settings);
  const Vec3d path[] = {{0, 0, 0}, {L, 0, 0}};
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  std::vector<Vec3f> x(51), v(51);
  for (std::size_t i = 0; i <= 50; ++i) {
    const auto s = static_cast<double>(i * i);
    const Vec3f step = normalized(Vec3f(Vec3d{std::sin(s), std::cos(2 * s), std::sin(3 * s + 1)}));
    if (i > 0) x[i] = x[i - 1] + step * 0.02f;
    v[i] = {5, 3, static_cast<float>(i % 7) - 3};
  }
  world.set_positions(rope, x);
  world.set_velocities(rope, v);
  double worst = 0;
  for (int frame = 0; frame < 300; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    const auto now = world.positions(rope);
    for (std::size_t i = 1; i < now.size(); ++i)
      worst = std::max(worst, static_cast<double>(length(now[i] - now[i - 1])) * 50 - 1);
  }
  EXPECT_LT(worst, 0.01);  // Gauss-Seidel with 100 substeps: 1.4 %
}

// A rope over a post, with half of its mass at either end: friction holds it.
TEST(RopeLoad, HangsOverAPost) {
  World world({.gravity = {0, 0, -9.81f}});
  const double R = 0.105, leg = (L - pi * R) / 2;
  std::vector<Vec3d> path{{-R, 0, -leg}};
  for (int i = 0; i <= 24; ++i) path.push_back({-R * std::cos(pi * i / 24), 0, R * std::sin(pi * i / 24)});
  path.push_back({R, 0, -leg});
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.add_collider(Capsule{.radius = 0.1f, .half_height = 1}, {.friction = 0.3f});
  std::vector<std::pair<VertexRef, VertexRef>> ties;
  for (const std::uint32_t end : {0u, 50u}) {
    const Vec3d at[] = {end == 0 ? path.front() : path.back()};
    const ObjectId weight = world.add_grains(at, grain_of_mass(world.total_mass(rope) / 2));
    world.set_collision_groups(weight, 0, 0);
    ties.push_back({{rope, end}, {weight, 0}});
  }
  world.connect(ties, 0);
  ASSERT_TRUE(run(world, 300, 1.0 / 60));
  const auto x = world.positions(rope);
  double worst = 0;
  for (std::size_t i = 1; i < x.size(); ++i)
    worst = std::max(worst, static_cast<double>(length(x[i] - x[i - 1])) * 50 / L - 1);
  EXPECT_LT(worst, 0.005);  // Gauss-Seidel: 12 %
  EXPECT_NEAR(static_cast<double>(x[0].z), -leg, 0.003);
  EXPECT_NEAR(static_cast<double>(x[50].z), -leg, 0.003);
  for (const Vec3f& v : world.velocities(rope)) EXPECT_LT(length(v), 0.005f);
}

// A soft body of a hundred times the rope's mass hangs by one vertex: the tie holds as well as the rope.
TEST(RopeLoad, OfASoftBodyHangsByItsTie) {
  World world;
  const Vec3d path[] = {{0, 0, 0}, {0, -L, 0}};
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  ObjectOptions below;
  below.transform.translation = {0, -L - 0.1, 0};
  const double mass = 100 * world.total_mass(rope);
  const ObjectId box =
      world.add_soft_body(tet_bar(4, 4, 4, {0.2, 0.2, 0.2}),
                          {.young_modulus = 1e6f, .density = static_cast<float>(mass / 0.008)}, below);
  world.set_collision_groups(rope, 0, 0);
  const std::uint32_t top = world.select(box, nearest({0, -1, 0}))[0];
  const std::pair<VertexRef, VertexRef> tie[] = {{{box, top}, {rope, 50}}};
  world.connect(tie, 0);
  ASSERT_TRUE(run(world, 180, 1.0 / 60));
  const Vec3f end = world.positions(rope)[50];
  EXPECT_LT(length(world.positions(box)[top] - end), 1e-3f);  // Gauss-Seidel: 1 cm
  const double theory = (mass + world.total_mass(rope) / 2) * 9.81 / (E * pi * radius * radius);
  EXPECT_NEAR(-static_cast<double>(end.y) / L - 1, theory, 0.1 * theory);
}

}  // namespace souple::test_physics_rope_loads
