#pragma once

#include "souple/math/scalar.h"

#include <limits>
#include <type_traits>

namespace souple {

/// A value and its derivative along one direction: the scalar for forward-mode differentiation.
///
/// Set the derivative of one input to 1 (or those of several inputs to the components of a direction) and
/// evaluate. The derivative of the result is df/dt, exact to rounding:
///
///     Vec3<Dual<double>> x[2] = ...;
///     x[0].y.derivative = 1;
///     Distance::evaluate(x, params, gradient).derivative   // = gradient[0].y
///
/// Comparisons use values only. If a function has no derivative (sqrt at 0, acos at -1 and 1, abs and atan2 at 0), its
/// derivative counts as 0. Dual<Dual<T>> gives second derivatives.
template <class T>
struct Dual {
  T value{};
  T derivative{};

  constexpr Dual() = default;
  constexpr Dual(const T& value_, const T& derivative_) : value(value_), derivative(derivative_) {}
  /// A constant, with derivative 0. Implicit, so that plain numbers mix with duals as with float and double.
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number> || std::is_same_v<Number, T>>>
  constexpr Dual(const Number& constant) : value(static_cast<T>(constant)), derivative(T(0)) {}

  constexpr Dual& operator+=(const Dual& b) { return *this = *this + b; }
  constexpr Dual& operator-=(const Dual& b) { return *this = *this - b; }
  constexpr Dual& operator*=(const Dual& b) { return *this = *this * b; }
  constexpr Dual& operator/=(const Dual& b) { return *this = *this / b; }

  friend constexpr Dual operator+(const Dual& a) { return a; }
  friend constexpr Dual operator-(const Dual& a) { return {-a.value, -a.derivative}; }
  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.derivative + b.derivative};
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.derivative - b.derivative};
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
  }
  // (a / b)' = (a' - (a / b) b') / b, without squaring b.
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return {quotient, (a.derivative - quotient * b.derivative) / b.value};
  }

  friend constexpr auto operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend constexpr auto operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }
  friend constexpr auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend constexpr auto operator<=(const Dual& a, const Dual& b) { return a.value <= b.value; }
  friend constexpr auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend constexpr auto operator>=(const Dual& a, const Dual& b) { return a.value >= b.value; }
};

using Duald = Dual<double>;

template <class Condition, class T>
constexpr Dual<T> select(const Condition& condition, const Dual<T>& a, const Dual<T>& b) {
  return {select(condition, a.value, b.value), select(condition, a.derivative, b.derivative)};
}

template <class T>
constexpr auto value_of(const Dual<T>& a) {
  return value_of(a.value);
}

namespace detail {
// numerator / denominator, or 0 where the denominator is not positive.
template <class T>
T divide_where_positive(const T& numerator, const T& denominator) {
  const auto positive = denominator > T(0);
  return select(positive, numerator / select(positive, denominator, T(1)), T(0));
}
}  // namespace detail

template <class T>
Dual<T> sqrt(const Dual<T>& a) {
  const T root = sqrt(a.value);
  return {root, detail::divide_where_positive(a.derivative, T(2) * root)};
}

template <class T>
Dual<T> abs(const Dual<T>& a) {
  const T signed_slope = select(a.value < T(0), -a.derivative, a.derivative);
  return {abs(a.value), select(a.value == T(0), T(0), signed_slope)};
}

template <class T>
Dual<T> sin(const Dual<T>& a) {
  return {sin(a.value), cos(a.value) * a.derivative};
}

template <class T>
Dual<T> cos(const Dual<T>& a) {
  return {cos(a.value), -sin(a.value) * a.derivative};
}

template <class T>
Dual<T> acos(const Dual<T>& a) {
  // 1 - v^2 as (1 - v)(1 + v): accurate near 1 and -1. Outside [-1, 1] the value itself is NaN.
  const T square = (T(1) - a.value) * (T(1) + a.value);
  const auto inside = square > T(0);
  const T sine = sqrt(select(inside, square, T(1)));
  return {acos(a.value), select(inside, -a.derivative / sine, T(0))};
}

template <class T>
Dual<T> atan2(const Dual<T>& y, const Dual<T>& x) {
  const T numerator = x.value * y.derivative - y.value * x.derivative;
  return {atan2(y.value, x.value),
          detail::divide_where_positive(numerator, x.value * x.value + y.value * y.value)};
}

/// Like std::min and std::max: the first operand where the values are equal.
template <class T>
constexpr Dual<T> min(const Dual<T>& a, const Dual<T>& b) {
  return select(b.value < a.value, b, a);
}
template <class T>
constexpr Dual<T> max(const Dual<T>& a, const Dual<T>& b) {
  return select(a.value < b.value, b, a);
}

}  // namespace souple

/// Limits of the value's type, so that relative thresholds also work for duals.
template <class T>
class std::numeric_limits<souple::Dual<T>> : public std::numeric_limits<T> {};
