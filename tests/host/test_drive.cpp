#include "souple/host/session/drive.h"
#include "tests/expect_error.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::host::test_host_drive {

/// A host's matrix: of a mesh that is twice as long in x, then turned about an axis, then moved.
Placement placed(const Vec3d& axis, double degrees, const Vec3d& at) {
  constexpr double radians = 3.14159265358979323846 / 180;
  const Mat3d turn = rotation_matrix(Quatd::from_axis_angle(normalized(axis), degrees * radians));
  float matrix[16] = {};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      matrix[4 * column + row] = static_cast<float>(turn(row, column) * (column == 0 ? 2 : 1));
  for (int row = 0; row < 3; ++row) matrix[12 + row] = static_cast<float>(at[row]);
  matrix[15] = 1;
  return Placement::of(matrix);
}

/// However far it is turned, also by 180 degrees about each axis, where a part of the quaternion is 0.
TEST(Drive, LeadsTheMeshFromWhereItWasToWhereItIs) {
  const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 0.5}};
  const Vec3d points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.3, 0.2, 1}};
  for (const double begin : {0.0, 20.0}) {
    const Placement from = placed({1, 1, 0}, begin, {1, 0, 2});
    for (const Vec3d& axis : axes)
      for (const double degrees : {0.0, 1.0, 90.0, 179.0, 180.0, 200.0, 359.0}) {
        const Placement to = placed(axis, degrees, {0, 3, -1});
        const Transform motion = rigid_motion(from, to, "table");
        for (const Vec3d& x : points)
          EXPECT_LT(length(motion.point(from.to_world(x)) - to.to_world(x)), 1e-5)
              << axis.y << ' ' << degrees;
      }
  }
}

TEST(Drive, GoesTheShorterWayDuringAStepAndStaysThere) {
  const Placement added = placed({0, 1, 0}, 0, {});
  const Vec3d corner{1, 0, 0};
  for (const double degrees : {-90.0, -20.0, 20.0, 90.0, 180.0}) {
    Drive drive;
    drive.from = rigid_motion(added, placed({0, 1, 0}, degrees - 10, {}), "table");
    drive.to = rigid_motion(added, placed({0, 1, 0}, degrees + 10, {0, 0, 1}), "table");
    EXPECT_LT(length(drive.at(7).point(corner) - drive.from.point(corner)), 1e-12);  // no step runs
    drive.begin_step(7, 0.1);
    EXPECT_LT(length(drive.at(7).point(corner) - drive.from.point(corner)), 1e-12);
    const Transform half = rigid_motion(added, placed({0, 1, 0}, degrees, {0, 0, 0.5}), "table");
    EXPECT_LT(length(drive.at(7.05).point(corner) - half.point(corner)), 1e-5) << degrees;
    EXPECT_LT(length(drive.at(7.1).point(corner) - drive.to.point(corner)), 1e-12);
    drive.end_step(true);
    EXPECT_LT(length(drive.at(9).point(corner) - drive.to.point(corner)), 1e-12);
  }
}

TEST(Drive, RefusesWhatIsNotRigid) {
  const Placement from = placed({0, 1, 0}, 30, {});
  float mirrored[16] = {2, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  expect_error([&] { rigid_motion(from, Placement::of(mirrored), "table"); }, {"table", "mirrored"});
  mirrored[5] = 1.01f;
  expect_error([&] { rigid_motion(from, Placement::of(mirrored), "table"); }, {"table", "scaled"});
}

}  // namespace souple::host::test_host_drive
