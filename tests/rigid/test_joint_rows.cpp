#include "souple/error.h"
#include "souple/rigid/joints/block_cholesky.h"
#include "tests/count_allocations.h"
#include "tests/expect_error.h"
#include "tests/rigid/joint_world.h"

#include <limits>
#include <random>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace souple::test_rigid_joint_rows {

// Errors of users, and joints that cannot hold.

using joint::Axis;
using joint::Joint;
using joint::Motor;
using joint::Spring;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The message names the joint and contains `part`.
void expect_refused(Joint joint, const std::string& part) {
  joint.name = "left knee";
  joint::Joints joints;
  expect_error([&] { add(joints, joint, 2); }, {"left knee", part});
  EXPECT_EQ(joints.size(), 0u);
}

Joint between(const joint::Kind& kind) {
  return {.name = {}, .a = 0, .b = 1, .kind = kind};
}

TEST(JointErrors, BadDescriptionsAreRefusedByName) {
  using joint::Ball, joint::Distance, joint::Fixed, joint::Hinge, joint::Pulley, joint::Slider,
      joint::Universal;
  using joint::unlimited;
  expect_refused({.name = {}, .a = 0, .b = 2, .kind = Fixed{}}, "body 2 does not exist");
  expect_refused({.name = {}, .a = 1, .b = 1, .kind = Fixed{}}, "to itself");
  expect_refused({.name = {}, .kind = Fixed{}}, "the world to itself");
  Joint joint = between(Hinge{});
  joint.frame_a.rotation = {0, 0, 0, 0};
  expect_refused(joint, "rotation of frame_a");
  joint = between(Hinge{});
  joint.frame_b.point.y = nan;
  expect_refused(joint, "point of frame_b");
  joint = between(Hinge{});
  joint.breaking_force = 0;
  expect_refused(joint, "breaking_force");
  joint = between(Hinge{});
  joint.breaking_torque = nan;
  expect_refused(joint, "breaking_torque");
  expect_refused(between(Hinge{.rotation = Axis{.limits = {1, -1}}}), "limits of the rotation are 1 to -1");
  expect_refused(between(Slider{.translation = Axis{.limits = {nan, 1}}}), "limits of the translation");
  expect_refused(between(Hinge{.compliance = -1}), "compliance is -1");
  expect_refused(between(Fixed{.angular_damping = nan}), "angular_damping");
  expect_refused(between(Slider{.translation = Axis{.spring = Spring{0, -1, 0}}}), "compliance of a spring");
  expect_refused(between(Slider{.translation = Axis{.spring = Spring{0, unlimited, 0}}}), "does nothing");
  expect_refused(between(Universal{.second = Axis{.motor = Motor{.target = nan}}}), "target of a motor");
  expect_refused(between(Universal{.first = Axis{.motor = Motor{.max_force = -1}}}), "max_force");
  expect_refused(between(Ball{.max_swing = -0.1}), "max_swing");
  expect_refused(between(Ball{.twist = {-4, 0}}), "-pi to pi");
  expect_refused(between(Distance{.shortest = 2, .longest = 1}), "expected the shortest first");
  expect_refused(between(Distance{.shortest = -2, .longest = 1}), "shortest length");
  expect_refused(between(Pulley{.ratio = 0}), "ratio");
  expect_refused(between(Pulley{.length = nan}), "length");
}

TEST(JointErrors, AnAxisWithoutLengthIsRefused) {
  RigidBodies bodies;
  bodies.resize(2);
  Joint joint = between(joint::Hinge{});
  place(joint, bodies, {}, joint::axes_along({0, 0, 0}));
  expect_refused(joint, "rotation of frame_a");
}

bool is_calm(const JointWorld& world, double speed) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (!is_finite(world.bodies.pose[i].position) || !(length(world.bodies.velocity[i].linear) < speed) ||
        !(length(world.bodies.velocity[i].angular) < 100))
      return false;
  return true;
}

TEST(JointErrors, JointsThatContradictEachOtherStayCalm) {
  for (const joint::Method method : {joint::Method::direct, joint::Method::sweep}) {
    JointWorld world;
    world.solver.method = method;
    const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {}), b = world.add_box(1000, {0.3, 0.2, 0.1}, {1, 0, 0});
    for (const auto& [body, point] :
         {std::pair{a, Vec3d{-1, 0, 0}}, {a, Vec3d{1, 2, 0}}, {b, Vec3d{3, 0, 0}}}) {
      joint::Joint joint{.name = "pin", .b = body, .kind = joint::Fixed{}};
      joint.frame_a.point = point;
      add(world.joints, joint, world.bodies.size());
    }
    for (const double length : {0.1, 4.0}) {
      joint::Joint joint{.name = "rod", .a = a, .b = b, .kind = joint::Distance{length, length}};
      add(world.joints, joint, world.bodies.size());
    }
    add(world.joints,
        {.name = "hinge", .a = a, .b = b, .frame_a = {{}, {1, 0, 0, 0}}, .kind = joint::Hinge{}},
        world.bodies.size());
    bool calm = true;
    world.run(5, [&] { calm = calm && is_calm(world, 100); });
    EXPECT_TRUE(calm) << static_cast<int>(method);
  }
}

TEST(JointErrors, AJointThatIsAssembledApartClosesWithoutAShot) {
  JointWorld world;
  world.gravity = {};
  const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {}), b = world.add_box(1, {0.3, 0.2, 0.1}, {2, 1, 0});
  world.bodies.pose[b].rotation = normalized(Quatd{0.3, 0.5, -0.2, 0.4});
  const auto j =
      add(world.joints, {.name = "weld", .a = a, .b = b, .kind = joint::Fixed{}}, world.bodies.size());
  bool calm = true;
  world.run(2, [&] { calm = calm && is_calm(world, 50); });
  EXPECT_TRUE(calm);
  const joint::JointError error = error_of(world.joints.joint[j], world.joints.state[j], world.bodies);
  EXPECT_LT(error.distance, 1e-5);
  EXPECT_LT(error.angle, 1e-5);
  EXPECT_LT(length(world.momentum()), 1e-9);
}

TEST(JointErrors, JointsToBodiesThatNothingMovesDoNothing) {
  JointWorld world;
  const auto a = world.add_box(1, {0.3, 0.2, 0.1}, {});
  world.bodies.mass[a] = {};
  world.bodies.inverse_inertia[a] = {};
  const auto j = world.add_joint(joint::Fixed{}, no_body, a, {});
  world.run(0.1);
  EXPECT_EQ(world.bodies.pose[a].position, Vec3d{});
  EXPECT_EQ(length(world.joints.state[j].force), 0);
}

const Axis everything{.limits = {-0.1, 0.2}, .spring = Spring{}, .motor = Motor{}};

/// Two bodies, b turned and moved so that the joint holds, and the joint.
struct Joined {
  RigidBodies bodies;
  joint::Joint joint;

  Joined(const joint::Kind& kind, const Quatd& relative, const Vec3d& offset) {
    bodies.resize(2);
    bodies.pose[0] = {{1, 2, 3}, normalized(Quatd{0.3, -0.2, 0.5, 0.7})};
    joint = {.name = "tested", .a = 0, .b = 1, .kind = kind};
    joint.frame_a = {{0.4, -0.3, 0.2}, normalized(Quatd{0.1, 0.2, -0.4, 0.8})};
    joint.frame_b = {{-0.2, 0.1, 0.5}, normalized(Quatd{0.5, 0.1, 0.3, 0.6})};
    const Quatd axes = bodies.pose[0].rotation * joint.frame_a.rotation;
    bodies.pose[1].rotation = normalized(axes * relative * conjugate(joint.frame_b.rotation));
    bodies.pose[1].position = bodies.pose[0].point(joint.frame_a.point) + rotate(axes, offset) -
                              bodies.pose[1].direction(joint.frame_b.point);
  }
  joint::Rows rows() const { return rows_of(joint, ends_of(joint, {}, bodies)); }
};

/// Compares each row's gradient by a motion of one body with central differences.
void check_gradients(const Joined& joined) {
  const joint::Rows rows = joined.rows();
  const double d = 1e-5;
  const auto difference = [&](std::size_t body, const Vec3d& dx, const Vec3d& turn, std::size_t i) {
    double value[2];
    for (const int side : {0, 1}) {
      Joined moved = joined;
      const double s = side == 0 ? -d : d;
      moved.bodies.pose[body].position += dx * s;
      moved.bodies.pose[body].rotation = turned(moved.bodies.pose[body].rotation, turn * s);
      value[side] = moved.rows().row[i].value;
    }
    return (value[1] - value[0]) / (2 * d);
  };
  for (std::size_t i = 0; i < static_cast<std::size_t>(rows.count); ++i)
    for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      const joint::Row& row = rows.row[i];
      EXPECT_NEAR(difference(0, e, {}, i), dot(row.linear_a, e), 1e-8) << i;
      EXPECT_NEAR(difference(1, e, {}, i), dot(row.linear_b, e), 1e-8) << i;
      EXPECT_NEAR(difference(0, {}, e, i), dot(row.angular_a, e), 1e-8) << i;
      EXPECT_NEAR(difference(1, {}, e, i), dot(row.angular_b, e), 1e-8) << i;
    }
}

TEST(JointRows, GradientsAreThoseOfTheValues) {
  const Quatd any = normalized(Quatd{0.2, -0.4, 0.1, 0.9});
  const Quatd about_x = Quatd::from_axis_angle({1, 0, 0}, 0.7),
              about_z = Quatd::from_axis_angle({0, 0, 1}, -0.4);
  check_gradients({joint::Fixed{}, any, {0.1, 0.2, 0.3}});
  check_gradients(
      {joint::Ball{.max_swing = 1, .twist = {-1, 1}, .spring = joint::RotationSpring{about_x}}, any, {}});
  check_gradients({joint::Hinge{.rotation = everything}, about_x, {}});
  check_gradients({joint::Slider{.translation = everything}, {}, {0.3, 0, 0}});
  check_gradients({joint::Universal{.first = everything, .second = everything}, about_x * about_z, {}});
  check_gradients({joint::Distance{.longest = 1, .motor = Motor{}}, any, {0.3, -0.2, 0.5}});
  check_gradients({joint::Pulley{{4, 5, 6}, {-3, 5, 2}, 1.7, 9}, any, {0.3, -0.2, 0.5}});
}

TEST(JointRows, PlacedFramesCoincide) {
  RigidBodies bodies;
  bodies.resize(2);
  bodies.pose[0] = {{1, 2, 3}, normalized(Quatd{0.3, -0.2, 0.5, 0.7})};
  bodies.pose[1] = {{-1, 0, 3}, normalized(Quatd{0.1, 0.6, 0.5, 0.2})};
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0.3, -2, 1}, Vec3d{0, 0, 5}}) {
    joint::Joint joint{.name = "tested", .a = 0, .b = 1};
    place(joint, bodies, {5, 6, 7}, joint::axes_along(axis));
    const joint::Ends ends = ends_of(joint, {}, bodies);
    EXPECT_LT(length(ends.point_a - Vec3d{5, 6, 7}) + length(ends.point_b - ends.point_a), 1e-13);
    EXPECT_LT(length(ends.axes_a.column[0] - normalized(axis)), 1e-13);
    EXPECT_LT(length(ends.axes_b.column[1] - ends.axes_a.column[1]), 1e-13);
  }
}

/// A matrix of blocks with rings and branches, solved by Eigen as well.
TEST(BlockCholesky, SolvesWhatADenseSolverSolves) {
  const std::vector<int> sizes{3, 6, 1, 5, 2, 4, 6, 3, 5, 1};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{
      {0, 1}, {1, 2}, {3, 2}, {3, 4}, {4, 0}, {5, 1}, {6, 5}, {7, 6}, {7, 5}, {8, 3}, {9, 8}, {1, 7}, {1, 5}};
  joint::BlockCholesky cholesky;
  cholesky.analyze(sizes, pairs);
  const auto n = static_cast<Eigen::Index>(cholesky.rows());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  cholesky.clear();
  const auto fill = [&](std::uint32_t i, std::uint32_t j) {
    const auto [offset, swapped] = cholesky.place(i, j);
    const std::uint32_t r = swapped ? j : i, c = swapped ? i : j;
    for (int k = 0; k < sizes[r]; ++k)
      for (int l = 0; l < sizes[c]; ++l) {
        const auto row = static_cast<Eigen::Index>(cholesky.first_row(r)) + k;
        const auto column = static_cast<Eigen::Index>(cholesky.first_row(c)) + l;
        if (i == j && column > row) continue;
        const double a = number(random) + (row == column ? 12 : 0);
        A(row, column) = A(column, row) = a;
        cholesky.at(offset)[k * sizes[c] + l] = a;
      }
  };
  for (std::uint32_t i = 0; i < sizes.size(); ++i) fill(i, i);
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [i, j] : pairs) fill(i, j);
  Eigen::VectorXd b(n);
  for (auto& value : b) value = number(random);
  const Eigen::VectorXd expected = A.ldlt().solve(b);
  std::vector<double> x(b.begin(), b.end());
  cholesky.factorize();
  cholesky.solve(x);
  for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i)], expected(i), 1e-12);
}

TEST(JointSolver, AWarmSubstepAllocatesNothing) {
  for (const joint::Method method : {joint::Method::direct, joint::Method::sweep}) {
    JointWorld world;
    world.solver.method = method;
    std::uint32_t before = no_body;
    for (int i = 0; i < 10; ++i) {
      const auto link = world.add_box(1, {0.1, 0.02, 0.02}, {0.1 * i + 0.05, 0, 0});
      world.add_joint(joint::Ball{.max_swing = 0.4, .twist = {-0.1, 0.1}}, before, link, {0.1 * i, 0, 0});
      before = link;
    }
    world.run(0.1);
    const long allocations = test::allocations();
    world.run(0.5);
    EXPECT_EQ(test::allocations(), allocations);
  }
}

}  // namespace souple::test_rigid_joint_rows
