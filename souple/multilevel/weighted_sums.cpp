#include "souple/multilevel/weighted_sums.h"

#include "souple/assert.h"

namespace souple {

using detail::FourFloats;
using detail::load;
using detail::store;

void WeightedSums::assign(std::size_t first, std::size_t last, std::span<const Vec4f> x,
                          std::span<const Vec4f> y, std::span<Vec4f> to_x, std::span<Vec4f> to_y) const {
  SOUPLE_ASSERT(last <= rows() && last <= to_x.size() && last <= to_y.size(), "rows of the sums");
  const std::uint32_t* const of = particle.data();
  const float* const by = weight.data();
  for (std::size_t j = first; j < last; ++j) {
    FourFloats sum_x{}, sum_y{};
    for (std::uint32_t k = begin[j]; k < begin[j + 1]; ++k) {
      const float w = by[k];
      sum_x += load(x[of[k]]) * w;
      sum_y += load(y[of[k]]) * w;
    }
    sum_x[3] = to_x[j].w, sum_y[3] = to_y[j].w;
    store(to_x[j], sum_x), store(to_y[j], sum_y);
  }
}

void WeightedSums::add_to(std::size_t first, std::size_t last, std::span<const Vec4f> of,
                          std::span<const std::uint32_t> target, std::span<const Vec4f> inverse_mass,
                          std::span<Vec4f> to) const {
  SOUPLE_ASSERT(last <= rows() && rows() <= target.size(), "one target per row");
  const std::uint32_t* const from = particle.data();
  const float* const by = weight.data();
  for (std::size_t j = first; j < last; ++j) {
    const std::uint32_t i = target[j];
    if (!(inverse_mass[i].w > 0)) continue;
    FourFloats sum{};
    for (std::uint32_t k = begin[j]; k < begin[j + 1]; ++k) sum += load(of[from[k]]) * by[k];
    store(to[i], load(to[i]) + sum);
  }
}

}  // namespace souple
