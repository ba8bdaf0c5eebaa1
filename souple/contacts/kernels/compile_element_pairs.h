#pragma once

#include "souple/collision/nearest.h"
#include "souple/contacts/contact_law.h"
#include "souple/contacts/kernels/element_pairs.h"
#include "souple/contacts/kernels/rolling_balls.h"
#include "souple/simd/registers.h"

// Include this only in translation units that are compiled for one instruction set. Every template here has
// the tag of its instruction set as an argument.

namespace souple::kernels {

/// Per corner and lane: first float of the particle's record. Lanes beyond the end repeat the last pair.
template <class Isa>
struct PairRecords {
  std::uint32_t first_float[4][Isa::lanes];

  SOUPLE_INLINE PairRecords(const std::uint32_t (*pairs)[4], const std::uint32_t (&index)[Isa::lanes]) {
    for (int lane = 0; lane < Isa::lanes; ++lane)
      for (int k = 0; k < 4; ++k) first_float[k][lane] = 4 * pairs[index[lane]][k];
  }
  SOUPLE_INLINE explicit PairRecords(const std::uint32_t (&first)[4][Isa::lanes]) {
    for (int k = 0; k < 4; ++k)
      for (int lane = 0; lane < Isa::lanes; ++lane) first_float[k][lane] = first[k][lane];
  }
};

/// Corners 1 to 3 relative to corner 0, without the rounding of positions far from the origin.
template <class Isa>
SOUPLE_INLINE inline void differences(const ParticleRecords& particles, const PairRecords<Isa>& corners,
                                      Vectors<Isa> (&x)[4]) {
  const Numbers<Isa> zero(0.f);
  x[0] = {zero, zero, zero};
  const Records<Isa> first(particles.position, corners.first_float[0]);
  for (int k = 1; k < 4; ++k) {
    Records<Isa> records(particles.position, corners.first_float[k]);
    records.subtract(first);
    Records<Isa> offset(particles.moving, corners.first_float[k]);
    offset.subtract(Records<Isa>(particles.moving, corners.first_float[0]));
    records.add(offset);
    x[k] = records.components();
  }
}

/// Motions of corners 1 to 3 relative to that of corner 0.
template <class Isa>
SOUPLE_INLINE inline void moved_differences(const ParticleRecords& particles, const PairRecords<Isa>& corners,
                                            Vectors<Isa> (&m)[4]) {
  const Numbers<Isa> zero(0.f);
  m[0] = {zero, zero, zero};
  const Records<Isa> first(particles.moved, corners.first_float[0]);
  for (int k = 1; k < 4; ++k) {
    Records<Isa> records(particles.moved, corners.first_float[k]);
    records.subtract(first);
    m[k] = records.components();
  }
}

/// Weights of the two nearest points: their difference is sum_k c_k x_k.
template <class Isa, bool edges>
SOUPLE_INLINE inline void nearest_points(const Vectors<Isa> (&x)[4], Numbers<Isa> (&c)[4]) {
  const Numbers<Isa> one(1.f);
  if constexpr (edges) {
    Numbers<Isa> s, t;
    nearest_on_edges(x[0], x[1], x[2], x[3], s, t);
    c[0] = one - s, c[1] = s, c[2] = t - one, c[3] = -t;
  } else {
    Numbers<Isa> weight[3];
    nearest_on_triangle(x[0], x[1], x[2], x[3], weight);
    c[0] = one;
    for (int k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
}

template <class T>
SOUPLE_INLINE inline Vec3<T> weighted(const Vec3<T> (&x)[4], const T (&c)[4]) {
  return x[1] * c[1] + x[2] * c[2] + x[3] * c[3];  // x[0] = 0
}

template <class Isa, bool edges>
SOUPLE_INLINE inline Numbers<Isa> distance(const Vectors<Isa> (&x)[4]) {
  Numbers<Isa> c[4];
  nearest_points<Isa, edges>(x, c);
  return length(weighted(x, c));
}

/// Upper bound of the motion of a point of one element relative to a point of the other element [m].
template <class Isa, bool edges>
SOUPLE_INLINE inline Numbers<Isa> relative_motion(const Vectors<Isa> (&m)[4]) {
  const Numbers<Isa> two = length_squared(m[2]), three = length_squared(m[3]);
  if constexpr (!edges) return sqrt(max(length_squared(m[1]), max(two, three)));
  return sqrt(max(max(two, three), max(length_squared(m[1] - m[2]), length_squared(m[1] - m[3]))));
}

template <class Isa, bool edges>
[[gnu::flatten]] void distances(const ParticleRecords& particles, const std::uint32_t (*pairs)[4],
                                std::size_t begin, std::size_t end, float* out) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end);
    Vectors<Isa> x[4];
    differences(particles, PairRecords<Isa>(pairs, indices.at), x);
    store<Isa>(distance<Isa, edges>(x), out + i, indices.count);
  }
}

/// Sum of both elements' largest values: of two or three corners, or of the one vertex.
template <class Isa, bool edges>
SOUPLE_INLINE inline Numbers<Isa> sum_of_largest(const float* column, std::size_t stride,
                                                 const PairRecords<Isa>& corners) {
  using T = Numbers<Isa>;
  T of[4];
  for (int k = 0; k < 4; ++k) {
    float lanes[Isa::lanes];
    for (int lane = 0; lane < Isa::lanes; ++lane)
      lanes[lane] = column[corners.first_float[k][lane] / 4 * stride];
    of[k] = max(T::load(lanes), T(0.f));
  }
  return edges ? max(of[0], of[1]) + max(of[2], of[3]) : of[0] + max(of[1], max(of[2], of[3]));
}

/// Largest contact margin of the four particles.
template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> max_contact_margin(const ParticleRecords& particles,
                                                     const PairRecords<Isa>& corners) {
  Numbers<Isa> most(0.f);
  for (int k = 0; k < 4; ++k) {
    float lanes[Isa::lanes];
    for (int lane = 0; lane < Isa::lanes; ++lane)
      lanes[lane] = particles.contact_margin[corners.first_float[k][lane] / 4];
    most = max(most, Numbers<Isa>::load(lanes));
  }
  return most;
}

template <class Isa, bool edges>
[[gnu::flatten]] void ranges(const ParticleRecords& particles, const PredictionMargins& margins, float dt,
                             const std::uint32_t (*pairs)[4], std::size_t begin, std::size_t end,
                             float* thickness, float* range) {
  using T = Numbers<Isa>;
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end);
    const PairRecords<Isa> corners(pairs, indices.at);
    Vectors<Isa> m[4];
    moved_differences(particles, corners, m);
    const T thick = max(sum_of_largest<Isa, edges>(margins.radius, 1, corners), T(margins.min_thickness));
    const T margin = sum_of_largest<Isa, edges>(margins.margin, margins.stride, corners);
    store<Isa>(thick, thickness + i, indices.count);
    const T contact_distance =
        T(1 + margins.speculative_part) * thick + max_contact_margin(particles, corners);
    store<Isa>(contact_distance + relative_motion<Isa, edges>(m) * T(dt) + margin, range + i, indices.count);
  }
}

template <class Isa>
SOUPLE_INLINE inline float min_lane(Numbers<Isa> a) {
  float lanes[Isa::lanes];
  a.store(lanes);
  float result = lanes[0];
  for (int lane = 1; lane < Isa::lanes; ++lane) result = lanes[lane] < result ? lanes[lane] : result;
  return result;
}

template <class Isa, bool edges>
[[gnu::flatten]] NearPairStatistics find_near(const ParticleRecords& particles,
                                              const ElementPairColumns& pairs, const NearRule& rule,
                                              float motion_since, float speculative_part, std::size_t begin,
                                              std::size_t end, std::uint32_t* found) {
  using T = Numbers<Isa>;
  std::size_t n = 0;
  T min_distance_bound(1e30f), min_gap_bound(1e30f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end);
    const PairRecords<Isa> records(pairs.particle, indices.at);
    Vectors<Isa> m[4];
    moved_differences(particles, records, m);
    const T motion = relative_motion<Isa, edges>(m);
    T distance_bound = load<Isa>(pairs.distance_bound + i, indices.count) - T(motion_since);
    const T thickness = load<Isa>(pairs.thickness + i, indices.count);
    const T required = T(rule.thickness_part) * thickness + T(rule.contact_margin);
    const auto is_near = motion >= T(rule.bound_part) * distance_bound - required;
    if (any_lane(is_near)) {
      Vectors<Isa> x[4];
      differences(particles, records, x);
      for (int k = 1; k < 4; ++k) x[k] -= m[k];
      distance_bound = select(is_near, distance<Isa, edges>(x), distance_bound);
      const auto still = is_near && motion >= T(rule.bound_part) * distance_bound - required;
      if (any_lane(still)) {
        float lanes[Isa::lanes];
        select(still, T(1.f), T(0.f)).store(lanes);
        for (int lane = 0; lane < indices.count; ++lane) {
          found[n] = indices.at[lane];
          n += lanes[lane] > 0 ? 1 : 0;
        }
      }
    }
    store<Isa>(distance_bound, pairs.distance_bound + i, indices.count);
    min_distance_bound = min(min_distance_bound, distance_bound);
    min_gap_bound = min(min_gap_bound, distance_bound - T(1 + speculative_part) * thickness);
  }
  return {n, min_lane<Isa>(min_distance_bound), min_lane<Isa>(min_gap_bound)};
}

/// sum_k w_k c_k^2
template <class Isa>
SOUPLE_INLINE inline Numbers<Isa> effective_inverse_mass(const ParticleRecords& particles,
                                                         const PairRecords<Isa>& corners,
                                                         const Numbers<Isa> (&c)[4]) {
  Numbers<Isa> sum(0.f);
  for (int k = 0; k < 4; ++k) {
    float w[Isa::lanes];
    for (int lane = 0; lane < Isa::lanes; ++lane)
      w[lane] = particles.position[corners.first_float[k][lane] + 3];
    sum += Numbers<Isa>::load(w) * c[k] * c[k];
  }
  return sum;
}

template <class Isa, bool edges>
[[gnu::flatten]] void classify(const ParticleRecords& particles, const ElementPairColumns& pairs,
                               float speculative_part, const std::uint32_t* found, std::size_t begin,
                               std::size_t end, float* classification) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  const auto flag = [&](auto is, unsigned value) { return select(is, T(static_cast<float>(value)), zero); };
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end, found);
    const PairRecords<Isa> corners(pairs.particle, indices.at);
    Vectors<Isa> x[4];
    T c[4];
    differences(particles, corners, x);
    nearest_points<Isa, edges>(x, c);
    const T size = length(weighted(x, c));
    const T contact_distance = T(1 + speculative_part) * gather<Isa>(pairs.thickness, indices.at) +
                               max_contact_margin(particles, corners);
    const auto moves = effective_inverse_mass(particles, corners, c) > zero;
    T sum = flag(size <= contact_distance && size > zero && moves, Classification::touches);
    Vectors<Isa> m[4];
    moved_differences(particles, corners, m);
    const T motion = relative_motion<Isa, edges>(m);
    sum += flag(motion > T(0.5f) * gather<Isa>(pairs.distance_bound, indices.at), Classification::fast);
    if constexpr (edges) {
      const auto is_end = [&](T a) { return a >= zero && a <= zero; };
      sum += flag(is_end(c[0]) || is_end(c[1]) || is_end(c[2]) || is_end(c[3]), Classification::on_border);
    } else {
      for (unsigned k = 0; k < 3; ++k) sum += flag(c[k + 1] >= zero, Classification::on_border << k);
    }
    store<Isa>(sum, classification + i, indices.count);
  }
}

template <class Isa, bool edges>
[[gnu::flatten]] void describe(const ParticleRecords& particles, const ElementPairColumns& pairs,
                               const std::uint32_t* found, const float* part, std::size_t begin,
                               std::size_t end, const ContactColumns& out) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end, found);
    const int count = indices.count;
    const PairRecords<Isa> corners(pairs.particle, indices.at);
    Vectors<Isa> x[4], m[4];
    differences(particles, corners, x);
    moved_differences(particles, corners, m);
    const T remaining = T(1.f) - load<Isa>(part + i, count);
    for (int k = 1; k < 4; ++k) x[k] -= m[k] * remaining;
    T c[4];
    nearest_points<Isa, edges>(x, c);
    const Vectors<Isa> difference = weighted(x, c);
    const T size = length(difference);
    const Vectors<Isa> n = difference * (T(1.f) / select(size > zero, size, T(1.f)));
    const T thickness = gather<Isa>(pairs.thickness, indices.at);
    const T overlap = gather<Isa>(pairs.distance_bound, indices.at) - thickness;
    for (int k = 0; k < 4; ++k) {
      for (int lane = 0; lane < count; ++lane)
        out.particle[k][i + static_cast<std::size_t>(lane)] = pairs.particle[indices.at[lane]][k];
      store<Isa>(c[k], out.c[k] + i, count);
    }
    for (int axis = 0; axis < 3; ++axis) {
      store<Isa>(n[axis], out.normal[axis] + i, count);
      store<Isa>(zero, out.tangent_sum[axis] + i, count);
    }
    store<Isa>(thickness, out.thickness + i, count);
    const T slop = min(zero, overlap + load<Isa>(out.slop + i, count));
    store<Isa>(select(overlap < zero, slop, zero), out.slop + i, count);
    store<Isa>(effective_inverse_mass(particles, corners, c), out.inverse_mass + i, count);
    store<Isa>(-dot(n, weighted(m, c)), out.approach + i, count);
    store<Isa>(zero, out.normal_sum + i, count);
    store<Isa>(zero, out.restitution_velocity + i, count);
    store<Isa>(zero, out.depth + i, count);
  }
}

/// Particles, weights and normals of the contacts from i on.
template <class Isa>
struct ContactPack {
  using T = Numbers<Isa>;
  int count;
  std::uint32_t first_float[4][Isa::lanes];
  T c[4];
  Vectors<Isa> n;
  SOUPLE_INLINE ContactPack(const ContactColumns& columns, std::size_t i, std::size_t end) {
    const Indices<Isa> indices(i, end);
    count = indices.count;
    for (int k = 0; k < 4; ++k) {
      for (int lane = 0; lane < Isa::lanes; ++lane)
        first_float[k][lane] = 4 * columns.particle[k][indices.at[lane]];
      c[k] = load<Isa>(columns.c[k] + i, count);
    }
    n = load3<Isa>(columns.normal, i, count);
  }
};

/// Inverse masses of contacts' particles, and the records that receive corrections: displacements or velocities.
template <class Isa>
struct Movable {
  using T = Numbers<Isa>;
  T inverse_mass[4];
  Records<Isa> records[4];

  SOUPLE_INLINE void load_masses(const float* position, const std::uint32_t (&first_float)[4][Isa::lanes]) {
    for (int k = 0; k < 4; ++k) {
      float w[Isa::lanes];
      for (int lane = 0; lane < Isa::lanes; ++lane) w[lane] = position[first_float[k][lane] + 3];
      inverse_mass[k] = T::load(w);
    }
  }
  SOUPLE_INLINE Vectors<Isa> component(int k) const {
    return {T(records[k].r[0]), T(records[k].r[1]), T(records[k].r[2])};
  }

  /// Adds change times w_k c_k to each corner, in the lanes of `which`. Writes to no particle that cannot
  /// move: contacts of one color may share it. A vertex is stored as an edge from it to itself, whose first corner has
  /// all the weight. The last corner is written first, so that the first corner's write counts.
  SOUPLE_INLINE void add(const Vectors<Isa>& change, const T (&c)[4], const typename T::Mask& which,
                         float* base, const std::uint32_t (&first_float)[4][Isa::lanes]) {
    for (int k = 3; k >= 0; --k) {
      const T factor = inverse_mass[k] * c[k];
      auto& r = records[k].r;
      for (int axis = 0; axis < 3; ++axis)
        r[axis] = select(which, T(r[axis]) + change[axis] * factor, T(r[axis])).v;
      if (any_lane(inverse_mass[k] <= T(0.f))) {
        write_movable(k, base, first_float[k]);
      } else {
        records[k].write(base, first_float[k]);
      }
    }
  }

 private:
  SOUPLE_INLINE void write_movable(int k, float* base, const std::uint32_t (&first_float)[Isa::lanes]) const {
    float component[3][Isa::lanes], w[Isa::lanes];
    inverse_mass[k].store(w);
    for (int axis = 0; axis < 3; ++axis) T(records[k].r[axis]).store(component[axis]);
    for (int lane = 0; lane < Isa::lanes; ++lane)
      for (std::uint32_t axis = 0; w[lane] > 0 && axis < 3; ++axis)
        base[first_float[lane] + axis] = component[axis][lane];
  }
};

/// As for two particles (particle_contacts.cpp), for the difference of two points:
///   dx_k = w_k c_k / (sum_j w_j c_j^2) dx
template <class Isa>
SOUPLE_INLINE inline void project_pack(const ParticleRecords& particles, const ContactColumns& columns,
                                       std::size_t i, std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f);
  const ContactPack<Isa> pack(columns, i, end);
  Movable<Isa> corners;
  Vectors<Isa> first, first_moved, difference{zero, zero, zero}, moved = difference;
  for (int k = 0; k < 4; ++k) {
    Records<Isa> position(particles.position, pack.first_float[k]),
        start(particles.start, pack.first_float[k]);
    Vectors<Isa> x = position.components();
    corners.inverse_mass[k] = T(position.r[3]);
    corners.records[k] = Records<Isa>(particles.moving, pack.first_float[k]);
    corners.records[k].transpose();
    const Vectors<Isa> d = corners.component(k), m = d - start.components();
    if (k == 0) {
      first = x, first_moved = m;
      continue;
    }
    x -= first;
    x += d - corners.component(0);
    difference += x * pack.c[k];
    moved += (m - first_moved) * pack.c[k];
  }
  ContactSums<T> sums = load_sums<Isa>(columns, i, pack.count);
  const T C = dot(pack.n, difference) - load<Isa>(columns.thickness + i, pack.count);
  const T slop = load<Isa>(columns.slop + i, pack.count);
  const auto acts = slop > C || sums.normal_sum > zero;
  if (!any_lane(acts)) return;
  const Vectors<Isa> change =
      solve_pack<Isa>(sums, acts, C, slop, pack.n, moved, particles.turn, columns, pack.first_float[0], i,
                      pack.count, [](const auto& balls) { return balls.turned; });
  store_sums<Isa>(sums, columns, i, pack.count);
  const T factor = T(1.f) / load<Isa>(columns.inverse_mass + i, pack.count);
  if (particles.corrected != particles.moving)
    for (int k = 0; k < 4; ++k) {
      corners.records[k] = Records<Isa>(particles.corrected, pack.first_float[k]);
      corners.records[k].transpose();
    }
  corners.add(change * factor, pack.c, acts, particles.corrected, pack.first_float);
}

template <class Isa>
[[gnu::flatten]] void project(const ParticleRecords& particles, const ContactColumns& columns,
                              std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; i += Isa::lanes) project_pack<Isa>(particles, columns, i, end);
}

/// solve_restitution(), for the difference of two points.
template <class Isa>
[[gnu::flatten]] void apply_restitution(const ParticleRecords& particles, const ContactColumns& columns,
                                        const ContactLimits& limits, float* velocity, std::size_t begin,
                                        std::size_t end) {
  using T = Numbers<Isa>;
  const T zero(0.f), inverse_h(limits.inverse_h);
  for (std::size_t i = begin; i < end; i += Isa::lanes) {
    const Indices<Isa> indices(i, end);
    const int count = indices.count;
    const T normal_sum = load<Isa>(columns.normal_sum + i, count);
    const auto acts = normal_sum > zero;
    if (!any_lane(acts)) continue;
    const ContactPack<Isa> pack(columns, i, end);
    Vectors<Isa> x[4];
    differences(particles, PairRecords<Isa>(pack.first_float), x);
    Movable<Isa> corners;
    corners.load_masses(particles.position, pack.first_float);
    Vectors<Isa> u{zero, zero, zero};
    for (int k = 0; k < 4; ++k) {
      corners.records[k] = Records<Isa>(velocity, pack.first_float[k]);
      corners.records[k].transpose();
      u += corners.component(k) * pack.c[k];
    }
    const auto column = [&](const float* of) { return load<Isa>(of + i, count); };
    const auto [change, restitution_velocity] =
        restitute_pack<Isa>(load_sums<Isa>(columns, i, count), acts, pack.n, u,
                            column(columns.approach) * inverse_h, limits, particles.turn, columns,
                            pack.first_float[0], i, count, [](const auto& balls) { return balls.turned; });
    corners.add(change * (T(1.f) / column(columns.inverse_mass)), pack.c, acts, velocity, pack.first_float);
    store<Isa>(select(acts, restitution_velocity, zero), columns.restitution_velocity + i, count);
    const T depth = max(zero, column(columns.thickness) - dot(pack.n, weighted(x, pack.c)));
    store<Isa>(select(acts, depth, zero), columns.depth + i, count);
  }
}

template <class Isa>
const ElementPairKernels& element_pair_kernels() {
  static constexpr ElementPairKernels kernels{{distances<Isa, false>, distances<Isa, true>},
                                              {ranges<Isa, false>, ranges<Isa, true>},
                                              {find_near<Isa, false>, find_near<Isa, true>},
                                              {classify<Isa, false>, classify<Isa, true>},
                                              {describe<Isa, false>, describe<Isa, true>},
                                              project<Isa>,
                                              apply_restitution<Isa>};
  return kernels;
}

}  // namespace souple::kernels
