#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_limits {

// Indices and numbers beyond what a world can hold are refused where a user sets them, and harmless where a simulation
// reaches them.

Transform moved_to(double x) {
  return {{x, 0, 0}, {}, 1};
}

TEST(Limits, AGroupNamesVerticesOfItsMesh) {
  TriangleMesh mesh = grid(3, 3, 1);
  mesh.groups["hem"] = {0, 9};
  World world;
  expect_error([&] { world.add_cloth(mesh, {}, {.name = "flag"}); },
               {"flag", "hem", "vertex 9", "9 vertices"});
  expect_error([&] { world.add_obstacle(mesh); }, {"hem", "vertex 9"});
  TetMesh bar = tet_bar(1, 1, 1, {1, 1, 1});
  bar.groups["end"] = {400};
  expect_error([&] { world.add_soft_body(bar); }, {"end", "vertex 400"});
  mesh.groups["hem"] = {0, 8};
  world.pin(world.add_cloth(mesh), group("hem"));
  mesh.faces = {{0, 1, 50}};
  expect_error([&] { world.add_cloth(mesh); }, {"face 0", "vertex 50"});
  EXPECT_EQ(world.objects().size(), 1u);
}

TEST(Limits, ValuesThatNoEnumerationHasAreRefused) {
  World world;
  expect_error([&] { world.before(Stage(99), [](World&) {}); }, {"before", "stage is 99"});
  expect_error([&] { world.after(Stage(-1), [](World&) {}); }, {"after", "stage is -1"});
  const auto refused = [&](const char* field, const auto& set) {
    Settings settings;
    set(settings);
    expect_error([&] { world.set_settings(settings); }, {field, "77"});
  };
  refused("mode", [](Settings& s) { s.mode = Mode(77); });
  refused("integrator", [](Settings& s) { s.integrator = Integrator(77); });
  refused("solver.kind", [](Settings& s) { s.solver.kind = SolverKind(77); });
  refused("solver.sweep", [](Settings& s) { s.solver.sweep = Sweep(77); });
  refused("fluid.kernel", [](Settings& s) { s.fluid.kernel = SmoothingShape(77); });
  refused("detection", [](Settings& s) { s.detection = Detection(77); });
  refused("segment_test", [](Settings& s) { s.segment_test = SegmentTest(77); });
  refused("threading", [](Settings& s) { s.threading = Threading(77); });
  expect_error([&] { world.add_cloth(grid(2, 2, 1), {}, {.self_collision = SelfCollision(77)}); },
               {"self_collision", "77"});
  expect_error([&] { world.add_cloth(grid(2, 2, 1), {.stretch = StretchModel(77)}); }, {"stretch", "77"});
  expect_error([&] { world.add_cloth(grid(2, 2, 1), {.bending = BendingModel(77)}); }, {"bending", "77"});
  const TetMesh bar = tet_bar(1, 1, 1, {1, 1, 1});
  expect_error([&] { world.add_soft_body(bar, {.model = SoftBodyModel(77)}); }, {"model", "77"});
  EXPECT_TRUE(world.objects().empty());
}

TEST(Limits, PositionsAndVelocitiesBeyondABillionAreRefused) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(2, 2, 1), {}, {.name = "flag"});
  const ObjectId fluid = world.add_fluid(std::vector<Vec3d>{{0, 3, 0}}, {}, {.max_particles = 10});
  const ColliderId ball = world.add_collider(Sphere{});
  const std::uint64_t before = world.hash();
  const std::vector<Vec3f> far(4, {0, 2e9f, 0});
  expect_error([&] { world.set_positions(cloth, far); }, {"set_positions", "flag", "1e+09"});
  expect_error([&] { world.set_velocities(cloth, far); }, {"set_velocities", "flag", "1e+09"});
  expect_error([&] { world.teleport(cloth, moved_to(1e300)); }, {"teleport", "translation", "1e+09"});
  expect_error([&] { world.add_cloth(grid(2, 2, 1), {}, {.transform = moved_to(2e9)}); }, {"1e+09"});
  expect_error([&] { world.add_grains(std::vector<Vec3d>{{0, -1e300, 0}}); }, {"1e+09"});
  expect_error([&] { world.add_cloth(grid(2, 2, 1), {}, {.velocity = {0, 1e30f, 0}}); }, {"velocity"});
  expect_error([&] { world.add_collider(Sphere{.center = {1e30f, 0, 0}}); }, {"center", "1e+09"});
  expect_error([&] { world.move_collider(ball, moved_to(-2e9)); }, {"translation"});
  const std::vector<PoseKey> far_key{{0, {}, {}}, {1, {0, 5e9, 0}, {}}}, late{{0, {}, {}}, {1e300, {}, {}}};
  expect_error([&] { ColliderMotion::keyframes(far_key); }, {"keyframe 1", "1e+09"});
  expect_error([&] { ColliderMotion::keyframes(late); }, {"keyframe 1", "1e+300 s"});
  expect_error([&] { world.add_emitter(fluid, {.position = {0, 2e9f, 0}}); }, {"position"});
  expect_error([&] { world.add_emitter(fluid, {.speed = 1e30f}); }, {"speed"});
  world.pin(cloth, vertices({0}));
  const std::uint32_t corner[] = {0};
  expect_error([&] { world.move_pins(cloth, corner, std::span(far).first(1)); }, {"move_pins", "1e+09"});
  world.teleport(cloth, moved_to(0.9e9));
  expect_error([&] { world.teleport(cloth, moved_to(0.9e9)); }, {"teleport", "flag"});
  world.teleport(cloth, moved_to(-0.9e9));
  EXPECT_EQ(world.objects().size(), 2u);
  EXPECT_NE(before, 0u);
}

// Neighbors grow with the square of the particles at one place: 20,001 took gigabytes.
TEST(Limits, CrowdsOfFluidParticlesAtOnePlaceAreRefused) {
  World world;
  std::vector<Vec3d> points(100, Vec3d{1, 2, 3});
  const ObjectId few = world.add_fluid(points);
  EXPECT_TRUE(world.step(0.01).ok());
  world.remove(few);
  points.resize(20001, Vec3d{1, 2, 3});
  expect_error([&] { world.add_fluid(points, {}, {.name = "sea"}); },
               {"sea", "20001", "0.02 m", "number 0", "smaller particles"});
  points.clear();
  for (int i = 0; i < 64000; ++i) points.push_back(Vec3d(Vec3<int>{i % 40, i / 40 % 40, i / 1600}) * 0.02);
  EXPECT_NO_THROW(world.add_fluid(points));
  // The scale brings them together.
  expect_error([&] { world.add_fluid(points, {}, {.transform = {{}, {}, 0.1}}); }, {"fluid2", "in one cube"});
}

TEST(Limits, TimesBeyondABillionSecondsAreRefused) {
  World world;
  const ObjectId fluid = world.add_fluid(std::vector<Vec3d>{{0, 3, 0}}, {}, {.max_particles = 10});
  for (const double start : {-1e300, 1e300, 2e9, std::nan("")})
    expect_error([&] { world.add_emitter(fluid, {.start = start}); }, {"an emitter of fluid", "start"});
  expect_error([&] { world.add_drain({.start = -1e300}); }, {"a drain", "start"});
  ObstacleMotion motion;
  motion.sequence = {.frames = {std::vector<Vec3f>(4), std::vector<Vec3f>(4)}, .start_time = -1e300};
  expect_error([&] { world.add_obstacle(grid(2, 2, 1), {}, motion); }, {"start time", "-1e+300"});
  for (const double dt : {1e300, 2e9, -1.0, std::nan("")})
    EXPECT_NE(world.step(dt).message.find("nothing was done"), std::string::npos) << dt;
  EXPECT_EQ(world.time(), 0);
  // Allowed, and long ago: the layers since then are not counted one by one.
  world.add_emitter(fluid, {.speed = 1e9f, .start = -1e9});
  EXPECT_TRUE(world.step(0.01).ok());
}

// The motion of a collider is checked where it is used; a step says so.
TEST(Limits, AMotionBeyondTheLimitIsReported) {
  World world;
  world.add_cloth(grid(3, 3, 1));
  double x = 0;
  world.add_collider(Sphere{}, {.motion = ColliderMotion::callback([&](double) { return moved_to(x); })});
  EXPECT_TRUE(world.step(0.01).ok());
  x = 1e300;
  EXPECT_NE(world.step(0.01).message.find("a collider's motion threw"), std::string::npos);
}

// Two grains fly along an axis at 6e8 m/s, one behind the other. Only the first leaves the range in two seconds, and
// the report says so from then on.
TEST(Limits, WhatLeavesThemIsFlaggedWithItsNameAndSpeed) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  world.add_cloth(grid(3, 3, 1), {}, {.name = "near"});
  const ObjectId flying =
      world.add_grains(std::vector<Vec3d>{{0, -0.9e9, 0}, {0, 0, 0}}, {}, {.name = "flying"});
  world.set_velocities(flying, std::vector<Vec3f>(2, {0, 6e8f, 0}));
  EXPECT_FALSE(world.step(1).has(Flag::out_of_range)) << world.report().message;
  for (int i = 0; i < 2; ++i) {
    const StepReport& report = world.step(0.8);
    EXPECT_TRUE(report.ok());
    ASSERT_TRUE(report.has(Flag::out_of_range)) << report.message;
    EXPECT_NE(report.message.find("flying, vertex 1 is"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find("at 6e+08 m/s"), std::string::npos) << report.message;
  }
}

// A force field throws everything as far as floats reach, in both directions. No conversion to a cell overflows (the
// sanitizers check), and values that are no number any more are flagged.
TEST(Limits, SimulationsMayLeaveThem) {
  for (const float way : {1.0f, -1.0f})
    for (const float push : {1e9f, 1e15f, 1e22f, 1e32f, 1e38f}) {
      World world({.substeps = 2});
      world.add_cloth(grid(4, 4, 1), {},
                      {.transform = moved_to(2), .self_collision = SelfCollision::surfaces});
      world.add_cloth(grid(4, 4, 1), {},
                      {.transform = moved_to(8), .self_collision = SelfCollision::particles});
      world.add_grains(std::vector<Vec3d>{{-3, 0, 0}, {-3, 0.02, 0}, {-3, 5, 0}});
      std::vector<Vec3d> centers;
      centers.reserve(64);
      for (int z = 0; z < 4; ++z)
        for (int y = 0; y < 4; ++y)
          for (int x = 0; x < 4; ++x) centers.push_back({5 + 0.1 * x, 0.1 * y, 0.1 * z});
      world.add_fluid(centers, {.spacing = 0.1f, .foam = 1});
      world.add_rope(std::vector<Vec3d>{{0, 3, 0}, {1, 3, 0}}, 5, {},
                     {.self_collision = SelfCollision::surfaces});
      world.add_collider(Sphere{});
      world.add_collider(Plane{});
      // Some of the particles only, so that near and far ones are in one search.
      world.add_force_field([&](const ForcePoint& point) {
        return point.vertex % 3 == 0 ? Vec3f{1, 1, 1} * (way * push * point.mass) : Vec3f{};
      });
      for (int i = 0; i < 4; ++i) world.step(0.1);
      for (const ObjectId id : world.objects())
        for (const Vec3f& x : world.positions(id)) EXPECT_TRUE(is_finite(x)) << push;
      (void)world.ray_cast({0, 9, 0}, {0, -1, 0});
    }
}

// Defective meshes: non-finite values are refused with one clear sentence. Flat, duplicated, flipped or
// coincident elements run with all collisions on, and nothing explodes.

constexpr double frame_time = 1.0 / 60;
constexpr float speed_limit = 15;  // m/s
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

ObjectOptions with_self_collision(double height = 0) {
  ObjectOptions options{.transform = {.translation = {0, height, 0}},
                        .self_collision = SelfCollision::surfaces};
  return options;
}

/// A defect of a mesh.
struct Spoilt {
  const char* what;
  bool refused;  // otherwise it runs
  std::function<void(TriangleMesh&)> spoil;
};

const Spoilt spoilt_meshes[] = {
    {"sound", false, [](TriangleMesh&) {}},
    {"a position that is no number", true, [](TriangleMesh& mesh) { mesh.positions[7].y = not_a_number; }},
    {"a position at infinity", true, [](TriangleMesh& mesh) { mesh.positions[3].x = infinity; }},
    {"a vertex that is not there", true, [](TriangleMesh& mesh) { mesh.triangles[2][1] = 1000000; }},
    {"a triangle with a repeated corner", false,
     [](TriangleMesh& mesh) {
       mesh.triangles.push_back({4, 4, 5});
     }},
    {"flat triangles", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions)
         if (x.x > 0.1) x.x = 0.1;
     }},
    {"a triangle twice", false, [](TriangleMesh& mesh) { mesh.triangles.push_back(mesh.triangles[5]); }},
    {"a triangle twice, once turned round", false,
     [](TriangleMesh& mesh) {
       const Triangle t = mesh.triangles[5];
       mesh.triangles.push_back({t[1], t[0], t[2]});
     }},
    {"half of it turned round", false,
     [](TriangleMesh& mesh) {
       for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)
         std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
     }},
    {"all of it twice", false,
     [](TriangleMesh& mesh) {
       const auto n = static_cast<std::uint32_t>(mesh.positions.size());
       const TriangleMesh copy = mesh;
       mesh.positions.insert(mesh.positions.end(), copy.positions.begin(), copy.positions.end());
       for (const Triangle& t : copy.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
     }},
    {"vertices in one place", false, [](TriangleMesh& mesh) { mesh.positions[8] = mesh.positions[9]; }},
    {"all vertices in one place", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {0.1, 0.2, 0.3};
     }},
    {"all vertices on one line", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {x.x, 0.2, 0.3};
     }},
    {"all vertices in one plane, folded over one another", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {std::abs(x.x), 0, std::abs(x.z)};
     }},
    {"all vertices shuffled", false,
     [](TriangleMesh& mesh) {
       for (std::size_t i = 0; i < mesh.positions.size(); ++i)
         std::swap(mesh.positions[i], mesh.positions[(i * 37) % mesh.positions.size()]);
     }},
    {"no triangles", false, [](TriangleMesh& mesh) { mesh.triangles.clear(); }},
    {"nothing at all", true, [](TriangleMesh& mesh) { mesh = {}; }},
};

/// Expects one sentence that describes the defect.
void expect_clear(const std::string& message, const char* what) {
  EXPECT_GT(message.size(), 10u) << what;
  EXPECT_EQ(message.find('\n'), std::string::npos) << what << ": " << message;
}

void expect_calm(World& world, const char* what) {
  for (int frame = 0; frame < 60; ++frame) {
    const StepReport& report = world.step(frame_time);
    ASSERT_TRUE(report.ok()) << what << ", frame " << frame << ": " << report.message;
    for (const ObjectId id : world.objects())
      for (const Vec3f& v : world.velocities(id))
        ASSERT_LT(length(v), speed_limit) << what << ", " << world.name(id) << ", frame " << frame;
  }
}

/// Adds a defective mesh to a world above a sheet and drops it there.
void expect_refused_or_calm(const Spoilt& spoilt, const std::function<void(World&)>& add) {
  World world;
  world.add_collider(Plane{.offset = -0.5f});
  const std::string error = error_of([&] { add(world); });
  if (spoilt.refused || !error.empty()) expect_clear(error, spoilt.what);
  world.add_cloth(grid(8, 8, 0.8), {.thickness = 0.02f}, with_self_collision(0.05));
  expect_calm(world, spoilt.what);
}

TEST(BadSurfaces, AClothIsRefusedOrCalm) {
  for (const Spoilt& spoilt : spoilt_meshes) {
    TriangleMesh mesh = grid(6, 6, 0.5);
    spoilt.spoil(mesh);
    expect_refused_or_calm(
        spoilt, [&](World& world) { world.add_cloth(mesh, {.thickness = 0.02f}, with_self_collision()); });
  }
}

TEST(BadSurfaces, AnObstacleIsRefusedOrCalm) {
  for (const Spoilt& spoilt : spoilt_meshes) {
    TriangleMesh mesh = sphere(1, 0.2);
    spoilt.spoil(mesh);
    expect_refused_or_calm(spoilt, [&](World& world) { world.add_obstacle(mesh, {.thickness = 0.02f}); });
  }
}

TEST(BadSurfaces, ASoftBodyIsRefusedOrCalm) {
  struct SpoiltTets {
    Spoilt as;
    std::function<void(TetMesh&)> spoil;
  };
  const SpoiltTets all[] = {
      {{"sound", false, {}}, [](TetMesh&) {}},
      {{"no number", true, {}}, [](TetMesh& mesh) { mesh.positions[3].z = not_a_number; }},
      {{"inside out", true, {}}, [](TetMesh& mesh) { std::swap(mesh.tets[1][0], mesh.tets[1][1]); }},
      {{"flat", true, {}},
       [](TetMesh& mesh) {
         for (Vec3d& x : mesh.positions) x.y = 0;
       }},
      {{"a tet twice", false, {}}, [](TetMesh& mesh) { mesh.tets.push_back(mesh.tets[2]); }},
      {{"a repeated corner", true, {}}, [](TetMesh& mesh) { mesh.tets[0][2] = mesh.tets[0][1]; }},
      {{"in one place", true, {}},
       [](TetMesh& mesh) {
         for (Vec3d& x : mesh.positions) x = {0, 0, 0};
       }},
      {{"nothing at all", true, {}}, [](TetMesh& mesh) { mesh = {}; }},
  };
  for (const SpoiltTets& spoilt : all) {
    TetMesh mesh = tet_bar(2, 2, 2, {0.3, 0.3, 0.3});
    spoilt.spoil(mesh);
    expect_refused_or_calm(spoilt.as, [&](World& world) {
      world.add_soft_body(mesh, {.thickness = 0.02f}, with_self_collision());
    });
  }
}

TEST(BadSurfaces, PositionsThatAreNoNumbersAreRefused) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(4, 4, 1), {}, with_self_collision());
  std::vector<Vec3f> positions(16);
  positions[5].x = std::numeric_limits<float>::quiet_NaN();
  expect_clear(error_of([&] { world.set_positions(cloth, positions); }), "set_positions");
  // All vertices at one point: accepted.
  world.set_positions(cloth, std::vector<Vec3f>(16, Vec3f{0.1f, 0.2f, 0.3f}));
  for (int frame = 0; frame < 60; ++frame) EXPECT_TRUE(world.step(frame_time).ok());
}

}  // namespace souple::test_world_limits
