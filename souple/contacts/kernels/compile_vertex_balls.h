#pragma once

#include "souple/contacts/kernels/rolling_balls.h"
#include "souple/contacts/kernels/vertex_balls.h"
#include "souple/simd/registers.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// Records of the two balls of a pack of pairs. Lanes beyond the end repeat the last pair.
template <class Isa>
class BallPack {
  std::uint32_t copy_[2][Isa::lanes];

 public:
  const std::uint32_t* first_float[2];
  int count;

  template <class Columns>
  SOUPLE_INLINE BallPack(const Columns& columns, std::size_t i, std::size_t end,
                         const std::uint32_t* list = nullptr) {
    if (!list && end - i >= Isa::lanes) {
      count = Isa::lanes;
      for (int k = 0; k < 2; ++k) first_float[k] = columns.first_float[k] + i;
      return;
    }
    const Indices<Isa> indices(i, end, list);
    count = indices.count;
    for (int k = 0; k < 2; ++k) {
      first_float[k] = copy_[k];
      for (int lane = 0; lane < Isa::lanes; ++lane) copy_[k][lane] = columns.first_float[k][indices.at[lane]];
    }
  }
  BallPack(const BallPack&) = delete;
  BallPack& operator=(const BallPack&) = delete;
  /// Difference in a record array: that of i minus that of j.
  SOUPLE_INLINE Vectors<Isa> difference(const float* base) const {
    Records<Isa> i(base, first_float[0]);
    i.subtract(Records<Isa>(base, first_float[1]));
    return i.components();
  }
};

/// Bits of the lanes before `count`.
template <class Isa>
SOUPLE_INLINE inline std::uint32_t lane_bits(const typename Numbers<Isa>::Mask& mask, int count) {
  const std::uint32_t bits = Isa::bits(mask.lanes);
  return count < Isa::lanes ? bits & ((1u << count) - 1) : bits;
}

template <class Isa>
[[gnu::flatten]] std::size_t find_in_runs(const BallCellColumns& cells, std::size_t slot, float rest_part,
                                          const BallRun* runs, std::size_t run_count, std::uint32_t* found) {
  using T = Numbers<Isa>;
  const T x(cells.place[0][slot]), y(cells.place[1][slot]), z(cells.place[2][slot]);
  const bool compares_rest = cells.rest[0] != nullptr;
  Vectors<Isa> rest{T(0.f), T(0.f), T(0.f)};
  for (int axis = 0; compares_rest && axis < 3; ++axis) rest[axis] = T(cells.rest[axis][slot]);
  const T own_radius(cells.radius[slot]), own_reach(cells.reach[slot]);
  const T square(rest_part * rest_part);
  std::size_t total = 0;
  for (const BallRun* run = runs; run != runs + run_count; ++run)
    for (std::size_t s = run->begin; s < run->end; s += Isa::lanes) {
      const int count = run->end - s < Isa::lanes ? static_cast<int>(run->end - s) : Isa::lanes;
      const Vectors<Isa> d{T::load(cells.place[0] + s) - x, T::load(cells.place[1] + s) - y,
                           T::load(cells.place[2] + s) - z};
      const T reach = T::load(cells.reach + s) + own_reach, row = T::load(cells.row + s);
      auto near = dot(d, d) < reach * reach && row <= T(run->row) && row >= T(run->row);
      if (!any_lane(near)) continue;
      if (compares_rest) {
        const T sum = T::load(cells.radius + s) + own_radius;
        const Vectors<Isa> at_rest{T::load(cells.rest[0] + s) - rest.x, T::load(cells.rest[1] + s) - rest.y,
                                   T::load(cells.rest[2] + s) - rest.z};
        near = near && dot(at_rest, at_rest) * square >= sum * sum;
      }
      for (std::uint32_t bits = lane_bits<Isa>(near, count); bits != 0; bits &= bits - 1)
        found[total++] = static_cast<std::uint32_t>(s) + static_cast<std::uint32_t>(__builtin_ctz(bits));
    }
  return total;
}

template <class Isa>
[[gnu::flatten]] std::size_t find_near(const float* place, const BallPairColumns& pairs, float part,
                                       std::size_t begin, std::size_t end, std::uint32_t* found) {
  using T = Numbers<Isa>;
  std::size_t count = 0;
  for (std::size_t p = begin; p < end; p += Isa::lanes) {
    const BallPack<Isa> pack(pairs, p, end);
    Records<Isa> i(place, pack.first_float[0]), j(place, pack.first_float[1]);
    const Vectors<Isa> x = i.components() - j.components();
    const T reach = load<Isa>(pairs.distance + p, pack.count) * T(1 + part);
    const auto near = dot(x, x) < reach * reach && T(i.r[3]) + T(j.r[3]) > T(0.f);
    for (std::uint32_t bits = lane_bits<Isa>(near, pack.count); bits != 0; bits &= bits - 1)
      found[count++] = static_cast<std::uint32_t>(p) + static_cast<std::uint32_t>(__builtin_ctz(bits));
  }
  return count;
}

template <class Isa>
[[gnu::flatten]] void describe_balls(const BallRecords& particles, const BallPairColumns& pairs,
                                     const BallLaw& law, const std::uint32_t* found,
                                     const BallContactColumns& out, std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f), one(1.f);
  for (std::size_t c = begin; c < end; c += Isa::lanes) {
    const BallPack<Isa> pack(pairs, c - begin, end - begin, found);
    const int count = pack.count;
    const Indices<Isa> indices(c - begin, end - begin, found);
    Records<Isa> i(particles.position, pack.first_float[0]), j(particles.position, pack.first_float[1]);
    const Vectors<Isa> x = i.components() - j.components();
    const T w_i(i.r[3]), w_j(j.r[3]), share = one / (w_i + w_j);
    const Vectors<Isa> start = pack.difference(particles.start);
    const Vectors<Isa> moved = pack.difference(particles.moving) - start;
    const Vectors<Isa> from = x + start;  // x_i - x_j at the start
    const T size = length(from), distance = gather<Isa>(pairs.distance, indices.at);
    const auto apart = size > zero;
    Vectors<Isa> n = from * (one / select(apart, size, one));
    n.y = select(apart, n.y, one);
    const T overlap = size - distance;
    const T slop = select(overlap < zero, min(zero, overlap + T(law.release)), zero);
    for (int lane = 0; lane < count; ++lane)
      for (int k = 0; k < 2; ++k)
        out.first_float[k][c + static_cast<std::size_t>(lane)] = pack.first_float[k][lane];
    store<Isa>(w_i * share, out.share[0] + c, count);
    store<Isa>(w_j * share, out.share[1] + c, count);
    store3<Isa>(n, out.normal, c, count), store3<Isa>(start, out.start, c, count);
    store3<Isa>({zero, zero, zero}, out.tangent_sum, c, count);
    store<Isa>(dot(n, x) - distance - slop, out.gap + c, count);
    const auto slides = dot(moved, moved) > T(law.sliding_threshold) * T(law.sliding_threshold);
    store<Isa>(select(slides, T(law.kinetic_friction), T(law.static_friction)), out.kinetic_friction + c,
               count);
    store<Isa>(zero, out.normal_sum + c, count);
  }
}

template <class Isa>
[[gnu::flatten]] void project_balls(const BallRecords& particles, const BallContactColumns& columns,
                                    float static_friction, std::size_t begin, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  for (std::size_t c = begin; c < end; c += Isa::lanes) {
    const BallPack<Isa> pack(columns, c, end);
    const int count = pack.count;
    Records<Isa> i(particles.moving, pack.first_float[0]), j(particles.moving, pack.first_float[1]);
    const Vectors<Isa> n = load3<Isa>(columns.normal, c, count), q = i.components() - j.components();
    const T C = load<Isa>(columns.gap + c, count) + dot(n, q);
    ContactSums<T> sums = load_sums<Isa>(columns, c, count);
    if (!any_lane(C < zero || sums.normal_sum > zero)) continue;
    const Vectors<Isa> change =
        solve_contact(sums, C, zero, n, q - load3<Isa>(columns.start, c, count), T(static_friction),
                      load<Isa>(columns.kinetic_friction + c, count));
    store_sums<Isa>(sums, columns, c, count);
    if (particles.corrected != particles.moving) {
      i = Records<Isa>(particles.corrected, pack.first_float[0]), i.transpose();
      j = Records<Isa>(particles.corrected, pack.first_float[1]), j.transpose();
    }
    const T share_i = load<Isa>(columns.share[0] + c, count),
            share_j = load<Isa>(columns.share[1] + c, count);
    for (int axis = 0; axis < 3; ++axis) {
      i.r[axis] = (T(i.r[axis]) + change[axis] * share_i).v;
      j.r[axis] = (T(j.r[axis]) - change[axis] * share_j).v;
    }
    i.write(particles.corrected, pack.first_float[0]);
    j.write(particles.corrected, pack.first_float[1]);
  }
}

template <class Isa>
const VertexBallKernels& vertex_ball_kernels() {
  static constexpr VertexBallKernels kernels{find_in_runs<Isa>, find_near<Isa>, describe_balls<Isa>,
                                             project_balls<Isa>};
  return kernels;
}

}  // namespace souple::kernels
