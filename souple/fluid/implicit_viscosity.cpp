#include "souple/fluid/implicit_viscosity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace souple {

namespace {

constexpr std::size_t chunk = 1024;

// Sum of (1 - r / 2) r^2 over the lattice of spacing 1: 6 neighbors at 1, 12 at sqrt 2, 8 at sqrt 3.
constexpr float viscosity_sum = 3 + 24 * (1 - 0.70710678f) + 24 * (1 - 0.86602540f);

double square(const Vec3f& a) {
  const Vec3d b(a);
  return dot(b, b);
}

}  // namespace

// The impulse of all neighbors on a particle within the substep [N s].
Vec3f ImplicitViscosity::force(const System& system, std::span<const Vec4f> values, std::uint32_t k,
                               std::span<const std::uint32_t> list) const {
  const Smoothing& smoothing = system.fluid.smoothing;
  const float V = smoothing.volume();
  const Vec3f strain = kernels_->strain(system.fluid.x.data(), values.data(), system.fluid.x[k], values[k],
                                        list.data(), list.size(), smoothing.factors());
  const float b = 3 / (V * viscosity_sum * smoothing.spacing() * smoothing.spacing());
  return strain * (10 * V * V * b * system.h);
}

// Impulse that walls take from a particle per velocity, a mass [kg].
float ImplicitViscosity::wall_drag(const System& system, std::size_t k) const {
  if (system.walls.empty()) return 0;
  const Smoothing& smoothing = system.fluid.smoothing;
  return system.h * smoothing.volume() * system.fluid.v[k].w * wall_friction(smoothing, system.walls[k].w);
}

// r = b - A v,  A v = m v - forces' impulse + wall_drag v,  b = m v* + wall_drag v_wall; p = r / m.
void ImplicitViscosity::begin(const System& system) {
  const FluidView& fluid = system.fluid;
  const std::size_t n = fluid.size();
  direction_.resize(n + 1);
  residual_.resize(n);
  product_.resize(n);
  chunks_.resize((n + chunk - 1) / chunk);
  fluid.for_lists(system.threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    Vec3f r = force(system, fluid.v, k, list);
    if (!system.walls.empty()) r += (system.walls[k].xyz() - fluid.v[k].xyz()) * wall_drag(system, k);
    residual_[k] = r;
  });
  for_each_index(n, system.threads, [&](std::size_t k) {
    direction_[k].set_xyz(residual_[k] * fluid.x[k].w);
    direction_[k].w = fluid.v[k].w;
  });
  direction_[n] = {};
}

// product = A direction
void ImplicitViscosity::apply_matrix(const System& system) {
  const FluidView& fluid = system.fluid;
  fluid.for_lists(system.threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    const Vec3f p = direction_[k].xyz();
    product_[k] = p * (1 / fluid.x[k].w + wall_drag(system, k)) - force(system, direction_, k, list);
  });
}

// Sum of term(k) over all particles: fixed chunks, added in order.
template <class Term>
double ImplicitViscosity::sum(const System& system, const Term& term) {
  const std::size_t n = system.fluid.size();
  system.threads.each(chunks_.size(), 1, [&](std::size_t c) {
    chunks_[c] = 0;
    for (std::size_t k = c * chunk; k < std::min(n, (c + 1) * chunk); ++k) chunks_[c] += term(k);
  });
  return std::accumulate(chunks_.begin(), chunks_.end(), 0.0);
}

ImplicitViscosity::Report ImplicitViscosity::apply(const FluidView& fluid, WallFriction walls, float h,
                                                   Threads& threads) {
  const System system{fluid, walls, h, threads};
  begin(system);
  const auto weighted = [&](std::size_t k) {
    return square(residual_[k]) * static_cast<double>(fluid.x[k].w);
  };
  const double first = sum(system, weighted);
  const double enough =
      first * static_cast<double>(options_.tolerance) * static_cast<double>(options_.tolerance);
  double rz = first;
  Report report;
  while (report.iterations < options_.max_iterations && rz > enough) {
    apply_matrix(system);
    const double curvature =
        sum(system, [&](std::size_t k) { return dot(Vec3d(direction_[k].xyz()), Vec3d(product_[k])); });
    const auto alpha = static_cast<float>(rz / curvature);
    for_each_index(fluid.size(), threads, [&](std::size_t k) {
      fluid.v[k].set_xyz(fluid.v[k].xyz() + direction_[k].xyz() * alpha);
      residual_[k] -= product_[k] * alpha;
    });
    const double next = sum(system, weighted);
    const auto beta = static_cast<float>(next / rz);
    for_each_index(fluid.size(), threads, [&](std::size_t k) {
      direction_[k].set_xyz(residual_[k] * fluid.x[k].w + direction_[k].xyz() * beta);
    });
    rz = next;
    ++report.iterations;
  }
  report.residual = first > 0 ? static_cast<float>(std::sqrt(rz / first)) : 0;
  return report;
}

}  // namespace souple
