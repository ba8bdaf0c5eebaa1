#include "souple/fluid/smoothing.h"

#include "souple/fluid/kernels/shapes.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace souple {

namespace {

/// A shape's functions of q, its support, and its measured constants (from columns of 25 to 75 layers at
/// rest).
struct ShapeFunctions {
  double support;  // in spacings
  double (*value)(double q);
  double (*slope)(double q);
  double density_factor;   // density of the packing at rest over that of the lattice
  double gradient_factor;  // g
  double mirror;           // a
};

template <class S>
constexpr ShapeFunctions shape_of(double support, double density, double gradient, double mirror) {
  return {
      support, [](double q) { return S::value(q); }, [](double q) { return S::slope(q); }, density, gradient,
      mirror};
}

ShapeFunctions find_shape(SmoothingShape shape) {
  switch (shape) {
    case SmoothingShape::poly6_spiky:
      return shape_of<kernels::Poly6Spiky>(2, 1.01, 1.04, 2.2);
    case SmoothingShape::cubic_spline:
      return shape_of<kernels::CubicSpline>(2, 1, 1.06, 2.2);
    case SmoothingShape::wide_wendland:
      return shape_of<kernels::Wendland>(2.3, 1, 1.02, 2.4);
    case SmoothingShape::wendland:
      break;
  }
  return shape_of<kernels::Wendland>(2, 1, 1.04, 2);
}

/// Sum of f(i, r^2) over the lattice of spacing 1 within a radius below 3, without the origin; i is the
/// coordinate along x.
template <class Function>
double lattice_sum(double radius, const Function& f) {
  double sum = 0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        const int r2 = i * i + j * j + k * k;
        if (r2 > 0 && r2 < radius * radius) sum += f(i, static_cast<double>(r2));
      }
  return sum;
}

/// The integrals of f from x to 1, for x = 0, 1 / n, ... 1.
template <class Function>
std::vector<double> integrals_to_one(int n, const Function& f) {
  std::vector<double> result(static_cast<std::size_t>(n) + 1, 0);
  for (int k = n; k-- > 0;)
    result[static_cast<std::size_t>(k)] = result[static_cast<std::size_t>(k) + 1] + f((k + 0.5) / n) / n;
  return result;
}

}  // namespace

Smoothing::Smoothing(float spacing, SmoothingShape which) : spacing_(spacing) {
  const ShapeFunctions shape = find_shape(which);
  const double d = spacing, volume = d * d * d, support = shape.support;
  const auto q = [&](double r2) { return std::sqrt(r2) / support; };
  const double value_sum =
      shape.value(0) + lattice_sum(support, [&](int, double r2) { return shape.value(q(r2)); });
  const double slope_sum =
      lattice_sum(support, [&](int, double r2) { return shape.slope(q(r2)) * r2; }) * d * d;
  const double value = shape.density_factor / (volume * value_sum);
  const double slope = -3 * shape.gradient_factor / (volume * slope_sum);
  const float h = static_cast<float>(support) * spacing;
  factors_ = {h, 1 / h, static_cast<float>(value), static_cast<float>(slope),
              static_cast<float>(std::ldexp(1.0, std::ilogb(volume)))};
  center_ = static_cast<float>(value * shape.value(0));
  mirror_ = static_cast<float>(shape.mirror);

  // Slices of a half-space are discs; P is the function whose gradient is slope(q) d.
  //   A(z) = integral_z^1 value(q) q dq,   H  ~ integral_z^1 A
  //   P(q) = -integral_q^1 slope(q) q dq,  H' ~ integral_z^1 P(q) q dq
  constexpr int fine = 32 * wall_steps;
  const auto at = [](const std::vector<double>& table, double x) {
    return table[static_cast<std::size_t>(std::min(x * fine, double{fine}))];
  };
  const std::vector<double> disc = integrals_to_one(fine, [&](double x) { return shape.value(x) * x; });
  const std::vector<double> half = integrals_to_one(fine, [&](double z) { return at(disc, z); });
  const std::vector<double> potential = integrals_to_one(fine, [&](double x) { return shape.slope(x) * x; });
  const std::vector<double> pull = integrals_to_one(fine, [&](double x) { return at(potential, x) * x; });
  const double layer_value =
      volume * value * lattice_sum(support, [&](int i, double r2) { return i < 0 ? shape.value(q(r2)) : 0; });
  const double layer_slope = volume * slope * d * lattice_sum(support, [&](int i, double r2) {
                               return i < 0 ? -i * shape.slope(q(r2)) : 0;
                             });
  for (int k = 0; k <= wall_steps; ++k) {
    const double z = static_cast<double>(k) / wall_steps;
    half_space_[static_cast<std::size_t>(k)] = {
        static_cast<float>(layer_value * at(half, z) / at(half, 0.5 / support)),
        static_cast<float>(layer_slope * at(pull, z) / at(pull, 0.5 / support))};
  }
}

Smoothing::Wall Smoothing::wall(float distance) const {
  const float z = 0.5f * spacing_ + mirror_ * (distance - 0.5f * spacing_);
  const float at = std::abs(z) * factors_.inverse_h * static_cast<float>(wall_steps);
  Wall here{0, 0};
  if (at < static_cast<float>(wall_steps)) {
    const auto step = static_cast<std::size_t>(at);
    const float t = at - static_cast<float>(step);
    const Wall &a = half_space_[step], &b = half_space_[step + 1];
    here = {a.value + t * (b.value - a.value), a.slope + t * (b.slope - a.slope)};
  }
  if (z < 0) here.value = 2 * half_space_[0].value - here.value;
  return {here.value, mirror_ * here.slope};
}

}  // namespace souple
