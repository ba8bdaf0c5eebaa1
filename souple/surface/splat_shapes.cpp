#include "souple/surface/splat_shapes.h"

#include "souple/error.h"

#include <cmath>

namespace souple {

namespace {

// Two thirds of the mesh's neighbors: a pool is as smooth, in two thirds of the time.
constexpr float neighbor_radius = 2.5f;
constexpr int few_neighbors = 7;  // within 2.5 d, the same part of all as the mesh's 12 within 3 d
// f: pools on a lattice, also with a jitter of 0.15 d, then end 0.5 d above their topmost layer.
constexpr float part_of_kernel = 0.53f;
// Radius of a ball with the volume of a particle, in spacings: (3 / 4 pi)^(1/3).
constexpr float drop_radius = 0.62035f;

SurfaceOptions options_of(float spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw Error("splats: spacing: expected the particles' distance, above 0 m");
  SurfaceOptions options;
  options.spacing = spacing;
  options.neighbor_radius = neighbor_radius;
  options.few_neighbors = few_neighbors;
  return options;
}

}  // namespace

SplatShapes::SplatShapes(float spacing) : options_(options_of(spacing)), particles_(options_) {}

void SplatShapes::build(std::span<const Vec3f> positions, Threads& threads) {
  const ActiveScope awake(threads);
  const float radius = options_.neighbor_radius * options_.spacing;
  const float limit = radius * 0x1p18f;  // within it, the coordinates of cells are in range
  positions_.clear();
  particle_.clear();
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const Vec3f& x = positions[i];
    if (!(std::abs(x.x) < limit && std::abs(x.y) < limit && std::abs(x.z) < limit)) continue;
    positions_.push_back({x.x, x.y, x.z, 0});
    particle_.push_back(i);
  }
  order_.build(positions_, radius, threads);
  neighbors_.find(order_, radius, threads);
  particles_.find(order_, neighbors_, threads);
  centers_.assign(positions.begin(), positions.end());
  axes_.assign(positions.size(), Mat3f{});
  threads.each(neighbors_.blocks().size(), 1, [&](std::size_t b) {
    const Neighbors::Block& block = neighbors_.blocks()[b];
    for (std::uint32_t sorted_index = block.begin; sorted_index < block.end; ++sorted_index) {
      const kernels::ParticleKernel& kernel = particles_.kernels()[sorted_index];
      const std::uint32_t i = particle_[order_.order()[sorted_index]];
      for (int a = 0; a < 3; ++a) centers_[i][a] = kernel.center[a] - kernel.shift[a];
      axes_[i] = axes_at(sorted_index, block.of(sorted_index).size());
    }
  });
}

Mat3f SplatShapes::axes_at(std::size_t sorted_index, std::size_t neighbors) const {
  if (neighbors <= few_neighbors) return Mat3f::identity() * (drop_radius * options_.spacing);
  if (particles_.is_surrounded(neighbors) && particles_.at_surface()[sorted_index] == 0) return {};
  const kernels::ParticleKernel& k = particles_.kernels()[sorted_index];
  return inverse(Mat3f({k.xx, k.xy, k.xz}, {k.xy, k.yy, k.yz}, {k.xz, k.yz, k.zz})) * part_of_kernel;
}

}  // namespace souple
