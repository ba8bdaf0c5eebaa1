#include "souple/fluid/kernels/density_kernels.h"
#include "souple/fluid/kernels/plain_sums.h"
#include "souple/fluid/kernels/shapes.h"

// Scalar reference of compile_density.h: one neighbor at a time.

namespace souple::kernels {

namespace {

template <class Shape>
DensitySums sums(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
                 const SmoothingFactors& factors) {
  PlainSixteen density, squared, gx, gy, gz;
  const float scaled_slope = factors.slope_factor * factors.scale, unscale = 1 / factors.scale;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec4f& other = records[list[k] / 4];
    const PlainNear near(at, other, factors);
    const float slope = scaled_slope * Shape::slope(near.q);
    density.sum[k % 16] += Shape::value(near.q);
    squared.sum[k % 16] += other.w * (slope * slope * near.r2);
    gx.sum[k % 16] += slope * near.d.x;
    gy.sum[k % 16] += slope * near.d.y;
    gz.sum[k % 16] += slope * near.d.z;
  }
  return {factors.value_factor * density.total(),
          squared.total(),
          {gx.total() * unscale, gy.total() * unscale, gz.total() * unscale}};
}

template <class Shape>
Vec3f push(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
           const SmoothingFactors& factors, const Repulsion& repulsion) {
  PlainSixteen px, py, pz;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec4f& other = records[list[k] / 4];
    const PlainNear near(at, other, factors);
    const float part = repulsion.scale * Shape::value(near.q), squared = part * part;
    const float repelled = repulsion.strength * (squared * squared);
    const float q_sum = at.w + other.w + (repulsion.strength != 0 ? repelled : 0);
    const float pull = q_sum * (factors.slope_factor * Shape::slope(near.q));
    px.sum[k % 16] += pull * near.d.x;
    py.sum[k % 16] += pull * near.d.y;
    pz.sum[k % 16] += pull * near.d.z;
  }
  return {px.total(), py.total(), pz.total()};
}

template <class Shape>
Vec3f push(const Vec4f* records, const Vec4f& at, const std::uint32_t* list, std::size_t count,
           const SmoothingFactors& factors) {
  return push<Shape>(records, at, list, count, factors, {});
}

template <class Shape>
Vec3f spread(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
             const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  PlainSixteen vx, vy, vz;
  for (std::size_t k = 0; k < count; ++k) {
    const PlainNear near(at, records[list[k] / 4], factors);
    const float weight = factors.value_factor * Shape::value(near.q);
    const Vec3f v = values[list[k] / 4].xyz() - value.xyz();
    vx.sum[k % 16] += weight * v.x;
    vy.sum[k % 16] += weight * v.y;
    vz.sum[k % 16] += weight * v.z;
  }
  return {vx.total(), vy.total(), vz.total()};
}

template <class Shape>
void sums_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
             DensitySums* result) {
  for (std::uint32_t k = 0; lists.begin + k < lists.end; ++k)
    result[k] = sums<Shape>(records, records[lists.begin + k], lists.entry + lists.first[k],
                            lists.first[k + 1] - lists.first[k], factors);
}

template <class Shape>
void push_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
             Vec3f* result) {
  for (std::uint32_t k = 0; lists.begin + k < lists.end; ++k)
    result[k] = push<Shape>(records, records[lists.begin + k], lists.entry + lists.first[k],
                            lists.first[k + 1] - lists.first[k], factors);
}

template <class Shape>
void repel_of(const Vec4f* records, const NeighborLists& lists, const SmoothingFactors& factors,
              const Repulsion& repulsion, Vec3f* result) {
  for (std::uint32_t k = 0; lists.begin + k < lists.end; ++k)
    result[k] = push<Shape>(records, records[lists.begin + k], lists.entry + lists.first[k],
                            lists.first[k + 1] - lists.first[k], factors, repulsion);
}

template <class Shape>
constexpr DensityKernels plain{sums_of<Shape>, push_of<Shape>, repel_of<Shape>,
                               sums<Shape>,    push<Shape>,    spread<Shape>};

}  // namespace

template <>
const DensityKernels& density_kernels<PlainLanes, Wendland>() {
  return plain<Wendland>;
}
template <>
const DensityKernels& density_kernels<PlainLanes, Poly6Spiky>() {
  return plain<Poly6Spiky>;
}
template <>
const DensityKernels& density_kernels<PlainLanes, CubicSpline>() {
  return plain<CubicSpline>;
}

}  // namespace souple::kernels
