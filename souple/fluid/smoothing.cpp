#include "souple/fluid/smoothing.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

// Of the continuum: Müller et al. 2003, equations 20 and 21.
double poly6_factor(double h) {
  return 315 / (64 * pi * std::pow(h, 9));
}
double spiky_factor(double h) {
  return -45 / (pi * std::pow(h, 6));
}

/// f(r^2) summed over the lattice within h, the origin left out.
template <class Function>
double lattice_sum(double spacing, double h, const Function& f) {
  const int n = static_cast<int>(std::ceil(h / spacing));
  double sum = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k) {
        const double r2 = spacing * spacing * (i * i + j * j + k * k);
        if (r2 > 0 && r2 < h * h) sum += f(r2);
      }
  return sum;
}

}  // namespace

Smoothing::Smoothing(float spacing, float support) : spacing_(spacing) {
  const double s = spacing, h = support, volume = s * s * s;
  const auto poly6 = [h](double r2) { return std::pow(h * h - r2, 3); };
  const auto spiky = [h](double r2) { return -std::pow(h - std::sqrt(r2), 2) * std::sqrt(r2); };
  const double density = volume * (std::pow(h, 6) + lattice_sum(s, h, poly6));
  const double gradient = volume * lattice_sum(s, h, spiky);
  factors_.h = support;
  factors_.poly6 = static_cast<float>(1 / density);
  factors_.spiky = static_cast<float>(3 / gradient);

  // A slice of the half-space at height z is a disc of radius sqrt(h^2 - z^2):
  //   integral of W over it = pi/4 poly6 (h^2 - z^2)^4,
  //   of the spiky kernel whose slope is (h - r)^2: -2 pi/3 integral_z^h (h - r)^3 r dr
  const auto disc_poly6 = [h](double z) { return pi / 4 * std::pow(h * h - z * z, 4); };
  const auto disc_spiky = [h](double z) {  // sum of W_spiky = (h - r)^3 / 3
    const double u = h - z;
    return 2 * pi / 3 * (h * std::pow(u, 4) / 4 - std::pow(u, 5) / 5);
  };
  constexpr int parts = 64;
  double density_above = 0;
  for (std::size_t step = wall_steps + 1; step-- > 0;) {
    const double z = h * static_cast<double>(step) / wall_steps, width = h / wall_steps / parts;
    if (step < wall_steps)
      for (int p = 0; p < parts; ++p) density_above += disc_poly6(z + (p + 0.5) * width) * width;
    wall_[step].density = static_cast<float>(poly6_factor(h) * density_above);
    wall_[step].slope = static_cast<float>(spiky_factor(h) * disc_spiky(z));
  }
}

float Smoothing::centre() const {
  const float h2 = factors_.h * factors_.h;
  return factors_.poly6 * h2 * h2 * h2;
}

Smoothing::Wall Smoothing::wall(float distance) const {
  const float at = std::max(distance, 0.0f) / factors_.h * static_cast<float>(wall_steps);
  if (!(at < static_cast<float>(wall_steps))) return {0, 0};
  const auto step = static_cast<std::size_t>(at);
  const float t = at - static_cast<float>(step);
  const Wall &a = wall_[step], &b = wall_[step + 1];
  return {a.density + t * (b.density - a.density), a.slope + t * (b.slope - a.slope)};
}

}  // namespace souple
