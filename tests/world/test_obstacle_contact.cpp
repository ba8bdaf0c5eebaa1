// Contacts with obstacles: they support, push and stop other objects, and nothing passes through.
#include "souple/geometry/adjacency.h"
#include "souple/souple.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_world_obstacle_contact {

void run(World& world, double seconds, int frame_rate = 60) {
  const int frames = static_cast<int>(std::lround(seconds * frame_rate));
  for (int i = 0; i < frames; ++i) world.step(1.0 / frame_rate);
}

/// Motion along x at a constant speed, from t = 0 on.
ColliderMotion sliding(double speed) {
  return ColliderMotion::callback([=](double t) { return Transform{.translation = {speed * t, 0, 0}}; });
}

ClothMaterial thick_cloth() {
  ClothMaterial material = material::cotton;
  material.thickness = 0.01f;
  return material;
}

double volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(b - a, cross(c - a, d - a));
}

bool crosses(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  if ((volume(a, b, c, p) > 0) == (volume(a, b, c, q) > 0)) return false;
  const bool side = volume(p, q, a, b) > 0;
  return side == (volume(p, q, b, c) > 0) && side == (volume(p, q, c, a) > 0);
}

/// Number of edges of either object that pass through triangles of the other.
int crossings(const World& world, ObjectId one, ObjectId other) {
  int count = 0;
  for (int turn = 0; turn < 2; ++turn, std::swap(one, other)) {
    const auto x = world.positions(one), y = world.positions(other);
    for (const Edge& edge : unique_edges(world.mesh(one).triangles))
      for (const Triangle& t : world.triangles(other))
        count +=
            crosses(Vec3d(x[edge[0]]), Vec3d(x[edge[1]]), Vec3d(y[t[0]]), Vec3d(y[t[1]]), Vec3d(y[t[2]]));
  }
  return count;
}

TEST(ObstacleContact, AGrainRestsOnAStaticMesh) {
  for (const double far : {0.0, 1000.0}) {
    World world;
    const Vec3d place{far, far / 2, -far};
    world.add_obstacle(grid(4, 4, 2), {.thickness = 0.01f}, {}, {.transform = {.translation = place}});
    const Vec3d start[] = {Vec3d{0.1, 0.2, 0.15} + place};
    const ObjectId grain = world.add_grains(start, {.radius = 0.05f});
    run(world, 1.5);
    EXPECT_NEAR(world.center_of_mass(grain).y - place.y, 0.055, 5e-4) << far;
    EXPECT_LT(length(world.velocities(grain)[0]), 1e-3f);
    ASSERT_FALSE(world.contacts().empty());
    const ContactEvent& contact = world.contacts()[0];
    EXPECT_FALSE(contact.other_is_collider);
    EXPECT_TRUE(contact.object == "obstacle" || contact.other == "obstacle");
    const double weight = world.total_mass(grain) * 9.81;
    double impulse = 0;
    for (const ContactEvent& event : world.contacts()) impulse += static_cast<double>(event.impulse);
    EXPECT_NEAR(impulse * 600, weight, 0.05 * weight);  // impulse of one substep
  }
}

TEST(ObstacleContact, AClothRestsOnAStaticMesh) {
  World world;
  world.add_obstacle(box({1, 1, 1}, 1), {.thickness = 0.01f});
  const ObjectId cloth =
      world.add_cloth(grid(11, 11, 0.8), thick_cloth(), {.transform = {.translation = {0.02, 0.6, 0.01}}});
  run(world, 1.5);
  for (const Vec3f& x : world.positions(cloth)) EXPECT_NEAR(x.y, 0.51f, 1e-3f);
  EXPECT_LT(world.kinetic_energy(cloth), 1e-6);
  EXPECT_EQ(world.report().flags, 0u);
}

TEST(ObstacleContact, AMovingMeshCarriesACloth) {
  World world;
  ClothMaterial material = thick_cloth();
  material.friction = 0.8f;
  world.add_obstacle(box({3, 0.2, 2}, 2), {.thickness = 0.01f, .friction = 0.8f}, {.pose = sliding(0.5)});
  const ObjectId cloth =
      world.add_cloth(grid(11, 11, 0.8), material, {.transform = {.translation = {0, 0.111, 0}}});
  run(world, 2);
  // It slides until friction has accelerated it to the speed of the mesh: v^2 / (2 mu g) behind.
  EXPECT_NEAR(world.center_of_mass(cloth).x, 1 - 0.25 / (2 * 0.8 * 9.81), 3e-3);
  for (const Vec3f& v : world.velocities(cloth)) EXPECT_NEAR(v.x, 0.5f, 0.005f);
}

TEST(ObstacleContact, AGrainBouncesOffWithTwiceTheSpeed) {
  for (const double far : {0.0, 500.0}) {
    World world({.gravity = {0, 0, 0}});
    const Transform upright{.translation = {far, far, 0},
                            .rotation = Quatd::from_axis_angle({0, 0, 1}, -pi / 2)};
    world.add_obstacle(grid(3, 3, 1), {.friction = 0, .restitution = 1}, {.pose = sliding(2)},
                       {.transform = upright});
    const Vec3d start[] = {{far + 0.3, far + 0.1, 0.05}};
    const ObjectId grain = world.add_grains(start, {.radius = 0.02f, .restitution = 1});
    run(world, 0.5);
    EXPECT_NEAR(world.velocities(grain)[0].x, 4, 0.04) << far;
    EXPECT_NEAR(world.velocities(grain)[0].y, 0, 0.04);
  }
}

TEST(ObstacleContact, AWallPushesABallOfClothWithoutPassing) {
  for (const double speed : {0.5, 5.0}) {
    World world;
    const Transform upright{.rotation = Quatd::from_axis_angle({0, 0, 1}, -pi / 2)};
    world.add_obstacle(grid(6, 6, 2), {.thickness = 0.01f}, {.pose = sliding(speed)}, {.transform = upright});
    world.add_collider(Plane{.offset = -0.3f}, {.friction = 0.2f});
    const ObjectId ball =
        world.add_cloth(sphere(2, 0.25), thick_cloth(), {.transform = {.translation = {0.35, 0, 0}}});
    world.set_enclosed_volume(ball, 1);
    for (int frame = 1; frame <= 60; ++frame) {
      world.step(1.0 / 60);
      const double wall = speed * frame / 60;
      for (const Vec3f& x : world.positions(ball)) ASSERT_GT(x.x, wall) << speed << " m/s, frame " << frame;
    }
    // It moves with the wall or ahead of it.
    EXPECT_GT(world.center_of_mass(ball).x, speed + 0.15);
    EXPECT_EQ(world.report().flags, 0u) << world.report().message;
  }
}

TEST(ObstacleContact, NothingPassesABallThatFliesIntoACloth) {
  for (const double speed : {2.0, 20.0}) {
    World world({.gravity = {0, 0, 0}});
    const ObjectId ball = world.add_obstacle(sphere(2, 0.2), {.thickness = 0.01f},
                                             {.pose = ColliderMotion::callback([=](double t) {
                                                return Transform{.translation = {0, speed * t, 0}};
                                              })},
                                             {.transform = {.translation = {0.01, -0.3, 0.02}}});
    const ObjectId cloth = world.add_cloth(grid(15, 15, 1), thick_cloth());
    for (double t = 0; t < 0.1 + 0.6 / speed; t += 1.0 / 60) {
      world.step(1.0 / 60);
      ASSERT_EQ(crossings(world, ball, cloth), 0) << speed << " m/s, " << t << " s";
    }
    EXPECT_GT(world.center_of_mass(cloth).y, 0.1);
  }
}

TEST(ObstacleContact, NothingPassesAPaddleThatTurnsInACloth) {
  World world;
  world.add_collider(Plane{});
  const auto turning = ColliderMotion::callback([](double t) {
    return Transform{.translation = {0, 0.2, 0}, .rotation = Quatd::from_axis_angle({0, 1, 0}, 9 * t)};
  });
  const ObjectId paddle = world.add_obstacle(box({1, 0.3, 0.1}, 2), {.thickness = 0.01f}, {.pose = turning});
  const ObjectId cloth =
      world.add_cloth(grid(15, 15, 1), thick_cloth(), {.transform = {.translation = {0.1, 0.38, 0}}});
  for (int frame = 0; frame < 45; ++frame) {
    world.step(1.0 / 60);
    ASSERT_EQ(crossings(world, paddle, cloth), 0) << frame;
  }
}

}  // namespace souple::test_world_obstacle_contact
