#include "souple/math/elementary.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

// Against the C library's long doubles, in units in the last place of the double nearest to them.

namespace souple::test::test_math_elementary {

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

}  // namespace souple::test::test_math_elementary
