#include "souple/math/polar_decomposition.h"
#include "souple/math/quaternion.h"
#include "tests/collision/random.h"

#include <cstdint>

#include <Eigen/SVD>
#include <gtest/gtest.h>

namespace souple::test_math_svd {

Mat3d rotation(test::Random& random) {
  const Vec3d axis = random.vector();
  return rotation_matrix(Quatd::from_axis_angle(normalized(axis), random.uniform(-pi, pi)));
}

Mat3d compose(test::Random& random, const Vec3d& sigma) {
  const Mat3d u = rotation(random);
  return u * Mat3d::diagonal(sigma) * transpose(rotation(random));
}

constexpr std::uint64_t family_count = 16;

// A matrix of one of the families that are known to be difficult for decompositions, with entries of about 1.
Mat3d matrix_of(std::uint64_t family, test::Random& random) {
  const Vec3d a = random.vector(), b = random.vector();
  const double s = random.uniform(-2, 2), t = random.uniform(-2, 2);
  const auto integer = [&] { return std::floor(random.uniform(-2, 3)); };
  switch (family) {
    case 0:
      return {a * s, a * t, a};  // rank 1
    case 1:
      return {a, b, a * s + b * t};  // rank 2
    case 2:
      return outer(a, b);  // rank 1
    case 3:
      return rotation(random);  // all singular values equal
    case 4:
      return rotation(random) * -1.0;  // the same, reflected
    case 5:
      return compose(random, {2, 2, s});  // the largest repeated
    case 6:
      return compose(random, {2, 1, 1});  // the smallest repeated
    case 7:
      return compose(random, {2, 1, -1});  // R not unique
    case 8:
      return compose(random, {2, 1 + 1e-9, 1});  // nearly repeated
    case 9:
      return compose(random, {1, 1e-9, -1e-9});  // nearly rank 1
    case 10:
      return compose(random, {1, 1, 1e-13 * s});  // nearly rank 2
    case 11:
      return compose(random, {1, 1e-20, 1e-30});  // rank 1 to rounding
    case 12:
      return Mat3d::diagonal({integer(), integer(), integer()});
    case 13: {
      Mat3d m;
      for (Vec3d& column : m.column)
        for (int i = 0; i < 3; ++i) column[i] = integer();
      return m;
    }
    default:
      return {a, b, random.vector()};
  }
}

double norm(const Mat3d& m) {
  return std::sqrt(frobenius_squared(m));
}

double distance_from_rotation(const Mat3d& q) {
  return norm(transpose(q) * q - Mat3d::identity()) + std::fabs(determinant(q) - 1);
}

Vec3d eigen_singular_values(const Mat3d& m) {
  Eigen::Matrix3d e;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) e(row, col) = m(row, col);
  const Eigen::Vector3d sigma = Eigen::JacobiSVD<Eigen::Matrix3d>(e).singularValues();
  return {sigma(0), sigma(1), sigma(2)};
}

/// Largest errors, in units of T's machine epsilon; errors with the unit of M are relative to |M|.
template <class T>
struct Errors {
  double rotations = 0, product = 0, order = 0, singular_values = 0, polar_rotation = 0, nearest = 0;

  // `m`: a matrix of numbers of type T. `sigma`: its singular values, by Eigen in double.
  void look_at(const Mat3<T>& matrix, const Vec3d& sigma) {
    const double epsilon = static_cast<double>(std::numeric_limits<T>::epsilon());
    const auto keep = [epsilon](double& largest, double error) {
      if (!(error / epsilon <= largest)) largest = error / epsilon;  // keeps a NaN
    };
    const double size = sigma.x > 0 ? sigma.x : 1.0;
    const Mat3d m = Mat3d(matrix) * (1 / size);
    const Svd<T> d = svd(matrix);
    const Mat3d u(d.u), v(d.v);
    const Vec3d s = Vec3d(d.sigma) / size, expected = sigma / size;
    keep(rotations, distance_from_rotation(u) + distance_from_rotation(v));
    keep(product, norm(u * Mat3d::diagonal(s) * transpose(v) - m));
    keep(order, std::fmax(s.y - s.x, std::fabs(s.z) - s.y));
    EXPECT_GE(s.y, 0);
    const double sign = determinant(m) < 0 ? -1 : 1;
    keep(singular_values,
         length(Vec3d{s.x, s.y, std::fabs(s.z)} - expected) +
             // where det M is above rounding, its sign must appear
             (expected.z > 100 * epsilon && expected.y > 1e-3 && s.z * sign < 0 ? 1.0 : 0.0));

    const Mat3d r(nearest_rotation(matrix));
    keep(polar_rotation, distance_from_rotation(r));
    // No rotation has a larger trace(R^T M) than sigma.x + sigma.y +- sigma.z.
    const double reached = trace(transpose(r) * m);
    keep(nearest, std::fabs(reached - (expected.x + expected.y + std::copysign(expected.z, s.z))));
  }

  // Sums of several errors of a few ulps each, Eigen's own among them.
  void expect_below(double bound) const {
    EXPECT_LT(rotations, bound);
    EXPECT_LT(product, bound);
    EXPECT_LT(order, bound);
    EXPECT_LT(singular_values, bound);
    EXPECT_LT(polar_rotation, bound);
    EXPECT_LT(nearest, bound);
  }
};

TEST(Svd, AgreesWithEigenOnAMillionMatrices) {
  test::Random random(2);
  Errors<double> of_double;
  Errors<float> of_float;
  for (std::uint64_t i = 0; i < 1000000; ++i) {
    const double scale = i % 3 == 0 ? 1.0 : std::pow(10.0, random.uniform(-30, 30));
    const Mat3d m = matrix_of(i % family_count, random) * scale;
    of_double.look_at(m, eigen_singular_values(m));
    if (i % 4 != 0 && i % 4 != 3) continue;  // every family at half its matrices in float as well
    const Mat3f rounded(m);
    of_float.look_at(rounded, eigen_singular_values(Mat3d(rounded)));
  }
  of_double.expect_below(24);
  of_float.expect_below(24);
}

template <class T>
class EverySvd : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(EverySvd, Scalars);

TYPED_TEST(EverySvd, ReflectionNegatesTheSmallestSingularValue) {
  using T = TypeParam;
  const Svd<T> d = svd(Mat3<T>::diagonal({T(1), T(2), T(-3)}));
  EXPECT_EQ(d.sigma, (Vec3<T>{T(3), T(2), T(-1)}));
  // The nearest rotation to a mirror image keeps the two longer axes: diag(-1, 1, -1) here.
  const Mat3<T> r = nearest_rotation(Mat3<T>::diagonal({T(1), T(2), T(-3)}));
  EXPECT_EQ(frobenius_squared(r - Mat3<T>::diagonal({T(-1), T(1), T(-1)})), T(0));
}

TYPED_TEST(EverySvd, ZeroAndIdentityGiveTheIdentity) {
  using T = TypeParam;
  for (const T s : {T(0), T(1), T(1e-30), T(1e30)}) {
    const Mat3<T> r = nearest_rotation(Mat3<T>::identity() * s);
    EXPECT_EQ(frobenius_squared(r - Mat3<T>::identity()), T(0));
  }
}

TYPED_TEST(EverySvd, WorksAtBothEndsOfTheExponent) {
  using T = TypeParam;
  const Mat3<T> turn(rotation_matrix(Quatd::from_axis_angle(normalized(Vec3d{1, 2, 3}), 1.0)));
  // A hundred steps above the smallest denormal, entries have two digits, and so has the rotation.
  const Mat3<T> tiny = turn * (std::numeric_limits<T>::denorm_min() * T(100));
  EXPECT_LT(frobenius_squared(nearest_rotation(tiny) - turn), T(1e-3));
  const Mat3<T> huge = turn * std::numeric_limits<T>::max();
  EXPECT_LT(frobenius_squared(nearest_rotation(huge) - turn), T(1e-12));
}

TYPED_TEST(EverySvd, TurnsWithTheMatrix) {
  using T = TypeParam;
  test::Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Mat3<T> m(compose(random, {2, 1, 0.3}));
    const Mat3<T> q(rotation(random));
    const Mat3<T> difference = nearest_rotation(q * m) - q * nearest_rotation(m);
    EXPECT_LT(std::sqrt(frobenius_squared(difference)), T(60) * std::numeric_limits<T>::epsilon());
  }
}

TYPED_TEST(EverySvd, EndsOnNonFiniteInput) {
  using T = TypeParam;
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    Mat3<T> m = Mat3<T>::identity();
    m(1, 2) = bad;
    EXPECT_FALSE(is_finite(svd(m).sigma));
  }
}

}  // namespace souple::test_math_svd
