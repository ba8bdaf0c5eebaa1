#include "souple/scene/scene.h"
#include "tests/collision/random.h"
#include "tests/expect_error.h"
#include "tests/paths.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_world_intersections {

// Objects that start with intersections, or are placed into each other, are separated or reported.

constexpr double frame_time = 1.0 / 60;
constexpr float speed_limit = 15;  // m/s

float top_speed(const World& world) {
  float top = 0;
  for (const ObjectId id : world.objects())
    if (world.kind(id) != ObjectKind::obstacle)
      for (const Vec3f& v : world.velocities(id)) {
        EXPECT_TRUE(is_finite(v));
        top = std::max(top, length(v));
      }
  return top;
}

struct History {
  std::size_t at_first = 0, at_last = 0;  // edges through triangles
  int apart_after = -1;                   // frames; -1: never
  bool reported = false;
  float top_speed = 0;  // m/s
};

History simulate(World& world, int frames) {
  History history;
  history.at_first = crossings(world);
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(frame_time);
    EXPECT_TRUE(report.ok()) << report.message;
    EXPECT_EQ(report.has(Flag::intersecting), report.intersections > 0);
    history.reported = history.reported || report.has(Flag::intersecting);
    history.top_speed = std::max(history.top_speed, top_speed(world));
    history.at_last = crossings(world);
    if (history.at_last > 0) history.apart_after = -1;
    if (history.at_last == 0 && history.apart_after < 0) history.apart_after = frame;
  }
  return history;
}

void expect_apart(const History& history) {
  EXPECT_TRUE(history.reported);
  EXPECT_EQ(history.at_last, 0u);
  EXPECT_LT(history.top_speed, speed_limit);
}

Transform upright(double x) {
  return {.translation = {x, 0.013, 0.021}, .rotation = Quatd::from_axis_angle({0, 0, 1}, 1.5707963)};
}

ObjectId add_sheet(World& world, const Transform& transform) {
  return world.add_cloth(grid(15, 15, 1), {.thickness = 0.02f},
                         {.transform = transform, .self_collision = SelfCollision::surfaces});
}

TEST(Intersections, SheetsThatCrossFromSideToSideComeApart) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  add_sheet(world, {});
  add_sheet(world, upright(0.21));
  const Vec3d before = total_momentum(world);
  const History history = simulate(world, 180);
  EXPECT_GT(history.at_first, 10u);
  expect_apart(history);
  EXPECT_LT(length(total_momentum(world) - before), 1e-3 * world.total_mass(world.objects()[0]));
}

TEST(Intersections, BoxesThatOverlapByAThirdComeApart) {
  World world({.gravity = {}});
  const SoftBodyMaterial jelly{.young_modulus = 1e5f, .thickness = 0.01f};
  const ObjectId one = world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly);
  const ObjectId other = world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly, at(0.2, 0.02, 0.03));
  const History history = simulate(world, 180);
  EXPECT_GT(history.at_first, 10u);
  expect_apart(history);
  const double mass = world.total_mass(one);
  EXPECT_LT(length(total_momentum(world)), 1e-3 * mass);
  EXPECT_GT((world.center_of_mass(other) - world.center_of_mass(one)).x, 0.29);
}

void hold_corners(World& world, ObjectId sheet) {
  world.pin(sheet, vertices({0, 14, 210, 224}));
}

// A closed obstacle jumps into a sheet, which is free or pinned at its corners.
History put_into_sheet(const TriangleMesh& mesh, const Vec3d& place, bool free, int frames) {
  World world({.gravity = {0, free ? 0 : -9.81f, 0}});
  const ObjectId sheet = add_sheet(world, {});
  if (!free) hold_corners(world, sheet);
  const ObjectId obstacle = world.add_obstacle(mesh, {.thickness = 0.01f}, {}, at(0, -3, 0));
  for (int frame = 0; frame < 30; ++frame) world.step(frame_time);
  EXPECT_EQ(crossings(world), 0u);
  world.set_motion(obstacle, {.pose = ColliderMotion::fixed({.translation = place + Vec3d{0, 3, 0}})});
  return simulate(world, frames);
}

void expect_left(bool free, double height) {
  const TriangleMesh cube = box({0.4, 0.4, 0.4}, 4), ball = sphere(3, 0.2), ring = torus(0.2, 0.06, 24, 12);
  for (const TriangleMesh& mesh : {cube, ball, ring}) {
    const History history = put_into_sheet(mesh, {0.03, height, 0.02}, free, free ? 60 : 180);
    EXPECT_GT(history.at_first, 10u);
    expect_apart(history);
  }
}

// Particles that an emitter adds touch the sheets while these are being separated.
TEST(Intersections, WaterIsPouredOnSheetsThatCross) {
  World world({.substeps = 4, .threads = 1});
  const ObjectId held = world.add_cloth(grid(8, 8, 0.4));
  world.pin(held, vertices({0, 7, 56, 63}));
  world.add_cloth(grid(8, 8, 0.4), {},
                  {.transform = {{0.003, 0, 0.002}, Quatd::from_axis_angle({0, 0, 1}, 0.2), 1}});
  const ObjectId water = world.add_fluid(std::vector<Vec3d>{}, {.spacing = 0.04f}, {.max_particles = 4000});
  world.add_emitter(water, {.position = {0, 0.25, 0}, .radius = 0.05f, .speed = 2});
  const History history = simulate(world, 15);
  EXPECT_TRUE(history.reported);
  EXPECT_GT(world.positions(water).size(), 20u);
}

TEST(Intersections, ObstaclesPutIntoAFreeSheetAreLeft) {
  expect_left(true, 0.04);
}

TEST(Intersections, ObstaclesInAHeldSheetAreLeftSlow) {
  expect_left(false, -0.03);
}

// The loop of an obstacle's keyframes restarts inside a sheet.
TEST(Intersections, AnObstacleThatJumpsIntoASheetIsLeft) {
  for (const bool sequence : {false, true}) {
    World world;
    const Vec3d away{0, -3, 0};
    ObstacleMotion motion;
    if (sequence) {
      const TriangleMesh ball = sphere(2, 0.15);
      std::vector<Vec3f> here, there;
      for (const Vec3d& x : ball.positions) here.emplace_back(x), there.emplace_back(x + away);
      motion.sequence = {.frames = {here, here, there, there}, .times = {0, 5, 5.5, 6}, .loop = true};
    } else {
      motion.pose =
          ColliderMotion::keyframes({{0, {}, {}}, {5, {}, {}}, {5.5, away, {}}, {6, away, {}}}, true);
    }
    world.add_obstacle(sphere(2, 0.15), {.thickness = 0.01f}, motion);
    for (int frame = 0; frame < 340; ++frame) world.step(frame_time);
    hold_corners(world, add_sheet(world, {.translation = {0.02, 0.01, 0.03}}));
    expect_apart(simulate(world, 200));
  }
}

// An analytic shape has no triangles that could intersect: contacts push out vertices inside it.
// Where a sheet is thrown by single vertices is chance, so that the speed of half of the cases counts.
TEST(Intersections, AColliderThatJumpsIntoASheetIsLeft) {
  std::vector<float> speeds;
  for (const double x : {0.012, 0.014, 0.016, 0.018, 0.02, 0.022, 0.024}) {
    World world;
    const Vec3d away{0, -3, 0};
    ColliderOptions options;
    options.motion =
        ColliderMotion::keyframes({{0, {}, {}}, {3, {}, {}}, {3.5, away, {}}, {4, away, {}}}, true);
    world.add_collider(Sphere{.radius = 0.2f}, options);
    for (int frame = 0; frame < 230; ++frame) world.step(frame_time);
    hold_corners(world, add_sheet(world, {.translation = {x, 0.01, 0.03}}));
    const History history = simulate(world, 150);
    EXPECT_EQ(history.at_last, 0u) << x;
    speeds.push_back(history.top_speed);
    EXPECT_LT(world.step(frame_time).deepest_contact, 0.01) << x;
  }
  std::sort(speeds.begin(), speeds.end());
  EXPECT_LT(speeds[speeds.size() / 2], speed_limit);
  EXPECT_LT(speeds.back(), 3 * speed_limit);
}

TEST(Intersections, ARopeThroughASheetIsDrawnOut) {
  World world({.gravity = {}});
  add_sheet(world, {});
  const std::vector<Vec3d> ends{{0.03, 0.6, 0.02}, {0.05, -0.1, 0.01}};
  const ObjectId rope = world.add_rope(ends, 20, {.radius = 0.01f});
  const StepReport& first = world.step(frame_time);
  EXPECT_EQ(first.intersections, 1u);
  EXPECT_TRUE(first.has(Flag::intersecting));
  EXPECT_NE(first.message.find("1 edge of 'rope' passes through triangles of 'cloth'"), std::string::npos)
      << first.message;
  simulate(world, 180);
  EXPECT_EQ(world.report().intersections, 0u);
  for (const Vec3f& x : world.positions(rope)) EXPECT_GT(x.y, 0.0f);
}

TEST(Intersections, WhatIsHeldIsOnlyReported) {
  World world;
  const ObjectId one = add_sheet(world, {}), other = add_sheet(world, upright(0.21));
  world.pin(one, in_box({-9, -9, -9}, {9, 9, 9}));
  world.pin(other, in_box({-9, -9, -9}, {9, 9, 9}));
  const History history = simulate(world, 60);
  EXPECT_GT(history.at_first, 10u);
  EXPECT_EQ(history.at_last, history.at_first);
  EXPECT_EQ(history.top_speed, 0);
  EXPECT_TRUE(world.report().has(Flag::intersecting));
  EXPECT_NE(world.report().message.find("where nothing can move"), std::string::npos);
}

// A sheet that is folded in two at rest, whose upper half bulges through the lower half.
TEST(Intersections, ABulgeThroughTheOtherHalfOfASheetIsDrawnOut) {
  World world({.gravity = {}});
  ObjectOptions options{.self_collision = SelfCollision::surfaces};
  TriangleMesh mesh = grid(25, 25, 1);
  for (Vec3d& x : mesh.positions) {
    const double r2 = (x.x - 0.25) * (x.x - 0.25) + x.z * x.z;
    const double bulge = 0.09 * std::exp(-r2 / (0.1 * 0.1));
    if (x.x > 0.01) x = {0.02 - x.x, 0.05 - bulge, x.z};
  }
  world.add_cloth(mesh, {.thickness = 0.01f}, options);
  const History history = simulate(world, 180);
  EXPECT_GT(history.at_first, 10u);
  expect_apart(history);
  EXPECT_LT(history.apart_after, 40);  // without intervention it takes twice as long
}

TEST(Intersections, BoxesInOneAnotherOnTheFloorComeApart) {
  World world;
  world.add_collider(Plane{});
  const SoftBodyMaterial jelly{.young_modulus = 1e5f, .thickness = 0.01f};
  for (const double x : {0.0, 0.2, 0.4})
    world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly, at(x, 0.16, 0));
  expect_apart(simulate(world, 240));
}

// Bodies, sheets and obstacles at one position, with random rotations.
TEST(Intersections, WhateverIsThrownTogetherComesApartSlow) {
  test::Random random(3);
  const auto anywhere = [&](double spread) {
    ObjectOptions options;
    const Vec3d axis = normalized(random.point(-1, 1));
    options.transform.rotation = Quatd::from_axis_angle(axis, random.uniform(0, 6.28));
    options.transform.translation = random.point(-spread, spread);
    options.self_collision = SelfCollision::surfaces;
    return options;
  };
  for (int turn = 0; turn < 12; ++turn) {
    World world({.gravity = {0, turn % 2 == 0 ? 0 : -9.81f, 0}});
    if (turn % 2 != 0) world.add_collider(Plane{.offset = -0.8f});
    const int kind = turn / 2 % 3;
    for (int k = 0; kind == 0 && k < 4; ++k)
      world.add_soft_body(tet_bar(4, 3, 3, {0.3, 0.2, 0.25}), {.young_modulus = 1e5f, .thickness = 0.01f},
                          anywhere(0.2));
    for (int k = 0; kind != 0 && k < 3 - kind; ++k)
      world.add_cloth(grid(15, 15, 1), {.thickness = 0.02f}, anywhere(0.2));
    ObjectOptions options = anywhere(0.2);
    options.self_collision = SelfCollision::off;
    if (kind == 2) world.add_obstacle(torus(0.25, 0.07, 24, 10), {.thickness = 0.01f}, {}, options);
    const History history = simulate(world, 200);
    EXPECT_EQ(history.at_last, 0u) << turn;
    EXPECT_LT(history.top_speed, speed_limit) << turn;
  }
}

// Layers of cloth: the higher layer moves outside from any start, and stays there.

// An open tube around Y, counter-clockwise from outside.
TriangleMesh tube(int around, int rows, double radius, double height) {
  TriangleMesh mesh;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * (i + 0.5 * j) / around;
      mesh.positions.push_back(
          {radius * std::cos(angle), height * (double(j) / (rows - 1) - 0.5), radius * std::sin(angle)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * around + i % around); };
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      mesh.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return mesh;
}

struct Dressing {
  std::size_t at_first = 0, at_last = 0;  // edges through triangles; at_last: maximum over the last frames
  float top_speed = 0;                    // m/s
};

Dressing dress(World& world, int frames) {
  constexpr int last_frames = 10;
  Dressing history{.at_first = crossings(world)};
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(frame_time);
    EXPECT_TRUE(report.ok()) << report.message;
    history.top_speed = std::max(history.top_speed, top_speed(world));
    if (frame >= frames - last_frames) history.at_last = std::max(history.at_last, crossings(world));
  }
  return history;
}

// Minimum over all vertices of the outer tube: its distance from the axis minus that of the inner tube. A ray
// from the axis finds the inner tube's triangle at the vertex's angle and height.
float least_clearance(const World& world, ObjectId inner, ObjectId outer) {
  const auto x = world.positions(inner);
  float least = 1;
  for (const Vec3f& p : world.positions(outer)) {
    const Vec3d from{0, static_cast<double>(p.y), 0}, offset = Vec3d(p) - from;
    for (const Triangle& t : world.triangles(inner)) {
      const Vec3d a(x[t[0]]), ab = Vec3d(x[t[1]]) - a, ac = Vec3d(x[t[2]]) - a, n = cross(ab, ac);
      const double speed = dot(offset, n);
      if (!(std::abs(speed) > 1e-12)) continue;
      const double s = dot(a - from, n) / speed;
      const Vec3d hit = from + offset * s - a;
      const double u = dot(cross(hit, ac), n) / dot(n, n), v = dot(cross(ab, hit), n) / dot(n, n);
      if (s <= 0 || u < 0 || v < 0 || u + v > 1) continue;
      least = std::min(least, static_cast<float>((1 - s) * length(offset)));
    }
  }
  return least;
}

const ClothMaterial cotton{.areal_density = 0.2f, .thickness = 0.006f, .damping = 2};

ObjectOptions layer(const char* name, int number, const Transform& placed = {}) {
  ObjectOptions options{.name = name, .transform = placed};
  options.self_collision = SelfCollision::surfaces;
  options.layer = number;
  return options;
}

TriangleMesh turned(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

struct Dressed {
  World world;
  ObjectId shirt{}, coat{};
  float clearance() const { return least_clearance(world, shirt, coat); }
};

// A column and two tubes around it.
Dressed dressed(double shirt_radius, int shirt_layer, const TriangleMesh& coat, const Transform& coat_placed,
                int coat_layer) {
  Dressed d{World({.gravity = {}})};
  d.world.add_obstacle(tube(20, 8, 0.11, 0.7), {.thickness = 0.004f});
  d.shirt = d.world.add_cloth(tube(30, 14, shirt_radius, 0.5), cotton, layer("shirt", shirt_layer));
  d.coat = d.world.add_cloth(coat, cotton, layer("coat", coat_layer, coat_placed));
  return d;
}

void expect_right(const Dressing& history) {
  EXPECT_EQ(history.at_last, 0u);
  EXPECT_LT(history.top_speed, 3);
}

TEST(Layers, ACoatThatBeginsInsideOfTheShirtComesOut) {
  for (const bool inside_out : {false, true}) {
    const TriangleMesh coat = tube(26, 12, 0.155, 0.4);
    Dressed d = dressed(0.165, 1, inside_out ? turned(coat) : coat, {.translation = {0, 0.01, 0}}, 2);
    EXPECT_LT(d.clearance(), -0.008f);
    const Dressing history = dress(d.world, 120);
    EXPECT_EQ(history.at_first, 0u);
    expect_right(history);
    EXPECT_GT(d.clearance(), 0.004f);
    EXPECT_EQ(d.world.report().layer_violations, 0u);
  }
}

TEST(Layers, NothingIsPushedFromOutside) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  const ObjectId shirt = world.add_cloth(tube(24, 10, 0.165, 0.4), cotton, layer("shirt", 1));
  const ObjectId coat =
      world.add_cloth(tube(22, 8, 0.16, 0.3), cotton, layer("coat", 2, {.translation = {0.01, 0.02, 0}}));
  const auto mass = [&] { return world.total_mass(shirt) + world.total_mass(coat); };
  const auto center = [&] {
    return (world.center_of_mass(shirt) * world.total_mass(shirt) +
            world.center_of_mass(coat) * world.total_mass(coat)) /
           mass();
  };
  const Vec3d before = center();
  world.step(frame_time);
  EXPECT_GT(world.report().layer_violations, 100u);
  expect_right(dress(world, 60));
  EXPECT_GT(least_clearance(world, shirt, coat), 0.004f);
  EXPECT_LT(length(world.momentum(shirt) + world.momentum(coat)), 1e-5 * mass());
  EXPECT_LT(length(center() - before), 1e-5);
}

TEST(Layers, WithoutThemItStaysInside) {
  for (const int of_both : {0, 3}) {
    Dressed d = dressed(0.165, of_both, tube(26, 12, 0.155, 0.4), {.translation = {0, 0.01, 0}}, of_both);
    dress(d.world, 60);
    EXPECT_LT(d.clearance(), -0.004f);
  }
}

TEST(Layers, TheLowerOneThatBeginsOutsideGoesIn) {
  Dressed d = dressed(0.165, 7, tube(26, 12, 0.175, 0.4), {.translation = {0, 0.01, 0}}, 2);
  expect_right(dress(d.world, 90));
  EXPECT_GT(least_clearance(d.world, d.coat, d.shirt), 0.004f);
}

TEST(Layers, ACoatHalfSunkIntoTheShirtComesOut) {
  Dressed d = dressed(0.165, 1, tube(26, 12, 0.167, 0.4), {.translation = {0.012, 0.01, 0.007}}, 2);
  const Dressing history = dress(d.world, 90);
  EXPECT_GT(history.at_first, 50u);
  expect_right(history);
  EXPECT_GT(d.clearance(), 0.004f);
}

float least_height(const World& world, ObjectId id) {
  float least = 1;
  for (const Vec3f& x : world.positions(id)) least = std::min(least, x.y);
  return least;
}
float mean_height(const World& world, ObjectId id) {
  return static_cast<float>(world.center_of_mass(id).y);
}

// Three sheets in the wrong order; two of them are coplanar.
TEST(Layers, SheetsOnATableAreSorted) {
  World world;
  world.add_collider(Plane{});
  const auto at = [](double y, double x) { return Transform{.translation = {x, y, 0.5 * x}}; };
  const ObjectId third = world.add_cloth(grid(12, 12, 0.5), cotton, layer("third", 3, at(0.01, 0)));
  const ObjectId second = world.add_cloth(grid(12, 12, 0.5), cotton, layer("second", 2, at(0.03, 0.02)));
  const ObjectId first = world.add_cloth(grid(12, 12, 0.5), cotton, layer("first", 1, at(0.03, 0.02)));
  const Dressing history = dress(world, 120);
  expect_right(history);
  EXPECT_GT(mean_height(world, second), mean_height(world, first) + 0.004f);
  EXPECT_GT(mean_height(world, third), mean_height(world, second) + 0.004f);
  EXPECT_GT(least_height(world, first), -1e-3f);
}

// A sheet that starts deep inside a closed body.
TEST(Layers, ASheetInsideOfABodyComesOut) {
  World world({.gravity = {}});
  const ObjectId body =
      world.add_obstacle(sphere(3, 0.2), {.thickness = 0.004f}, {}, {.name = "body", .layer = 1});
  const ObjectId sheet =
      world.add_cloth(grid(14, 14, 0.3), cotton, layer("sheet", 2, {.translation = {0.01, 0.05, 0.02}}));
  const Dressing history = dress(world, 150);
  expect_right(history);
  float nearest = 1;
  for (const Vec3f& x : world.positions(sheet)) nearest = std::min(nearest, length(x));
  EXPECT_GT(nearest, 0.19f);
  EXPECT_TRUE(world.contains(body));
}

// The upper sheet is sewn to the lower one along a line where the two coincide.
TEST(Layers, WhatIsSewnTogetherIsNotPulled) {
  constexpr double angle = 0.2, half = 0.2;
  World world({.gravity = {}});
  const ObjectId lower = world.add_cloth(grid(10, 10, 2 * half), cotton, layer("lower", 1));
  const Transform raised{.translation = {0, half * std::sin(angle), half * (std::cos(angle) - 1)},
                         .rotation = Quatd::from_axis_angle({1, 0, 0}, -angle)};
  const ObjectId upper = world.add_cloth(grid(10, 10, 2 * half), cotton, layer("upper", 2, raised));
  std::vector<std::pair<VertexRef, VertexRef>> seam;
  for (std::uint32_t i = 0; i < 10; ++i) seam.push_back({{lower, i}, {upper, i}});
  world.connect(seam);
  for (int frame = 0; frame < 20; ++frame) {
    world.step(frame_time);
    EXPECT_EQ(world.report().layer_violations, 0u);
  }
  EXPECT_GT(mean_height(world, upper), mean_height(world, lower) + 0.02f);
}

// The shipped scene, with an independent checker.
TEST(Layers, ATorsoInAShirtAndACoatStaysDressedSlow) {
  World world = build_world(load_scene(source_path("scenes/layers.json")));
  EXPECT_GT(crossings(world), 300u);
  for (int frame = 0; frame < 100; ++frame) {
    world.step(frame_time);
    if (frame >= 10 && frame % 10 == 0) {
      EXPECT_EQ(crossings(world), 0u) << "frame " << frame;
    }
  }
}

// Two sheets in contact whose order changes.
TEST(Layers, TheOrderMayBeGivenLater) {
  World world({.gravity = {}});
  const ObjectId one = world.add_cloth(grid(10, 10, 0.4), cotton, layer("one", 0));
  const ObjectId other =
      world.add_cloth(grid(9, 9, 0.36), cotton, layer("other", 0, {.translation = {0.01, 0.007, 0.02}}));
  const auto above = [&] { return mean_height(world, other) - mean_height(world, one); };
  world.step(frame_time);
  EXPECT_GT(above(), 0.004f);
  world.set_layer(one, 2);
  world.set_layer(other, 1);
  EXPECT_EQ(world.layer(one), 2);
  expect_right(dress(world, 60));
  EXPECT_LT(above(), -0.004f);
}

TEST(Layers, WhatIsNoLayerIsRefused) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(3, 3, 1), {}, layer("sheet", 1000));
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{0, 1, 0}}, {}, {.name = "sand"});
  expect_error([&] { world.add_cloth(grid(3, 3, 1), {}, layer("veil", -1)); },
               {"veil", "layer", "-1", "from 0 to 1000"});
  expect_error([&] { world.set_layer(sheet, 1001); }, {"sheet", "layer", "1001", "from 0 to 1000"});
  expect_error([&] { world.set_layer(grains, 1); }, {"sand", "layer", "its own surface"});
  const TriangleMesh crate = box({1, 1, 1});
  expect_error([&] { world.add_soft_body(crate, {}, {.cells = 10}, layer("jelly", 1)); },
               {"jelly", "layer", "its own surface"});
  EXPECT_EQ(world.layer(sheet), 1000);
  EXPECT_EQ(world.objects().size(), 2u);
}

}  // namespace souple::test_world_intersections
