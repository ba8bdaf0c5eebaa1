#include "souple/geometry/adjacency.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

namespace souple::test_world_obstacles {

// Obstacles: positions and velocities of their motion, and operations that they refuse.

ColliderMotion spinning(double turns_per_second) {
  return ColliderMotion::callback([=](double t) {
    return Transform{.rotation = Quatd::from_axis_angle({0, 1, 0}, 2 * pi * turns_per_second * t)};
  });
}

/// A sphere whose radius oscillates once per second by the fraction `part`.
MeshSequence breathing(const TriangleMesh& mesh, double part, double frame_rate) {
  MeshSequence sequence{.frame_rate = frame_rate, .loop = true};
  for (int frame = 0; frame <= static_cast<int>(frame_rate); ++frame) {
    const double size = 1 - part * (1 - std::cos(2 * pi * frame / frame_rate)) / 2;
    std::vector<Vec3f>& x = sequence.frames.emplace_back();
    for (const Vec3d& vertex : mesh.positions) x.push_back(Vec3f(vertex * size));
  }
  sequence.frames.back() = sequence.frames.front();
  return sequence;
}

TEST(Obstacles, AStaticOneStandsStill) {
  World world;
  const TriangleMesh mesh = torus(0.5, 0.2, 12, 8);
  const ObjectId ring =
      world.add_obstacle(mesh, {}, {}, {.transform = {.translation = {0.1, 1.3, 0}, .scale = 2}});
  EXPECT_EQ(world.kind(ring), ObjectKind::obstacle);
  EXPECT_EQ(world.name(ring), "obstacle");
  const std::vector<Vec3f> before(world.positions(ring).begin(), world.positions(ring).end());
  EXPECT_LT(length(Vec3d(before[3]) - (mesh.positions[3] * 2 + Vec3d{0.1, 1.3, 0})), 1e-6);
  for (int i = 0; i < 20; ++i) world.step(1.0 / 60);
  for (std::size_t v = 0; v < before.size(); ++v) {
    EXPECT_EQ(world.positions(ring)[v], before[v]);
    EXPECT_EQ(world.velocities(ring)[v], Vec3f());
  }
  EXPECT_EQ(world.total_mass(ring), 0);
  EXPECT_EQ(world.kinetic_energy(ring), 0);
  EXPECT_LT(length(world.center_of_mass(ring) - Vec3d{0.1, 1.3, 0}), 1e-6);
  EXPECT_TRUE(world.pinned(ring).empty());
  EXPECT_EQ(world.report().flags, 0u);
}

TEST(Obstacles, APoseIsFollowed) {
  World world;
  const TriangleMesh mesh = box({1, 1, 1}, 2);
  const Transform placement{.translation = {1, 0, 0}};
  const ObjectId block = world.add_obstacle(mesh, {}, {.pose = spinning(0.5)}, {.transform = placement});
  for (int i = 1; i <= 30; ++i) {
    world.step(1.0 / 60);
    const Quatd turn = Quatd::from_axis_angle({0, 1, 0}, pi * i / 60);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3d wanted = rotate(turn, mesh.positions[v] + Vec3d{1, 0, 0});
      ASSERT_LT(length(Vec3d(world.positions(block)[v]) - wanted), 1e-6);
      const Vec3d speed = cross(Vec3d{0, pi, 0}, wanted);
      ASSERT_LT(length(Vec3d(world.velocities(block)[v]) - speed), 0.01 * length(speed));
    }
  }
}

TEST(Obstacles, ASequenceIsFollowedBetweenItsFrames) {
  const TriangleMesh mesh = sphere(2, 0.5);
  World world;
  const ObjectId ball = world.add_obstacle(
      mesh, {},
      {.pose = ColliderMotion::fixed({.translation = {0, 3, 0}}), .sequence = breathing(mesh, 0.4, 10)},
      {.transform = {.scale = 2}});
  for (int i = 1; i <= 150; ++i) {
    world.step(1.0 / 60);
    const double t = std::fmod(i / 60.0, 1), frame = std::floor(t * 10 + 1e-9);
    const auto size = [](double k) { return 1 - 0.2 * (1 - std::cos(2 * pi * k / 10)); };
    const double now = size(frame) + (size(frame + 1) - size(frame)) * (t * 10 - frame);
    for (std::size_t v = 0; v < mesh.positions.size(); v += 17)
      ASSERT_LT(length(Vec3d(world.positions(ball)[v]) - (mesh.positions[v] * 2 * now + Vec3d{0, 3, 0})),
                2e-6)
          << i;
    const double speed = (size(frame + 1) - size(frame)) * 10;
    const bool between = t * 10 - frame > 0.05;  // the speed changes at a frame
    if (between) {
      ASSERT_NEAR(length(Vec3d(world.velocities(ball)[5])), std::fabs(speed), 0.01 * std::fabs(speed) + 1e-4);
    }
  }
}

TEST(Obstacles, ASequenceIsClampedAtItsEndsAndHasItsOwnTimes) {
  const TriangleMesh mesh = grid(2, 2, 1);
  MeshSequence sequence{.times = {0, 0.5, 0.6}, .start_time = 0.1};
  for (const float y : {1.0f, 2.0f, 5.0f}) {
    std::vector<Vec3f>& frame = sequence.frames.emplace_back();
    for (const Vec3d& x : mesh.positions) frame.push_back(Vec3f(x) + Vec3f{0, y, 0});
  }
  World world;
  const ObjectId plate = world.add_obstacle(mesh, {}, {.sequence = sequence});
  EXPECT_FLOAT_EQ(world.positions(plate)[0].y, 1);
  const auto height_after = [&](double dt) {
    world.step(dt);
    return world.positions(plate)[0].y;
  };
  EXPECT_NEAR(height_after(0.05), 1, 1e-6);    // not started
  EXPECT_NEAR(height_after(0.30), 1.5, 1e-5);  // 0.35 s: halfway between the first two frames
  EXPECT_NEAR(height_after(0.30), 3.5, 1e-4);  // 0.65 s: halfway between the last two frames
  EXPECT_NEAR(height_after(0.20), 5, 1e-5);    // finished
  EXPECT_NEAR(height_after(0.20), 5, 1e-5);
  EXPECT_EQ(world.velocities(plate)[0], Vec3f());
}

TEST(Obstacles, ALoopThatStartsOverHasNoVelocityOfTheJump) {
  MeshSequence sequence{.frame_rate = 10, .loop = true};
  const TriangleMesh mesh = grid(2, 2, 1);
  for (int k = 0; k < 3; ++k) {
    std::vector<Vec3f>& frame = sequence.frames.emplace_back();
    for (const Vec3d& x : mesh.positions)
      frame.push_back(Vec3f(x) + Vec3f{0, 0.1f * static_cast<float>(k), 0});
  }
  const std::vector<PoseKey> keys{{0, {0, 0, 0}}, {0.2, {0, 0.2, 0}}};
  for (const bool by_keys : {false, true}) {
    World world({.substeps = 1});
    ObstacleMotion motion;
    if (by_keys) {
      motion.pose = ColliderMotion::keyframes(keys, true);
    } else {
      motion.sequence = sequence;
    }
    const ObjectId plate = world.add_obstacle(mesh, {}, motion);
    for (int i = 1; i <= 90; ++i) {
      world.step(1.0 / 97);
      ASSERT_NEAR(world.positions(plate)[0].y, std::fmod(i / 97.0, 0.2), 1e-5);
      ASSERT_LT(length(world.velocities(plate)[0]), 1.02f);
    }
  }
}

TEST(Obstacles, CachesKeepTheUsersVertices) {
  // Two triangles with an edge that they share by position only; the welded mesh has four particles.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {3, 4, 5}};
  MeshSequence sequence{.frame_rate = 1};
  for (const float y : {0.0f, 1.0f}) {
    std::vector<Vec3f>& frame = sequence.frames.emplace_back();
    for (const Vec3d& x : mesh.positions)
      frame.push_back(Vec3f(x) + Vec3f{0, y * static_cast<float>(x.x), 0});
  }
  World world;
  const ObjectId plate = world.add_obstacle(mesh, {}, {.sequence = sequence});
  world.step(0.5);
  ASSERT_EQ(world.positions(plate).size(), 6u);
  EXPECT_EQ(world.particle(plate, 1), world.particle(plate, 3));
  for (std::size_t v = 0; v < 6; ++v) {
    EXPECT_NEAR(world.positions(plate)[v].y, 0.5 * mesh.positions[v].x, 1e-6);
    EXPECT_NEAR(world.velocities(plate)[v].y, mesh.positions[v].x, 1e-4);
  }
}

TEST(Obstacles, SnapshotsContinueToTheBit) {
  const auto build = [] {
    World world;
    const TriangleMesh mesh = sphere(1, 0.5);
    world.add_obstacle(mesh, {}, {.pose = spinning(0.3), .sequence = breathing(mesh, 0.2, 24)});
    world.add_cloth(grid(9, 9, 1.2), {}, at(0, 0.6, 0));
    return world;
  };
  expect_resumes(build, 20.0 / 60, 10.0 / 60);
}

// An obstacle that stood still in the last step is left out of most of the next one, unless something changed.
TEST(Obstacles, WhatStandsStillIsLeftOutToTheBit) {
  const auto make = [] {
    auto world = std::make_unique<World>();
    world->add_obstacle(sphere(2, 0.3));
    world->add_obstacle(sphere(2, 0.3), {}, {}, at(5, 0, 0));
    world->add_cloth(grid(17, 17, 1), {}, at(0.05, 0.35, 0));
    world->add_grains(std::vector<Vec3d>{{0, 0.6, 0}, {0.05, 0.6, 0}});
    return world;
  };
  const auto still = make(), changed = make();
  for (int frame = 0; frame < 60; ++frame) {
    changed->restore(changed->snapshot());
    still->step(1.0 / 60), changed->step(1.0 / 60);
    ASSERT_EQ(still->hash(), changed->hash()) << "frame " << frame;
  }
  EXPECT_GT(still->report().contacts, 0u);
}

TEST(Obstacles, ANewMotionHoldsAtOnce) {
  World world;
  const ObjectId plate = world.add_obstacle(grid(3, 3, 1));
  world.step(0.1);
  const std::uint64_t before = world.version();
  world.set_motion(plate, {.pose = ColliderMotion::fixed({.translation = {0, 2, 0}})});
  EXPECT_NE(world.version(), before);
  EXPECT_EQ(world.positions(plate)[0].y, 2);
  world.step(0.1);
  EXPECT_EQ(world.positions(plate)[0].y, 2);
  EXPECT_EQ(world.velocities(plate)[0], Vec3f());
  EXPECT_EQ(world.motion(plate).pose.keys().size(), 1u);
  world.set_material(plate, ObstacleMaterial{.thickness = 0.1f});
  EXPECT_EQ(world.particle_radius(plate), 0.05f);
}

TEST(Obstacles, RaysMeasuresAndLinesSeeThem) {
  World world;
  const ObjectId ball = world.add_obstacle(sphere(3, 1), {}, {}, at(0, 5, 0));
  const Hit hit = world.ray_cast({0, 0, 0}, {0, 1, 0});
  ASSERT_TRUE(hit.found);
  EXPECT_EQ(hit.object, ball);
  EXPECT_NEAR(hit.distance, 4, 0.02);
  MeshSequence sequence = breathing(sphere(3, 1), 0.1, 10);
  const std::size_t of_frames = sequence.frames.size() * sequence.frames[0].size() * sizeof(Vec3f);
  const std::size_t without = MemoryReport::total(world.memory().objects);
  world.set_motion(ball, {.sequence = std::move(sequence)});
  EXPECT_GE(MemoryReport::total(world.memory().objects), without + of_frames);
  std::size_t particles = 0;
  DebugDraw draw;
  draw.particle = [&](const DebugParticle&) { ++particles; };
  world.debug_draw(draw);
  EXPECT_EQ(particles, world.positions(ball).size());
  world.remove(ball);
  EXPECT_FALSE(world.ray_cast({0, 0, 0}, {0, 1, 0}).found);
  world.step(0.1);
}

TEST(Obstacles, WhatMakesNoSenseIsSaid) {
  World world;
  const ObjectId plate = world.add_obstacle(grid(3, 3, 1));
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  const std::vector<Vec3f> nine(9);
  const std::string hint = "set_motion";
  expect_error([&] { world.pin(plate, all()); }, {"pin", "obstacle", hint});
  expect_error([&] { world.unpin(plate, all()); }, {"unpin", hint});
  expect_error([&] { world.attach(plate, all()); }, {"attach", hint});
  expect_error([&] { world.add_tethers(plate); }, {"add_tethers", hint});
  expect_error([&] { world.set_positions(plate, nine); }, {"set_positions", hint});
  expect_error([&] { world.set_velocities(plate, nine); }, {"set_velocities", hint});
  expect_error([&] { world.teleport(plate, {}); }, {"teleport", hint});
  expect_error([&] { world.apply_impulse(plate, all(), {0, 1, 0}); }, {"apply_impulse", hint});
  expect_error([&] { world.set_pressure(plate, 10); }, {"obstacle", "cloth"});
  expect_error([&] { world.set_motion(cloth, {}); }, {"cloth", "expected an obstacle"});
  expect_error([&] { world.set_material(plate, ClothMaterial{}); }, {"obstacle"});
  const TriangleMesh mesh = grid(3, 3, 1);
  expect_error([&] { world.add_obstacle(mesh, {}, {}, {.velocity = {1, 0, 0}}); }, {"velocity", "motion"});
  expect_error([&] { world.add_obstacle(mesh, {}, {}, {.self_collision = SelfCollision::surfaces}); },
               {"self_collision"});
  expect_error([&] { world.add_obstacle(mesh, {.friction = -1}); }, {"friction", "-1"});
  TriangleMesh point;
  point.positions = {{0, 0, 0}};
  expect_error([&] { world.add_obstacle(point); }, {"no triangles"});
  MeshSequence short_one{.frames = {std::vector<Vec3f>(9), std::vector<Vec3f>(8)}};
  expect_error([&] { world.add_obstacle(mesh, {}, {.sequence = short_one}); },
               {"8 vertices", "frame 1", "9"});
  short_one.frames[1].assign(9, {0, std::nanf(""), 0});
  expect_error([&] { world.add_obstacle(mesh, {}, {.sequence = short_one}); }, {"finite", "frame 1"});
  short_one.frames[1].assign(9, {});
  short_one.times = {0, 0};
  expect_error([&] { world.set_motion(plate, {.sequence = short_one}); }, {"frame 1", "not later"});
  const auto throws = ColliderMotion::callback([](double) -> Transform { throw Error("no pose"); });
  expect_error([&] { world.set_motion(plate, {.pose = throws}); }, {"no pose"});
  EXPECT_EQ(world.objects().size(), 2u);
  world.step(0.1);
  EXPECT_EQ(world.positions(plate)[0].y, 0);
  EXPECT_EQ(world.report().flags, 0u);
}

TEST(Obstacles, AMotionThatThrowsIsReportedAndStandsStill) {
  World world;
  const auto fails_later = ColliderMotion::callback([](double t) {
    if (t > 0.1) throw Error("the tape is torn");
    return Transform{.translation = {t, 0, 0}};
  });
  const ObjectId plate = world.add_obstacle(grid(3, 3, 1), {}, {.pose = fails_later});
  world.step(0.05);
  const float before = world.positions(plate)[0].x;
  world.step(0.2);
  EXPECT_NE(world.report().message.find("the tape is torn"), std::string::npos);
  EXPECT_GT(world.positions(plate)[0].x, before);
  const float last = world.positions(plate)[0].x;
  world.step(0.2);
  EXPECT_EQ(world.positions(plate)[0].x, last);
}

// Contacts with obstacles: they support, push and stop other objects, and nothing passes through.

/// Motion along x at a constant speed, from t = 0 on.
ColliderMotion sliding(double speed) {
  return ColliderMotion::callback([=](double t) { return Transform{.translation = {speed * t, 0, 0}}; });
}

/// Number of edges of either object that pass through triangles of the other.
int crossings(const World& world, ObjectId one, ObjectId other) {
  test::CrossingCounter both;
  for (const ObjectId id : {one, other}) both.add(world.positions(id), world.triangles(id));
  const std::size_t of_one = world.positions(one).size();
  int count = 0;
  for (const Edge& edge : unique_edges(both.triangles))
    for (const Triangle& t : both.triangles)
      if ((edge[0] < of_one) != (t[0] < of_one)) count += both.passes(edge, t) ? 1 : 0;
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
  const ObjectId cloth = world.add_cloth(grid(11, 11, 0.8), thick_cloth(), at(0.02, 0.6, 0.01));
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
  const ObjectId cloth = world.add_cloth(grid(11, 11, 0.8), material, at(0, 0.111, 0));
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
    World world({.wind = {.air_density = 0}});
    const Transform upright{.rotation = Quatd::from_axis_angle({0, 0, 1}, -pi / 2)};
    world.add_obstacle(grid(6, 6, 2), {.thickness = 0.01f}, {.pose = sliding(speed)}, {.transform = upright});
    world.add_collider(Plane{.offset = -0.3f}, {.friction = 0.2f});
    const ObjectId ball = world.add_cloth(sphere(2, 0.25), thick_cloth(), at(0.35, 0, 0));
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
                                             at(0.01, -0.3, 0.02));
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
  const ObjectId cloth = world.add_cloth(grid(15, 15, 1), thick_cloth(), at(0.1, 0.38, 0));
  for (int frame = 0; frame < 45; ++frame) {
    world.step(1.0 / 60);
    ASSERT_EQ(crossings(world, paddle, cloth), 0) << frame;
  }
}

}  // namespace souple::test_world_obstacles
