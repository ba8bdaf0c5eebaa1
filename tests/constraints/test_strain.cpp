#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/math/quaternion.h"
#include "tests/constraints/examples.h"

#include <algorithm>

#include <gtest/gtest.h>

// The strain that reports state, compared with the singular values of the deformation.

namespace souple::test_constraints_strain {

Mat3d turn(Random& random) {
  return rotation_matrix(Quatd::from_axis_angle(normalized(random.vector()), 3 * random()));
}

float membrane_strain(const Mat3d& F, const Vec3d (&rest)[3]) {
  Vec3f x[3];
  for (int i = 0; i < 3; ++i) x[i] = Vec3f(F * (rest[i] - rest[0]));
  const auto params = TriangleMembrane::from_rest(rest, {1, 0.3, 0});
  float C[3];
  Vec3f gradient[3][3];
  TriangleMembrane::evaluate<float>(x, params, C, gradient);
  return TriangleMembrane::strain(params, C);
}

float tet_strain(const Mat3d& F) {
  const Vec3d rest[4] = {{0, 0, 0}, {1, 0.1, 0.2}, {0.1, 1.2, -0.1}, {0.2, 0.1, 0.9}};
  Vec3f x[4];
  for (int i = 0; i < 4; ++i) x[i] = Vec3f(F * rest[i]);
  const auto params = NeoHookean::from_rest(rest);
  float C[2];
  Vec3f gradient[2][4];
  NeoHookean::evaluate<float>(x, params, C, gradient);
  return NeoHookean::strain(params, C);
}

// A triangle in the plane z = 0, stretched by s and t along two axes at an angle to warp and weft.
TEST(Strain, OfAMembraneIsItsLargestExtensionInAnyDirection) {
  const Vec3d rest[3] = {{0, 0, 0}, {1, 0.2, 0}, {0.3, 0.9, 0}};
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const double s = 1 + 2 * std::fabs(random()), t = 1 + 0.9 * random();
    const Mat3d in_plane = rotation_matrix(Quatd::from_axis_angle({0, 0, 1}, 3 * random()));
    const Mat3d F = turn(random) * in_plane * Mat3d::diagonal({s, t, 1}) * transpose(in_plane);
    EXPECT_NEAR(static_cast<double>(membrane_strain(F, rest)), std::max(s, t) - 1, 1e-5 * (1 + s * s));
  }
  EXPECT_NEAR(membrane_strain(turn(random), rest), 0, 1e-6);
  EXPECT_NEAR(membrane_strain(Mat3d::diagonal({5.12, 1, 1}), rest), 4.12, 1e-4);
}

TEST(Strain, OfATetIsExactWhenPulledAlongOneAxis) {
  Random random(2);
  for (const double strain : {1e-3, 0.02, 0.3, 1.0, 4.0})
    for (const double across : {1.0, 0.97, 0.7}) {
      const Mat3d axes = turn(random);
      const Mat3d F = turn(random) * axes * Mat3d::diagonal({1 + strain, across, across}) * transpose(axes);
      EXPECT_NEAR(static_cast<double>(tet_strain(F)), strain, 1e-3 * strain + 1e-5)
          << "strain " << strain << ", across " << across;
    }
  EXPECT_NEAR(tet_strain(turn(random)), 0, 1e-5);
}

TEST(Strain, OfATetIsABoundOtherwise) {
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    const Vec3d s = Vec3d{1, 1, 1} + random.vector() * 0.8;
    const Mat3d F = turn(random) * Mat3d::diagonal(s) * turn(random);
    const double largest = std::max({s.x, s.y, s.z}) - 1;
    EXPECT_GE(static_cast<double>(tet_strain(F)), largest - 1e-4) << s.x << " " << s.y << " " << s.z;
    if (s.x * s.x + s.y * s.y + s.z * s.z > 1) {
      EXPECT_LT(static_cast<double>(tet_strain(F)), largest + 0.7) << s.x << " " << s.y << " " << s.z;
    }
  }
}

}  // namespace souple::test_constraints_strain
