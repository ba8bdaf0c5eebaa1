// Objects that start with intersections, or are placed into each other, are separated or reported.
#include "souple/geometry/builders.h"
#include "souple/world/world.h"
#include "tests/collision/random.h"
#include "tests/intersections/crossings.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace souple::test_world_intersections {

constexpr double frame_time = 1.0 / 60;
constexpr float speed_limit = 15;  // m/s

std::size_t crossings(const World& world) {
  test::CrossingCounter counter;
  for (const ObjectId id : world.objects()) counter.add(world.positions(id), world.mesh(id).triangles);
  return counter.crossings();
}

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

Vec3d total_momentum(const World& world) {
  Vec3d sum;
  for (const ObjectId id : world.objects()) sum += world.momentum(id);
  return sum;
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
  ObjectOptions options;
  options.transform = transform;
  options.self_collision = SelfCollision::surfaces;
  return world.add_cloth(grid(15, 15, 1), {.thickness = 0.02f}, options);
}

TEST(Intersections, SheetsThatCrossFromSideToSideComeApart) {
  World world({.gravity = {}});
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
  ObjectOptions beside;
  beside.transform.translation = {0.2, 0.02, 0.03};
  const SoftBodyMaterial jelly{.young_modulus = 1e5f, .thickness = 0.01f};
  const ObjectId one = world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly);
  const ObjectId other = world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly, beside);
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
History put_into_sheet(const TriangleMesh& mesh, const Vec3d& at, bool free, int frames) {
  World world({.gravity = {0, free ? 0 : -9.81f, 0}});
  const ObjectId sheet = add_sheet(world, {});
  if (!free) hold_corners(world, sheet);
  ObjectOptions away;
  away.transform.translation = {0, -3, 0};
  const ObjectId obstacle = world.add_obstacle(mesh, {.thickness = 0.01f}, {}, away);
  for (int frame = 0; frame < 30; ++frame) world.step(frame_time);
  EXPECT_EQ(crossings(world), 0u);
  world.set_motion(obstacle, {.pose = ColliderMotion::fixed({.translation = at + Vec3d{0, 3, 0}})});
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
  ObjectOptions options;
  options.self_collision = SelfCollision::surfaces;
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
  for (const double x : {0.0, 0.2, 0.4}) {
    ObjectOptions options;
    options.transform.translation = {x, 0.16, 0};
    world.add_soft_body(tet_bar(4, 4, 4, {0.3, 0.3, 0.3}), jelly, options);
  }
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

}  // namespace souple::test_world_intersections
