#include "souple/surface/fluid_surface.h"

#include "souple/error.h"
#include "souple/surface/kernels/find_kernels.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>

namespace souple {

namespace {

void require(bool fine, const char* what) {
  if (!fine) throw Error(std::string("surface: ") + what);
}

void check(const SurfaceOptions& o) {
  require(o.spacing > 0 && std::isfinite(o.spacing), "spacing: expected the particles' distance, above 0 m");
  require(o.cell >= 0 && std::isfinite(o.cell), "cell: expected 0 or a length [m]");
  require(o.cell == 0 || (o.cell >= 0.05f * o.spacing && o.cell <= 10 * o.spacing),
          "cell: expected 0.05 to 10 spacings");
  require(o.neighbor_radius >= 1.5f && o.neighbor_radius <= 6, "neighbor_radius: expected 1.5 to 6");
  require(o.center_smoothing >= 0 && o.center_smoothing <= 1, "center_smoothing: expected 0 to 1");
  require(o.kernel_radius >= 1 && o.kernel_radius <= 8, "kernel_radius: expected 1 to 8");
  require(o.isotropic_radius >= 1 && o.isotropic_radius <= 8, "isotropic_radius: expected 1 to 8");
  require(o.drop_radius >= 0.5f && o.drop_radius <= 8, "drop_radius: expected 0.5 to 8");
  require(o.max_axis_ratio >= 1 && o.max_axis_ratio <= 100, "max_axis_ratio: expected 1 to 100");
  require(o.few_neighbors >= 0, "few_neighbors: expected 0 or more");
  require(o.level >= 0 && o.level < 1, "level: expected 0, or up to 1");
  require(o.smoothing_passes >= 0, "smoothing_passes: expected 0 or more");
  require(o.smoothing >= 0 && o.smoothing <= 1, "smoothing: expected 0 to 1");
}

constexpr int samples = 16;  // four by four across a lattice cell

/// The field at points, one on each of `samples` vertical lines.
struct Samples {
  float at[3][samples], value[samples], gradient[3][samples], shift[3][samples], crowd[samples];
  kernels::FieldPoints points() {
    return {{at[0], at[1], at[2]},
            value,
            {gradient[0], gradient[1], gradient[2]},
            {shift[0], shift[1], shift[2]},
            crowd};
  }
};

/// A lattice without jitter, with its topmost layer at z = 0, so wide and deep that its other boundaries have
/// no effect above its middle.
std::vector<Vec4f> lattice_pool(const SurfaceOptions& options) {
  const float widest = std::max(1.5f * options.kernel_radius, options.isotropic_radius);
  const int half = static_cast<int>(std::ceil(widest + options.neighbor_radius)) + 1;
  const auto at = [&](int k) { return static_cast<float>(k) * options.spacing; };
  std::vector<Vec4f> points;
  for (int k = 0; k < half; ++k)
    for (int j = -half; j < half; ++j)
      for (int i = -half; i < half; ++i) points.push_back({at(i), at(j), -at(k), 0});
  return points;
}

/// The kernels of a lattice_pool, and their field.
class Pool {
 public:
  explicit Pool(const SurfaceOptions& options) : kernels_(options) {
    const float radius = options.neighbor_radius * options.spacing;
    const std::vector<Vec4f> points = lattice_pool(options);
    const auto serial = make_threads(Threading::serial, 1);
    CellOrder order;
    Neighbors neighbors;
    order.build(points, radius, *serial);
    neighbors.find(order, radius, *serial);
    kernels_.find(order, neighbors, *serial);
    all_.resize(points.size());
    std::iota(all_.begin(), all_.end(), 0u);
  }
  void sample(Samples& at) const {
    functions_.points(kernels_.kernels().data(), all_.data(), all_.size(), at.points(), samples);
  }

 private:
  const kernels::SurfaceKernels& functions_ = kernels::find_surface_kernels(instruction_set());
  ParticleKernels kernels_;
  std::vector<std::uint32_t> all_;
};

/// The level of the field at the surface of a pool, which is half a spacing above the topmost layer of a
/// lattice. Vertices are there after they are moved back by the shift of the centers:
///
///   level = mean of field(z_s),   z_s - shift(z_s) = d / 2,   s over a cell of the lattice
///
/// So a pool has the right height, and the volume of a body of fluid is right where its surface is flat.
/// Found by bisection.
float pool_level(const SurfaceOptions& options) {
  const float d = options.spacing;
  const Pool pool(options);
  Samples sample;
  float low[samples], high[samples];
  for (int s = 0; s < samples; ++s) {
    const int row = s / 4;
    sample.at[0][s] = (static_cast<float>(s % 4) + 0.5f) * d / 4;
    sample.at[1][s] = (static_cast<float>(row) + 0.5f) * d / 4;
    low[s] = -2 * d, high[s] = 2 * d;
  }
  for (int halving = 0; halving < 24; ++halving) {
    for (int s = 0; s < samples; ++s) sample.at[2][s] = 0.5f * (low[s] + high[s]);
    pool.sample(sample);
    for (int s = 0; s < samples; ++s) {
      const float lies = sample.at[2][s] - sample.shift[2][s];
      (lies > 0.5f * d ? high[s] : low[s]) = sample.at[2][s];
    }
  }
  return std::accumulate(std::begin(sample.value), std::end(sample.value), 0.0f) / samples;
}

SurfaceOptions completed(SurfaceOptions options) {
  check(options);
  if (options.cell == 0) options.cell = options.spacing / 2;
  if (options.level == 0) {
    options.level = pool_level(options);
    require(options.level > 0.02f,
            "kernels are too small: the surface of a pool is beyond them; take a larger kernel_radius");
  }
  return options;
}

}  // namespace

FluidSurface::FluidSurface(const SurfaceOptions& options)
    : options_(completed(options)), particles_(options_), field_(options_.cell, options_.level) {}

const SurfaceMesh& FluidSurface::build(std::span<const Vec3f> positions, Threads& threads) {
  const ActiveScope awake(threads);
  const float radius = options_.neighbor_radius * options_.spacing;
  // Within this distance, the coordinates of cells and bricks are in range.
  const float limit = std::min(radius, 4 * options_.cell) * 0x1p18f;
  positions_.clear();
  for (const Vec3f& x : positions)
    if (std::abs(x.x) < limit && std::abs(x.y) < limit && std::abs(x.z) < limit)
      positions_.push_back({x.x, x.y, x.z, 0});
  order_.build(positions_, radius, threads);
  neighbors_.find(order_, radius, threads);
  particles_.find(order_, neighbors_, threads);
  field_.build(order_, radius, particles_, threads);
  cubes_.extract(field_, mesh_, threads);
  if (options_.smoothing_passes > 0)
    smoothing_.smooth(mesh_, cubes_.crowd(), options_.smoothing_passes, options_.smoothing, threads);
  return mesh_;
}

}  // namespace souple
