#pragma once

#include "souple/math/simd/pack.h"
#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/projection.h"

#include <utility>

// The projection of many constraints, a register's worth at a time. Included by the translation units that
// are compiled for one instruction set, and by nothing else; every template here carries the set's tag.

namespace souple::kernels {

/// f(0), f(1), ... f(n - 1) with constants, whatever the compiler thinks of unrolling: an index that it does
/// not know puts registers into memory.
template <int n, class Function>
[[gnu::always_inline]] inline void unrolled(const Function& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) {
    (f(std::integral_constant<int, k>{}), ...);
  }
  (std::make_integer_sequence<int, n>{});
}

/// A column that loads as a register everywhere: an equal number for all is spread over one.
template <class Set>
struct LoadedColumn {
  alignas(64) float spread[Set::lanes];
  const float* values;
  std::size_t stride;

  void set(const ColumnView& column) {
    values = column.values;
    stride = column.stride;
    if (stride == 1) return;
    simd::Pack<Set>(*column.values).store(spread);
    values = spread;
  }
  simd::Pack<Set> load(std::size_t i) const { return simd::Pack<Set>::load(values + i * stride); }
};

/// A copy of SetArrays that the compiler knows no store of positions to change.
template <class Set, class Kind>
struct LocalSet {
  static constexpr int param_count = sizeof(typename Kind::template Params<float>) / sizeof(float);
  static constexpr int alpha_count = static_cast<int>(compliance_size<Kind>);

  const std::uint32_t* records[Kind::arity];
  LoadedColumn<Set> parameters[param_count], compliances[alpha_count], damping_time, scale;
  float* multipliers[rows_of<Kind>];
  bool stored;
  simd::Pack<Set> h, inverse_h2, relaxation;

  explicit LocalSet(const SetArrays& set)
      : stored(set.multipliers != nullptr), h(set.h), inverse_h2(set.inverse_h2), relaxation(set.relaxation) {
    for (int k = 0; k < Kind::arity; ++k) records[k] = set.records[k];
    for (int k = 0; k < param_count; ++k) parameters[k].set(set.parameters[k]);
    for (int k = 0; k < alpha_count; ++k) compliances[k].set(set.compliances[k]);
    damping_time.set(set.damping_time);
    scale.set(set.scale);
    for (int r = 0; r < rows_of<Kind>; ++r) multipliers[r] = stored ? set.multipliers[r] : nullptr;
  }
};

/// `lanes` neighbouring constraints: what their projection reads.
template <class Set, class Kind>
struct Block {
  using T = simd::Pack<Set>;

  const std::uint32_t* records[Kind::arity];
  typename Set::Vector moving[Kind::arity][4];  ///< the records that corrections are added to
  typename Kind::template Params<T> params;
  ProjectionInput<Kind, T> in;

  Block(const LocalSet<Set, Kind>& set, std::size_t i) {
    for (int k = 0; k < Kind::arity; ++k) records[k] = set.records[k] + i;
    T* param = reinterpret_cast<T*>(&params);  // members of type T only
    for (int k = 0; k < LocalSet<Set, Kind>::param_count; ++k) param[k] = set.parameters[k].load(i);
  }
};

/// x_k - x_0 (or x_0 - origin) and the inverse masses. Differences are taken record by record, before they
/// are transposed: half the transposes of taking them after, and the displacement form costs loads only.
template <class Set, class Kind, bool displacement>
inline void load_particles(const ParticleArrays& p, Block<Set, Kind>& block) {
  using T = simd::Pack<Set>;
  using Vector = typename Set::Vector;
  constexpr int arity = Kind::arity;
  Vector first[4];
  unrolled<4>([&](auto j) {
    first[j] = Set::load_records(p.position, block.records[0] + j);
    block.moving[0][j] = displacement ? Set::load_records(p.moving, block.records[0] + j) : first[j];
  });
  unrolled<arity - 1>([&](auto before) {
    constexpr int k = before + 1;
    Vector record[4];
    unrolled<4>([&](auto j) {
      const Vector x = Set::load_records(p.position, block.records[k] + j);
      block.moving[k][j] = displacement ? Set::load_records(p.moving, block.records[k] + j) : x;
      record[j] = Set::difference_but_last(x, first[j]);
      if constexpr (displacement) record[j] = record[j] + (block.moving[k][j] - block.moving[0][j]);
    });
    simd::transpose<Set>(record);
    block.in.x[k] = {T(record[0]), T(record[1]), T(record[2])};
    block.in.inverse_mass[k] = T(record[3]);
  });
  simd::transpose<Set>(first);
  block.in.inverse_mass[0] = T(first[3]);
  if constexpr (has_origin<Kind>) {
    block.in.x[0] = Vec3<T>{T(first[0]), T(first[1]), T(first[2])} - Kind::origin(block.params);
    if constexpr (displacement) {
      Vector moving[4] = {block.moving[0][0], block.moving[0][1], block.moving[0][2], block.moving[0][3]};
      simd::transpose<Set>(moving);
      block.in.x[0] += Vec3<T>{T(moving[0]), T(moving[1]), T(moving[2])};
    }
  } else {
    block.in.x[0] = {T(0.0f), T(0.0f), T(0.0f)};
  }
}

template <class Set, class Kind>
inline void load_moved(const ParticleArrays& p, Block<Set, Kind>& block) {
  using T = simd::Pack<Set>;
  unrolled<Kind::arity>([&](auto k) {
    typename Set::Vector record[4];
    unrolled<4>(
        [&](auto j) { record[j] = block.moving[k][j] - Set::load_records(p.start, block.records[k] + j); });
    simd::transpose<Set>(record);
    block.in.moved[k] = {T(record[0]), T(record[1]), T(record[2])};
  });
}

/// Adds the corrections to their records; the fourth lane stays.
template <class Set, class Kind>
inline void store_corrections(const ParticleArrays& p, const Block<Set, Kind>& block,
                              const Vec3<simd::Pack<Set>> (&dx)[Kind::arity]) {
  unrolled<Kind::arity>([&](auto k) {
    typename Set::Vector record[4] = {dx[k].x.v, dx[k].y.v, dx[k].z.v, typename Set::Vector{}};
    simd::transpose<Set>(record);
    unrolled<4>([&](auto j) {
      const std::uint32_t* i = block.records[k] + j;
      const auto before = p.corrected == p.moving ? block.moving[k][j] : Set::load_records(p.corrected, i);
      Set::store_records(p.corrected, i, before + record[j]);
    });
  });
}

/// Blocks of a register's worth of constraints from the i-th on. All in one function: what is not inlined
/// would pass registers through memory.
template <class Set, class Kind, bool displacement, Terms terms>
[[gnu::flatten]] void project_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays, std::size_t i,
                                     std::size_t end) {
  using T = simd::Pack<Set>;
  const ParticleArrays p = arrays;
  const LocalSet<Set, Kind> set(set_arrays);
  for (; i < end; i += Set::lanes) {
    Block<Set, Kind> block(set, i);
    load_particles<Set, Kind, displacement>(p, block);
    for (int k = 0; k < LocalSet<Set, Kind>::alpha_count; ++k)
      block.in.alpha[k] = set.compliances[k].load(i) * set.inverse_h2;
    block.in.scale = set.scale.load(i) * set.relaxation;
    if constexpr (terms == Terms::general) {
      block.in.gamma = set.damping_time.load(i) / set.h;
      load_moved(p, block);
      for (int r = 0; set.stored && r < rows_of<Kind>; ++r)
        block.in.lambda[r] = T::load(set.multipliers[r] + i);
    }
    Vec3<T> dx[Kind::arity];
    T dlambda[rows_of<Kind>];
    project_constraint<Kind, T, terms>(block.in, block.params, dx, dlambda);
    if constexpr (terms == Terms::general)
      for (int r = 0; set.stored && r < rows_of<Kind>; ++r)
        (block.in.lambda[r] + dlambda[r] * block.in.scale).store(set.multipliers[r] + i);
    store_corrections(p, block, dx);
  }
}

/// C of the same.
template <class Set, class Kind, bool displacement>
[[gnu::flatten]] void evaluate_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays,
                                      std::size_t i, std::size_t end, float* const* values) {
  using T = simd::Pack<Set>;
  const LocalSet<Set, Kind> set(set_arrays);
  for (std::size_t at = 0; i < end; i += Set::lanes, at += Set::lanes) {
    Block<Set, Kind> block(set, i);
    load_particles<Set, Kind, displacement>(arrays, block);
    T C[rows_of<Kind>];
    Vec3<T> gradient[rows_of<Kind>][Kind::arity];
    evaluate_rows<Kind, T>(block.in.x, block.params, C, gradient);
    for (int r = 0; r < rows_of<Kind>; ++r) C[r].store(values[r] + at);
  }
}

/// A copy of the last constraints of a range, filled up to a whole block with constraints on dummy particles
/// that weigh nothing to anyone: the end of a range runs the same code, so it gives the same bits.
template <class Set, class Kind>
struct Tail {
  static constexpr int lanes = Set::lanes;
  static constexpr int arity = Kind::arity;
  static constexpr int param_count = LocalSet<Set, Kind>::param_count;
  static constexpr int alphas = LocalSet<Set, Kind>::alpha_count;

  std::uint32_t indices[arity][lanes];
  float parameter[param_count][lanes], compliance[alphas][lanes], damping[lanes], scale[lanes];
  float lambda[rows_of<Kind>][lanes];
  alignas(16) float position[arity][lanes][4], moving[arity][lanes][4], start[arity][lanes][4],
      corrected[arity][lanes][4];
  const std::uint32_t* index_pointers[arity];
  ColumnView parameter_views[param_count], compliance_views[alphas];
  float* lambda_pointers[rows_of<Kind>];
  std::size_t first, count;

  Tail(const ParticleArrays& p, const SetArrays& set, std::size_t begin, std::size_t end)
      : first(begin), count(end - begin) {
    const auto at = [&](const ColumnView& column, std::size_t lane) {
      return column.values[source(lane) * column.stride];
    };
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      for (int k = 0; k < arity; ++k) {
        indices[k][lane] = 4 * (static_cast<std::uint32_t>(k * lanes) + static_cast<std::uint32_t>(lane));
        const std::size_t record = set.records[k][source(lane)];
        for (int axis = 0; axis < 4; ++axis) {
          position[k][lane][axis] = p.position[record + axis];
          moving[k][lane][axis] = p.moving[record + axis];
          start[k][lane][axis] = p.start ? p.start[record + axis] : 0;
          corrected[k][lane][axis] = p.corrected ? p.corrected[record + axis] : 0;
        }
      }
      for (int k = 0; k < param_count; ++k) parameter[k][lane] = at(set.parameters[k], lane);
      for (int k = 0; k < alphas; ++k) compliance[k][lane] = at(set.compliances[k], lane);
      damping[lane] = at(set.damping_time, lane);
      scale[lane] = at(set.scale, lane);
      for (int r = 0; r < rows_of<Kind>; ++r)
        lambda[r][lane] = set.multipliers ? set.multipliers[r][source(lane)] : 0;
    }
  }
  std::size_t source(std::size_t lane) const { return first + (lane < count ? lane : 0); }

  ParticleArrays particles() { return {position[0][0], moving[0][0], start[0][0], corrected[0][0]}; }
  SetArrays set(const SetArrays& of) {
    SetArrays result = of;
    for (int k = 0; k < arity; ++k) index_pointers[k] = indices[k];
    for (int k = 0; k < param_count; ++k) parameter_views[k] = {parameter[k], 1};
    for (int k = 0; k < alphas; ++k) compliance_views[k] = {compliance[k], 1};
    for (int r = 0; r < rows_of<Kind>; ++r) lambda_pointers[r] = lambda[r];
    result.records = index_pointers;
    result.parameters = parameter_views;
    result.compliances = compliance_views;
    result.damping_time = {damping, 1};
    result.scale = {scale, 1};
    if (of.multipliers) result.multipliers = lambda_pointers;
    return result;
  }
  void copy_back(const ParticleArrays& p, const SetArrays& of) const {
    for (std::size_t lane = 0; lane < count; ++lane) {
      for (int k = 0; k < arity; ++k) {
        float* record = p.corrected + of.records[k][first + lane];
        for (int axis = 0; axis < 3; ++axis) record[axis] = corrected[k][lane][axis];
      }
      if (of.multipliers)
        for (int r = 0; r < rows_of<Kind>; ++r) of.multipliers[r][first + lane] = lambda[r][lane];
    }
  }
};

/// The end of the last whole block of [begin, end).
template <class Set>
std::size_t whole(std::size_t begin, std::size_t end) {
  return end - (end - begin) % Set::lanes;
}

template <class Set, class Kind, bool displacement, Terms terms>
void project(const ParticleArrays& p, const SetArrays& set, std::size_t begin, std::size_t end) {
  const std::size_t last = whole<Set>(begin, end);
  if (begin < last) project_blocks<Set, Kind, displacement, terms>(p, set, begin, last);
  if (last == end) return;
  Tail<Set, Kind> tail(p, set, last, end);
  project_blocks<Set, Kind, displacement, terms>(tail.particles(), tail.set(set), 0, Set::lanes);
  tail.copy_back(p, set);
}

template <class Set, class Kind, bool displacement>
void evaluate(const ParticleArrays& p, const SetArrays& set, std::size_t begin, std::size_t end,
              float* const* values) {
  const std::size_t last = whole<Set>(begin, end);
  if (begin < last) evaluate_blocks<Set, Kind, displacement>(p, set, begin, last, values);
  if (last == end) return;
  Tail<Set, Kind> tail(p, set, last, end);
  float C[rows_of<Kind>][Set::lanes];
  float* pointers[rows_of<Kind>];
  for (int r = 0; r < rows_of<Kind>; ++r) pointers[r] = C[r];
  evaluate_blocks<Set, Kind, displacement>(tail.particles(), tail.set(set), 0, Set::lanes, pointers);
  for (int r = 0; r < rows_of<Kind>; ++r)
    for (std::size_t lane = 0; lane < end - last; ++lane) values[r][last - begin + lane] = C[r][lane];
}

template <class Set, class Kind>
const KindKernels& kind_kernels() {
  static constexpr KindKernels kernels{
      {project<Set, Kind, false, Terms::plain>, project<Set, Kind, true, Terms::plain>},
      {project<Set, Kind, false, Terms::general>, project<Set, Kind, true, Terms::general>},
      {evaluate<Set, Kind, false>, evaluate<Set, Kind, true>}};
  return kernels;
}

/// Instantiates the kernels of every kind in a list.
template <class Set, class List>
struct Compile;
template <class Set, class... Kinds>
struct Compile<Set, std::tuple<Kinds...>> {
  using Getter = const KindKernels& (*)();
  static constexpr Getter all[] = {kind_kernels<Set, Kinds>...};
};

}  // namespace souple::kernels
