#include "souple/rigid/joints/block_cholesky.h"
#include "tests/count_allocations.h"
#include "tests/rigid/joint_world.h"

#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace souple::test_rigid_joint_rows {

using joint::Axis;
using joint::Motor;
using joint::Spring;

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
