#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

namespace souple::test_world_step {

TEST(Step, RefusesATimeThatIsNone) {
  World world;
  world.add_cloth(grid(3, 3, 1));
  const std::uint64_t before = world.hash();
  for (const double dt : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(world.step(dt).message.find("dt"), std::string::npos);
    EXPECT_EQ(world.report().outcome, StepOutcome::refused);
    EXPECT_FALSE(world.report().ok());
    EXPECT_EQ(world.hash(), before);
  }
}

// A loop `while (world.step(dt).ok())` ends, and the report says why.
TEST(Step, IsRefusedByASolverThatCannotTakeTheScene) {
  World world({.solver = {.kind = SolverKind::dense}});
  world.add_cloth(grid(30, 30, 1));
  expect_error([&] { world.prepare(); }, {"the solver dense takes at most"});
  std::string logged;
  world.set_log([&](LogLevel level, std::string_view words) {
    if (level == LogLevel::error) logged = words;
  });
  const StepReport& report = world.step(0.01);
  EXPECT_EQ(report.outcome, StepOutcome::refused);
  EXPECT_NE(report.message.find("the solver dense takes at most"), std::string::npos) << report.message;
  EXPECT_EQ(logged, report.message);
  EXPECT_EQ(world.time(), 0);
  world.set_settings({});
  world.prepare();
  EXPECT_EQ(world.step(0.01).outcome, StepOutcome::done);
  EXPECT_TRUE(world.report().ok());
  EXPECT_EQ(world.time(), 0.01);
}

TEST(Step, ThatAnExceptionPassesIsAbandoned) {
  World world;
  world.add_cloth(grid(3, 3, 1));
  world.before(Stage::solve, [](World&) { throw std::bad_alloc(); });
  EXPECT_THROW(world.step(0.01), std::bad_alloc);
  EXPECT_EQ(world.report().outcome, StepOutcome::abandoned);
  EXPECT_FALSE(world.report().ok());
  EXPECT_NE(world.report().message.find("restore a snapshot"), std::string::npos);
}

TEST(Step, OfAWorldThatWasMovedFromIsRefused) {
  World world;
  const World other = std::move(world);
  EXPECT_EQ(world.step(0.01).outcome, StepOutcome::refused);  // NOLINT(bugprone-use-after-move)
}

// A small number is printed as it is, not as 0.000000.
TEST(Step, MessagesPrintSmallNumbers) {
  World world;
  EXPECT_NE(world.step(-1e-9).message.find("dt is -1e-09 s"), std::string::npos);
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  world.pin(cloth, vertices({0}));
  expect_error([&] { world.add_tethers(cloth, -1e-9f); }, {"slack is -1e-09, expected"});
  expect_error([] { World({.drag = -1e-9f}); }, {"drag is -1e-09, expected"});
}

TEST(Step, TheReportCounts) {
  World world({.substeps = 7, .iterations = 3, .mode = Mode::xpbd});
  const ObjectId cloth = world.add_cloth(grid(5, 4, 1));
  world.pin(cloth, vertices({0}));
  const StepReport& report = world.step(1.0 / 60);
  EXPECT_EQ(report.step, 1u);
  EXPECT_EQ(report.substeps, 7);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_EQ(report.particles, 20u);
  ASSERT_EQ(report.kinds.size(), 2u);
  EXPECT_EQ(report.kinds[0].kind, "distance");
  EXPECT_EQ(report.kinds[0].count, 4u * 4 + 3u * 5 + 3u * 4);  // rows, columns, one diagonal per square
  EXPECT_EQ(report.kinds[1].kind, "isometric_bending");
  EXPECT_GT(report.total_milliseconds(), 0);
  EXPECT_NEAR(report.time, 1.0 / 60, 1e-12);
}

// An edge of a soft material is 30 % too long: substeps would change nothing, and the message names the stiffness.
TEST(Step, LargeStrainIsFlagged) {
  World world({.gravity = {}});
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1), {.membrane_stiffness = 1e-3f});
  std::vector<Vec3f> x(world.positions(cloth).begin(), world.positions(cloth).end());
  for (Vec3f& p : x) p = p * 1.3f;
  world.set_positions(cloth, x);
  const StepReport& report = world.step(1e-3);
  EXPECT_TRUE(report.has(Flag::large_strain));
  EXPECT_NEAR(report.largest_strain, 0.3, 0.01);
  EXPECT_NE(report.message.find("raise the stiffness"), std::string::npos) << report.message;
}

// Where the solver leaves the stretch, a hundredfold stiffness changes nothing, and the message names substeps.
TEST(Step, LargeStrainThatTheSolverLeavesIsFlagged) {
  double strain[2];
  for (const int k : {0, 1}) {
    World world({.substeps = 1, .solver = {.kind = SolverKind::gauss_seidel}});
    ClothMaterial material = material::cotton;
    material.membrane_stiffness *= k == 0 ? 1.0f : 100.0f;
    const ObjectId cloth = world.add_cloth(grid(40, 40, 1), material);
    world.pin(cloth, vertices({0, 39}));
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    const StepReport& report = world.report();
    ASSERT_TRUE(report.has(Flag::large_strain));
    EXPECT_NE(report.message.find("raise substeps; a higher stiffness"), std::string::npos) << report.message;
    strain[k] = report.largest_strain;
  }
  EXPECT_NEAR(strain[1] / strain[0], 1, 0.1);
}

// A sheet that falls in still air reaches its terminal speed: 1/2 rho c v^2 A = m g.
TEST(Step, StillAirResistsAFlatSheet) {
  World world;
  const ClothMaterial paper{.areal_density = 0.1f, .air_drag = 1, .air_lift = 0};
  const ObjectId sheet = world.add_cloth(grid(5, 5, 1), paper);
  for (int i = 0; i < 600; ++i) world.step(1.0 / 60);
  const double terminal = std::sqrt(2 * 0.1 * 9.81 / 1.225);
  EXPECT_NEAR(-world.velocities(sheet)[12].y, terminal, 0.01 * terminal);
}

TEST(Step, StillAirIsTheLimitOfAFaintWind) {
  std::vector<Vec3f> at[2];
  for (const int k : {0, 1}) {
    World world({.wind = {.velocity = {0, k == 0 ? 0.0f : 1e-6f, 0}}});
    const ObjectId sheet = world.add_cloth(grid(11, 11, 1));
    for (int i = 0; i < 180; ++i) world.step(1.0 / 60);
    at[k].assign(world.positions(sheet).begin(), world.positions(sheet).end());
  }
  for (std::size_t i = 0; i < at[0].size(); ++i) EXPECT_LT(length(at[1][i] - at[0][i]), 1e-4f) << i;
}

// Air acts on triangles of cloth: where it is missing, and on ropes, grains and rigid bodies, all fall as in a vacuum.
TEST(Step, AirResistsClothAndNothingElse) {
  for (const float density : {0.0f, 1.225f}) {
    World world({.wind = {.air_density = density}});
    const ObjectId sheet = world.add_cloth(grid(5, 5, 1));
    const ObjectId rope = world.add_rope(std::vector<Vec3d>{{3, 0, 0}, {4, 0, 0}}, 8);
    const ObjectId ball = world.add_rigid_body(Sphere{}, {}, at(6, 0, 0));
    const ObjectId grain = world.add_grains(std::vector<Vec3d>{{9, 0, 0}}, {.radius = 0.1f});
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    for (const ObjectId id : {rope, ball, grain}) EXPECT_NEAR(world.velocities(id)[0].y, -9.81, 1e-3);
    EXPECT_EQ(density == 0, std::abs(world.velocities(sheet)[0].y + 9.81f) < 1e-3f);
  }
}

// Air and pressure stay finite, and push nothing away, where a substep moves a surface by a hundred times its size.
TEST(Step, ABalloonOfAnySpeedIsStoppedByTheAir) {
  for (const float speed : {1e4f, 1e5f, 1e6f}) {
    World world({.substeps = 30, .gravity = {}, .threads = 1});
    ObjectOptions options;
    options.velocity = {speed, 0.1f * speed, 0};
    const ObjectId balloon =
        world.add_cloth(sphere(2, 0.3), {.areal_density = 0.25f, .membrane_stiffness = 600}, options);
    world.set_pressure(balloon, 40);
    const double energy = world.kinetic_energy(balloon);
    for (int frame = 0; frame < 10; ++frame) {
      EXPECT_TRUE(world.step(1.0 / 60).ok()) << speed << " m/s, frame " << frame;
      EXPECT_LT(world.kinetic_energy(balloon), energy) << speed << " m/s, frame " << frame;
    }
  }
}

TEST(Step, GustsComeFromTheSeed) {
  const auto blow = [](std::uint64_t seed) {
    World world({.wind = {.velocity = {5, 0, 0}, .gust = 0.8f}, .seed = seed});
    world.add_cloth(grid(5, 5, 1));
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    return world.hash();
  };
  EXPECT_EQ(blow(1), blow(1));
  EXPECT_NE(blow(1), blow(2));
}

// Damping of all but rigid motion (Müller et al. 2007, section 3.5): a spinning, moving body keeps both
// momenta.
TEST(Step, DampingKeepsRigidMotion) {
  World world({.gravity = {}});
  const ObjectId body =
      world.add_soft_body(tet_bar(3, 3, 3, {0.3, 0.3, 0.3}), {.young_modulus = 1e5f, .damping = 20},
                          {.velocity = {1, 0, 0}, .angular_velocity = {0, 0, 1}});
  const double spin_before = world.velocities(body)[0].y;
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  EXPECT_NEAR(world.momentum(body).x, world.total_mass(body), 1e-3 * world.total_mass(body));
  EXPECT_NEAR(world.center_of_mass(body).x, 1, 1e-3);
  double L = 0, L0 = 0;  // about the center, axis z
  const Vec3d c = world.center_of_mass(body);
  const auto x = world.positions(body), v = world.velocities(body);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3d r = Vec3d(x[i]) - c, w = Vec3d(v[i]) - Vec3d{1, 0, 0};
    L += r.x * w.y - r.y * w.x;
    L0 += r.x * r.x + r.y * r.y;
  }
  EXPECT_NEAR(L / L0, 1, 0.02);
  EXPECT_LT(spin_before, 0);
}

// The embedded surface, not its lattice, rests on the floor. Between the few nodes that support it a round
// surface penetrates by about cell^2 / (4 r), 3 mm here.
TEST(Step, ASoftBodyRestsOnItsSurface) {
  World world({.substeps = 20, .drag = 2});
  const ObjectId ball = world.add_soft_body(sphere(3, 0.2), {.young_modulus = 5e5f, .density = 300},
                                            {.cell_size = 0.05}, at(0, 0.25, 0));
  world.add_collider(Plane{});
  for (int i = 0; i < 90; ++i) world.step(1.0 / 60);
  float lowest = 1;
  for (const Vec3f& x : world.positions(ball)) lowest = std::min(lowest, x.y);
  EXPECT_GT(lowest, -0.012);
  EXPECT_LT(lowest, 0.003);
}

/// Advances by one substep of `settings`, like a viewer: a step of dt / substeps with one substep.
void advance_one_substep(World& world, double dt) {
  const Settings settings = world.settings();
  Settings one = settings;
  one.substeps = 1;
  world.set_settings(one);
  world.step(dt / settings.substeps);
  world.set_settings(settings);
}

double largest_difference(const World& a, const World& b) {
  double largest = 0;
  for (const ObjectId object : a.objects())
    for (std::size_t i = 0; i < a.positions(object).size(); ++i)
      largest = std::max(largest, length(Vec3d(a.positions(object)[i]) - Vec3d(b.positions(object)[i])));
  return largest;
}

/// Without contacts a step does not depend on its division. Ten steps of one substep equal one step of ten bitwise,
/// including pins and attachments with targets.
TEST(Substeps, OneByOneEqualAStepToTheBit) {
  const auto build = [] {
    World world({.wind = {.velocity = {1, 0, 0}, .gust = 0.5f}});
    const ObjectId cloth = world.add_cloth(grid(12, 12, 1));
    world.pin(cloth, vertices({0}), [](std::uint32_t, double t) { return Vec3d(-0.5, std::sin(t), -0.5); });
    world.attach(cloth, vertices({143}), {}, 1e-3f);
    world.add_soft_body(sphere(2, 0.2), {}, {.cells = 60}, at(3, 0, 0));
    return world;
  };
  World whole = build(), cut = build();
  for (int frame = 0; frame < 30; ++frame) {
    whole.step(1.0 / 60);
    for (int i = 0; i < 10; ++i) advance_one_substep(cut, 1.0 / 60);
    EXPECT_EQ(cut.settings().substeps, 10);
  }
  EXPECT_EQ(largest_difference(whole, cut), 0);
  EXPECT_NEAR(whole.time(), cut.time(), 1e-12);
}

/// With contacts the same holds unless the broad phase, which then runs ten times instead of once, finds
/// other candidates.
TEST(Substeps, OneByOneAreCloseWithContacts) {
  const auto build = [] {
    World world;
    world.add_cloth(grid(12, 12, 1), {}, at(0, 0.6, 0));
    world.add_collider(Sphere{.radius = 0.4f});
    world.add_collider(Plane{.offset = -0.4f});
    return world;
  };
  World whole = build(), cut = build();
  for (int frame = 0; frame < 30; ++frame) {
    whole.step(1.0 / 60);
    for (int i = 0; i < 10; ++i) advance_one_substep(cut, 1.0 / 60);
  }
  EXPECT_GT(whole.report().contacts, 10u);
  EXPECT_LT(largest_difference(whole, cut), 1e-4);
}

World everything() {
  World world({.wind = {.velocity = {3, 0, 0}, .gust = 0.5f}});
  const ObjectId cloth = world.add_cloth(grid(9, 9, 1), {}, at(0, 1, 0));
  world.pin(cloth, vertices({0, 8}));
  world.add_soft_body(sphere(2, 0.2), {}, {.cells = 200}, at(0, 0.5, 0));
  std::vector<Vec3d> grains;
  grains.reserve(60);
  for (int i = 0; i < 60; ++i) {
    const int layer = i / 4;
    grains.push_back({0.3 + 0.03 * (i % 4), 0.03 * layer, 0.03 * (i % 3)});
  }
  world.add_grains(grains, {}, {.velocity = {1, 0, 0}});
  world.add_collider(Plane{});
  return world;
}

TEST(Snapshot, ContinuesBitwiseTheSame) {
  World a = everything(), b = everything();
  for (int i = 0; i < 60; ++i) a.step(1.0 / 60);
  ASSERT_GT(a.report().contacts, 20u) << "the heap has to touch, or friction is not tested";
  const Snapshot snapshot = a.snapshot();
  b.restore(snapshot);
  const auto spin_a = a.angular_velocities(a.objects()[2]), spin_b = b.angular_velocities(b.objects()[2]);
  ASSERT_EQ(spin_a.size(), 60u);
  EXPECT_TRUE(std::equal(spin_a.begin(), spin_a.end(), spin_b.begin()));
  EXPECT_TRUE(std::any_of(spin_a.begin(), spin_a.end(), [](const Vec3f& w) { return length(w) > 0; }));
  for (int i = 0; i < 20; ++i) {
    a.step(1.0 / 60);
    b.step(1.0 / 60);
    ASSERT_EQ(a.hash(), b.hash()) << "step " << i;
  }
  a.restore(snapshot);
  for (int i = 0; i < 20; ++i) a.step(1.0 / 60);
  EXPECT_EQ(a.hash(), b.hash()) << "rolled back";
}

TEST(Snapshot, ADamagedOrForeignOneChangesNothing) {
  World world = everything();
  world.step(1.0 / 60);
  const std::uint64_t before = world.hash();
  Snapshot damaged = world.snapshot();
  damaged.bytes[damaged.bytes.size() / 2] ^= std::byte{1};
  expect_error([&] { world.restore(damaged); }, {"damaged"});
  damaged.bytes.resize(10);
  expect_error([&] { world.restore(damaged); }, {"cut short"});
  World other;
  other.add_cloth(grid(3, 3, 1));
  expect_error([&] { world.restore(other.snapshot()); }, {"other objects"});
  EXPECT_EQ(world.hash(), before);
}

}  // namespace souple::test_world_step
