#include "souple/constraints/distance.h"
#include "souple/math/dual.h"
#include "souple/math/elementary.h"
#include "souple/math/mat3.h"
#include "souple/math/vec3.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace souple::test::test_math_elementary {

// Against the C library's long doubles, in units in the last place of the double nearest to them.

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largest_error = 3;

double units(double value, long double expected) {
  const double nearest = std::abs(static_cast<double>(expected));
  return static_cast<double>(std::abs(value - expected) / (std::nextafter(nearest, infinity) - nearest));
}

template <class Function, class Reference>
void expect_close(const char* name, double low, double high, Function function, Reference reference) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> between(low, high);
  for (int i = 0; i < 20000; ++i) {
    const double x = between(random);
    ASSERT_LT(units(function(x), reference(static_cast<long double>(x))), largest_error)
        << name << " of " << x;
  }
}

template <class T>
T sine(T x) {
  return std::sin(x);
}
template <class T>
T cosine(T x) {
  return std::cos(x);
}

TEST(Elementary, AnglesAreThoseOfTheLibrary) {
  for (const double size : {1e-8, 0.1, 1.0, 10.0, 1000.0, 1e6}) {
    expect_close("sin", -size, size, elementary::sin, sine<long double>);
    expect_close("cos", -size, size, elementary::cos, cosine<long double>);
  }
  expect_close("asin", -1, 1, elementary::asin, [](long double x) { return std::asin(x); });
  expect_close("acos", -1, 1, elementary::acos, [](long double x) { return std::acos(x); });
  for (const double x : {-2.5, -1.0, -1e-9, 0.0, 1e-300, 0.3, 4e8})
    expect_close(
        "atan2", -2, 2, [&](double y) { return elementary::atan2(y, x); },
        [&](long double y) { return std::atan2(y, static_cast<long double>(x)); });
}

TEST(Elementary, FarAnglesKeepThePeriodOfADouble) {
  for (const double x : {3e6, 1e9, -7.7e15, 1e300}) {
    EXPECT_NEAR(elementary::sin(x), std::sin(std::remainder(x, 2 * 3.14159265358979323846)), 1e-15);
    EXPECT_NEAR(elementary::cos(x), std::cos(std::remainder(x, 2 * 3.14159265358979323846)), 1e-15);
  }
}

TEST(Elementary, PowersAreThoseOfTheLibrary) {
  for (const double size : {1e-6, 1.0, 700.0})
    expect_close("exp", -size, size, elementary::exp, [](long double x) { return std::exp(x); });
  for (const double size : {1e-300, 1.5, 1e30})
    expect_close("log", 0, size, elementary::log, [](long double x) { return std::log(x); });
  for (const double size : {1e-300, 1.0, 1e30})
    expect_close("cbrt", -size, size, elementary::cbrt, [](long double x) { return std::cbrt(x); });
  for (const double y : {-3.0, 0.2, 1.0, 8.0})
    expect_close(
        "hypot", -3, 3, [&](double x) { return elementary::hypot(x, y); },
        [&](long double x) { return std::hypot(x, static_cast<long double>(y)); });
  for (const double y : {-20.0, -0.4, 0.1, 0.5, 3.0}) {
    for (const double x : {1e-9, 0.3, 1.0, 17.0, 1e12}) {
      const double expected = std::pow(x, y);
      EXPECT_NEAR(elementary::pow(x, y), expected, 4e-16 * expected * (1 + std::abs(y * std::log(x))))
          << x << " " << y;
    }
  }
}

TEST(Elementary, EdgesAreThoseOfTheStandard) {
  const double pi = 3.14159265358979323846, nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(elementary::atan2(0, 0), 0);
  EXPECT_EQ(elementary::atan2(0, -1), pi);
  EXPECT_EQ(elementary::atan2(-0.0, -1), -pi);
  EXPECT_EQ(elementary::atan2(1, 0), pi / 2);
  EXPECT_EQ(elementary::atan2(infinity, infinity), pi / 4);
  EXPECT_EQ(elementary::atan2(1, -infinity), pi);
  EXPECT_TRUE(std::isnan(elementary::atan2(nan, 1)));
  EXPECT_EQ(elementary::asin(1), pi / 2);
  EXPECT_EQ(elementary::acos(-1), pi);
  EXPECT_TRUE(std::isnan(elementary::acos(1.0000001)));
  EXPECT_TRUE(std::isnan(elementary::sin(infinity)));
  EXPECT_EQ(elementary::exp(0), 1);
  EXPECT_EQ(elementary::exp(-1000), 0);
  EXPECT_EQ(elementary::exp(1000), infinity);
  EXPECT_TRUE(std::isnan(elementary::exp(nan)));
  EXPECT_EQ(elementary::log(1), 0);
  EXPECT_EQ(elementary::log(0), -infinity);
  EXPECT_TRUE(std::isnan(elementary::log(-1)));
  EXPECT_EQ(elementary::pow(0, 0.5), 0);
  EXPECT_EQ(elementary::pow(5, 0), 1);
  EXPECT_TRUE(std::isnan(elementary::pow(-2, 0.5)));
  EXPECT_EQ(elementary::cbrt(-27), -3);
  EXPECT_EQ(elementary::cbrt(infinity), infinity);
  EXPECT_LT(units(elementary::hypot(3e200, 4e200), 5e200L), largest_error);
  EXPECT_EQ(elementary::hypot(0, 0), 0);
}

// The rounding remainder of a double as a float. g++ 12 gives 0 here when it vectorizes straight-line code,
// which the build turns off: positions would lose the remainder that offsets keep.
Vec3f remainder_of(const Vec3d& x) {
  return Vec3f(x - Vec3d(Vec3f(x)));
}

TEST(Rounding, TheRemainderOfAFloatSurvivesTheOptimizer) {
  volatile double x = -0.2, y = 0.6, z = 1000.1;
  const Vec3f lost = remainder_of({x, y, z});
  EXPECT_EQ(lost.x, static_cast<float>(-0.2 - static_cast<double>(-0.2f)));
  EXPECT_EQ(lost.y, static_cast<float>(0.6 - static_cast<double>(0.6f)));
  EXPECT_EQ(lost.z, static_cast<float>(1000.1 - static_cast<double>(1000.1f)));
  EXPECT_NE(lost.x, 0);
}

// The derivative of f at x by duals against central differences: error about 1e-10 here.
template <class Function>
void expect_derivative(Function f, double x) {
  const double step = 1e-5;
  const double difference = (f(Duald(x + step)).value - f(Duald(x - step)).value) / (2 * step);
  EXPECT_NEAR(f(Duald(x, 1.0)).derivative, difference, 1e-8 * (1 + std::fabs(difference))) << "x = " << x;
}

TEST(Dual, MatchesDifferencesOfEveryFunction) {
  for (const double x : {-0.83, -0.4, 0.3, 0.77}) {
    expect_derivative([](Duald a) { return a * a * a - 2 * a + 1.0f; }, x);
    expect_derivative([](Duald a) { return (a + 1) / (a * a + 3); }, x);
    expect_derivative([](Duald a) { return sqrt(a + 2); }, x);
    expect_derivative([](Duald a) { return sin(a) * cos(3 * a); }, x);
    expect_derivative([](Duald a) { return acos(a); }, x);
    expect_derivative([](Duald a) { return abs(a) * a; }, x);
    expect_derivative([](Duald a) { return atan2(a - 0.1, 2 * a + 0.1); }, x);
    expect_derivative([](Duald a) { return min(a, a * a) + max(sin(a), Duald(0.1)); }, x);
    expect_derivative([](Duald a) { return select(a > 0, a * a, -a); }, x);
    expect_derivative([](Duald a) { return -a + +a * a; }, x);
  }
}

TEST(Dual, CompoundAssignmentsAreTheOperators) {
  Duald a(1.5, 2.0);
  const Duald b(0.7, -1.0);
  a += b;
  a *= b;
  a -= 2;
  a /= b;
  const Duald expected = ((Duald(1.5, 2.0) + b) * b - 2) / b;
  EXPECT_EQ(a.value, expected.value);
  EXPECT_EQ(a.derivative, expected.derivative);
}

TEST(Dual, HasZeroDerivativeWhereThereIsNone) {
  for (const double slope : {0.0, 1.0, -3.0}) {
    EXPECT_EQ(sqrt(Duald(0, slope)).derivative, 0);
    EXPECT_EQ(abs(Duald(0, slope)).derivative, 0);
    EXPECT_EQ(acos(Duald(1, slope)).derivative, 0);
    EXPECT_EQ(acos(Duald(-1, slope)).derivative, 0);
    EXPECT_EQ(atan2(Duald(0, slope), Duald(0, 1)).derivative, 0);
  }
}

TEST(Dual, ComparesValuesOnly) {
  EXPECT_TRUE(Duald(1, 5) == Duald(1, 7));
  EXPECT_TRUE(Duald(1, 5) < Duald(2, -7));
  EXPECT_TRUE(Duald(1, 5) <= 1);
  EXPECT_TRUE(2.0f > Duald(1, 5));
  EXPECT_TRUE(Duald(1, 5) != 2);
  EXPECT_EQ(value_of(Duald(3, 5)), 3.0);
}

TEST(Dual, NestsForSecondDerivatives) {
  using Second = Dual<Duald>;
  const Second x(Duald(0.3, 1), Duald(1, 0));
  EXPECT_NEAR(sin(x * x).derivative.derivative, 2 * std::cos(0.09) - 0.36 * std::sin(0.09), 1e-14);
  EXPECT_EQ(value_of(x), 0.3);
}

TEST(Dual, DifferentiatesADeterminantIntoItsCofactors) {
  Mat3<Duald> m({0.2, -1.0, 0.5}, {1.5, 0.3, -0.7}, {-0.4, 0.8, 1.1});
  const Mat3<Duald> expected = cofactor(m);
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) {
      m(row, col).derivative = 1;
      EXPECT_NEAR(determinant(m).derivative, expected(row, col).value, 1e-14);
      m(row, col).derivative = 0;
    }
}

TEST(Dual, ChecksAConstraintsGradient) {
  Vec3<Duald> x[2] = {{0.1, 0.2, 0.3}, {-1.0, 0.5, 2.0}};
  for (int particle = 0; particle < 2; ++particle)
    for (int axis = 0; axis < 3; ++axis) {
      Vec3<Duald> gradient[2];
      x[particle][axis].derivative = 1;
      const Duald C = Distance::evaluate(x, Distance::Params<Duald>{Duald(0.5)}, gradient);
      EXPECT_NEAR(C.derivative, gradient[particle][axis].value, 1e-15);
      x[particle][axis].derivative = 0;
    }
}

}  // namespace souple::test::test_math_elementary
