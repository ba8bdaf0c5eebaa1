#include "tests/collision/random.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_surface_contacts {

using test::CrossingCounter;

struct OnTwoTriangles {
  World world;
  ObjectId large, fine;
};

/// A sheet of n x n vertices is pressed with 10 m/s^2 on one of two triangles that can move. Each of these has
/// thousands of contacts.
OnTwoTriangles on_two_triangles(int n, int threads) {
  OnTwoTriangles scene{
      World({.substeps = 2, .gravity = {}, .wind = {.air_density = 0}, .threads = threads}), {}, {}};
  scene.large = scene.world.add_cloth(grid(2, 2, 3), {.areal_density = 1});
  scene.fine = scene.world.add_cloth(grid(n, n, 1), {.areal_density = 1}, at(0.05, 0.003, 0.02));
  scene.world.add_force_field([](const ForcePoint& point) {
    const bool is_fine = point.mass < 0.1f;
    return Vec3f{0, is_fine ? -10 * point.mass : 0, 0};
  });
  return scene;
}

// Test of the checker: crumpled sheets, counted with its grid and pair by pair.
TEST(Crossings, GridCountsWhatAllPairsCount) {
  for (const int n : {2, 7, 20, 40}) {
    const TriangleMesh mesh = grid(n, n, 1);
    std::vector<Vec3f> positions;
    test::Random random(1);
    for (const Vec3d& p : mesh.positions) positions.emplace_back(p + random.vector() * (2.0 / n));
    CrossingCounter counter;
    counter.add(positions, mesh.triangles);
    EXPECT_EQ(counter.crossings(), counter.crossings_of_all_pairs()) << n;
    if (n >= 20) {
      EXPECT_GT(counter.crossings(), 10u) << n;
    }
  }
}

World falling_sheet(int n, SelfCollision self_collision) {
  World world({.wind = {.air_density = 0}});
  ObjectOptions options{.self_collision = self_collision};
  options.transform = {{0, 0.52, 0}, Quatd::from_axis_angle({0, 0, 1}, 1.48), 1};
  world.add_cloth(grid(n, n, 1), {.areal_density = 0.2f, .thickness = 0.3f / static_cast<float>(n)}, options);
  world.add_collider(Plane{});
  return world;
}

TEST(SurfaceContacts, ASheetThatFallsInAHeapNeverPassesThroughItself) {
  World world = falling_sheet(20, SelfCollision::surfaces);
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    EXPECT_EQ(crossings(world), 0u) << frame;
  }
  World without = falling_sheet(20, SelfCollision::off);
  for (int frame = 0; frame < 60; ++frame) without.step(1.0 / 60);
  EXPECT_GT(crossings(without), 0u);
}

// A stone thrown at a free sheet moves it: no crossing, and momentum is conserved.
TEST(SurfaceContacts, AFastStoneDoesNotPass) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  const ObjectId sheet =
      world.add_cloth(grid(12, 12, 0.5), {.thickness = 0.01f}, {.self_collision = SelfCollision::surfaces});
  ObjectOptions thrown = at(0.013, 0.5, 0.017);
  thrown.self_collision = SelfCollision::surfaces;
  thrown.velocity = {0, -30, 0};
  const ObjectId stone = world.add_soft_body(tet_bar(2, 2, 2, {0.1, 0.1, 0.1}), {.thickness = 0.01f}, thrown);
  const Vec3d before = total_momentum(world);
  std::size_t contacts = 0;
  for (int frame = 0; frame < 6; ++frame) {
    contacts += world.step(1.0 / 60).contacts;
    EXPECT_EQ(crossings(world), 0u) << frame;
  }
  EXPECT_GT(contacts, 0u);
  EXPECT_LT(world.momentum(sheet).y, -0.1);
  EXPECT_GT(world.momentum(stone).y, before.y);
  EXPECT_LT(length(total_momentum(world) - before), 1e-4 * length(before));
}

// Triangles support an object that lies between their vertices.
TEST(SurfaceContacts, AGrainRestsInTheMiddleOfATriangle) {
  World world({.substeps = 20});
  const ObjectId sheet = world.add_cloth(grid(3, 3, 1), {.thickness = 0.01f});
  world.pin(sheet, in_box({-9, -9, -9}, {9, 9, 9}));
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0.2, 0.1, 0.13}}, {.radius = 0.02f});
  for (int frame = 0; frame < 90; ++frame) world.step(1.0 / 60);
  EXPECT_NEAR(double(world.positions(grain)[0].y), 0.025, 5e-4);
  EXPECT_LT(double(length(world.velocities(grain)[0])), 1e-3);
}

// Above a node, and between two nodes 5 cm apart.
TEST(SurfaceContacts, AGrainRestsOnARopeWhereverItIs) {
  World world({.substeps = 20});
  const std::vector<Vec3d> across{{-0.5, 0, 0}, {0.5, 0, 0}};
  const std::vector<Vec3d> above{{-0.2, 0.02, 0}, {0.024, 0.02, 0}, {0.21, 0.02, 0}};
  const ObjectId rope = world.add_rope(across, 20, {.radius = 0.01f});
  world.pin(rope, in_box({-9, -9, -9}, {9, 9, 9}));
  const ObjectId grains = world.add_grains(above, {.radius = 0.005f});
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(double(world.positions(grains)[std::size_t(i)].y), 0.015, 5e-4) << i;
    EXPECT_LT(double(length(world.velocities(grains)[std::size_t(i)])), 1e-2) << i;
  }
}

// A grain on a sloping rope sticks and slides according to mu, over edges and nodes alike: a = g (sin - mu
// cos).
TEST(SurfaceContacts, AGrainSlidesDownARopeAsMuSays) {
  const double mu = 0.4;
  for (const double steepness : {0.9, 1.5}) {  // tan of the slope over mu
    const double angle = std::atan(steepness * mu);
    World world({.substeps = 20,
                 .gravity = {static_cast<float>(9.81 * std::sin(angle)),
                             static_cast<float>(-9.81 * std::cos(angle)), 0}});
    const auto friction = static_cast<float>(mu);
    const std::vector<Vec3d> along{{-0.2, 0, 0}, {1.2, 0, 0}}, above{{0.013, 0.015, 0}};
    const ObjectId rope = world.add_rope(along, 28, {.radius = 0.01f, .friction = friction});
    world.pin(rope, in_box({-9, -9, -9}, {9, 9, 9}));
    const ObjectId grain =
        world.add_grains(above, {.radius = 0.005f, .friction = friction, .rolling_friction = 10});
    const double seconds = 0.8;
    for (int frame = 0; frame < 48; ++frame) world.step(1.0 / 60);
    const double slid = double(world.positions(grain)[0].x) - above[0].x;
    const double a = std::max(0.0, 9.81 * (std::sin(angle) - mu * std::cos(angle)));
    EXPECT_NEAR(slid, 0.5 * a * seconds * seconds, 0.02 * 0.5 * a * seconds * seconds + 1e-3) << steepness;
  }
}

// A grain falls on the midpoint of an edge of a free rope. It bounces according to restitution, and the rope receives
// the momentum that it loses.
TEST(SurfaceContacts, AGrainBouncesOffAnEdgeOfARope) {
  World world({.substeps = 20, .gravity = {}});
  const std::vector<Vec3d> across{{-0.05, 0, 0}, {0.05, 0, 0}}, above{{0, 0.1, 0}};
  const ObjectId rope = world.add_rope(across, 1, {.radius = 0.01f, .friction = 0});
  const ObjectId grain = world.add_grains(above, {.radius = 0.005f, .friction = 0, .restitution = 0.5f},
                                          {.velocity = {0, -2, 0}});
  const Vec3d before = total_momentum(world);
  for (int frame = 0; frame < 12; ++frame) world.step(1.0 / 60);
  const double apart = double(world.velocities(grain)[0].y) - world.momentum(rope).y / world.total_mass(rope);
  EXPECT_NEAR(apart, 0.5 * 2, 0.02);
  EXPECT_LT(length(total_momentum(world) - before), 1e-4 * length(before));
}

// 3.3 m per frame, on either side of a rope 2 cm thick with nodes 25 cm apart. Each grain stays on its side,
// or moves with the rope.
TEST(SurfaceContacts, NoGrainThatIsAimedAtARopePasses) {
  std::vector<Vec3f> of_one_thread;
  for (const int threads : {1, 2, 8}) {
    World world({.gravity = {}, .threads = threads});
    const ObjectId rope = world.add_rope(std::vector<Vec3d>{{-0.5, 0, 0}, {0.5, 0, 0}}, 4, {.radius = 0.01f});
    world.pin(rope, vertices({0, 4}));
    std::vector<Vec3d> centers(40);
    for (int i = 0; i < 40; ++i) centers[std::size_t(i)] = {-0.45 + 0.023 * i, 1 + 0.037 * i, 0};
    const ObjectId grains = world.add_grains(centers, {.radius = 0.002f}, {.velocity = {0, -200, 0}});
    const double before = std::abs(world.momentum(grains).y);
    std::size_t contacts = 0;
    for (int frame = 0; frame < 3; ++frame) {
      contacts += world.step(1.0 / 60).contacts;
      // First all move down, then the rope throws back what hit it; it gains nothing.
      const double momentum = world.momentum(rope).y + world.momentum(grains).y;
      EXPECT_LT(frame == 0 ? momentum : std::abs(momentum), frame == 0 ? 0 : before);
      const auto nodes = world.positions(rope);
      for (const Vec3f& x : world.positions(grains)) {
        float height = -9;  // height of the rope at the grain
        for (std::size_t k = 0; k < 4; ++k)
          if (nodes[k].x <= x.x && x.x <= nodes[k + 1].x)
            height = nodes[k].y +
                     (nodes[k + 1].y - nodes[k].y) * (x.x - nodes[k].x) / (nodes[k + 1].x - nodes[k].x);
        if (std::abs(x.z) < 1e-3f) {
          EXPECT_GT(x.y, height) << frame;
        }
      }
    }
    EXPECT_GT(contacts, 0u);
    const auto x = world.positions(grains);
    if (of_one_thread.empty()) of_one_thread.assign(x.begin(), x.end());
    EXPECT_TRUE(std::equal(x.begin(), x.end(), of_one_thread.begin())) << threads;
  }
}

TEST(SurfaceContacts, ARopeHangsOverARope) {
  World world;
  const std::vector<Vec3d> across{{-0.5, 0, 0}, {0.5, 0, 0}}, above{{0, 0.03, -0.4}, {0, 0.03, 0.4}};
  const ObjectId bar = world.add_rope(across, 9, {.radius = 0.01f});
  world.pin(bar, in_box({-9, -9, -9}, {9, 9, 9}));
  const ObjectId rope = world.add_rope(above, 21, {.radius = 0.01f, .friction = 1, .damping = 2});
  for (int frame = 0; frame < 120; ++frame) world.step(1.0 / 60);
  const auto x = world.positions(rope);
  EXPECT_NEAR(double(x[10].y + x[11].y) / 2, 0.02, 3e-3);
  EXPECT_LT(x[0].y, -0.2f);
  EXPECT_LT(x[21].y, -0.2f);
}

// A patch of cloth on a slope of cloth sticks and slides according to mu: a = g (sin - mu cos).
TEST(SurfaceContacts, ClothOnAClothSlopeSlidesAsMuSays) {
  const double mu = 0.4;
  for (const double steepness : {0.9, 1.5}) {  // tan of the slope over mu
    const double angle = std::atan(steepness * mu);
    World world({.gravity = {static_cast<float>(9.81 * std::sin(angle)),
                             static_cast<float>(-9.81 * std::cos(angle)), 0}});
    const auto friction = static_cast<float>(mu);
    const ObjectId slope = world.add_cloth(grid(21, 21, 4), {.thickness = 0.01f, .friction = friction});
    world.pin(slope, in_box({-9, -9, -9}, {9, 9, 9}));
    const ObjectId patch = world.add_cloth(grid(6, 6, 0.31), {.thickness = 0.01f, .friction = friction},
                                           at(-1.03, 0.0101, 0.02));
    const auto speed = [&] { return world.momentum(patch).x / double(world.total_mass(patch)); };
    for (int frame = 0; frame < 12; ++frame) world.step(1.0 / 60);
    const double early = speed();
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
    const double expected = steepness < 1 ? 0 : 9.81 * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_NEAR((speed() - early) / 0.5, expected, steepness < 1 ? 0.01 : 0.02 * expected) << steepness;
  }
}

// Two sheets that start coplanar have no defined sides: they separate, and nothing explodes.
TEST(SurfaceContacts, SheetsThatBeginInOnePlaneComeApart) {
  World world;
  const ObjectId held = world.add_cloth(grid(9, 9, 1));
  world.pin(held, vertices({0, 8, 72, 80}));
  const ObjectId loose = world.add_cloth(grid(4, 4, 0.3));
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    for (const Vec3f& v : world.velocities(loose)) EXPECT_LT(length(v), 15.0f) << frame;
  }
}

// Finer segments would be near thousands of others each.
// More colors than the 1024 that are searched for the lowest one.
TEST(SurfaceContacts, ThousandsOfContactsOfOneTriangle) {
  OnTwoTriangles one = on_two_triangles(48, 1), four = on_two_triangles(48, 4);
  std::size_t most = 0;
  for (int frame = 0; frame < 6; ++frame) {
    const StepReport& report = one.world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    most = std::max(most, report.contacts);
    four.world.step(1.0 / 60);
  }
  EXPECT_GT(most, 2000u);
  EXPECT_EQ(one.world.hash(), four.world.hash());
  EXPECT_EQ(crossings(one.world), 0u);
  EXPECT_NEAR(total_momentum(one.world).y, -1, 1e-3);  // 1 kg, 10 m/s^2, 0.1 s
  EXPECT_LT(one.world.momentum(one.large).y, -0.5);
}

TEST(RopeOnItself, NeedsSegmentsOfAFifthOfItsRadius) {
  World world;
  const std::vector<Vec3d> line{{0, 0, 0}, {1, 0, 0}};
  const ObjectOptions on_itself{.self_collision = SelfCollision::surfaces};
  expect_error([&] { world.add_rope(line, 100000, {.radius = 0.005f}, on_itself); },
               {"rope", "radius 0.005 m", "at most 1000 segments"});
  world.add_rope(line, 100000, {.radius = 0.005f});
  const ObjectId rope = world.add_rope(line, 999, {.radius = 0.005f}, on_itself);
  expect_error([&] { world.set_material(rope, RopeMaterial{.radius = 0.01f}); },
               {"rope", "radius 0.01 m", "at most 500 segments"});
  EXPECT_EQ(world.rope_material(rope).radius, 0.005f);
}

// Self-collision of particles: balls at vertices.

const ObjectOptions with_balls{.self_collision = SelfCollision::particles};

/// A sheet around a half turn of `radius` [m] at x = 0: its right half lies over its left.
std::vector<Vec3f> folded(const TriangleMesh& mesh, double radius) {
  std::vector<Vec3f> x;
  for (const Vec3d& at : mesh.positions) {
    const double turned = std::clamp(at.x / radius, 0.0, pi), beyond = std::max(0.0, at.x - pi * radius);
    x.push_back(Vec3f{float(std::min(at.x, 0.0) + radius * std::sin(turned) - beyond),
                      float(radius * (1 - std::cos(turned))), float(at.z)});
  }
  return x;
}

std::size_t self_contacts(const World& world) {
  std::size_t count = 0;
  for (const ContactEvent& contact : world.contacts()) count += contact.other_is_collider ? 0 : 1;
  return count;
}

// Also irregular edges, and a tube that is closed at rest.
TEST(VertexBalls, TheShapeAtRestHasNoContact) {
  TriangleMesh uneven = grid(20, 20, 1);
  for (Vec3d& x : uneven.positions) x.x += 0.4 * x.x * x.x;
  for (const TriangleMesh& mesh : {grid(20, 20, 1), uneven, torus(0.3, 0.05, 40, 12), sphere(2, 0.2)}) {
    std::vector<std::uint64_t> hashes;
    for (const SelfCollision mode : {SelfCollision::particles, SelfCollision::off}) {
      World world({.gravity = {}});
      world.add_cloth(mesh, {}, {.self_collision = mode});
      for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60);
      EXPECT_EQ(world.report().contacts, 0u);
      hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

// Two halves of a sheet, folded over each other and closing at 2 m/s, stop each other.
TEST(VertexBalls, LayersOfAFoldedSheetStayApart) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  const TriangleMesh mesh = grid(30, 30, 1);
  const ObjectId cloth = world.add_cloth(mesh, {.thickness = 0.005f}, with_balls);
  std::vector<Vec3f> v;
  constexpr double radius = 0.05;
  for (const Vec3d& at : mesh.positions)
    v.push_back({0, at.x > pi * radius ? -1.0f : at.x < 0 ? 1.0f : 0.0f, 0});
  world.set_positions(cloth, folded(mesh, radius));
  world.set_velocities(cloth, v);
  std::size_t most = 0;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60);
    most = std::max(most, self_contacts(world));
    EXPECT_EQ(crossings(world), 0u) << frame;
  }
  EXPECT_GT(most, 50u);
}

// Two folded sheets, 3 m apart, whose layers slide over each other: the friction of one is no matter of the other.
TEST(VertexBalls, EachSheetHasItsOwnFriction) {
  const auto positions = [](float friction_of_first) {
    const TriangleMesh mesh = grid(30, 20, 1);
    World world({.gravity = {}});
    std::vector<ObjectId> sheets;
    for (const float friction : {friction_of_first, 0.8f}) {
      ObjectOptions options = with_balls;
      options.transform.translation.z = 3.0 * double(sheets.size());
      const ClothMaterial material{.thickness = 0.005f, .friction = friction};
      const ObjectId sheet = sheets.emplace_back(world.add_cloth(mesh, material, options));
      std::vector<Vec3f> x = folded(mesh, 0.05), v;
      for (Vec3f& at : x) {
        v.push_back(at.y > 0.05f ? Vec3f{0, -1, 0.5f} : Vec3f{0, 1, 0});
        at += Vec3f(options.transform.translation);
      }
      world.set_positions(sheet, x);
      world.set_velocities(sheet, v);
    }
    std::size_t most = 0;
    for (int frame = 0; frame < 10; ++frame) {
      world.step(1.0 / 60);
      most = std::max(most, self_contacts(world));
    }
    EXPECT_GT(most, 20u);
    std::vector<std::vector<Vec3f>> result;
    for (const ObjectId sheet : sheets) {
      const auto x = world.positions(sheet);
      result.emplace_back(x.begin(), x.end());
    }
    return result;
  };
  const auto smooth = positions(0), rough = positions(0.8f);
  EXPECT_NE(smooth[0], rough[0]);
  EXPECT_EQ(smooth[1], rough[1]);
}

// Measured: no crossing at any size from 80 to 125 vertices a side, 10 edges of 67,000 at 150.
TEST(VertexBalls, AHeapHasFewCrossings) {
  World world = falling_sheet(40, SelfCollision::particles);
  World without = falling_sheet(40, SelfCollision::off);
  const ObjectId cloth = world.objects()[0];
  for (int frame = 0; frame < 75; ++frame) {
    world.step(1.0 / 60);
    without.step(1.0 / 60);
  }
  const std::size_t found = world.count_crossings(cloth);
  EXPECT_LE(found, 20u) << "of 4,600 edges";
  EXPECT_GT(without.count_crossings(cloth), 500u);
  EXPECT_EQ(world.report().intersections, 0u) << "none is searched or resolved";
  EXPECT_FALSE(world.report().has(Flag::intersecting));
}

// While it falls: in a flat heap many edges only touch triangles, which may count or not.
TEST(VertexBalls, CrossingsAreCountedAsTheCheckerCountsThem) {
  World world = falling_sheet(20, SelfCollision::off);
  for (int frame = 0; frame < 26; ++frame) world.step(1.0 / 60);
  const ObjectId cloth = world.objects()[0];
  CrossingCounter checker;
  checker.add(world.positions(cloth), world.mesh(cloth).triangles);
  std::size_t edges = 0;
  for (const Edge& edge : unique_edges(checker.triangles))
    if (std::any_of(checker.triangles.begin(), checker.triangles.end(),
                    [&](const Triangle& t) { return checker.passes(edge, t); }))
      ++edges;
  EXPECT_GT(edges, 100u);
  EXPECT_NEAR(static_cast<double>(world.count_crossings(cloth)), static_cast<double>(edges),
              0.06 * static_cast<double>(edges));
}

// A crumpled sheet in free flight: the contacts and the bound on motion leave its momentum as it is.
TEST(VertexBalls, MomentumIsConserved) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  const TriangleMesh mesh = grid(24, 24, 1);
  const ObjectId cloth = world.add_cloth(mesh, {.thickness = 0.005f}, with_balls);
  std::vector<Vec3f> v;
  for (const Vec3d& x : mesh.positions)
    v.push_back(
        {float(3 - 48 * x.x + 60 * x.x * x.x), float(80 * x.x * x.z), float(-48 * x.z)});  // closes in
  world.set_velocities(cloth, v);
  const Vec3d before = world.momentum(cloth);
  std::size_t most = 0;
  for (int frame = 0; frame < 40; ++frame) {
    world.step(1.0 / 60);
    most = std::max(most, self_contacts(world));
  }
  EXPECT_GT(most, 20u);
  EXPECT_LT(length(world.momentum(cloth) - before), 2e-5 * length(before));
}

TEST(VertexBalls, ARestoredSnapshotGoesOnToTheBit) {
  expect_resumes([] { return falling_sheet(24, SelfCollision::particles); }, 40.0 / 60, 10.0 / 60);
}

TEST(VertexBalls, FrictionHoldsLayersOnEachOther) {
  const auto slid = [](float friction) {
    World world({.gravity = {0, -9.81f, 0}});
    const TriangleMesh mesh = grid(24, 12, 1);
    ClothMaterial material{.thickness = 0.005f};
    material.friction = friction;
    const ObjectId cloth = world.add_cloth(mesh, material, with_balls);
    world.add_collider(Plane{.offset = -0.01f}, {.friction = 1});
    const std::vector<Vec3f> x = folded(mesh, 0.035);
    std::vector<Vec3f> v(mesh.positions.size());
    std::size_t corner = 0;
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      if (mesh.positions[k].x > 0.1) v[k] = {0, 0, 0.6f};
      if (mesh.positions[k].x > mesh.positions[corner].x) corner = k;
    }
    world.set_positions(cloth, x);
    world.set_velocities(cloth, v);
    const float z = x[corner].z;
    for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);
    return world.positions(cloth)[corner].z - z;
  };
  EXPECT_LT(slid(0.8f), 0.6f * slid(0));
}

TEST(VertexBalls, APairOfTheNameWithItselfSwitchesThemOff) {
  World world = falling_sheet(16, SelfCollision::particles), off = falling_sheet(16, SelfCollision::off);
  world.set_collide("cloth", "cloth", false);
  for (int frame = 0; frame < 40; ++frame) world.step(1.0 / 60), off.step(1.0 / 60);
  EXPECT_EQ(world.hash(), off.hash());
  EXPECT_EQ(world.self_collision(world.objects()[0]), SelfCollision::particles);
}

TEST(VertexBalls, OnlyObjectsWithTrianglesHaveThem) {
  World world;
  const std::vector<Vec3d> line{{0, 0, 0}, {1, 0, 0}};
  expect_error([&] { world.add_rope(line, 10, {}, with_balls); }, {"self_collision", "particles"});
  const TriangleMesh crate = box({0.1, 0.1, 0.1});
  expect_error([&] { world.add_soft_body(crate, {}, {.cells = 60}, with_balls); },
               {"self_collision", "tets"});
  world.add_soft_body(tet_bar(3, 3, 3, {0.1, 0.1, 0.1}), {}, with_balls);
  EXPECT_TRUE(world.step(1.0 / 60).ok());
}

// Crushed to a point, so that each ball is near all others: a step ends, and nothing is infinite.
TEST(VertexBalls, ACrushedSheetStopsNothing) {
  World world;
  const TriangleMesh mesh = grid(60, 60, 1);
  const ObjectId cloth = world.add_cloth(mesh, {}, with_balls);
  std::vector<Vec3f> x;
  for (const Vec3d& at : mesh.positions) x.push_back(Vec3f(at * 0.01));
  world.set_positions(cloth, x);
  for (int frame = 0; frame < 3; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok());
}

}  // namespace souple::test_world_surface_contacts
