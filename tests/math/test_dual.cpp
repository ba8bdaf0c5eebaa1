#include "souple/constraints/distance.h"
#include "souple/math/dual.h"
#include "souple/math/mat3.h"

#include <gtest/gtest.h>

namespace souple::test_math_dual {

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

}  // namespace souple::test_math_dual
