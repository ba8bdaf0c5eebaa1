#pragma once

#include "souple/math/reductions.h"
#include "souple/state/particles.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace souple {

namespace detail {

// A whole record: compilers load the four floats of a Vec4f one by one.
inline FourFloats load(const Vec4f& record) {
  FourFloats result;
  std::memcpy(&result, &record.x, sizeof result);
  return result;
}

inline void store(Vec4f& record, const FourFloats& value) {
  std::memcpy(&record.x, &value, sizeof value);
}

}  // namespace detail

/// A sparse matrix that takes particles to weighted sums of particles: row j sums weight[k] times particle[k], k in
/// [begin[j], begin[j + 1]), in order.
struct WeightedSums {
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> particle;
  std::vector<float> weight;

  std::size_t rows() const { return begin.size() - 1; }
  void add(std::uint32_t of, float by) { particle.push_back(of), weight.push_back(by); }
  void end_row() { begin.push_back(static_cast<std::uint32_t>(particle.size())); }

  /// to_x[j] = sum of `x`, to_y[j] = sum of `y`, rows [first, last). The w lanes of the results stay.
  void assign(std::size_t first, std::size_t last, std::span<const Vec4f> x, std::span<const Vec4f> y,
              std::span<Vec4f> to_x, std::span<Vec4f> to_y) const;
  /// to[target[j]] += sum of `of`, rows [first, last), for targets that are not fixed: inverse_mass[target].w > 0.
  /// The w lanes of `of` are 0.
  void add_to(std::size_t first, std::size_t last, std::span<const Vec4f> of,
              std::span<const std::uint32_t> target, std::span<const Vec4f> inverse_mass,
              std::span<Vec4f> to) const;
};

}  // namespace souple
