#include "tests/world/scene.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Nothing changes for an object by what it cannot touch, not even a bit: objects alone, and with a companion 60 m away.

namespace souple::test_world_regions {

constexpr double far = 60;  // m

struct Scene {
  const char* name;
  std::function<std::vector<ObjectId>(World&)> add;
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
          {"soft ball", [](World& world) { return add_ball(world, 1e4f); }},
          {"stiff ball", [](World& world) { return add_ball(world, 1e7f); }},
          {"rope", add_rope},
          {"stack", add_stack},
          {"chain", add_chain}};
}

// --- far

ObjectId tie_box(World& world, double breaking_force) {
  const ObjectId box = add_box(world, {far, 0, 0}),
                 cloth = world.add_cloth(grid(6, 6, 0.4), {}, at(far, 0.5, 0));
  world.pin(cloth, vertices({0, 5}));
  world.add_tie(SurfacePoint{cloth, {30}}, box, {.point = {far, 0.1, 0}, .breaking_force = breaking_force});
  return box;
}

std::vector<Scene> far_scenes() {
  const auto none = [](const auto& add) {
    return [add](World& world) {
      add(world);
      return std::vector<ObjectId>{};
    };
  };
  return {
      {"crossing cloths", none([](World& world) {
         ObjectOptions options = at(far, 0, 0);
         options.self_collision = SelfCollision::surfaces;
         world.add_cloth(grid(9, 9, 0.5), {}, options);
         options.transform.rotation = Quatd::from_axis_angle({1, 0, 0}, 1.2);
         world.add_cloth(grid(9, 9, 0.45), {}, options);
       })},
      {"large cloth", none([](World& world) {
         world.pin(world.add_cloth(grid(25, 25, 1), {}, at(far, 0, 0)), vertices({0}));
       })},
      {"stiff ball", none([](World& world) {
         world.add_soft_body(tet_ball(1, 2, 0.2), {.young_modulus = 1e7f}, at(far, 0, 0));
       })},
      {"grains", none([](World& world) {
         world.add_grains(cube_of_grains({far, 0, 0}, 3), {.radius = 0.02f});
       })},
      {"falling box", none([](World& world) {
         add_box(world, {far, 0, 0});
       })},
      {"tied box", none([](World& world) { tie_box(world, 1e6); })},
      {"torn tie", none([](World& world) { tie_box(world, 1); })},
      {"moving ball", none([](World& world) {
         world.add_collider(Sphere{{}, 0.2f},
                            {.motion = ColliderMotion::callback([](double t) {
                               return Transform{.translation = {far + std::sin(3 * t), 0, 0}};
                             })});
       })},
      {"joint", none([](World& world) {
         world.add_joint(add_box(world, {far, 0, 0}), JointSide{}, joint::Ball{},
                         {.point = {far + 0.1, 0, 0}});
       })},
      {"stack of three", none([](World& world) {
         for (int i = 0; i < 3; ++i)
           world.add_soft_body(box({0.2, 0.2, 0.2}), {.model = SoftBodyModel::shape_matching}, {.cells = 60},
                               at(far, 0.21 * i, 0));
       })},
      {"obstacle", none([](World& world) {
         world.add_obstacle(torus(0.5, 0.2, 24, 12), {},
                            {.pose = ColliderMotion::callback([](double t) {
                               return Transform{.translation = {far, std::sin(t), 0}};
                             })});
       })},
      {"fluid", none([](World& world) {
         world.add_fluid(fill(Vec3d{far, 0, 0}, Vec3d{far + 0.2, 0.2, 0.2}, 0.04), {.spacing = 0.04f});
       })},
      {"emitter", none([](World& world) {
         const ObjectId fluid =
             world.add_fluid(std::vector<Vec3d>{}, {.spacing = 0.04f}, {.max_particles = 2000});
         world.add_emitter(fluid, {.position = {far, 0, 0}, .radius = 0.08f, .speed = 2});
       })},
  };
}

std::vector<Vec3f> run_scene(const Scene& near, const Scene* companion) {
  World world({.threads = 1});
  const std::vector<ObjectId> objects = near.add(world);
  if (companion != nullptr) companion->add(world);
  for (int frame = 0; frame < 45; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << report.message;
  }
  std::vector<Vec3f> positions;
  for (const ObjectId object : objects)
    positions.insert(positions.end(), world.positions(object).begin(), world.positions(object).end());
  return positions;
}

TEST(Regions, WhatIsFarAwayChangesNothing) {
  for (const Scene& near : near_scenes()) {
    const std::vector<Vec3f> alone = run_scene(near, nullptr);
    for (const Scene& companion : far_scenes())
      EXPECT_EQ(run_scene(near, &companion), alone) << near.name << ", " << companion.name;
  }
}

}  // namespace souple::test_world_regions
