#pragma once

#include "souple/fluid/fluid_view.h"
#include "tests/collision/random.h"

#include <memory>
#include <vector>

namespace souple::test {

/// Particles by sorted index with neighbor lists, without a pressure solver.
struct FluidArrays {
  float mass;
  Smoothing smoothing;
  std::unique_ptr<Threads> threads;
  CellOrder order;
  Neighbors neighbors;
  std::vector<Vec4f> x, v;

  /// `density` [kg/m^3], `mu` [Pa s].
  FluidArrays(const std::vector<Vec4f>& positions, float spacing, float density, float mu,
              int thread_count = 2, SmoothingShape shape = SmoothingShape::wendland)
      : mass(density * spacing * spacing * spacing),
        smoothing(spacing, shape),
        threads(make_threads(Threading::pool, thread_count)) {
    order.build(positions, smoothing.support(), *threads);
    neighbors.find(order, smoothing.support(), *threads);
    for (const std::uint32_t i : order.order()) {
      x.push_back(positions[i]);
      x.back().w = 1 / mass;
      v.push_back({0, 0, 0, mu});
    }
    x.push_back({1e15f, 1e15f, 1e15f, 0});
    v.push_back({});
  }
  std::size_t size() const { return x.size() - 1; }
  FluidView view() { return {x, v, neighbors, smoothing}; }
  /// Velocities f(position) [m/s].
  template <class Function>
  void set_velocities(const Function& f) {
    for (std::size_t k = 0; k < size(); ++k) v[k].set_xyz(f(x[k].xyz()));
  }
  Vec3d momentum() const {
    Vec3d sum{};
    for (std::size_t k = 0; k < size(); ++k) sum += Vec3d(v[k].xyz()) * (1 / double{x[k].w});
    return sum;
  }
  Vec3d angular_momentum() const {
    Vec3d sum{};
    for (std::size_t k = 0; k < size(); ++k)
      sum += cross(Vec3d(x[k].xyz()), Vec3d(v[k].xyz())) * (1 / double{x[k].w});
    return sum;
  }
  double energy() const {
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k)
      sum += 0.5 * double{dot(v[k].xyz(), v[k].xyz())} / double{x[k].w};
    return sum;
  }
};

/// A lattice block with a corner at the origin; each particle is displaced by up to `jitter` spacings along
/// each axis.
inline std::vector<Vec4f> block_of(int nx, int ny, int nz, float d, float jitter = 0) {
  Random random(7);
  std::vector<Vec4f> result;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const Vec3f off(random.point(-double{jitter}, double{jitter}));
        result.push_back(
            {(float(x) + 0.5f + off.x) * d, (float(y) + 0.5f + off.y) * d, (float(z) + 0.5f + off.z) * d, 0});
      }
  return result;
}

/// Lattice positions within `radius` of the origin.
inline std::vector<Vec4f> ball_of(float radius, float d) {
  std::vector<Vec4f> result;
  const int n = static_cast<int>(radius / d) + 1;
  for (int z = -n; z < n; ++z)
    for (int y = -n; y < n; ++y)
      for (int x = -n; x < n; ++x) {
        const Vec3f p((float(x) + 0.5f) * d, (float(y) + 0.5f) * d, (float(z) + 0.5f) * d);
        if (dot(p, p) < radius * radius) result.push_back({p.x, p.y, p.z, 0});
      }
  return result;
}

}  // namespace souple::test
