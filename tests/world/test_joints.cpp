#include "souple/math/limits.h"
#include "souple/scene/scene.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_joints {

const Box brick{{}, {0.1f, 0.05f, 0.05f}};  // half extents

/// A chain of `count` bricks along x, hung by its first end from the origin, with a ball at the other end.
struct Chain {
  std::vector<JointId> joints;
  ObjectId ball;
};
Chain hang_chain(World& world, int count, float ball_density) {
  Chain chain;
  JointSide before;
  for (int i = 0; i < count; ++i) {
    const double x = 0.1 + 0.2 * i;
    const ObjectId link = world.add_rigid_body(brick, {}, at(x, 0, 0));
    chain.joints.push_back(
        world.add_joint(before, link, joint::Hinge{}, {.point = {x - 0.1, 0, 0}, .axis = {0, 0, 1}}));
    before = link;
  }
  chain.ball = world.add_rigid_body(Sphere{{}, 0.2f}, {.density = ball_density}, at(0.2 * count + 0.2, 0, 0));
  chain.joints.push_back(world.add_joint(before, chain.ball, joint::Ball{}, {.point = {0.2 * count, 0, 0}}));
  return chain;
}

double largest_error(const World& world) {
  double result = 0;
  for (const JointId id : world.joints()) result = std::max(result, world.joint_report(id).distance_error);
  return result;
}

TEST(WorldJoints, AMotionThatThrowsIsReported) {
  World world;
  const ObjectId box = world.add_rigid_body(brick, {}, at(8, 0, 0));
  world.add_joint({}, box, joint::Hinge{});
  world.add_collider(Sphere{}, {.motion = ColliderMotion::callback([](double) -> Transform {
                                  throw std::runtime_error("collider trouble");
                                })});
  for (int i = 0; i < 3; ++i)
    EXPECT_NE(world.step(1.0 / 60).message.find("collider trouble"), std::string::npos);
}

TEST(WorldJoints, BreakAtTheirForceAndSaySo) {
  World world;
  const ObjectId load = world.add_rigid_body(brick, {}, at(0, 0, 0));
  const double weight = world.rigid_body(load).mass * 9.81;
  const JointId holds =
      world.add_joint({}, load, joint::Fixed{}, {.name = "holds", .breaking_force = 1.02 * weight});
  run(world, 1);
  EXPECT_FALSE(world.joint_report(holds).broken);
  EXPECT_NEAR(length(world.joint_report(holds).force), weight, 0.001 * weight);
  const ObjectId more = world.add_rigid_body(brick, {.density = 35}, at(0, -0.3, 0));
  world.add_joint(load, more, joint::Distance{.shortest = 0.3, .longest = 0.3},
                  {.point_b = Vec3d{0, -0.3, 0}});
  std::size_t broken = 0;
  for (int frame = 0; frame < 60; ++frame) broken += world.step(1.0 / 60).broken_joints;
  EXPECT_EQ(broken, 1u);
  EXPECT_TRUE(world.joint_report(holds).broken);
  EXPECT_EQ(length(world.joint_report(holds).force), 0);
  EXPECT_LT(world.rigid_body(load).velocity.y, -5);
}

TEST(WorldJoints, WhatIsJoinedDoesNotCollideUntilTheJointIsRemoved) {
  World world({.gravity = {}});
  const ObjectId a = world.add_rigid_body(Sphere{{}, 0.2f}, {}, at(0, 0, 0));
  const ObjectId b = world.add_rigid_body(Sphere{{}, 0.2f}, {}, at(0.2, 0, 0));
  const JointId joint = world.add_joint(a, b, joint::Ball{}, {.point = {0.1, 0, 0}});
  run(world, 0.5);
  EXPECT_NEAR(length(world.rigid_body(a).pose.translation - world.rigid_body(b).pose.translation), 0.2, 1e-6);
  world.remove(joint);
  run(world, 1);
  EXPECT_GT(length(world.rigid_body(a).pose.translation - world.rigid_body(b).pose.translation), 0.39);
}

TEST(WorldJoints, AMotorTurnsAWheelAndCanBeChanged) {
  World world;
  const ObjectId wheel = world.add_rigid_body(Cylinder{{}, 0.3f, 0.05f}, {}, at(0, 2, 0));
  joint::Hinge hinge;
  hinge.rotation.motor = joint::Motor{.target = 4};
  const JointId drive = world.add_joint({}, wheel, hinge, {.point = {0, 2, 0}, .axis = {0, 1, 0}});
  run(world, 1);
  EXPECT_NEAR(world.rigid_body(wheel).angular_velocity.y, 4, 0.001);
  EXPECT_NEAR(world.joint_report(drive).coordinate[0], 4, 0.05);
  hinge.rotation.motor = joint::Motor{.kind = joint::Motor::Target::position, .target = 1};
  world.set_joint(drive, hinge);
  run(world, 2);
  EXPECT_NEAR(world.joint_report(drive).coordinate[0], 1, 0.001);
  EXPECT_NEAR(length(world.rigid_body(wheel).angular_velocity), 0, 0.001);
}

TEST(WorldJoints, AMovingColliderTakesABodyAlong) {
  World world;
  const auto motion = ColliderMotion::keyframes({{0, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}});
  const ColliderId crane = world.add_collider(Sphere{{}, 0.05f}, {.motion = motion});
  const ObjectId load = world.add_rigid_body(brick, {}, at(0, -1, 0));
  world.add_joint(crane, load, joint::Distance{.longest = 1}, {.point_b = Vec3d{0, -1, 0}});
  run(world, 1);
  EXPECT_GT(world.rigid_body(load).pose.translation.x, 0.3);
  EXPECT_LT(length(world.rigid_body(load).pose.translation - Vec3d{1, 0, 0}), 1.001);
}

// Planks between two banks, and a crate that lies on them.
TEST(WorldJoints, ABridgeCarriesACrate) {
  World world = on_the_ground();
  constexpr int planks = 8;
  JointSide before;
  for (int i = 0; i < planks; ++i) {
    const double x = -0.7 + 0.2 * i;
    const ObjectId plank = world.add_rigid_body(Box{{}, {0.095f, 0.02f, 0.3f}}, {}, at(x, 1, 0));
    const joint::Hinge hinge{
        .rotation = {.spring = joint::Spring{.compliance = joint::unlimited, .damping = 0.5}}};
    world.add_joint(before, plank, hinge, {.point = {x - 0.1, 1, 0}, .axis = {0, 0, 1}});
    before = plank;
  }
  // 5 % longer than straight, so that the planks hang through.
  world.add_joint(before, {}, joint::Distance{.longest = 0.08},
                  {.point = {0.8, 1, 0}, .point_b = Vec3d{0.86, 1, 0}});
  const ObjectId crate = world.add_rigid_body(small_box, {}, at(0, 1.13, 0));
  run(world, 8);
  const RigidBodyState state = world.rigid_body(crate);
  EXPECT_GT(state.pose.translation.y, 0.7);
  EXPECT_LT(state.pose.translation.y, 1.13);
  EXPECT_LT(length(state.velocity), 0.1);
  EXPECT_LT(world.report().deepest_contact, 2e-4);
  EXPECT_LT(largest_error(world), 1e-4 * 0.2);
}

TEST(WorldJoints, AnIslandOfJointsFallsAsleepTogether) {
  World world({.sleeping = {.enabled = true}});
  world.add_collider(Plane{});
  const ObjectId a = world.add_rigid_body(brick, {}, at(0, 0.05, 0));
  const ObjectId b = world.add_rigid_body(brick, {}, at(5, 0.05, 0));
  world.add_joint(a, b, joint::Distance{.longest = 6}, {.point_b = Vec3d{5, 0.05, 0}});
  run(world, 3);
  EXPECT_TRUE(world.is_asleep(a));
  EXPECT_TRUE(world.is_asleep(b));
  world.wake(a);
  EXPECT_FALSE(world.is_asleep(b));
}

TEST(WorldJoints, ASnapshotHoldsThem) {
  const auto build = [](int threads = 0) {
    World world({.threads = threads});
    hang_chain(world, 5, 700);
    return world;
  };
  expect_resumes(build, 0.5, 0.5);
  World world = build(1), same = build(8);
  run(world, 0.5), run(same, 0.5);
  EXPECT_EQ(world.hash(), same.hash());
  const Snapshot snapshot = world.snapshot();
  World without;
  hang_chain(without, 5, 700);
  without.remove(without.joints().back());
  expect_error([&] { without.restore(snapshot); }, {"other objects"});
}

TEST(WorldJoints, GoWithWhatTheyHold) {
  World world = on_the_ground();
  const Chain chain = hang_chain(world, 3, 700);
  const ColliderId hook = world.add_collider(Sphere{{0, 2, 0}, 0.1f});
  world.add_joint(hook, chain.ball, joint::Distance{.longest = 9}, {.name = "rope"});
  EXPECT_EQ(world.joints().size(), 5u);
  EXPECT_EQ(world.joint_report(world.find_joint("rope")).name, "rope");
  world.remove(hook);
  EXPECT_EQ(world.joints().size(), 4u);
  world.remove(chain.ball);
  EXPECT_EQ(world.joints().size(), 3u);
  expect_error([&] { (void)world.joint_report(chain.joints.back()); }, {"no joint has the handle"});
  expect_error([&] { (void)world.find_joint("hinge22"); }, {"hinge2"});
  run(world, 0.1);
}

TEST(WorldJoints, RefuseWhatTheyCannotHold) {
  World world;
  const ObjectId body = world.add_rigid_body(brick);
  const ObjectId cloth = world.add_cloth(grid(2, 2, 1), {}, {.name = "sheet"});
  const auto refused = [&](const JointSide& a, const JointSide& b, const joint::Kind& kind,
                           const JointOptions& options, const char* words) {
    expect_error([&] { world.add_joint(a, b, kind, options); }, {words});
  };
  refused({}, {}, joint::Ball{}, {}, "neither side is a rigid body");
  refused(body, body, joint::Ball{}, {}, "to itself");
  refused({}, cloth, joint::Ball{}, {.name = "seam"},
          "joint 'seam': sheet is a cloth, expected a rigid_body");
  refused({}, body, joint::Hinge{}, {.axis = {}}, "quaternion other than 0");
  refused({}, body, joint::Hinge{}, {.point = {NAN, 0, 0}}, "expected coordinates");
  refused({}, body, joint::Distance{.shortest = 2, .longest = 1}, {}, "shortest first");
  refused({}, body, joint::Universal{}, {.axis = {1, 0, 0}, .second_axis = Vec3d{2, 0, 0}}, "parallel");
  refused({}, body, joint::Fixed{}, {.breaking_force = 0}, "breaking_force");
  EXPECT_TRUE(world.joints().empty());
  const JointId joint = world.add_joint({}, body, joint::Ball{}, {.name = "one"});
  refused({}, body, joint::Ball{}, {.name = "one"}, "taken by another joint");
  expect_error([&] { world.set_joint(joint, joint::Hinge{}); }, {"is a ball joint, got a hinge"});
  expect_error([&] { world.set_joint(joint, joint::Ball{.max_swing = 4}); }, {"max_swing"});
}

constexpr double g = 9.81;  // m/s^2

SurfacePoint vertex(ObjectId object, std::uint32_t v) {
  return {object, {v, v, v}, {1, 0, 0}};
}

/// An upright cloth of n x n vertices and 1 m, pinned by its top row at y = 0.5.
ObjectId hang_cloth(World& world, int n, const ClothMaterial& material = {}) {
  ObjectOptions options{.name = "cloth", .transform = {.rotation = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}};
  const ObjectId cloth = world.add_cloth(grid(n, n, 1.0), material, options);
  world.pin(cloth, in_box({-1, 0.499f, -1}, {1, 0.501f, 1}));
  return cloth;
}

std::vector<std::uint32_t> bottom_row(const World& world, ObjectId cloth) {
  return world.select(cloth, in_box({-1, -0.501f, -1}, {1, -0.499f, 1}));
}

/// A bar of `mass` that hangs from the bottom of a cloth by four vertices.
struct HungBar {
  ObjectId cloth, bar;
  std::vector<TieId> ties;
};
HungBar hang_bar(World& world, double mass, const ClothMaterial& material = {}, int n = 30) {
  HungBar result;
  result.cloth = hang_cloth(world, n, material);
  const Box box{{}, {0.4f, 0.05f, 0.05f}};
  result.bar = world.add_rigid_body(box, {.density = static_cast<float>(mass / 0.008)}, at(0, -0.56, 0));
  world.set_collide("cloth", world.name(result.bar), false);
  const std::vector<std::uint32_t> row = bottom_row(world, result.cloth);
  const std::size_t last = row.size() - 1;
  for (const std::size_t k : {last / 8, 3 * last / 8, last - 3 * last / 8, last - last / 8}) {
    const Vec3d x(world.positions(result.cloth)[row[k]]);
    result.ties.push_back(world.add_tie(vertex(result.cloth, row[k]), result.bar, {.point = x}));
  }
  return result;
}

double sum_of_forces(const World& world, const std::vector<TieId>& ties) {
  double sum = 0;
  for (const TieId id : ties) sum += world.tie_report(id).force.y;
  return sum;
}

/// Hangs a crate of 4 kg by its middle from a rope of 0.9 m.
std::pair<ObjectId, TieId> hang_crate(World& world, const TieOptions& options) {
  const ObjectId crate = world.add_rigid_body(small_box, {.density = 500}, at(0, 1, 0));
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 2, 0}, {0, 1.1, 0}}, 10, {}, {.name = "rope"});
  world.pin(rope, vertices({0}));
  world.set_collide("rope", world.name(crate), false);
  return {crate, world.add_tie(vertex(rope, 10), crate, options)};
}

TEST(Ties, TheForceInATieIsTheWeightThatItHolds) {
  World world;
  const auto [crate, tie] = hang_crate(world, {.point = {0, 1.1, 0}});
  run(world, 4);
  const double weight = world.total_mass(crate) * g;
  EXPECT_NEAR(world.tie_report(tie).force.y, weight, 0.02 * weight);
  EXPECT_NEAR(world.rigid_body(crate).pose.translation.y, 1, 0.01);
  EXPECT_LT(length(world.tie_report(tie).point_a - world.tie_report(tie).point_b), 1e-5);
}

TEST(Ties, ABarycentricTieSharesTheLoadByItsWeights) {
  World world;
  const std::array<Vec3d, 3> corners{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};
  const ObjectId grains =
      world.add_grains(std::vector<Vec3d>(corners.begin(), corners.end()), {.radius = 0.05f});
  const ObjectId ball = world.add_rigid_body(Sphere{{}, 0.1f}, {.density = 100}, at(0.5, -0.5, 0.3));
  // Each grain hangs from the world by a spring, which tells its load.
  std::vector<TieId> springs;
  for (std::uint32_t k = 0; k < 3; ++k)
    springs.push_back(world.add_tie({}, vertex(grains, k), {.point = corners[k], .compliance = 1e-3}));
  const SurfacePoint point{grains, {0, 1, 2}, {0.2, 0.5, 0.3}};
  world.add_tie(point, ball, {.point = {0.5, 0, 0.3}, .point_b = Vec3d{0.5, -0.5, 0.3}});
  run(world, 1);
  double mean[3] = {};  // of the oscillation about equilibrium
  constexpr int frames = 240;
  for (int frame = 0; frame < frames; ++frame) {
    world.step(1.0 / 60);
    for (std::size_t k = 0; k < 3; ++k) mean[k] -= world.tie_report(springs[k]).force.y / frames;
  }
  const double weight = world.total_mass(ball) * g, own = world.total_mass(grains) / 3 * g;
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(-mean[k] - own, point.weights[k] * weight, 0.02 * weight) << k;
}

TEST(Ties, AHeavyBodyHangsFromLightCloth) {
  for (const int n : {8, 30})
    for (const double ratio : {1.0, 10.0, 100.0}) {
      World world;
      ClothMaterial material;  // the load stretches it by about 1 %
      material.membrane_stiffness = static_cast<float>(std::max(4000.0, 200 * ratio));
      const HungBar hung = hang_bar(world, ratio * 0.15, material, n);
      run(world, 3);
      double force = 0, depth = 0;  // means over an oscillation
      constexpr int frames = 60;
      for (int frame = 0; frame < frames; ++frame) {
        world.step(1.0 / 60);
        force += sum_of_forces(world, hung.ties) / frames;
        depth += (-0.56 - world.rigid_body(hung.bar).pose.translation.y) / frames;
        EXPECT_LT(world.report().largest_strain, 0.05) << n << ", " << ratio;
      }
      const double weight = ratio * 0.15 * g;
      EXPECT_NEAR(force, weight, 0.02 * weight) << n << ", " << ratio;
      EXPECT_GT(depth, 0) << n << ", " << ratio;
      EXPECT_LT(depth, 0.02) << n << ", " << ratio;  // 2 % of the cloth's length
    }
}

TEST(Ties, TwoFreeObjectsKeepTheirMomentum) {
  World world({.gravity = {}, .wind = {.air_density = 0}});
  const ObjectId cloth = world.add_cloth(grid(12, 12, 0.5), {}, {.name = "cloth"});
  const ObjectId body = world.add_rigid_body(small_box, {.density = 300}, at(0, -0.2, 0));
  world.set_collide("cloth", world.name(body), false);
  world.stitch(cloth, in_box({-0.1f, -1, -0.1f}, {0.1f, 1, 0.1f}), body, 0.2, {});
  world.set_body_velocity(body, {1, 0.5f, 0}, {0, 0, 4});
  const Vec3d before = world.momentum(body) + world.momentum(cloth);
  run(world, 3);
  const Vec3d after = world.momentum(body) + world.momentum(cloth);
  EXPECT_LT(length(after - before), 1e-4 * length(before));
  EXPECT_GT(length(world.momentum(cloth)), 0.01 * length(before));  // it is dragged along
}

TEST(Ties, ATieBreaksAtItsForce) {
  World world;
  constexpr double limit = 100;  // more than twice the weight, with which the crate falls into the rope
  const auto [crate, tie] = hang_crate(world, {.point = {0, 1.1, 0}, .breaking_force = limit});
  std::vector<std::string> log;
  world.set_log([&log](LogLevel, std::string_view line_of_log) { log.emplace_back(line_of_log); });
  run(world, 2);
  ASSERT_FALSE(world.tie_report(tie).broken);
  const double weight = world.total_mass(crate) * g;
  Settings settings = world.settings();
  double at_break = 0;
  for (int frame = 0; frame < 1200 && at_break == 0; ++frame) {
    settings.gravity.y -= 0.02f;  // slowly
    world.set_settings(settings);
    world.step(1.0 / 60);
    if (world.report().broken_ties == 1)
      at_break = world.total_mass(crate) * static_cast<double>(-settings.gravity.y);
  }
  EXPECT_LT(weight, limit);
  EXPECT_NEAR(at_break, limit, 0.02 * limit);
  EXPECT_TRUE(world.tie_report(tie).broken);
  EXPECT_TRUE(std::any_of(log.begin(), log.end(),
                          [](const std::string& s) { return s.find("broke at") != std::string::npos; }));
  run(world, 1);
  EXPECT_LT(world.rigid_body(crate).pose.translation.y, -2);  // it falls
}

TEST(Ties, ATieBreaksAtItsStrain) {
  World world({.gravity = {}});
  const ObjectId grains = world.add_grains(std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}}, {.radius = 0.01f});
  const TieId tie =
      world.add_tie(vertex(grains, 0), vertex(grains, 1), {.compliance = 0.01, .breaking_strain = 0.1});
  EXPECT_NEAR(world.tie_report(tie).rest_length, 1, 1e-6);
  world.pin(grains, vertices({0, 1}));
  double longest = 0;
  for (int frame = 1; frame <= 200 && world.report().broken_ties == 0; ++frame) {
    world.move_pins(grains, std::vector<std::uint32_t>{1},
                    std::vector<Vec3f>{{1 + 0.001f * static_cast<float>(frame), 0, 0}});
    world.step(1.0 / 60);
    longest = static_cast<double>(world.positions(grains)[1].x);
  }
  EXPECT_TRUE(world.tie_report(tie).broken);
  EXPECT_NEAR(longest - 1, 0.1, 0.002);
}

/// A bead that slides down a fixed, straight rope of 10 m, from 1 m on.
struct Bead {
  World world;
  ObjectId bead;
  TieId tie;

  Bead(double angle, const TieSlide& slide) {
    const std::vector<Vec3d> line{{0, 0, 0}, {10 * std::cos(angle), -10 * std::sin(angle), 0}};
    const ObjectId rope = world.add_rope(line, 20, {}, {.name = "rope"});
    world.pin(rope, all());
    bead = world.add_grains(std::vector<Vec3d>{line[1] * 0.1}, {.radius = 0.02f}, {.name = "bead"});
    world.set_collide("rope", "bead", false);
    tie = world.add_tie(vertex(bead, 0), rope, {.point = line[1] * 0.1, .slide = slide});
    run(world, 1);
  }
};

TEST(Ties, ABeadSlidesDownAStraightRope) {
  const double angle = 0.5;
  Bead sliding(angle, {});
  auto& [world, bead, tie] = sliding;
  const double along = length(Vec3d(world.positions(bead)[0])) - 1;
  EXPECT_NEAR(along, 0.5 * g * std::sin(angle), 0.02 * 0.5 * g * std::sin(angle));
  EXPECT_LT(length(world.tie_report(tie).point_a - world.tie_report(tie).point_b), 1e-4);
  run(world, 2);
  EXPECT_NEAR(length(Vec3d(world.positions(bead)[0])), 10, 0.01);  // it stops at the end
}

TEST(Ties, FrictionHoldsABeadOnAGentleSlope) {
  for (const double friction : {0.5, 0.7}) {  // tan(0.54) = 0.6
    const double angle = std::atan(0.6);
    const Bead sliding(angle, {{}, friction});
    const double along = length(Vec3d(sliding.world.positions(sliding.bead)[0])) - 1;
    const double wanted = friction < 0.6 ? 0.5 * g * (std::sin(angle) - friction * std::cos(angle)) : 0;
    EXPECT_NEAR(along, wanted, 0.02 * 0.5 * g * std::sin(angle)) << friction;
  }
}

/// Cloth, a soft body, a rope and rigid bodies, tied to each other and to a moving collider.
std::vector<TieId> tie_everything(World& world) {
  const HungBar hung = hang_bar(world, 2, {}, 16);
  const ObjectId soft =
      world.add_soft_body(sphere(2, 0.2), SoftBodyMaterial{}, LatticeOptions{}, at(0, -1.2, 0));
  std::vector<TieId> ties = hung.ties;
  const std::vector<Vec3d> line{{0, -0.61, 0}, {0, -1, 0}};
  const ObjectId rope = world.add_rope(line, 6, {}, {.name = "rope"});
  world.set_collide("rope", world.name(hung.bar), false);
  world.set_collide("rope", world.name(soft), false);
  ties.push_back(world.add_tie(vertex(rope, 0), hung.bar, {.point = {0, -0.61, 0}}));
  ties.push_back(world.add_tie(vertex(rope, 6), soft, {.point = {0, -1, 0}, .rest_length = 0}));
  const auto circling = ColliderMotion::callback([](double t) {
    return Transform{{0.05 * std::sin(3 * t), -1.2, 1}, {}, 1};
  });
  const ColliderId collider = world.add_collider(Sphere{{}, 0.05f}, {.motion = circling});
  ties.push_back(world.add_tie(soft, collider, {.point = {0, -1.2, 0.2}, .compliance = 1e-3}));
  return ties;
}

TEST(Ties, ASnapshotContinuesWithEqualBits) {
  World first, second;
  const std::vector<TieId> ties = tie_everything(first);
  tie_everything(second);
  run(first, 0.3);
  const Snapshot snapshot = first.snapshot();
  second.restore(snapshot);
  run(first, 0.3), run(second, 0.3);
  EXPECT_EQ(first.hash(), second.hash());
  for (const TieId tie : ties) EXPECT_EQ(first.tie_report(tie).force, second.tie_report(tie).force);
  World other;
  expect_error([&] { other.restore(snapshot); }, {"other objects"});
}

TEST(Ties, WhatIsRemovedTakesItsTiesAlong) {
  World world;
  const HungBar hung = hang_bar(world, 1, {}, 10);
  run(world, 0.1);
  world.remove(hung.ties[0]);
  EXPECT_EQ(world.ties().size(), 3u);
  expect_error([&] { world.tie_report(hung.ties[0]); }, {"no tie has the handle"});
  run(world, 0.1);
  world.remove(hung.cloth);
  EXPECT_TRUE(world.ties().empty());
  run(world, 1);
  EXPECT_LT(world.rigid_body(hung.bar).pose.translation.y, -4);
}

TEST(Ties, TiedObjectsSleepTogether) {
  World world({.sleeping = {.enabled = true}});
  world.add_collider(Plane{});
  const ObjectId a = world.add_rigid_body(small_box, {}, at(0, 0.1, 0));
  const ObjectId b = world.add_grains(std::vector<Vec3d>{{2, 0.05, 0}}, {.radius = 0.05f}, at(0, 0, 0));
  world.add_tie(vertex(b, 0), vertex(a, 0), {.point = {2, 0.05, 0}, .rest_length = 1.9, .compliance = 0.1});
  run(world, 6);
  ASSERT_TRUE(world.is_asleep(a));
  ASSERT_TRUE(world.is_asleep(b));
  world.wake(b);
  EXPECT_FALSE(world.is_asleep(a));
}

TEST(Ties, TheClosestPointOfASurface) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 2.0));  // vertices 1 m apart
  const SurfacePoint point = world.surface_point(cloth, {0.25, 0.7, 0.5});
  Vec3d x;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    x += Vec3d(world.positions(cloth)[point.vertices[k]]) * point.weights[k];
    sum += point.weights[k];
  }
  EXPECT_NEAR(length(x - Vec3d{0.25, 0, 0.5}), 0, 1e-6);
  EXPECT_NEAR(sum, 1, 1e-12);
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 5}, {1, 0, 5}}, 2);
  EXPECT_NEAR(world.surface_point(rope, {0.6, 1, 5}).weights[1], 0.2, 1e-6);
}

TEST(Ties, AScenesTiesAreThoseOfTheWorld) {
  const std::string objects = R"({"souple": 1, "objects": [
    {"kind": "cloth", "name": "a", "mesh": {"grid": {"columns": 5, "rows": 5, "size": 1}}},
    {"kind": "cloth", "name": "b", "mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}},
     "transform": {"translate": [1, 0, 0]}},
    {"kind": "rope", "name": "rope", "points": [[3, 0, 0], [4, 0, 0]], "segments": 4}], "ties": [)";
  const auto parse = [&](const std::string& ties) {
    return parse_scene(objects + ties + "]}", ".", "scene");
  };
  World world = build_world(parse(R"(
    {"from": "a", "to": "b", "stitch": {"in_box": [[0.49, -1, -1], [0.51, 1, 1]], "distance": 0.01}},
    {"to": "rope", "point": [3, 0, 0], "compliance": 0.01, "breaking_force": 5},
    {"from": "a", "to": "rope", "point": [0.5, 0, 0], "to_point": [3.5, 0, 0], "slide": {"friction": 0.2}})"));
  ASSERT_EQ(world.ties().size(), 7u);
  const TieReport seam = world.tie_report(world.ties()[1]);  // between two vertices of b
  EXPECT_NEAR(length(seam.point_a - seam.point_b), 0, 1e-6);
  EXPECT_EQ(world.tie_report(world.ties()[6]).segment, 1u);
  expect_error([&] { parse(R"({"from": "a", "to": "c", "point": [0, 0, 0]})"); }, {"ties[0].to", "\"c\""});
  expect_error([&] { parse(R"({"from": "a", "to": "b"})"); }, {"needs \"point\" or \"stitch\""});
}

TEST(Ties, InvalidInputGetsASentence) {
  World world;
  const HungBar hung = hang_bar(world, 1, {}, 5);
  const ObjectId fluid = world.add_fluid(std::vector<Vec3d>{{7, 7, 7}}, {.spacing = 0.1f});
  const SurfacePoint corner = vertex(hung.cloth, 0);
  const auto expect = [&](const TieSide& a, const TieSide& b, const TieOptions& options, const char* text) {
    expect_error([&] { world.add_tie(a, b, options); }, {text});
  };
  expect({}, {}, {}, "neither side is an object");
  expect(corner, corner, {}, "to itself");
  expect(hung.bar, hung.bar, {}, "to itself");
  expect(corner, fluid, {}, "is a fluid");
  expect(vertex(hung.cloth, 99), hung.bar, {}, "has 25 vertices, got vertex 99");
  expect(SurfacePoint{hung.cloth, {0, 1, 2}, {0.5, 0.2, 0.1}}, hung.bar, {}, "sum to 0.8, expected 1");
  expect(corner, hung.bar, {.compliance = -1}, "compliance is -1");
  expect(corner, hung.bar, {.breaking_force = 0}, "breaking_force is 0");
  expect(corner, hung.bar, {.rest_length = NAN}, "rest_length is nan");
  expect(corner, hung.bar, {.breaking_strain = 0.1}, "no rest length");
  expect(hung.bar, hung.cloth, {.slide = TieSlide{}}, "no rope");
  expect(corner, hung.bar, {.slide = TieSlide{}}, "second side");
  expect(corner, hung.bar, {.point = {INFINITY, 0, 0}}, "not finite");
  expect_error([&] { world.stitch(hung.cloth, all(), hung.bar, 1e-6, {}); }, {"raise the distance"});
  expect_error([&] { world.surface_point(hung.cloth, {NAN, 0, 0}); }, {"not finite"});
  EXPECT_EQ(world.ties().size(), 4u);
}

}  // namespace souple::test_world_joints
