#include "souple/collision/mesh_tree.h"
#include "souple/geometry/measures.h"
#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/paths.h"
#include "tests/world/scene.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_robustness {

constexpr double d = 0.02;  // m
constexpr FluidMaterial water{.spacing = 0.02f};

void add_tank(World& world, const Vec3d& size) {
  world.add_collider(Plane{});
  world.add_collider(Plane{{0, -1, 0}, static_cast<float>(-size.y)});
  world.add_collider(Plane{{1, 0, 0}, static_cast<float>(-size.x / 2)});
  world.add_collider(Plane{{-1, 0, 0}, static_cast<float>(-size.x / 2)});
  world.add_collider(Plane{{0, 0, 1}, static_cast<float>(-size.z / 2)});
  world.add_collider(Plane{{0, 0, -1}, static_cast<float>(-size.z / 2)});
}

double farthest_out(const World& world, ObjectId fluid, const Vec3d& size) {
  double out = -1e30;
  for (const Vec3f& x : world.positions(fluid)) {
    const Vec3d at(x);
    out = std::max({out, std::fabs(at.x) - size.x / 2, std::fabs(at.z) - size.z / 2, -at.y, at.y - size.y});
  }
  return out;
}

/// A closed box, half full, shaken along two axes: all particles stay inside.
void shake(int across, int high, int deep, int substeps, double seconds) {
  const Vec3d size{across * d, high * d, deep * d};
  World world({.substeps = substeps});
  add_tank(world, size);
  const ObjectId fluid = world.add_fluid(
      fill(Vec3d{-size.x / 2, 0, -size.z / 2}, Vec3d{size.x / 2, size.y / 2, size.z / 2}, d), water);
  const auto particles = static_cast<std::size_t>(across * high / 2 * deep);
  ASSERT_EQ(world.positions(fluid).size(), particles);
  const int frames = static_cast<int>(seconds * 60);
  double error = 0;
  for (int frame = 0; frame < frames; ++frame) {
    Settings settings = world.settings();
    const double t = frame / 60.0;
    settings.gravity = {static_cast<float>(12 * std::sin(2 * pi * 1.5 * t)), -9.81f,
                        static_cast<float>(12 * std::sin(2 * pi * 2.3 * t))};
    world.set_settings(settings);
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok());
    error += report.fluid.mean_density_error / frames;
    ASSERT_LT(farthest_out(world, fluid, size), 0);
  }
  EXPECT_EQ(world.positions(fluid).size(), particles);
  EXPECT_LT(error, 0.01);
}

TEST(FluidRobustness, AShakenBoxLosesNothing) {
  shake(20, 14, 10, 8, 5);
}

TEST(FluidRobustness, ALargeShakenBoxLosesNothingSlow) {
  shake(30, 36, 28, 10, 20);
}

TEST(FluidRobustness, ThrownAtAHundredMetresASecondItStaysInside) {
  const Vec3d size{60 * d, 40 * d, 24 * d};
  World world({.substeps = 10});
  add_tank(world, size);
  world.add_collider(Box{{0.3f, 0.4f, 0}, {0.005f, 0.4f, 0.3f}});  // thin
  const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.55, 0.2, -0.1}, Vec3d{-0.35, 0.4, 0.1}, d), water,
                                         {.velocity = {100, 0, 0}});
  bool told = false;
  for (int frame = 0; frame < 60; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    told = told || report.has(Flag::coarse_substeps);
    ASSERT_LT(farthest_out(world, fluid, size), 0) << frame;
    for (const Vec3f& x : world.positions(fluid)) ASSERT_TRUE(frame >= 3 || x.x < 0.3f) << frame;
  }
  EXPECT_TRUE(told);
  double fastest = 0;
  for (const Vec3f& v : world.velocities(fluid)) fastest = std::max(fastest, double{length(v)});
  EXPECT_LT(fastest, 20);
}

TEST(FluidRobustness, ItersUntilTheErrorIsSmallEnough) {
  for (const float tolerance : {0.0f, 2e-3f}) {
    World world({.substeps = 4, .fluid = {.tolerance = tolerance}});
    add_tank(world, {0.2, 1, 0.2});
    world.add_fluid(fill(Vec3d{-0.1, 0, -0.1}, Vec3d{0.1, 0.4, 0.1}, d), water);
    for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);
    const FluidReport& report = world.report().fluid;
    EXPECT_EQ(report.mean_density_error <= 2e-3, tolerance > 0) << report.mean_density_error;
    EXPECT_EQ(report.iterations > 1, tolerance > 0);
  }
}

// No walls, no gravity: a sheared cube with a body in it.
TEST(FluidRobustness, KeepsItsMomentum) {
  World world({.substeps = 8, .gravity = {}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-0.2, -0.2, -0.2}, Vec3d{0.2, 0.2, 0.2}, d))
    if (std::max({std::fabs(x.x), std::fabs(x.y), std::fabs(x.z)}) > 0.06) points.push_back(x);
  const ObjectId fluid = world.add_fluid(points, water);
  const ObjectId body = world.add_soft_body(box({0.12, 0.12, 0.12}, 3), material::rubber,
                                            LatticeOptions{.cells = 500}, {.velocity = {0.5f, 0, 0}});
  std::vector<Vec3f> v;
  for (const Vec3f& x : world.positions(fluid)) v.push_back({2 * x.y, 0, 0.3f});
  world.set_velocities(fluid, v);
  world.leave_out_covered();
  const auto momentum = [&] { return world.momentum(fluid) + world.momentum(body); };
  const Vec3d before = momentum();
  double sum = 0;
  for (const Vec3f& u : v) sum += 1000 * d * d * d * double{length(u)};
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  EXPECT_LT(length(momentum() - before), 1e-4 * sum);
}

TEST(FluidRobustness, BodiesStartedInEachOtherInWaterDoNotExplode) {
  World world({.substeps = 8});
  const Vec3d size{24 * d, 40 * d, 24 * d};
  add_tank(world, size);
  const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.24, 0, -0.24}, Vec3d{0.24, 0.3, 0.24}, d), water);
  for (const double x : {-0.02, 0.03})
    world.add_soft_body(box({0.12, 0.12, 0.12}, 3), {.young_modulus = 1e5f, .density = 500},
                        LatticeOptions{.cells = 300}, {.transform = {.translation = {x, 0.15, 0}}});
  for (int frame = 0; frame < 60; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    ASSERT_LT(farthest_out(world, fluid, size), 0) << frame;
  }
  double fastest = 0;
  for (const Vec3f& v : world.velocities(fluid)) fastest = std::max(fastest, double{length(v)});
  EXPECT_LT(fastest, 3);
}

/// The number of points of a fluid inside a mesh.
std::size_t count_inside(const World& world, ObjectId fluid, ObjectId body,
                         const std::vector<Triangle>& triangles) {
  std::vector<Vec3d> surface;
  for (const Vec3f& x : world.positions(body)) surface.emplace_back(x);
  const MeshTree tree(surface, triangles);
  const BoundingBox box = bounding_box(surface, triangles);
  std::size_t count = 0;
  for (const Vec3f& x : world.positions(fluid)) {
    bool near = true;
    for (int k = 0; k < 3; ++k) near = near && double{x[k]} > box.lo[k] && double{x[k]} < box.hi[k];
    count += near && tree.winding_number(Vec3d(x)) > 0.5 ? 1 : 0;
  }
  return count;
}

/// A basin of water of 0.4 x 0.24 x 0.4 m in which something begins.
struct Immersed {
  static constexpr double spacing = 0.025;
  World world;
  ObjectId fluid;
  std::vector<std::string> told;
  double fastest = 0, highest = 0;

  Immersed() {
    add_tank(world, {0.4, 2, 0.4});
    fluid = world.add_fluid(fill(Vec3d{-0.2, 0, -0.2}, Vec3d{0.2, 0.25, 0.2}, spacing),
                            {.spacing = float(spacing)}, {.name = "water"});
    world.set_log([this](LogLevel, std::string_view line) { told.emplace_back(line); });
  }
  void run(int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      ASSERT_TRUE(world.step(1.0 / 60).ok());
      for (const Vec3f& v : world.velocities(fluid)) fastest = std::max(fastest, double{length(v)});
      for (const Vec3f& x : world.positions(fluid)) highest = std::max(highest, double{x.y});
    }
  }
};

TEST(FluidImmersed, AColliderThrowsNothing) {
  Immersed basin;
  const std::size_t before = basin.world.positions(basin.fluid).size();
  basin.world.add_collider(Sphere{{0, 0.12f, 0}, 0.08f}, {.name = "ball"});
  basin.run(40);
  EXPECT_LT(basin.fastest, 1);
  EXPECT_LT(basin.highest, 0.35);
  const std::size_t gone = before - basin.world.positions(basin.fluid).size();
  const double volume = static_cast<double>(gone) * Immersed::spacing * Immersed::spacing * Immersed::spacing;
  EXPECT_NEAR(volume / (4 * pi / 3 * 0.08 * 0.08 * 0.08), 1, 0.1);
  ASSERT_EQ(basin.told.size(), 1u);
  EXPECT_EQ(basin.told[0],
            "water: " + std::to_string(gone) + " of 2560 points lie inside ball and were left out");
}

/// Makes a step whose second substep diverges, after the world has left out what is covered.
void diverge_once(World& world) {
  world.leave_out_covered();
  const auto force = world.add_force_field([](const Vec3f&, const Vec3f&, float, double time) {
    return Vec3f{time > 0 ? 3e38f : 0, 0, 0};
  });
  EXPECT_EQ(world.step(1.0 / 60).outcome, StepOutcome::diverged);
  world.remove(force);
}

// Boxes whose faces lie a share of a spacing before a layer of particles, and one that is turned. The first step of the
// first box diverges and is undone.
TEST(FluidImmersed, NoDistanceOfAFaceThrowsTheWater) {
  for (const double gap : {0.02, 0.11, 0.25, 0.4, -1.0}) {
    Immersed basin;
    ObjectOptions options{.transform = {.translation = {0, 0.125, 0}}};
    if (gap < 0) options.transform.rotation = Quatd::from_axis_angle({0.6, 0, 0.8}, 1);
    const auto size = static_cast<float>((gap < 0 ? 3 : 3.5 - gap) * Immersed::spacing);
    const ObjectId body = basin.world.add_rigid_body(Box{{}, {size, size, size}}, {}, options);
    basin.world.set_kinematic(body, true);
    if (gap == 0.02) diverge_once(basin.world);
    basin.run(20);
    EXPECT_LT(basin.fastest, 1.3) << gap;
  }
}

// A snapshot of a world whose water has yet to settle: goes on with equal bits.
TEST(FluidImmersed, SettlesAfterARestore) {
  Immersed basin;
  basin.world.add_collider(Sphere{{0, 0.12f, 0}, 0.08f});
  basin.world.leave_out_covered();
  const Snapshot snapshot = basin.world.snapshot();
  basin.run(2);
  const std::uint64_t hash = basin.world.hash();
  basin.world.restore(snapshot);
  basin.run(2);
  EXPECT_EQ(basin.world.hash(), hash);
}

TEST(FluidImmersed, ALightBodyFloatsAndAHeavyOneStays) {
  for (const bool heavy : {false, true}) {
    Immersed basin;
    const TriangleMesh ball = sphere(2, 0.08);
    const ObjectId body = basin.world.add_rigid_body(ball, {.density = heavy ? 2000.0f : 300.0f},
                                                     {.transform = {.translation = {0, 0.12, 0}}});
    basin.run(45);
    EXPECT_LT(basin.fastest, 1.5);  // of water that runs off the ball
    if (heavy)
      EXPECT_NEAR(basin.world.center_of_mass(body).y, 0.08, 0.01);
    else
      EXPECT_GT(basin.world.center_of_mass(body).y, 0.23);
    EXPECT_EQ(count_inside(basin.world, basin.fluid, body, ball.triangles), 0u);
  }
}

TEST(FluidImmersed, AVesselKeepsItsWater) {
  Immersed basin;
  basin.world.add_obstacle(box({0.42, 0.6, 0.42}, 1), {}, {}, {.transform = {.translation = {0, 0.2, 0}}});
  basin.run(1);
  EXPECT_EQ(basin.world.positions(basin.fluid).size(), 2560u);
}

// A wave of 0.6 m and a light soft box. With four substeps, half of those required, one of the 7,680 particles may be in
// the box.
TEST(FluidRobustness, NothingGetsIntoASoftBodyThatAWaveStrikes) {
  constexpr double spacing = 0.025;
  constexpr int frames = 60;
  for (const int substeps : {4, 10}) {
    World world({.substeps = substeps});
    add_tank(world, {1.6, 1.2, 0.5});
    const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.8, 0, -0.25}, Vec3d{-0.3, 0.6, 0.25}, spacing),
                                           {.spacing = float(spacing), .density = 998});
    const TriangleMesh shape = box({0.2, 0.2, 0.2}, 4);
    const ObjectId body =
        world.add_soft_body(shape, {.young_modulus = 5e4f, .density = 500}, LatticeOptions{.cells = 500},
                            {.transform = {.translation = {0.1, 0.11, 0}}});
    double inside = 0, highest = 0;  // inside: mean number of particles
    for (int frame = 0; frame < frames; ++frame) {
      ASSERT_TRUE(world.step(1.0 / 60).ok());
      highest = std::max(highest, world.center_of_mass(body).y);
      inside += static_cast<double>(count_inside(world, fluid, body, shape.triangles)) / frames;
    }
    EXPECT_LE(inside, substeps < 10 ? 1 : 0);
    EXPECT_GT(highest, 0.14);  // the wave lifted it
  }
}

TEST(FluidRobustness, AColliderWhoseMotionThrowsIsReported) {
  World world;
  world.add_fluid(fill(Vec3d{0, 0, 0}, Vec3d{0.1, 0.1, 0.1}, d), water);
  world.add_collider(
      Sphere{},
      {.motion = ColliderMotion::callback([](double) -> Transform { throw std::runtime_error("no way"); })});
  EXPECT_NO_THROW(world.step(1.0 / 60));
  EXPECT_TRUE(world.report().has(Flag::callback_failed));
}

TEST(FluidRobustness, GoesOnFromASnapshotToTheBit) {
  const auto make = [] {
    World world({.substeps = 6});
    add_tank(world, {0.5, 1, 0.3});
    world.add_fluid(fill(Vec3d{-0.25, 0, -0.15}, Vec3d{0, 0.3, 0.15}, d), water);
    return world;
  };
  expect_resumes(make, 20.0 / 60, 20.0 / 60);
}

// No gravity, no walls, no vorticity confinement, no drag: no external source of momentum.

/// sum m |v| of a fluid [kg m/s].
double sum_of_momenta(const World& world, ObjectId fluid) {
  const double mass = world.total_mass(fluid) / double(world.positions(fluid).size());
  double sum = 0;
  for (const Vec3f& v : world.velocities(fluid)) sum += mass * double{length(v)};
  return sum;
}

/// Angular momentum of a fluid about the origin [kg m^2/s].
Vec3d angular_momentum(const World& world, ObjectId fluid) {
  const auto x = world.positions(fluid), v = world.velocities(fluid);
  Vec3d sum{};
  for (std::size_t i = 0; i < x.size(); ++i) sum += cross(Vec3d(x[i]), Vec3d(v[i]));
  return sum * (world.total_mass(fluid) / double(x.size()));
}

// A sheet that the water accelerates, and the reaction on the water.
TEST(FluidMomentum, IsKeptWithClothInTheWater) {
  World world({.substeps = 8, .gravity = {}});
  const ObjectId fluid =
      world.add_fluid(fill(Vec3d{-0.2, -0.2, -0.2}, Vec3d{0.2, 0.2, 0.2}, d), {.spacing = float(d)});
  ClothMaterial material = material::cotton;
  material.air_drag = 0;
  material.air_lift = 0;
  const ObjectId cloth = world.add_cloth(grid(12, 12, 0.25f), material, {.velocity = {0, 1, 0}});
  std::vector<Vec3f> v;
  for (const Vec3f& x : world.positions(fluid)) v.push_back({2 * x.y, x.x, 0.3f});
  world.set_velocities(fluid, v);
  world.leave_out_covered();
  const auto momentum = [&] { return world.momentum(fluid) + world.momentum(cloth); };
  const Vec3d before = momentum(), of_cloth = world.momentum(cloth);
  const double sum = sum_of_momenta(world, fluid);
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  // Most of its momentum has gone to the water.
  EXPECT_GT(length(world.momentum(cloth) - of_cloth), 0.3 * length(of_cloth));
  validate_below("fluid without gravity and walls",
                 "cloth in the fluid: change of linear momentum in 1 s / sum m |v|",
                 length(momentum() - before) / sum, 1e-4);
}

/// A ball of fluid in rigid rotation: changes within a second, relative to the initial values.
struct Spun {
  double linear, angular;  // relative to sum m |v| and to L
};
Spun spin(const FluidMaterial& material) {
  World world({.substeps = 8, .gravity = {}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-0.2, -0.2, -0.2}, Vec3d{0.2, 0.2, 0.2}, d))
    if (length(x) < 0.2) points.push_back(x);
  FluidMaterial fluid_material = material;
  fluid_material.spacing = float(d);
  const ObjectId fluid = world.add_fluid(points, fluid_material);
  std::vector<Vec3f> v;
  for (const Vec3f& x : world.positions(fluid)) v.push_back(cross(Vec3f{0, 0, 2}, x));  // 2 rad/s
  world.set_velocities(fluid, v);
  const Vec3d linear = world.momentum(fluid), angular = angular_momentum(world, fluid);
  const double sum = sum_of_momenta(world, fluid);
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
  return {length(world.momentum(fluid) - linear) / sum,
          length(angular_momentum(world, fluid) - angular) / length(angular)};
}

TEST(FluidMomentum, OfASpinningBall) {
  const std::string name = "fluid without gravity and walls", of = "ball of 20 spacings at 2 rad/s, ";
  FluidMaterial bare = material::water;
  bare.xsph = 0;
  for (const auto& [label, material] : {std::pair{"water", material::water},
                                        {"water, xsph 0", bare},
                                        {"oil", material::oil},
                                        {"honey", material::honey}}) {
    const Spun spun = spin(material);
    validate_below(name, of + label + ": change of linear momentum in 1 s / sum m |v|", spun.linear, 1e-4);
    state(name, of + label + ": change of angular momentum in 1 s", spun.angular);
    EXPECT_LT(spun.angular, 0.5) << label;
  }
}

bool has_fluid(const SceneDescription& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [](const AnyObjectDescription& object) {
    return std::holds_alternative<FluidDescription>(object);
  });
}

std::vector<std::filesystem::path> scenes_with_fluids() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("scenes")))
    if (entry.path().extension() == ".json" && has_fluid(load_scene(entry.path())))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class FluidScene : public ::testing::TestWithParam<std::filesystem::path> {};

// All shipped scenes: the compression of a fluid is at most a percent, averaged over its particles and
// frames.
TEST_P(FluidScene, KeepsDensitySlow) {
  const SceneDescription scene = load_scene(GetParam());
  World world = build_world(scene);
  double mean = 0, worst_frame = 0, largest = 0, step = 0;
  for (std::uint32_t frame = 0; frame < scene.frames; ++frame) {
    const StepReport& report = world.step(1 / scene.frame_rate);
    ASSERT_TRUE(report.ok()) << report.message;
    mean += report.fluid.mean_density_error / scene.frames;
    worst_frame = std::max(worst_frame, report.fluid.mean_density_error);
    largest = std::max(largest, report.fluid.largest_density_error);
    step = std::max(step, report.fluid.largest_step);
  }
  const std::string name = "density error in the shipped scenes", of = GetParam().stem().string() + ": ";
  validate_below(name, of + "mean", mean, 0.01);
  state(name, of + "mean in the worst frame", worst_frame);
  state(name, of + "largest, of one particle", largest);
  state(name, of + "longest step, should be below 0.33", step);
}

INSTANTIATE_TEST_SUITE_P(Shipped, FluidScene, ::testing::ValuesIn(scenes_with_fluids()),
                         [](const auto& test) { return test.param.stem().string(); });

}  // namespace souple::test_physics_fluid_robustness
