#include "souple/surface/particle_kernels.h"

#include "souple/math/svd.h"
#include "souple/surface/kernels/find_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {

using kernels::Moments;
using kernels::ParticleKernel;

namespace {

// W(0) h^3 of poly6, which integrates to 1.
constexpr float poly6_center = 315.0f / (64.0f * static_cast<float>(pi));
constexpr float max_axis = 1.5f;  // relative to an axis inside the fluid: limits the kernels of wisps
// Boxes are slightly larger than the support, against rounding.
constexpr float box_growth = 1.001f;

/// Sum w z^2 / sum w over a cubic lattice of spacing 1, w = 1 - (r / radius)^3.
float lattice_variance(float radius) {
  const int n = static_cast<int>(std::ceil(radius));
  double sum = 0, weighted = 0;
  for (int i = -n; i <= n; ++i) {
    for (int j = -n; j <= n; ++j) {
      for (int k = -n; k <= n; ++k) {
        const double r = std::sqrt(double{1} * (i * i + j * j + k * k)) / static_cast<double>(radius);
        const double w = r < 1 ? 1 - r * r * r : 0;
        sum += w, weighted += w * k * k;
      }
    }
  }
  return static_cast<float>(weighted / sum);
}

}  // namespace

KernelBox KernelBox::none() {
  constexpr float far = std::numeric_limits<float>::infinity();
  return {{far, far, far}, {-far, -far, -far}};
}

void KernelBox::add(const KernelBox& other) {
  for (int a = 0; a < 3; ++a) lo[a] = std::min(lo[a], other.lo[a]), hi[a] = std::max(hi[a], other.hi[a]);
}

ParticleKernels::ParticleKernels(const SurfaceOptions& options)
    : options_(options),
      variance_(lattice_variance(options.neighbor_radius) * options.spacing * options.spacing),
      surrounded_count_(static_cast<std::size_t>(static_cast<float>(pi) * options.neighbor_radius *
                                                 options.neighbor_radius * options.neighbor_radius)) {}

void ParticleKernels::find(const CellOrder& order, const Neighbors& neighbors, Threads& threads) {
  if (functions_ == nullptr) functions_ = &kernels::find_surface_kernels(instruction_set());
  constexpr float far = 1e15f;  // position of the record that pads lists: its weight w is 0
  const std::size_t n = order.size();
  records_.resize(n + 1);
  kernels_.resize(n);
  boxes_.resize(n);
  shift_.resize(n);
  at_surface_.resize(n);
  records_[n] = {far, far, far, 0};
  threads.each(n, 4096, [&](std::size_t i) {
    records_[i] = {order.component(0)[i], order.component(1)[i], order.component(2)[i], 0};
  });
  threads.each(neighbors.blocks().size(), 1, [&](std::size_t b) {
    const Neighbors::Block& block = neighbors.blocks()[b];
    for (std::uint32_t i = block.begin; i < block.end; ++i) find_at(i, block.padded(i), block.of(i).size());
  });
  if (options_.method == SurfaceMethod::isotropic) return;
  threads.each(neighbors.blocks().size(), 1, [&](std::size_t b) {
    const Neighbors::Block& block = neighbors.blocks()[b];
    for (std::uint32_t i = block.begin; i < block.end; ++i)
      if (at_surface_[i] != 0) smooth_shift(i, block.of(i));
  });
}

// The shift that moves vertices back is smoothed, so that it adds no noise. It is the mean over neighbors
// with similar shifts s,
//
//   sum_j w_ij s_j / sum_j w_ij,   w_ij = max(0, 1 - |s_i - s_j|^2 / (0.4 r)^2)
//
// Neighbors beyond an edge of the fluid have different shifts and small weights.
void ParticleKernels::smooth_shift(std::uint32_t sorted_index, std::span<const std::uint32_t> list) {
  const float alike = 0.4f * options_.neighbor_radius * options_.spacing;
  const float inverse = 1 / (alike * alike);
  const Vec3f own = shift_[sorted_index];
  Vec3f sum = own;
  float weight = 1;
  for (const std::uint32_t entry : list) {
    const Vec3f other = shift_[entry / 4], apart = other - own;
    const float w = std::max(0.0f, 1 - dot(apart, apart) * inverse);
    sum += other * w;
    weight += w;
  }
  const Vec3f mean = sum / weight;
  ParticleKernel& kernel = kernels_[sorted_index];
  kernel.shift[0] = mean.x, kernel.shift[1] = mean.y, kernel.shift[2] = mean.z;
}

// Yu and Turk 2013, equations 6 and 9 to 16:
//
//   delta_i = sum_j w_ij (x_j - x_i) / sum_j w_ij,   center_i = x_i + lambda delta_i
//
// lambda grows with the number of neighbors up to `few_neighbors`: otherwise drops of two or three particles
// would collapse into one.
void ParticleKernels::find_at(std::uint32_t sorted_index, std::span<const std::uint32_t> list,
                              std::size_t count) {
  const Vec4f& at = records_[sorted_index];
  ParticleKernel& kernel = kernels_[sorted_index];
  const float radius = options_.neighbor_radius * options_.spacing;
  const Moments m = functions_->moments(records_.data(), at, list.data(), list.size(), 1 / radius);
  const Vec3f delta = Vec3f{m.first[0], m.first[1], m.first[2]} / m.weight;
  const float aside = dot(delta, delta) / (radius * radius);
  const bool few = count <= static_cast<std::size_t>(options_.few_neighbors);
  at_surface_[sorted_index] = few || aside > 0.1f * 0.1f ? 1 : 0;

  const bool isotropic = options_.method == SurfaceMethod::isotropic;
  const float crowd = static_cast<float>(count) / static_cast<float>(std::max(1, options_.few_neighbors));
  const float lambda = isotropic ? 0 : options_.center_smoothing * std::min(1.0f, crowd);
  const Vec3f shift = delta * lambda;
  kernel.center[0] = at.x + shift.x, kernel.center[1] = at.y + shift.y, kernel.center[2] = at.z + shift.z;
  shift_[sorted_index] = shift;
  kernel.shift[0] = shift.x, kernel.shift[1] = shift.y, kernel.shift[2] = shift.z;
  kernel.crowd = std::min(1.0f, 0.5f * crowd);
  Vec3f extent;
  if (isotropic)
    extent = set_ball(kernel, options_.isotropic_radius * options_.spacing);
  else if (few)
    extent = set_ball(kernel, options_.drop_radius * options_.spacing);
  else if (aside < 0.03f * 0.03f && is_surrounded(count))  // deep inside: nearly a ball, and invisible
    extent = set_ball(kernel, options_.kernel_radius * options_.spacing);
  else
    extent = set_ellipsoid(kernel, m);
  extent *= box_growth;
  kernel.extent_z = extent.z;
  kernel.unused = 0;
  KernelBox& box = boxes_[sorted_index];
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = kernel.center[a] - extent[a];
    box.hi[a] = kernel.center[a] + extent[a];
  }
}

// G = I / h
Vec3f ParticleKernels::set_ball(ParticleKernel& kernel, float radius) const {
  const float inside = options_.spacing / radius;
  kernel.weight = poly6_center * (inside * inside * inside);
  kernel.xx = kernel.yy = kernel.zz = 1 / radius;
  kernel.xy = kernel.xz = kernel.yz = 0;
  return {radius, radius, radius};
}

//   C = sum w d d^T / sum w - delta delta^T = R S R^T,   s_k = max(S_k, S_1 / k_r) / S_inside
//   G = R diag(1 / (h s_k)) R^T
//
// S_inside is S of a lattice, 1 / k_s of the paper: kernels inside the fluid are balls of support h.
Vec3f ParticleKernels::set_ellipsoid(ParticleKernel& kernel, const Moments& m) const {
  const float w = 1 / (m.weight * variance_);
  const float x = m.first[0] / m.weight, y = m.first[1] / m.weight, z = m.first[2] / m.weight;
  const float u = 1 / variance_;
  const float xx = m.xx * w - x * x * u, xy = m.xy * w - x * y * u, xz = m.xz * w - x * z * u;
  const float yy = m.yy * w - y * y * u, yz = m.yz * w - y * z * u, zz = m.zz * w - z * z * u;
  const Svd<float> parts = svd(Mat3f({xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}));
  const float least = parts.sigma.x / options_.max_axis_ratio;
  const float h = options_.kernel_radius * options_.spacing;
  float axis[3], inverse[3];
  for (int k = 0; k < 3; ++k) {
    axis[k] = h * std::min(std::max(parts.sigma[k], least), max_axis);
    inverse[k] = 1 / axis[k];
  }
  float g[3][3] = {}, extent_squared[3] = {};
  for (int k = 0; k < 3; ++k) {
    const Vec3f& r = parts.v.column[k];
    for (int a = 0; a < 3; ++a) {
      extent_squared[a] += (r[a] * axis[k]) * (r[a] * axis[k]);
      for (int b = a; b < 3; ++b) g[a][b] += (inverse[k] * r[a]) * r[b];
    }
  }
  const float d = options_.spacing;
  kernel.weight = poly6_center * ((d * inverse[0]) * (d * inverse[1]) * (d * inverse[2]));
  kernel.xx = g[0][0], kernel.xy = g[0][1], kernel.xz = g[0][2];
  kernel.yy = g[1][1], kernel.yz = g[1][2], kernel.zz = g[2][2];
  return {std::sqrt(extent_squared[0]), std::sqrt(extent_squared[1]), std::sqrt(extent_squared[2])};
}

}  // namespace souple
