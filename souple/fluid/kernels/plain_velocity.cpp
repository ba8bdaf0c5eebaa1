#include "souple/fluid/kernels/plain_sums.h"
#include "souple/fluid/kernels/shapes.h"
#include "souple/fluid/kernels/velocity_kernels.h"

// Scalar reference of compile_velocity.h: one neighbor at a time.

namespace souple::kernels {

namespace {

float harmonic_mean(float a, float b) {
  return 2 * a * b / max(a + b, 1e-30f);
}

/// Sum of term(near, the neighbor's value) over a list.
template <class Term>
Vec3f sum_of(const Vec4f* records, const Vec4f* values, const Vec4f& at, const std::uint32_t* list,
             std::size_t count, const SmoothingFactors& factors, const Term& term) {
  PlainSixteenOfThree sum;
  for (std::size_t k = 0; k < count; ++k)
    sum.add(k, term(PlainNear(at, records[list[k] / 4], factors), values[list[k] / 4]));
  return sum.total();
}

template <class Shape>
Vec3f exchange(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
               const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  return sum_of(records, values, at, list, count, factors, [&](const PlainNear& near, const Vec4f& other) {
    const float weight = harmonic_mean(value.w, other.w) * (factors.value_factor * Shape::value(near.q));
    return (other.xyz() - value.xyz()) * weight;
  });
}

Vec3f strain(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
             const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  const float floor = 1e-4f * factors.h * factors.h;
  return sum_of(records, values, at, list, count, factors, [&](const PlainNear& near, const Vec4f& other) {
    const float along = dot(value.xyz() - other.xyz(), near.d);
    const float weight = max(1.0f - near.q, 0.0f) * harmonic_mean(value.w, other.w);
    return -near.d * (weight * (along / (near.r2 + floor)));
  });
}

template <class Shape>
Vec3f curl(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
           const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  return sum_of(records, values, at, list, count, factors, [&](const PlainNear& near, const Vec4f& other) {
    return cross(value.xyz() - other.xyz(), near.d) * (factors.slope_factor * Shape::slope(near.q));
  });
}

float closing_speed(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
                    const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors) {
  PlainSixteen sum;
  for (std::size_t k = 0; k < count; ++k) {
    const PlainNear near(at, records[list[k] / 4], factors);
    const Vec3f apart = value.xyz() - values[list[k] / 4].xyz();
    sum.sum[k % 16] += (length(apart) - dot(apart, near.d) / (factors.h * near.q)) * max(1.0f - near.q, 0.0f);
  }
  return sum.total();
}

template <class Shape>
Vec3f cohesion(const Vec4f* records, const Vec4f* values, const Vec4f& at, const Vec4f& value,
               const std::uint32_t* list, std::size_t count, const SmoothingFactors& factors,
               const CohesionFactors& cohesion) {
  return sum_of(records, values, at, list, count, factors, [&](const PlainNear& near, const Vec4f& other) {
    const float share = -2 / (value.w + other.w);
    const float pull = share * (cohesion.attraction * factors.inverse_h * Cohesion::slope(near.q));
    const float flatten = share * (cohesion.flattening * Shape::value(near.q));
    return near.d * pull + (value.xyz() - other.xyz()) * flatten;
  });
}

template <class Shape>
constexpr VelocityKernels plain{exchange<Shape>, strain, curl<Shape>, closing_speed, cohesion<Shape>};

}  // namespace

template <>
const VelocityKernels& velocity_kernels<PlainLanes, Wendland>() {
  return plain<Wendland>;
}
template <>
const VelocityKernels& velocity_kernels<PlainLanes, Poly6Spiky>() {
  return plain<Poly6Spiky>;
}
template <>
const VelocityKernels& velocity_kernels<PlainLanes, CubicSpline>() {
  return plain<CubicSpline>;
}

}  // namespace souple::kernels
