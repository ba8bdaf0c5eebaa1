#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/error.h"
#include "souple/math/quaternion.h"
#include "tests/constraints/examples.h"
#include "tests/constraints/small_body.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_constraints_single_constraints {

/// Projects `count` times without inertia.
template <class Kind>
void relax(SmallBody<Kind>& body, int count) {
  for (int k = 0; k < count; ++k) {
    body.step(1 / 60.0f, 1, 1, Mode::pbd);
    for (std::size_t i = 0; i < body.size(); ++i) body.set_velocity(i, {});
  }
}

// Without the factor 1/6 in the gradient, a rigid projection would leave 5/6 of the error.
TEST(TetVolume, OneProjectionRemovesTheError) {
  const auto rest = TetExample::points();
  const auto params = TetVolume::from_rest(raw<TetVolume>(rest));
  SmallBody<TetVolume> body;
  for (const Vec3d& x : rest) body.add_particle(x * 1.01, 1);
  body.projector.add({0, 1, 2, 3}, params);
  relax(body, 1);
  const double volume = tet_volume(body.at(0), body.at(1), body.at(2), body.at(3));
  const double error = std::fabs(volume / static_cast<double>(params.rest_volume) - 1);
  EXPECT_LT(error, 0.02 * (std::pow(1.01, 3) - 1));
}

TEST(TetVolume, OpensAFlatTet) {
  const auto rest = TetExample::points();
  SmallBody<TetVolume> body;
  for (const Vec3d& x : rest) body.add_particle({x.x, x.y, 0}, 1);
  body.projector.add({0, 1, 2, 3}, TetVolume::from_rest(raw<TetVolume>(rest)));
  relax(body, 50);
  EXPECT_NEAR(tet_volume(body.at(0), body.at(1), body.at(2), body.at(3)),
              tet_volume(rest[0], rest[1], rest[2], rest[3]), 1e-5);
}

/// Energy per area of a membrane with engineering strains along and across `warp` and in shear. [N/m]
double membrane_energy(const Vec3d& warp, double along, double across, double shear) {
  const Vec3d rest[3] = {{0.1, 0, 0}, {1, 0.2, 0}, {0.3, 0.8, 0}};
  const double area = 0.5 * length(cross(rest[1] - rest[0], rest[2] - rest[0]));
  const auto params = TriangleMembrane::from_rest(rest, warp);
  const Vec3d u = normalized(warp), v{-u.y, u.x, 0};
  Vec3d x[3];
  for (int i = 0; i < 3; ++i) {
    const double a = dot(rest[i], u), b = dot(rest[i], v);
    x[i] = u * (a * (1 + along) + b * shear) + v * (b * (1 + across));
  }
  double C[3];
  Vec3d gradient[3][3];
  TriangleMembrane::evaluate(x, converted<TriangleMembrane, double>(params), C, gradient);
  // S from the compliance: E = A/2 C^T S C with alpha = S^-1 / A.
  const auto alpha = TriangleMembrane::compliance(2000, 500, 0.4, 100, area);
  const double a00 = alpha[0], a10 = alpha[1], a11 = alpha[2], a22 = alpha[5], det = a00 * a11 - a10 * a10;
  EXPECT_EQ(alpha[3], 0);
  EXPECT_EQ(alpha[4], 0);
  const double energy =
      (a11 * C[0] * C[0] - 2 * a10 * C[0] * C[1] + a00 * C[1] * C[1]) / det + C[2] * C[2] / a22;
  return 0.5 * energy / area;
}

// Warp 2000 N/m, weft 500 N/m, Poisson's ratio 0.4 from warp to weft, shear 100 N/m, for all directions of
// the warp.
TEST(TriangleMembrane, HasTheStiffnessOfItsThreads) {
  const double s = 1e-4;
  for (const Vec3d& warp : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{1, 2, 0}}) {
    EXPECT_NEAR(membrane_energy(warp, s, -0.4 * s, 0) / (0.5 * s * s), 2000, 2);
    EXPECT_NEAR(membrane_energy(warp, -0.4 * 500 / 2000 * s, s, 0) / (0.5 * s * s), 500, 1);
    EXPECT_NEAR(membrane_energy(warp, 0, 0, s) / (0.5 * s * s), 100, 0.2);
  }
}

TEST(TriangleMembrane, RefusesImpossibleMaterials) {
  EXPECT_THROW(TriangleMembrane::compliance(500, 2000, 0.6, 100, 1), Error);
  EXPECT_NO_THROW(TriangleMembrane::compliance(2000, 500, 0.6, 100, 1));
  EXPECT_THROW(TriangleMembrane::compliance(0, 500, 0.3, 100, 1), Error);
  const Vec3d line[3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_THROW(TriangleMembrane::from_rest(line, {1, 0, 0}), Error);
}

// The three rows are solved together. A swinging triangle is stable for any modulus, iterations and substeps.
TEST(TriangleMembrane, CalmInEveryMode) {
  for (const Mode mode : {Mode::small_steps, Mode::xpbd, Mode::pbd})
    for (const double stiffness : {1e1, 1e3, 1e5})
      for (const int iterations : {1, 5, 20})
        for (const int substeps : {1, 5, 20}) {
          SmallBody<TriangleMembrane> body;
          const Vec3d rest[3] = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
          for (const Vec3d& x : rest) body.add_particle(x * 1.02, 0.001, body.size() == 0);
          body.projector.add({0, 1, 2}, TriangleMembrane::from_rest(rest, {1, 1, 0}),
                             TriangleMembrane::compliance(stiffness, stiffness, 0.3, stiffness / 4, 0.005));
          body.gravity = {0, -9.81f, 0};
          for (int frame = 0; frame < 300; ++frame) body.step(1 / 60.0f, substeps, iterations, mode);
          EXPECT_LT(body.kinetic_energy(), 0.002 * 9.81 * 0.5)
              << stiffness << " " << iterations << " " << substeps;
          // The weight causes a strain of about (m g / 0.1 m) / stiffness.
          const double edge = length(body.at(2) - body.at(1)) / (0.1 * std::sqrt(2.0));
          EXPECT_NEAR(edge, 1, 0.02 + 3 / stiffness) << stiffness << " " << iterations << " " << substeps;
        }
}

TEST(ParticleContact, PartsOverlappingAndCoincidentGrains) {
  for (const double gap : {0.0, 0.5, 2.0, 3.0}) {
    SmallBody<ParticleContact> body;
    body.add_particle({0, 0, 0}, 1);
    body.add_particle({gap, 0, 0}, 3);
    body.projector.add({0, 1}, {2.0f});
    relax(body, 3);
    EXPECT_NEAR(length(body.at(1) - body.at(0)), std::fmax(gap, 2.0), 1e-6) << "gap " << gap;
  }
}

// Two kilometers from the origin, a spring that sags by a millimeter has the exact extension.
TEST(Attachment, SpringFarFromTheOriginSags) {
  SmallBody<Attachment> body;
  const Vec3d target{1000, 2000, -500};
  body.add_particle(target, 0.1);
  const double stiffness = 981;
  body.projector.add({0}, {Vec3f(target)}, {static_cast<float>(1 / stiffness)});
  body.gravity = {0, -9.81f, 0};
  for (int frame = 0; frame < 600; ++frame) {
    body.step(1 / 60.0f, 10, 1, Mode::small_steps);
    body.set_velocity(0, body.velocity(0) * 0.8);
  }
  EXPECT_NEAR(target.y - body.at(0).y, 0.1 * 9.81 / stiffness, 1e-6);
}

TEST(BallJoint, HoldsTwoRodsTogether) {
  const Vec3d rest[4] = {{0, 0, 0}, {1, 0, 0}, {0.75, 0, 0}, {0.75, 1, 0}};
  SmallBody<BallJoint> body;
  Random random(2);
  for (const Vec3d& x : rest) body.add_particle(x + random.vector() * 0.3, 1);
  body.projector.add({0, 1, 2, 3}, BallJoint::from_rest(rest, {0.75, 0, 0}));
  relax(body, 20);
  const Vec3d on_first = body.at(0) + (body.at(1) - body.at(0)) * 0.75;
  EXPECT_LT(length(on_first - body.at(2)), 1e-6);
}

// The general form: connects a point of a triangle to a point of a tet.
TEST(BallJoint, HoldsATriangleToATet) {
  using Joint = BallJointBetween<3, 4>;
  SmallBody<Joint> body;
  Random random(4);
  for (int i = 0; i < 7; ++i) body.add_particle(random.vector(), 1 + i);
  body.projector.add({0, 1, 2, 3, 4, 5, 6}, {{0.2f, 0.3f, 0.1f, 0.4f, 0.25f}});
  relax(body, 20);
  const Vec3d a = body.at(0) * 0.5 + body.at(1) * 0.2 + body.at(2) * 0.3;
  const Vec3d b = body.at(3) * 0.25 + body.at(4) * 0.1 + body.at(5) * 0.4 + body.at(6) * 0.25;
  EXPECT_LT(length(a - b), 1e-6);
}

double angle_between(const Vec3d& u, const Vec3d& v) {
  return std::atan2(length(cross(u, v)), dot(u, v));
}

TEST(ConeLimit, BringsTheSegmentIntoTheCone) {
  for (const double turn : {0.0, 0.5, 1.0, 2.0, 3.0, pi}) {
    SmallBody<ConeLimit> body;
    body.add_particle({-1, 0, 0}, 1);
    body.add_particle({0, 0, 0}, 2);
    body.add_particle({std::cos(turn), std::sin(turn), 0}, 1);
    body.projector.add({0, 1, 2}, {0.6f});
    relax(body, 200);
    const double angle = angle_between(body.at(1) - body.at(0), body.at(2) - body.at(1));
    // Large angles are overcorrected slightly, because the angle is far from linear in the positions.
    EXPECT_LE(angle, std::fmin(turn, 0.6) + 1e-3) << "turned by " << turn;
    EXPECT_GE(angle, std::fmin(turn, 0.45)) << "turned by " << turn;
  }
}

TEST(TwistLimit, LetsTwistUpToTheLimit) {
  const auto twisted = [](double turn) {
    return std::array<Vec3d, 4>{{{0, 0, 0}, {2, 0, 0}, {0.3, 1, 0}, {1.7, std::cos(turn), std::sin(turn)}}};
  };
  const auto twist = [](const SmallBody<TwistLimit>& body) {
    const Vec3d axis = normalized(body.at(1) - body.at(0));
    const Vec3d a = cross(axis, body.at(2) - body.at(0)), b = cross(axis, body.at(3) - body.at(0));
    return angle_between(a, b);
  };
  const auto rest = twisted(0);
  const auto params = TwistLimit::from_rest(raw<TwistLimit>(rest), 0.5);
  for (const double turn : {-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0}) {
    SmallBody<TwistLimit> body;
    for (const Vec3d& x : twisted(turn)) body.add_particle(x, 1);
    body.projector.add({0, 1, 2, 3}, params);
    relax(body, 100);
    EXPECT_NEAR(twist(body), std::fmin(std::fabs(turn), 0.5), 1e-3) << "turned by " << turn;
  }
}

TEST(Tether, HoldsOnlyWhenTaut) {
  for (const double distance : {0.0, 0.5, 1.0, 1.5}) {
    SmallBody<Tether> body;
    body.add_particle({0, -distance, 0}, 1);
    body.add_particle({0, 0, 0}, 1, true);
    body.projector.add({0, 1}, {1.0f});
    relax(body, 2);
    EXPECT_NEAR(-body.at(0).y, std::fmin(distance, 1.0), 1e-6);
    EXPECT_EQ(length(body.at(1)), 0);
  }
}

// The strain that reports state, compared with the singular values of the deformation.

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

}  // namespace souple::test_constraints_single_constraints
