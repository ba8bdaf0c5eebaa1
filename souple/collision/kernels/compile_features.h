#pragma once

#include "souple/collision/contact_law.h"
#include "souple/collision/kernels/features.h"
#include "souple/collision/nearest.h"
#include "souple/math/simd/pack.h"

// Included by the translation units that are compiled for one instruction set, and by nothing else; every
// template here carries the set's tag.

#define SOUPLE_INLINE __attribute__((always_inline))

namespace souple::kernels {

template <class Set>
using Numbers = simd::Pack<Set>;
template <class Set>
using Vectors = Vec3<simd::Pack<Set>>;

/// Four floats of each lane's record; as they were loaded, then, after `components`, turned into components.
template <class Set>
struct Records {
  typename Set::Vector r[4];

  Records() = default;
  SOUPLE_INLINE Records(const float* base, const std::uint32_t* first_float) {
    for (std::uint32_t j = 0; j < 4; ++j) {
      if constexpr (Set::lanes == 1) {
        r[j] = base[first_float[0] + j];
      } else {
        r[j] = Set::load_records(base, first_float + j);
      }
    }
  }
  SOUPLE_INLINE void add(const Records& b) {
    for (int j = 0; j < 4; ++j) r[j] = r[j] + b.r[j];
  }
  SOUPLE_INLINE void subtract(const Records& b) {
    for (int j = 0; j < 4; ++j) r[j] = r[j] - b.r[j];
  }
  /// Turned back and written.
  SOUPLE_INLINE void write(float* base, const std::uint32_t* first_float) {
    turn();
    for (std::uint32_t j = 0; j < 4; ++j) {
      if constexpr (Set::lanes == 1) {
        base[first_float[0] + j] = r[j];
      } else {
        Set::store_records(base, first_float + j, r[j]);
      }
    }
  }
  SOUPLE_INLINE void turn() {
    if constexpr (Set::lanes > 1) simd::transpose<Set>(r);
  }
  SOUPLE_INLINE Vectors<Set> components() {
    turn();
    return {Numbers<Set>(r[0]), Numbers<Set>(r[1]), Numbers<Set>(r[2])};
  }
};

/// Where the records of as many pairs as there are lanes begin. Lanes beyond the end repeat the last pair.
template <class Set>
struct PairRecords {
  std::uint32_t first_float[4][Set::lanes];

  SOUPLE_INLINE PairRecords(const std::uint32_t (*pairs)[4], const std::uint32_t (&index)[Set::lanes]) {
    for (int lane = 0; lane < Set::lanes; ++lane)
      for (int k = 0; k < 4; ++k) first_float[k][lane] = 4 * pairs[index[lane]][k];
  }
  SOUPLE_INLINE explicit PairRecords(const std::uint32_t (&first)[4][Set::lanes]) {
    for (int k = 0; k < 4; ++k)
      for (int lane = 0; lane < Set::lanes; ++lane) first_float[k][lane] = first[k][lane];
  }
};

/// Indices from i on, or those that a list has there; lanes beyond the end repeat the last.
template <class Set>
struct Indices {
  std::uint32_t at[Set::lanes];
  int count;  ///< lanes before the end

  SOUPLE_INLINE Indices(std::size_t i, std::size_t end, const std::uint32_t* list = nullptr)
      : count(end - i < Set::lanes ? static_cast<int>(end - i) : Set::lanes) {
    for (int lane = 0; lane < Set::lanes; ++lane) {
      const std::size_t k = i + static_cast<std::size_t>(lane < count ? lane : count - 1);
      at[lane] = list ? list[k] : static_cast<std::uint32_t>(k);
    }
  }
};

template <class Set>
SOUPLE_INLINE inline Numbers<Set> gather(const float* column, const std::uint32_t (&index)[Set::lanes]) {
  float lanes[Set::lanes];
  for (int lane = 0; lane < Set::lanes; ++lane) lanes[lane] = column[index[lane]];
  return Numbers<Set>::load(lanes);
}

// Neighbors in a column; where fewer are left than there are lanes, nothing behind them is touched.
template <class Set>
SOUPLE_INLINE inline Numbers<Set> load(const float* column, int count) {
  if (count == Set::lanes) return Numbers<Set>::load(column);
  float lanes[Set::lanes];
  for (int lane = 0; lane < Set::lanes; ++lane) lanes[lane] = column[lane < count ? lane : count - 1];
  return Numbers<Set>::load(lanes);
}
template <class Set>
SOUPLE_INLINE inline void store(Numbers<Set> a, float* column, int count) {
  if (count == Set::lanes) return a.store(column);
  float lanes[Set::lanes];
  a.store(lanes);
  for (int lane = 0; lane < count; ++lane) column[lane] = lanes[lane];
}

/// PairRecords 1 to 3 less corner 0, without the rounding of what is far away.
template <class Set, bool displacement>
SOUPLE_INLINE inline void differences(const FeaturePoints& points, const PairRecords<Set>& corners,
                                      Vectors<Set> (&x)[4]) {
  const Numbers<Set> zero(0.f);
  x[0] = {zero, zero, zero};
  const Records<Set> first(points.position, corners.first_float[0]);
  for (int k = 1; k < 4; ++k) {
    Records<Set> records(points.position, corners.first_float[k]);
    records.subtract(first);
    if constexpr (displacement) {
      Records<Set> offset(points.moving, corners.first_float[k]);
      offset.subtract(Records<Set>(points.moving, corners.first_float[0]));
      records.add(offset);
    }
    x[k] = records.components();
  }
}
template <class Set>
SOUPLE_INLINE inline void differences(const FeaturePoints& points, const PairRecords<Set>& corners,
                                      Vectors<Set> (&x)[4]) {
  if (points.position == points.moving) return differences<Set, false>(points, corners, x);
  differences<Set, true>(points, corners, x);
}

/// The same of what corners moved.
template <class Set>
SOUPLE_INLINE inline void moved_differences(const FeaturePoints& points, const PairRecords<Set>& corners,
                                            Vectors<Set> (&m)[4]) {
  const Numbers<Set> zero(0.f);
  m[0] = {zero, zero, zero};
  const Records<Set> first(points.moved, corners.first_float[0]);
  for (int k = 1; k < 4; ++k) {
    Records<Set> records(points.moved, corners.first_float[k]);
    records.subtract(first);
    m[k] = records.components();
  }
}

/// Weights of the two nearest points: their difference is sum_k c_k x_k.
template <class Set, bool edges>
SOUPLE_INLINE inline void nearest_points(const Vectors<Set> (&x)[4], Numbers<Set> (&c)[4]) {
  const Numbers<Set> one(1.f);
  if constexpr (edges) {
    Numbers<Set> s, t;
    nearest_on_edges(x[0], x[1], x[2], x[3], s, t);
    c[0] = one - s, c[1] = s, c[2] = t - one, c[3] = -t;
  } else {
    Numbers<Set> weight[3];
    nearest_on_triangle(x[0], x[1], x[2], x[3], weight);
    c[0] = one;
    for (int k = 0; k < 3; ++k) c[k + 1] = -weight[k];
  }
}

template <class T>
SOUPLE_INLINE inline Vec3<T> weighted(const Vec3<T> (&x)[4], const T (&c)[4]) {
  return x[1] * c[1] + x[2] * c[2] + x[3] * c[3];  // x[0] = 0
}

template <class Set, bool edges>
SOUPLE_INLINE inline Numbers<Set> distance(const Vectors<Set> (&x)[4]) {
  Numbers<Set> c[4];
  nearest_points<Set, edges>(x, c);
  return length(weighted(x, c));
}

/// How far any point of one feature may have moved relative to any point of the other [m].
template <class Set, bool edges>
SOUPLE_INLINE inline Numbers<Set> relative_way(const Vectors<Set> (&m)[4]) {
  const Numbers<Set> two = length_squared(m[2]), three = length_squared(m[3]);
  if constexpr (!edges) return sqrt(max(length_squared(m[1]), max(two, three)));
  return sqrt(max(max(two, three), max(length_squared(m[1] - m[2]), length_squared(m[1] - m[3]))));
}

template <class Set, bool edges>
[[gnu::flatten]] void distances(const FeaturePoints& points, const std::uint32_t (*pairs)[4],
                                std::size_t begin, std::size_t end, float* out) {
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end);
    Vectors<Set> x[4];
    differences(points, PairRecords<Set>(pairs, indices.at), x);
    store<Set>(distance<Set, edges>(x), out + i, indices.count);
  }
}

/// The larger of each feature's two or three, or of the vertex's one; both added up.
template <class Set, bool edges>
SOUPLE_INLINE inline Numbers<Set> sum_of_largest(const float* column, std::size_t stride,
                                                 const PairRecords<Set>& corners) {
  using T = Numbers<Set>;
  T of[4];
  for (int k = 0; k < 4; ++k) {
    float lanes[Set::lanes];
    for (int lane = 0; lane < Set::lanes; ++lane)
      lanes[lane] = column[corners.first_float[k][lane] / 4 * stride];
    of[k] = max(T::load(lanes), T(0.f));
  }
  return edges ? max(of[0], of[1]) + max(of[2], of[3]) : of[0] + max(of[1], max(of[2], of[3]));
}

/// The most of the four.
template <class Set>
SOUPLE_INLINE inline Numbers<Set> most_pressed(const FeaturePoints& points, const PairRecords<Set>& corners) {
  Numbers<Set> most(0.f);
  for (int k = 0; k < 4; ++k) {
    float lanes[Set::lanes];
    for (int lane = 0; lane < Set::lanes; ++lane)
      lanes[lane] = points.pressed[corners.first_float[k][lane] / 4];
    most = max(most, Numbers<Set>::load(lanes));
  }
  return most;
}

template <class Set, bool edges>
[[gnu::flatten]] void reaches(const FeaturePoints& points, const FeatureRooms& rooms, float dt,
                              const std::uint32_t (*pairs)[4], std::size_t begin, std::size_t end,
                              float* thickness, float* reach) {
  using T = Numbers<Set>;
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end);
    const PairRecords<Set> corners(pairs, indices.at);
    Vectors<Set> m[4];
    moved_differences(points, corners, m);
    const T thick = max(sum_of_largest<Set, edges>(rooms.radius, 1, corners), T(rooms.least_thickness));
    const T room = sum_of_largest<Set, edges>(rooms.room, rooms.stride, corners);
    store<Set>(thick, thickness + i, indices.count);
    const T near = T(1 + rooms.early) * thick + most_pressed(points, corners);
    store<Set>(near + relative_way<Set, edges>(m) * T(dt) + room, reach + i, indices.count);
  }
}

template <class Set>
SOUPLE_INLINE inline float least(Numbers<Set> a) {
  float lanes[Set::lanes];
  a.store(lanes);
  float result = lanes[0];
  for (int lane = 1; lane < Set::lanes; ++lane) result = lanes[lane] < result ? lanes[lane] : result;
  return result;
}

template <class Set, bool edges>
[[gnu::flatten]] Nearness near(const FeaturePoints& points, const FeatureColumns& pairs, const NearRule& rule,
                               float owed, float early, std::size_t begin, std::size_t end,
                               std::uint32_t* found) {
  using T = Numbers<Set>;
  std::size_t n = 0;
  T least_known(1e30f), least_slack(1e30f);
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end);
    const PairRecords<Set> records(pairs.particle, indices.at);
    Vectors<Set> m[4];
    moved_differences(points, records, m);
    const T way = relative_way<Set, edges>(m);
    T known = load<Set>(pairs.known + i, indices.count) - T(owed);
    const T thickness = load<Set>(pairs.thickness + i, indices.count);
    const T thick = T(rule.thickness_part) * thickness + T(rule.pressed);
    const auto is_near = way >= T(rule.known_part) * known - thick;
    if (any_lane(is_near)) {
      Vectors<Set> x[4];
      differences(points, records, x);
      for (int k = 1; k < 4; ++k) x[k] -= m[k];
      known = select(is_near, distance<Set, edges>(x), known);
      const auto still = is_near && way >= T(rule.known_part) * known - thick;
      if (any_lane(still)) {
        float lanes[Set::lanes];
        select(still, T(1.f), T(0.f)).store(lanes);
        for (int lane = 0; lane < indices.count; ++lane) {
          found[n] = indices.at[lane];
          n += lanes[lane] > 0 ? 1 : 0;
        }
      }
    }
    store<Set>(known, pairs.known + i, indices.count);
    least_known = min(least_known, known);
    least_slack = min(least_slack, known - T(1 + early) * thickness);
  }
  return {n, least<Set>(least_known), least<Set>(least_slack)};
}

/// sum_k w_k c_k^2
template <class Set>
SOUPLE_INLINE inline Numbers<Set> effective_inverse_mass(const FeaturePoints& points,
                                                         const PairRecords<Set>& corners,
                                                         const Numbers<Set> (&c)[4]) {
  Numbers<Set> sum(0.f);
  for (int k = 0; k < 4; ++k) {
    float w[Set::lanes];
    for (int lane = 0; lane < Set::lanes; ++lane) w[lane] = points.position[corners.first_float[k][lane] + 3];
    sum += Numbers<Set>::load(w) * c[k] * c[k];
  }
  return sum;
}

template <class Set, bool edges>
[[gnu::flatten]] void judge(const FeaturePoints& points, const FeatureColumns& pairs, float early,
                            const std::uint32_t* found, std::size_t begin, std::size_t end, float* verdict) {
  using T = Numbers<Set>;
  const T zero(0.f);
  const auto flag = [&](auto is, unsigned value) { return select(is, T(static_cast<float>(value)), zero); };
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end, found);
    const PairRecords<Set> corners(pairs.particle, indices.at);
    Vectors<Set> x[4];
    T c[4];
    differences(points, corners, x);
    nearest_points<Set, edges>(x, c);
    const T size = length(weighted(x, c));
    const T near = T(1 + early) * gather<Set>(pairs.thickness, indices.at) + most_pressed(points, corners);
    const auto moves = effective_inverse_mass(points, corners, c) > zero;
    T sum = flag(size <= near && size > zero && moves, Verdict::touches);
    Vectors<Set> m[4];
    moved_differences(points, corners, m);
    const T way = relative_way<Set, edges>(m);
    sum += flag(way > T(0.5f) * gather<Set>(pairs.known, indices.at), Verdict::fast);
    if constexpr (edges) {
      const auto is_end = [&](T a) { return a >= zero && a <= zero; };
      sum += flag(is_end(c[0]) || is_end(c[1]) || is_end(c[2]) || is_end(c[3]), Verdict::on_border);
    } else {
      for (unsigned k = 0; k < 3; ++k) sum += flag(c[k + 1] >= zero, Verdict::on_border << k);
    }
    store<Set>(sum, verdict + i, indices.count);
  }
}

template <class Set, bool edges>
[[gnu::flatten]] void describe(const FeaturePoints& points, const FeatureColumns& pairs,
                               const ContactLimits& limits, const std::uint32_t* found, const float* part,
                               std::size_t begin, std::size_t end, const ContactColumns& out) {
  using T = Numbers<Set>;
  const T zero(0.f);
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end, found);
    const int count = indices.count;
    const PairRecords<Set> corners(pairs.particle, indices.at);
    Vectors<Set> x[4], m[4];
    differences(points, corners, x);
    moved_differences(points, corners, m);
    const T rest_of_way = T(1.f) - load<Set>(part + i, count);
    for (int k = 1; k < 4; ++k) x[k] -= m[k] * rest_of_way;
    T c[4];
    nearest_points<Set, edges>(x, c);
    const Vectors<Set> apart = weighted(x, c);
    const T size = length(apart);
    const Vectors<Set> n = apart * (T(1.f) / select(size > zero, size, T(1.f)));
    const T thickness = gather<Set>(pairs.thickness, indices.at);
    const T overlap = gather<Set>(pairs.known, indices.at) - thickness;
    for (int k = 0; k < 4; ++k) {
      for (int lane = 0; lane < count; ++lane)
        out.particle[k][i + static_cast<std::size_t>(lane)] = pairs.particle[indices.at[lane]][k];
      store<Set>(c[k], out.c[k] + i, count);
    }
    for (int axis = 0; axis < 3; ++axis) {
      store<Set>(n[axis], out.normal[axis] + i, count);
      store<Set>(zero, out.tangent_sum[axis] + i, count);
    }
    store<Set>(thickness, out.thickness + i, count);
    store<Set>(select(overlap < zero, min(zero, overlap + T(limits.depenetration)), zero), out.slop + i,
               count);
    store<Set>(effective_inverse_mass(points, corners, c), out.inverse_mass + i, count);
    store<Set>(-dot(n, weighted(m, c)), out.approach + i, count);
    store<Set>(zero, out.normal_sum + i, count);
    store<Set>(zero, out.restitution_velocity + i, count);
    store<Set>(zero, out.depth + i, count);
  }
}

/// What contacts from i on read.
template <class Set>
struct ContactPack {
  using T = Numbers<Set>;
  int count;
  std::uint32_t first_float[4][Set::lanes];
  T c[4];
  Vectors<Set> n;
  SOUPLE_INLINE ContactPack(const ContactColumns& columns, std::size_t i, std::size_t end) {
    const Indices<Set> indices(i, end);
    count = indices.count;
    for (int k = 0; k < 4; ++k) {
      for (int lane = 0; lane < Set::lanes; ++lane)
        first_float[k][lane] = 4 * columns.particle[k][indices.at[lane]];
      c[k] = load<Set>(columns.c[k] + i, count);
    }
    n = {load<Set>(columns.normal[0] + i, count), load<Set>(columns.normal[1] + i, count),
         load<Set>(columns.normal[2] + i, count)};
  }
};

/// PairRecords of contacts, what they weigh, and the records that corrections are added to: positions (plain
/// form), displacements or velocities.
template <class Set>
struct Movable {
  using T = Numbers<Set>;
  T inverse_mass[4];
  Records<Set> records[4];

  SOUPLE_INLINE void load_masses(const float* position, const std::uint32_t (&first_float)[4][Set::lanes]) {
    for (int k = 0; k < 4; ++k) {
      float w[Set::lanes];
      for (int lane = 0; lane < Set::lanes; ++lane) w[lane] = position[first_float[k][lane] + 3];
      inverse_mass[k] = T::load(w);
    }
  }
  SOUPLE_INLINE Vectors<Set> component(int k) const {
    return {T(records[k].r[0]), T(records[k].r[1]), T(records[k].r[2])};
  }

  /// Adds change times w_k c_k / inverse_mass to each corner where `which` says so. Nothing is written to a
  /// particle that cannot move: contacts of one color may share it. Backwards, for a vertex that stands as
  /// an edge from it to itself: all the weight is on its first corner, and what is written last counts.
  SOUPLE_INLINE void add(const Vectors<Set>& change, const T (&c)[4], const typename T::Mask& which,
                         float* base, const std::uint32_t (&first_float)[4][Set::lanes]) {
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
  SOUPLE_INLINE void write_movable(int k, float* base, const std::uint32_t (&first_float)[Set::lanes]) const {
    float component[3][Set::lanes], w[Set::lanes];
    inverse_mass[k].store(w);
    for (int axis = 0; axis < 3; ++axis) T(records[k].r[axis]).store(component[axis]);
    for (int lane = 0; lane < Set::lanes; ++lane)
      for (std::uint32_t axis = 0; w[lane] > 0 && axis < 3; ++axis)
        base[first_float[lane] + axis] = component[axis][lane];
  }
};

/// As for two particles (particle_contacts.cpp), on the difference of two points:
///   dx_k = w_k c_k / (sum_j w_j c_j^2) dx
template <class Set, bool displacement>
SOUPLE_INLINE inline void project_pack(const FeaturePoints& points, const ContactColumns& columns,
                                       std::size_t i, std::size_t end) {
  using T = Numbers<Set>;
  const T zero(0.f);
  const ContactPack<Set> pack(columns, i, end);
  Movable<Set> corners;
  Vectors<Set> first, first_moved, apart{zero, zero, zero}, moved = apart;
  for (int k = 0; k < 4; ++k) {
    Records<Set> position(points.position, pack.first_float[k]), start(points.start, pack.first_float[k]);
    Vectors<Set> x = position.components();
    corners.inverse_mass[k] = T(position.r[3]);
    corners.records[k] = position;
    if constexpr (displacement) {
      corners.records[k] = Records<Set>(points.moving, pack.first_float[k]);
      corners.records[k].turn();
    }
    const Vectors<Set> d = corners.component(k), m = d - start.components();
    if (k == 0) {
      first = x, first_moved = m;
      continue;
    }
    x -= first;
    if constexpr (displacement) x += d - corners.component(0);
    apart += x * pack.c[k];
    moved += (m - first_moved) * pack.c[k];
  }
  ContactSums<T> sums{load<Set>(columns.normal_sum + i, pack.count),
                  {load<Set>(columns.tangent_sum[0] + i, pack.count), load<Set>(columns.tangent_sum[1] + i, pack.count),
                   load<Set>(columns.tangent_sum[2] + i, pack.count)}};
  const T C = dot(pack.n, apart) - load<Set>(columns.thickness + i, pack.count);
  const T slop = load<Set>(columns.slop + i, pack.count);
  const auto acts = slop > C || sums.normal_sum > zero;
  if (!any_lane(acts)) return;
  const Vectors<Set> change =
      solve_contact(sums, C, slop, pack.n, moved, load<Set>(columns.static_friction + i, pack.count),
            load<Set>(columns.kinetic_friction + i, pack.count));
  store<Set>(sums.normal_sum, columns.normal_sum + i, pack.count);
  for (int axis = 0; axis < 3; ++axis) store<Set>(sums.tangent_sum[axis], columns.tangent_sum[axis] + i, pack.count);
  const T share = T(1.f) / load<Set>(columns.inverse_mass + i, pack.count);
  if (points.corrected != points.moving)
    for (int k = 0; k < 4; ++k) {
      corners.records[k] = Records<Set>(points.corrected, pack.first_float[k]);
      corners.records[k].turn();
    }
  corners.add(change * share, pack.c, acts, points.corrected, pack.first_float);
}

template <class Set>
[[gnu::flatten]] void project(const FeaturePoints& points, const ContactColumns& columns, std::size_t begin,
                              std::size_t end) {
  const bool displacement = points.position != points.moving;
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    if (displacement) {
      project_pack<Set, true>(points, columns, i, end);
    } else {
      project_pack<Set, false>(points, columns, i, end);
    }
  }
}

/// rebound(), on the difference of two points.
template <class Set>
[[gnu::flatten]] void apply_restitution(const FeaturePoints& points, const ContactColumns& columns,
                                    const ContactLimits& limits, float* velocity, std::size_t begin,
                                    std::size_t end) {
  using T = Numbers<Set>;
  const T zero(0.f), inverse_h(limits.inverse_h);
  for (std::size_t i = begin; i < end; i += Set::lanes) {
    const Indices<Set> indices(i, end);
    const int count = indices.count;
    const T normal_sum = load<Set>(columns.normal_sum + i, count);
    const auto acts = normal_sum > zero;
    if (!any_lane(acts)) continue;
    const ContactPack<Set> pack(columns, i, end);
    Vectors<Set> x[4];
    differences(points, PairRecords<Set>(pack.first_float), x);
    Movable<Set> corners;
    corners.load_masses(points.position, pack.first_float);
    Vectors<Set> u{zero, zero, zero};
    for (int k = 0; k < 4; ++k) {
      corners.records[k] = Records<Set>(velocity, pack.first_float[k]);
      corners.records[k].turn();
      u += corners.component(k) * pack.c[k];
    }
    const auto column = [&](const float* of) { return load<Set>(of + i, count); };
    const ContactSums<T> sums{normal_sum,
                          {column(columns.tangent_sum[0]), column(columns.tangent_sum[1]), column(columns.tangent_sum[2])}};
    const auto [change, restitution_velocity] =
        solve_restitution(sums, pack.n, u, column(columns.approach) * inverse_h, T(limits.restitution_threshold),
                column(columns.restitution), column(columns.static_friction),
                column(columns.kinetic_friction), inverse_h);
    corners.add(change * (T(1.f) / column(columns.inverse_mass)), pack.c, acts, velocity, pack.first_float);
    store<Set>(select(acts, restitution_velocity, zero), columns.restitution_velocity + i, count);
    const T depth = max(zero, column(columns.thickness) - dot(pack.n, weighted(x, pack.c)));
    store<Set>(select(acts, depth, zero), columns.depth + i, count);
  }
}

template <class Set>
const FeatureKernels& feature_kernels() {
  static constexpr FeatureKernels kernels{{distances<Set, false>, distances<Set, true>},
                                          {reaches<Set, false>, reaches<Set, true>},
                                          {near<Set, false>, near<Set, true>},
                                          {judge<Set, false>, judge<Set, true>},
                                          {describe<Set, false>, describe<Set, true>},
                                          project<Set>,
                                          apply_restitution<Set>};
  return kernels;
}

}  // namespace souple::kernels

#undef SOUPLE_INLINE
