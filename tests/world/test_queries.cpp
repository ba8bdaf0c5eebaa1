#include "souple/geometry/closest_point.h"
#include "souple/studies/segment_triangle/choice.h"
#include "tests/collision/random.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_world_queries {

TEST(Queries, ARayHitsTheNearestObject) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(11, 11, 2), {}, at(0, 1, 0));
  const ColliderId floor = world.add_collider(Plane{});
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{5, 0.5, 0}}, {.radius = 0.1f});

  Hit hit = world.ray_cast({0.21f, 3, 0.39f}, {0, -1, 0});
  ASSERT_TRUE(hit.found);
  EXPECT_FALSE(hit.is_collider);
  EXPECT_EQ(hit.object, sheet);
  EXPECT_NEAR(hit.distance, 2, 1e-6);
  EXPECT_EQ(hit.vertex, 7u * 11 + 6);  // the corner at (0.2, 0.4)

  hit = world.ray_cast({3, 3, 0}, {0, -2, 0});
  ASSERT_TRUE(hit.is_collider);
  EXPECT_EQ(hit.collider, floor);
  EXPECT_NEAR(hit.distance, 3, 1e-6);

  hit = world.ray_cast({5, 3, 0}, {0, -1, 0});
  EXPECT_EQ(hit.object, grains);
  EXPECT_NEAR(hit.distance, 2.4, 1e-6);

  EXPECT_FALSE(world.ray_cast({0, 3, 0}, {0, 1, 0}).found);
  EXPECT_FALSE(world.ray_cast({0, 3, 0}, {0, -1, 0}, 1.5).found);
  expect_error([&] { world.ray_cast({0, 0, 0}, {0, 0, 0}); }, {"direction"});
}

TEST(Queries, TheClosestPoint) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(3, 3, 2), {}, at(0, 1, 0));
  Hit hit = world.closest_point({0.3f, 1.5f, 0.2f});
  EXPECT_EQ(hit.object, sheet);
  EXPECT_NEAR(hit.distance, 0.5, 1e-6);
  EXPECT_LT(length(hit.point - Vec3f{0.3f, 1, 0.2f}), 1e-6f);
  hit = world.closest_point({2, 1, 2});
  EXPECT_LT(length(hit.point - Vec3f{1, 1, 1}), 1e-6f);
  EXPECT_EQ(hit.vertex, 8u);
}

TEST(Queries, ContactsAreEvents) {
  World world;
  const Vec3d grain[] = {{0, 0.2, 0}};
  const ObjectId grains = world.add_grains(grain, {.radius = 0.1f, .density = 1000});
  world.add_collider(Plane{}, {.name = "floor"});
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  // At rest a contact is active in most substeps; find such a step.
  for (int i = 0; i < 10 && world.contacts().empty(); ++i) world.step(1.0 / 60);
  ASSERT_EQ(world.contacts().size(), 1u);
  const ContactEvent& event = world.contacts()[0];
  EXPECT_EQ(event.object, "grains");
  EXPECT_EQ(event.other, "floor");
  EXPECT_TRUE(event.other_is_collider);
  EXPECT_LT(length(event.normal - Vec3f{0, 1, 0}), 1e-5f);
  EXPECT_NEAR(event.point.y, 0, 1e-4);
  EXPECT_GT(event.impulse, 0);
  EXPECT_NEAR(world.positions(grains)[0].y, 0.1, 1e-4);
}

// Also before the first step: a rope of one segment, stiffness E pi r^2 / l, at 1.1 times its length.
TEST(Queries, ElasticEnergyNeedsNoStep) {
  World world;
  const Vec3d ends[] = {{0, 0, 0}, {2, 0, 0}};
  const ObjectId rope = world.add_rope(ends, 1, {.radius = 0.1f, .young_modulus = 1e6f});
  world.set_positions(rope, std::vector<Vec3f>{{0, 0, 0}, {2.2f, 0, 0}});
  const double k = 1e6 * pi * 0.01 / 2;
  EXPECT_NEAR(world.elastic_energy(), k * 0.04 / 2, 1e-4 * k);
}

// A cloth far stiffer than one sweep can make it swings down from the horizontal. Its springs seem to store many times
// the energy that it had, but no step can return that.
TEST(Queries, EnergyOfAnUnconvergedClothDoesNotGrow) {
  Settings settings;
  settings.wind.air_density = 0;
  settings.solver.kind = SolverKind::gauss_seidel;
  World world(settings);
  const ObjectId cloth = world.add_cloth(grid(30, 30, 1), {.membrane_stiffness = 1e6f});
  std::vector<std::uint32_t> row(30);
  for (std::uint32_t i = 0; i < 30; ++i) row[i] = i;
  world.pin(cloth, vertices(row));
  const double scale = world.total_mass(cloth) * 9.81;  // the energy of a fall by 1 m; 0 at the start
  double apparent = 0, highest = -1;
  for (int frame = 0; frame < 180; ++frame) {
    world.step(1.0 / 60);
    const double motion = world.kinetic_energy(cloth) + world.potential_energy(cloth);
    const double elastic = world.elastic_energy(), lost = world.unconverged_energy(1.0 / 60);
    EXPECT_GE(lost, 0);
    EXPECT_LE(lost, elastic);
    apparent = std::max(apparent, (motion + elastic) / scale);
    highest = std::max(highest, (motion + elastic - lost) / scale);
  }
  EXPECT_GT(apparent, 100);
  EXPECT_LT(highest, 0.02);
}

// Energy that sweeps can carry, and energy of exactly solved constraints, is complete.
TEST(Queries, EnergyOfConvergedConstraintsIsComplete) {
  World world({.substeps = 30});
  const ObjectId cloth = world.add_cloth(grid(10, 10, 1), {.membrane_stiffness = 10});
  world.pin(cloth, vertices({0, 9}));
  const Vec3d ends[] = {{2, 0, 0}, {3, 0, 0}};
  const ObjectId rope = world.add_rope(ends, 10, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  EXPECT_GT(world.elastic_energy(), 0.01);
  EXPECT_LT(world.unconverged_energy(1.0 / 60), 0.01 * world.elastic_energy());
  world.remove(cloth);
  EXPECT_GT(world.elastic_energy(), 0);
  EXPECT_EQ(world.unconverged_energy(1.0 / 60), 0);
}

// Queries through trees of boxes find what testing every element finds.

constexpr double never = std::numeric_limits<double>::infinity();

/// Calls f(object, element, corners or null, vertex) for everything that a query may see, in order.
template <class OnTriangle, class OnBall>
void for_each_element(const World& world, const OnTriangle& on_triangle, const OnBall& on_ball) {
  for (const ObjectId id : world.objects()) {
    const auto x = world.positions(id);
    const auto faces = world.triangles(id);
    for (std::uint32_t t = 0; t < faces.size(); ++t)
      on_triangle(id, t,
                  Corners<double>{Vec3d(x[faces[t][0]]), Vec3d(x[faces[t][1]]), Vec3d(x[faces[t][2]])});
    if (!faces.empty()) continue;
    for (std::uint32_t v = 0; v < x.size(); ++v)
      on_ball(id, v, Vec3d(x[v]), static_cast<double>(world.particle_radius(id)));
  }
}

struct Found {
  ObjectId object{};
  std::uint32_t element = 0;
  double distance = never;
  void offer(ObjectId id, std::uint32_t of, double at) {
    if (at < distance) *this = {id, of, at};
  }
};

double ray_ball_by_formula(const Vec3d& o, const Vec3d& d, const Vec3d& center, double r) {
  const double along = dot(center - o, d), miss = length(center - o - d * along);
  if (miss > r || along + std::sqrt(r * r - miss * miss) < 0) return never;
  return std::max(along - std::sqrt(r * r - miss * miss), 0.0);
}

Found ray_cast_all_elements(const World& world, const Vec3f& origin, const Vec3f& direction) {
  const Vec3d o(origin), d = normalized(Vec3d(direction));
  Found found;
  for_each_element(
      world,
      [&](ObjectId id, std::uint32_t t, const Corners<double>& f) {
        found.offer(id, t, crossing_test_of(world.settings().segment_test).in_double({o, d, never}, f).t);
      },
      [&](ObjectId id, std::uint32_t v, const Vec3d& x, double r) {
        found.offer(id, v, ray_ball_by_formula(o, d, x, r));
      });
  return found;
}

Found closest_of_all_elements(const World& world, const Vec3f& point) {
  const Vec3d p(point);
  Found found;
  for_each_element(
      world,
      [&](ObjectId id, std::uint32_t t, const Corners<double>& f) {
        const TrianglePoint w = closest_on_triangle(p, f.a, f.b, f.c);
        found.offer(id, t, length(f.a * w.a + f.b * w.b + f.c * w.c - p));
      },
      [&](ObjectId id, std::uint32_t v, const Vec3d& x, double r) {
        found.offer(id, v, std::fabs(length(p - x) - r));
      });
  return found;
}

/// Cloth that crumples on grains, a rope, a soft body and an obstacle.
World crumpled_world() {
  World world({.substeps = 5});
  world.add_cloth(grid(30, 30, 1), {}, {.name = "sheet", .transform = {.translation = {0, 0.6, 0}}});
  std::vector<Vec3d> centers(40);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const std::size_t row = i / 7, column = i % 7;
    centers[i] = {0.12 * static_cast<double>(column) - 0.4, 0.06, 0.12 * static_cast<double>(row) - 0.35};
  }
  world.add_grains(centers, {.radius = 0.05f});
  world.add_rope(std::vector<Vec3d>{{-0.6, 0.9, 0.1}, {0.6, 0.9, -0.1}}, 25, {.radius = 0.02f});
  world.add_soft_body(box({0.2, 0.2, 0.2}), {}, {}, at(0.1, 1.2, 0));
  world.add_obstacle(sphere(2, 0.2f), {}, {}, at(-0.2, 0.2, 0.1));
  world.add_collider(Plane{});
  return world;
}

void expect_found(const Hit& hit, const Found& found, const World& world) {
  ASSERT_EQ(hit.found, found.distance < never);
  if (!hit.found) return;
  EXPECT_EQ(hit.object, found.object);
  EXPECT_EQ(world.triangles(hit.object).empty() ? hit.vertex : hit.triangle, found.element);
  EXPECT_NEAR(hit.distance, found.distance, 1e-12 * (1 + found.distance));
}

TEST(QueryTree, FindsWhatTestingEveryElementFinds) {
  World world = crumpled_world();
  test::Random random(7);
  const QueryFilter objects{.colliders = false};
  int hits = 0;
  for (int frame = 0; frame < 40; ++frame) {
    world.step(1.0 / 60);
    for (int k = 0; k < 20; ++k) {
      const Vec3f origin = Vec3f(random.vector() * 1.5) + Vec3f{0, 0.5f, 0};
      const Vec3f towards = Vec3f(random.vector() * 0.5) + Vec3f{0, 0.4f, 0} - origin;
      const Hit hit = world.ray_cast(origin, towards, 1e30, objects);
      expect_found(hit, ray_cast_all_elements(world, origin, towards), world);
      hits += hit.found ? 1 : 0;
      expect_found(world.closest_point(origin, objects), closest_of_all_elements(world, origin), world);
    }
  }
  EXPECT_GT(hits, 200);
}

// Rays along the axes through the corners of a flat grid, where boxes have no thickness and triangles share corners: the
// first triangle wins.
TEST(QueryTree, TiesGoToTheFirst) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(9, 9, 2));
  world.add_cloth(grid(9, 9, 2));  // the same place
  for (const Vec3f& x : world.positions(sheet)) {
    const Found found = ray_cast_all_elements(world, x + Vec3f{0, 1, 0}, {0, -1, 0});
    ASSERT_EQ(found.object, sheet);
    expect_found(world.ray_cast(x + Vec3f{0, 1, 0}, {0, -1, 0}), found, world);
    expect_found(world.closest_point(x + Vec3f{0, 1, 0}), closest_of_all_elements(world, x + Vec3f{0, 1, 0}),
                 world);
    expect_found(world.ray_cast(x + Vec3f{-5, 0, 0}, {1, 0, 0}),
                 ray_cast_all_elements(world, x + Vec3f{-5, 0, 0}, {1, 0, 0}), world);
  }
  // At exactly the largest distance nothing is hit.
  EXPECT_FALSE(world.ray_cast({0.1f, 1, 0.05f}, {0, -1, 0}, 1).found);
  EXPECT_TRUE(world.ray_cast({0.1f, 1, 0.05f}, {0, -1, 0}, std::nextafter(1.0, 2.0)).found);
}

TEST(QueryTree, FollowsObjectsThatComeAndGo) {
  World world;
  const ObjectId low = world.add_cloth(grid(5, 5, 1));
  EXPECT_EQ(world.ray_cast({0.1f, 3, 0}, {0, -1, 0}).object, low);
  const ObjectId high = world.add_cloth(grid(5, 5, 1), {}, at(0, 1, 0));
  EXPECT_EQ(world.ray_cast({0.1f, 3, 0}, {0, -1, 0}).object, high);
  world.teleport(high, {.translation = {0, -2, 0}});
  EXPECT_EQ(world.ray_cast({0.1f, 3, 0}, {0, -1, 0}).object, low);
  world.remove(low);
  EXPECT_EQ(world.ray_cast({0.1f, 3, 0}, {0, -1, 0}).object, high);
  world.remove(high);
  EXPECT_FALSE(world.ray_cast({0.1f, 3, 0}, {0, -1, 0}).found);
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0, 0, 0}}, {.radius = 0.1f});
  EXPECT_NEAR(world.ray_cast({0, 3, 0}, {0, -1, 0}).distance, 2.9, 1e-6);
  world.set_material(grain, GrainsMaterial{.radius = 0.5f});
  EXPECT_NEAR(world.ray_cast({0, 3, 0}, {0, -1, 0}).distance, 2.5, 1e-6);
}

TEST(QueryTree, Filters) {
  World world;
  const ObjectId sheet =
      world.add_cloth(grid(5, 5, 1), {}, {.transform = {.translation = {0, 2, 0}}, .collision_groups = 2});
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0, 1, 0}}, {.radius = 0.1f});
  const ColliderId floor = world.add_collider(Plane{}, {.collision_groups = 4});
  const auto cast = [&](const QueryFilter& filter) {
    return world.ray_cast({0.02f, 3, 0}, {0, -1, 0}, 1e30, filter);
  };
  EXPECT_EQ(cast({}).object, sheet);
  EXPECT_EQ(cast({.except = {sheet}}).object, grain);
  EXPECT_EQ(cast({.groups = 1}).object, grain);
  EXPECT_EQ(cast({.kinds = kind_bit(ObjectKind::grains) | kind_bit(ObjectKind::rope)}).object, grain);
  EXPECT_EQ(cast({.only = {grain}}).object, grain);
  EXPECT_EQ(cast({.groups = 4}).collider, floor);
  EXPECT_EQ(cast({.objects = false}).collider, floor);
  EXPECT_FALSE(cast({.except_colliders = {floor}, .objects = false}).found);
  EXPECT_FALSE(cast({.only = {grain}, .except = {grain}, .colliders = false}).found);
  EXPECT_EQ(world.closest_point({0, 1.9f, 0}, {.except = {sheet}}).object, grain);
}

TEST(QueryTree, AllHitsAreSorted) {
  World world;
  const Vec3d centers[] = {{0, 1, 0}, {0, 0.5, 0}, {3, 1, 0}};
  const ObjectId grains = world.add_grains(centers, {.radius = 0.1f});
  const ObjectId sheet = world.add_cloth(grid(4, 4, 1), {}, at(0, 0.75, 0));
  const ColliderId floor = world.add_collider(Plane{});
  const std::vector<Hit> hits = world.ray_cast_all({0.05f, 2, 0.02f}, {0, -1, 0});
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_EQ(hits[0].object, grains);
  EXPECT_EQ(hits[0].vertex, 0u);
  EXPECT_EQ(hits[1].object, sheet);
  EXPECT_NEAR(hits[1].distance, 1.25, 1e-6);
  EXPECT_LT(length(hits[1].normal - Vec3f{0, 1, 0}), 1e-6f);
  EXPECT_EQ(hits[2].object, grains);
  EXPECT_EQ(hits[2].vertex, 1u);
  EXPECT_EQ(hits[3].collider, floor);
  EXPECT_NEAR(hits[3].distance, 2, 1e-6);
  EXPECT_EQ(world.ray_cast_all({0.05f, 2, 0.02f}, {0, -1, 0}, 1.3).size(), 2u);
  EXPECT_TRUE(world.ray_cast_all({0.05f, 2, 0.02f}, {0, 1, 0}).empty());
}

/// Distance of a moving ball's center at the first contact, by the distance to everything.
double advance(const World& world, const Vec3f& origin, const Vec3f& direction, double radius) {
  const Vec3d d = normalized(Vec3d(direction));
  double at = 0;
  for (int k = 0; k < 3000 && at < 10; ++k) {
    const double free = closest_of_all_elements(world, Vec3f(Vec3d(origin) + d * at)).distance - radius;
    if (free < 1e-5) return at;
    at += free;
  }
  return never;
}

TEST(QueryTree, ASweptBallStopsAtTheFirstContact) {
  World world;
  world.add_cloth(grid(4, 4, 1), {}, at(0, 0.6, 0));
  world.add_obstacle(sphere(2, 0.3f));
  world.add_grains(std::vector<Vec3d>{{0.7, 0, 0}, {0, 0.2, 0.7}}, {.radius = 0.1f});
  test::Random random(7);
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec3f origin = normalized(Vec3f(random.vector())) * 2.0f;
    const Vec3f towards = Vec3f(random.vector() * 0.6) - origin;
    const Hit hit = world.sphere_cast(origin, 0.15f, towards);
    const double expected = advance(world, origin, towards, static_cast<double>(0.15f));
    if (expected == never && hit.found) {  // grazing: the march gave up
      EXPECT_NEAR(
          closest_of_all_elements(world, origin + normalized(towards) * static_cast<float>(hit.distance))
              .distance,
          0.15, 1e-5);
      continue;
    }
    ASSERT_EQ(hit.found, expected < never) << k;
    if (!hit.found) continue;
    ++hits;
    EXPECT_NEAR(hit.distance, expected, 2e-3) << k;
    const Vec3f center = origin + normalized(towards) * static_cast<float>(hit.distance);
    EXPECT_NEAR(length(center - hit.point), 0.15f, 1e-5) << k;
    EXPECT_NEAR(dot(hit.normal, normalized(center - hit.point)), 1, 1e-3) << k;
  }
  EXPECT_GT(hits, 30);
}

TEST(QueryTree, ASweptBallStopsAtColliders) {
  World world;
  const ColliderId floor = world.add_collider(Plane{});
  Hit hit = world.sphere_cast({0, 10, 0}, 0.25f, {1, -1, 0});
  EXPECT_EQ(hit.collider, floor);
  EXPECT_NEAR(hit.distance, 9.75 * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(hit.point.y, 0, 1e-6);
  EXPECT_FALSE(world.sphere_cast({0, 10, 0}, 0.25f, {1, 0, 0}).found);
  EXPECT_EQ(world.sphere_cast({0, 0.1f, 0}, 0.25f, {0, 1, 0}).distance, 0);  // touches at the start
  const ColliderMotion turned =
      ColliderMotion::keyframes({{0, {0, 5, 0}, Quatd{0.0, 0.0, std::sin(pi / 8), std::cos(pi / 8)}}});
  const ColliderId crate = world.add_collider(Box{.half_extents = {1, 1, 1}}, {.motion = turned});
  hit = world.sphere_cast({0, 10, 0}, 0.25f, {0, -1, 0});
  EXPECT_EQ(hit.collider, crate);
  EXPECT_NEAR(hit.distance, 5 - std::sqrt(2.0) - 0.25, 1e-5);  // its edge is up
  for (const Shape& shape : {Shape(Sphere{.radius = 1}), Shape(Capsule{.radius = 1, .half_height = 2}),
                             Shape(Cylinder{.radius = 1, .half_height = 2})}) {
    World other;
    other.add_collider(shape, {.motion = ColliderMotion::keyframes({{0, {0, 0, 3}}})});
    EXPECT_NEAR(other.sphere_cast({0, 0, 10}, 0.5f, {0, 0, -1}).distance, 5.5, 1e-6);
    EXPECT_NEAR(other.sphere_cast({1, 0, 10}, 0.5f, {0, 0, -1}).distance, 7 - std::sqrt(1.5 * 1.5 - 1), 1e-5);
    EXPECT_FALSE(other.sphere_cast({1.6f, 0, 10}, 0.5f, {0, 0, -1}).found);
    EXPECT_FALSE(other.sphere_cast({0, 0, 10}, 0.5f, {0, 0, -1}, 5).found);
  }
  expect_error([&] { world.sphere_cast({}, 0, {0, 1, 0}); }, {"sphere_cast", "radius"});
}

TEST(QueryTree, OverlapsOfBallsAndBoxes) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(5, 5, 1));  // vertices 0.25 m apart
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{0, 1, 0}, {0.5, 1, 0}}, {.radius = 0.1f});
  const ColliderId floor = world.add_collider(Plane{.offset = -0.5f});
  const ColliderId sensor = world.add_collider(Sphere{.radius = 0.2f}, {.sensor = true});
  std::vector<Overlap> found = world.overlap(Sphere{.center = {0, 0, 0}, .radius = 0.3f});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].object, sheet);
  EXPECT_EQ(found[0].vertices, (std::vector<std::uint32_t>{7, 11, 12, 13, 17}));
  // Between the corners of a triangle, and just above it.
  found = world.overlap(Sphere{.center = {0.1f, 0.04f, 0.04f}, .radius = 0.05f});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].vertices.empty());
  EXPECT_TRUE(world.overlap(Sphere{.center = {0.1f, 0.06f, 0.04f}, .radius = 0.05f}).empty());
  // A box with an edge down reaches the sheet with that edge alone.
  const double turn = pi / 8;
  const Box crate{.half_extents = {0.1f, 0.1f, 0.02f}};
  for (const double above : {0.001, -0.001}) {
    const Transform pose{{0.1, 0.1 * std::sqrt(2.0) + above, 0.06},
                         Quatd{0.0, 0.0, std::sin(turn), std::cos(turn)}};
    EXPECT_EQ(world.overlap(crate, pose).size(), above < 0 ? 1u : 0u);
  }
  // Grains as balls, and the floor.
  found = world.overlap(Box{.center = {0.25f, 0.5f, 0}, .half_extents = {0.2f, 1.2f, 0.2f}}, {},
                        {.except = {sheet}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].object, grains);
  EXPECT_EQ(found[0].vertices, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(found[1].is_collider);
  EXPECT_EQ(found[1].collider, floor);
  found =
      world.overlap(Sphere{.center = {0.3f, 0, 0}, .radius = 0.11f}, {}, {.objects = false, .sensors = true});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].collider, sensor);
  found = world.overlap(Plane{.offset = 0.95f}, {}, {.colliders = false});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].vertices.size(), 25u);
  expect_error([&] { world.overlap(Sphere{.radius = -1}); }, {"overlap", "radius"});
  expect_error([&] { world.overlap(Sphere{}, {.scale = 2}); }, {"overlap", "scale"});
}

}  // namespace souple::test_world_queries
