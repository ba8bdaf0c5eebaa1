#include "tests/world/scene.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Nothing changes for an object by what it cannot touch, not even a bit: objects alone, and with companions 60 m away.

namespace souple::test_world_regions {

constexpr double far = 60;  // m

struct Scene {
  const char* name;
  std::function<std::vector<ObjectId>(World&)> add;
};

struct Companion {
  const char* name;
  std::function<void(World&, const Vec3d& place)> add;
};

ObjectId add_box(World& world, const Vec3d& place) {
  return world.add_rigid_body(small_box, {}, at(place));
}

std::vector<Vec3d> cube_of_grains(const Vec3d& corner, int count) {
  std::vector<Vec3d> centers;
  for (int x = 0; x < count; ++x)
    for (int y = 0; y < count; ++y)
      for (int z = 0; z < count; ++z) centers.push_back(corner + Vec3d{0.041 * x, 0.041 * y, 0.041 * z});
  return centers;
}

// --- near

std::vector<ObjectId> add_curtain(World& world) {
  const ObjectId cloth = world.add_cloth(grid(20, 20, 1));
  world.pin(cloth, vertices({0, 19}));
  return {cloth};
}

std::vector<ObjectId> add_cloth_on_ball(World& world) {
  world.add_collider(Sphere{{0, -0.4f, 0}, 0.3f});
  return {world.add_cloth(grid(16, 16, 1), {}, at(0.02, 0, 0))};
}

std::vector<ObjectId> add_on_cloth(World& world, bool grains) {
  const ObjectId cloth = world.add_cloth(grid(14, 14, 0.8));
  world.pin(cloth, vertices({0, 13, 182, 195}));
  return {cloth, grains ? world.add_grains(cube_of_grains({-0.04, 0.05, -0.04}, 3), {.radius = 0.02f})
                        : add_box(world, {0, 0.12, 0})};
}

std::vector<ObjectId> add_ball(World& world, float young_modulus) {
  world.add_collider(Plane{.offset = -0.25f});
  return {world.add_soft_body(tet_ball(1, 2, 0.2), {.young_modulus = young_modulus})};
}

std::vector<ObjectId> add_rope(World& world) {
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 0}, {1, 0.1, 0}}, 30);
  world.pin(rope, vertices({0}));
  return {rope};
}

std::vector<ObjectId> add_stack(World& world) {
  world.add_collider(Plane{.offset = -0.3f});
  std::vector<ObjectId> boxes;
  for (int i = 0; i < 5; ++i) boxes.push_back(add_box(world, {0.01 * i, -0.19 + 0.21 * i, 0}));
  return boxes;
}

std::vector<ObjectId> add_chain(World& world) {
  std::vector<ObjectId> links;
  for (int i = 0; i < 6; ++i)
    links.push_back(world.add_rigid_body(Box{{}, {0.1f, 0.02f, 0.02f}}, {}, at(0.1 + 0.2 * i, 0, 0)));
  world.add_joint(links[0], JointSide{}, joint::Ball{}, {.point = {0, 0, 0}});
  for (std::size_t i = 1; i < links.size(); ++i)
    world.add_joint(links[i - 1], links[i], joint::Hinge{},
                    {.point = {0.2 * static_cast<double>(i), 0, 0}, .axis = {0, 0, 1}});
  return links;
}

std::vector<Scene> near_scenes() {
  return {{"curtain", add_curtain},
          {"cloth on a ball", add_cloth_on_ball},
          {"box on a cloth", [](World& world) { return add_on_cloth(world, false); }},
          {"grains on a cloth", [](World& world) { return add_on_cloth(world, true); }},
          {"soft ball", [](World& world) { return add_ball(world, 1e4f); }},
          {"stiff ball", [](World& world) { return add_ball(world, 1e7f); }},
          {"rope", add_rope},
          {"stack", add_stack},
          {"chain", add_chain}};
}

// --- far

void tie_box(World& world, const Vec3d& place, double breaking_force) {
  const ObjectId box = add_box(world, place),
                 cloth = world.add_cloth(grid(6, 6, 0.4), {}, at(place + Vec3d{0, 0.5, 0}));
  world.pin(cloth, vertices({0, 5}));
  world.add_tie(SurfacePoint{cloth, {30}}, box,
                {.point = place + Vec3d{0, 0.1, 0}, .breaking_force = breaking_force});
}

void add_crossing_cloths(World& world, const Vec3d& place) {
  ObjectOptions options = at(place);
  options.self_collision = SelfCollision::surfaces;
  world.add_cloth(grid(9, 9, 0.5), {}, options);
  options.transform.rotation = Quatd::from_axis_angle({1, 0, 0}, 1.2);
  world.add_cloth(grid(9, 9, 0.45), {}, options);
}

ColliderMotion swinging(const Vec3d& place) {
  return ColliderMotion::callback([place](double t) {
    return Transform{.translation = place + Vec3d{0, std::sin(3 * t), 0}};
  });
}

std::vector<Companion> companions() {
  return {
      {"crossing cloths", add_crossing_cloths},
      {"large cloth",
       [](World& world, const Vec3d& place) {
         world.pin(world.add_cloth(grid(25, 25, 1), {}, at(place)), vertices({0}));
       }},
      {"stiff ball",
       [](World& world, const Vec3d& place) {
         world.add_soft_body(tet_ball(1, 2, 0.2), {.young_modulus = 1e7f}, at(place));
       }},
      {"grains", [](World& world,
                    const Vec3d& place) { world.add_grains(cube_of_grains(place, 3), {.radius = 0.02f}); }},
      {"falling box", [](World& world, const Vec3d& place) { add_box(world, place); }},
      {"tied box", [](World& world, const Vec3d& place) { tie_box(world, place, 1e6); }},
      {"torn tie", [](World& world, const Vec3d& place) { tie_box(world, place, 1); }},
      {"moving ball",
       [](World& world, const Vec3d& place) {
         world.add_collider(Sphere{{}, 0.2f}, {.motion = swinging(place)});
       }},
      {"joint",
       [](World& world, const Vec3d& place) {
         world.add_joint(add_box(world, place), JointSide{}, joint::Ball{},
                         {.point = place + Vec3d{0.1, 0, 0}});
       }},
      {"stack of three",
       [](World& world, const Vec3d& place) {
         for (int i = 0; i < 3; ++i)
           world.add_soft_body(box({0.2, 0.2, 0.2}), {.model = SoftBodyModel::shape_matching}, {.cells = 60},
                               at(place + Vec3d{0, 0.21 * i, 0}));
       }},
      {"obstacle",
       [](World& world, const Vec3d& place) {
         world.add_obstacle(torus(0.5, 0.2, 24, 12), {}, {.pose = swinging(place)});
       }},
      {"fluid",
       [](World& world, const Vec3d& place) {
         world.add_fluid(fill(place, place + Vec3d{0.2, 0.2, 0.2}, 0.04), {.spacing = 0.04f});
       }},
      {"emitter",
       [](World& world, const Vec3d& place) {
         const ObjectId fluid =
             world.add_fluid(std::vector<Vec3d>{}, {.spacing = 0.04f}, {.max_particles = 2000});
         world.add_emitter(fluid, {.position = Vec3f(place), .radius = 0.08f, .speed = 2});
       }},
  };
}

/// Positions after 0.75 s, or so many frames.
std::vector<Vec3f> run_scene(const Scene& near, const std::function<void(World&)>& add_others,
                             int frames = 45) {
  World world({.threads = 1});
  const std::vector<ObjectId> objects = near.add(world);
  add_others(world);
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << report.message;
  }
  std::vector<Vec3f> positions;
  for (const ObjectId object : objects)
    positions.insert(positions.end(), world.positions(object).begin(), world.positions(object).end());
  return positions;
}

std::vector<Vec3f> run_alone(const Scene& near) {
  return run_scene(near, [](World&) {});
}

// The companions stand in a ring, 29 m apart.
TEST(Regions, WhatIsFarAwayChangesNothing) {
  const auto add_all = [](World& world) {
    double angle = 0;
    for (const Companion& companion : companions()) {
      companion.add(world, {far * std::cos(angle), 0, far * std::sin(angle)});
      angle += 0.483;
    }
  };
  for (const Scene& near : near_scenes()) EXPECT_EQ(run_scene(near, add_all), run_alone(near)) << near.name;
}

ObjectOptions falling_sheet(const Vec3d& place, float speed) {
  ObjectOptions options = at(place);
  options.velocity = {0, -speed, 0};
  options.self_collision = SelfCollision::surfaces;
  return options;
}

// They meet so fast that a search finds more pairs than its budget.
std::vector<ObjectId> add_fast_sheets(World& world, const Vec3d& place, int count) {
  std::vector<ObjectId> sheets;
  for (int i = 0; i < count; ++i)
    sheets.push_back(world.add_cloth(grid(20, 20, 1), {}, falling_sheet(place + Vec3d{0, 0.05 * i, 0}, 80)));
  return sheets;
}

TEST(Regions, BudgetsOfSearchesAreOfThoseThatMeet) {
  const Scene folded{"folded", [](World& world) {
                       ObjectOptions options = falling_sheet({}, 0);
                       options.transform.rotation = Quatd::from_euler_xyz({0.3, 0, 1.4});
                       return std::vector{world.add_cloth(grid(17, 17, 0.5), {}, options)};
                     }};
  const Scene fast{"fast", [](World& world) { return add_fast_sheets(world, {}, 3); }};
  for (const Scene& near : {folded, fast}) {
    const auto run = [&](int others) {
      const auto add_others = [&](World& world) {
        world.add_collider(Plane{.offset = -0.3f});
        add_fast_sheets(world, {far, 0.3, 0}, others);
      };
      return run_scene(near, add_others, 12);
    };
    EXPECT_EQ(run(5), run(0)) << near.name;
  }
}

TEST(Regions, NoCompanionAloneChangesAnythingSlow) {
  for (const Scene& near : near_scenes()) {
    const std::vector<Vec3f> alone = run_alone(near);
    for (const Companion& companion : companions())
      EXPECT_EQ(run_scene(near,
                          [&](World& world) {
                            companion.add(world, {far, 0, 0});
                          }),
                alone)
          << near.name << ", " << companion.name;
  }
}

}  // namespace souple::test_world_regions
