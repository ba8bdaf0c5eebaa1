#pragma once

#include "souple/simd/pack.h"
#include "souple/solver/kernels/links.h"

// Included only by translation units that are compiled for one instruction set; every template here has the
// tag of that instruction set as parameter.

namespace souple::kernels {

/// Registers loaded from i, i + 1, i + 2, i + 3 transpose to components in the order of i.
template <class Isa>
[[gnu::always_inline]] inline void load_four(const float* records, const std::uint32_t* i,
                                             typename Isa::Vector (&r)[4]) {
  r[0] = Isa::load_records(records, i), r[1] = Isa::load_records(records, i + 1);
  r[2] = Isa::load_records(records, i + 2), r[3] = Isa::load_records(records, i + 3);
}

/// Differences of the records of a and b.
template <class Isa>
[[gnu::always_inline]] inline void subtract_records(const float* records, const std::uint32_t* a,
                                                    const std::uint32_t* b,
                                                    typename Isa::Vector (&difference)[4]) {
  typename Isa::Vector of_b[4];
  load_four<Isa>(records, a, difference), load_four<Isa>(records, b, of_b);
  for (int j = 0; j < 4; ++j) difference[j] = difference[j] - of_b[j];
}

/// Differences of the records of a and b, transposed.
template <class Isa>
[[gnu::always_inline]] inline Vec3<simd::Pack<Isa>> difference_of(const float* records,
                                                                  const std::uint32_t* a,
                                                                  const std::uint32_t* b) {
  using T = simd::Pack<Isa>;
  typename Isa::Vector r[4];
  subtract_records<Isa>(records, a, b, r);
  simd::transpose<Isa>(r);
  return {T(r[0]), T(r[1]), T(r[2])};
}

template <class Isa, bool with_path>
[[gnu::flatten]] void measure_links(const LinkArrays& of, const LinkMeasures& from, std::size_t begin,
                                    std::size_t end) {
  using T = simd::Pack<Isa>;
  const LinkArrays links = of;
  const LinkMeasures m = from;
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Vec3<T> x = difference_of<Isa>(m.start, m.start_a + i, m.start_b + i);
    const Vec3<T> X = difference_of<Isa>(m.position, links.a + i, links.b + i);
    const Vec3<T> d = difference_of<Isa>(m.moving, links.a + i, links.b + i);
    const T now = sqrt(dot(x, x)), rest_length = T::load(m.rest_length + i);
    T ratio = link_ratio(now, rest_length);
    if constexpr (with_path) {
      ratio = max(ratio, path_ratio(T::load(m.path_length + i), T::load(m.stretch + i), rest_length));
    } else {
      (now - rest_length).store(m.stretch + i);
    }
    const LinkLimits<T> limits(X, d, ratio);
    X.x.store(links.x + i), X.y.store(links.y + i), X.z.store(links.z + i);
    limits.min_length.store(links.min_length + i), limits.max_length.store(links.max_length + i);
  }
}

template <class Isa>
void measure_any_links(const LinkArrays& links, const LinkMeasures& from, std::size_t begin,
                       std::size_t end) {
  (from.path_length ? measure_links<Isa, true> : measure_links<Isa, false>)(links, from, begin, end);
}

template <class Isa>
[[gnu::flatten]] void sweep_links(const LinkArrays& of, float* moving, std::size_t begin, std::size_t end,
                                  float relaxation) {
  using T = simd::Pack<Isa>;
  const LinkArrays links = of;
  const T omega(relaxation);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    typename Isa::Vector d_a[4], d_b[4], r[4];
    load_four<Isa>(moving, links.a + i, d_a), load_four<Isa>(moving, links.b + i, d_b);
    for (int j = 0; j < 4; ++j) r[j] = d_a[j] - d_b[j];
    simd::transpose<Isa>(r);
    const Vec3<T> u{T::load(links.x + i) + T(r[0]), T::load(links.y + i) + T(r[1]),
                    T::load(links.z + i) + T(r[2])};
    const Vec3<T> p = link_correction(u, T::load(links.min_length + i), T::load(links.max_length + i),
                                      omega * T::load(links.gain + i));
    r[0] = p.x.v, r[1] = p.y.v, r[2] = p.z.v, r[3] = typename Isa::Vector{};
    simd::transpose<Isa>(r);
    for (int j = 0; j < 4; ++j) {
      const std::size_t k = i + static_cast<std::size_t>(j);
      Isa::store_records(moving, links.a + k, d_a[j] - Isa::broadcast_last(d_a[j]) * r[j]);
      Isa::store_records(moving, links.b + k, d_b[j] + Isa::broadcast_last(d_b[j]) * r[j]);
    }
  }
}

template <class Isa>
[[gnu::flatten]] void find_stretched(const ParticleLinks& of, const float* position, const float* moving,
                                     std::uint16_t* stretched, std::size_t begin, std::size_t end) {
  using T = simd::Pack<Isa>;
  constexpr std::size_t block = 16;
  const ParticleLinks links = of;
  for (std::size_t k = begin; k < end; ++k) {
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < block; lane += Isa::lanes) {
      const std::size_t i = block * k + lane;
      typename Isa::Vector r[4], d[4];
      subtract_records<Isa>(position, links.a + i, links.b + i, r);
      subtract_records<Isa>(moving, links.a + i, links.b + i, d);
      for (int j = 0; j < 4; ++j) r[j] = r[j] + d[j];
      simd::transpose<Isa>(r);
      const Vec3<T> u{T(r[0]), T(r[1]), T(r[2])};
      const T longest = T::load(links.longest + i);
      const auto longer = dot(u, u) > longest * longest;
      if (!any_lane(longer)) continue;
      float is[Isa::lanes];
      select(longer, T(1.f), T(0.f)).store(is);
      for (std::size_t j = 0; j < Isa::lanes; ++j) bits |= is[j] > 0 ? 1u << (lane + j) : 0u;
    }
    stretched[k] = static_cast<std::uint16_t>(bits);
  }
}

template <class Isa>
[[gnu::flatten]] void measure_stretched(const LinkArrays& of, const StretchedMeasures& from,
                                        const float* position, const float* moving, float* gain,
                                        std::size_t begin, std::size_t end) {
  using T = simd::Pack<Isa>;
  const LinkArrays links = of;
  const StretchedMeasures m = from;
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Vec3<T> X = difference_of<Isa>(position, links.a + i, links.b + i);
    const Vec3<T> u = X + difference_of<Isa>(moving, links.a + i, links.b + i);
    const T longest = T::load(m.longest + i);
    X.x.store(links.x + i), X.y.store(links.y + i), X.z.store(links.z + i);
    longest.store(links.max_length + i);
    min(longest * T(m.shortest_part), sqrt(dot(u, u))).store(links.min_length + i);
    stretched_gain(T::load(m.compliance + i), T::load(m.inverse_mass + i), T(m.softest), T(m.sweeps_over_h2))
        .store(gain + i);
  }
}

template <class Isa>
const LinkKernels& link_kernels() {
  static constexpr LinkKernels kernels{measure_any_links<Isa>, sweep_links<Isa>, find_stretched<Isa>,
                                       measure_stretched<Isa>};
  return kernels;
}

}  // namespace souple::kernels
