#pragma once

#include "souple/constraints/all.h"
#include "souple/simd/pack.h"
#include "souple/solver/kernels/kernels.h"
#include "souple/solver/kernels/projection.h"

#include <utility>

// The projection of many constraints, one register of constraints at a time. Included only by translation
// units that are compiled for one instruction set; every template here has the tag of that instruction set as
// parameter.

// Functions that are not inlined pass registers through memory, at half the speed. g++'s flatten does not
// inline lambdas.
namespace souple::kernels {

/// Calls f(0), f(1), ... f(n - 1) with constants, independent of the compiler's unrolling: an index unknown
/// at compile time would force registers into memory.
template <int n, class Function>
SOUPLE_INLINE inline void static_for(const Function& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) SOUPLE_INLINE {
    (f(std::integral_constant<int, k>{}), ...);
  }
  (std::make_integer_sequence<int, n>{});
}

/// A column that always loads as a register: a uniform value is broadcast to one.
template <class Isa>
struct LoadedColumn {
  alignas(64) float broadcast[Isa::lanes];
  const float* values;
  std::size_t stride;

  void set(const ColumnView& column) {
    values = column.values;
    stride = column.stride;
    if (stride == 1) return;
    simd::Pack<Isa>(*column.values).store(broadcast);
    values = broadcast;
  }
  simd::Pack<Isa> load(std::size_t i) const { return simd::Pack<Isa>::load(values + i * stride); }
};

/// A local copy of SetArrays: the compiler knows that no store of positions changes it.
template <class Isa, class Kind>
struct LocalSet {
  static constexpr int param_count = sizeof(typename Kind::template Params<float>) / sizeof(float);
  static constexpr int alpha_count = static_cast<int>(compliance_size<Kind>);

  const std::uint32_t* records[Kind::arity];
  LoadedColumn<Isa> parameters[param_count], compliances[alpha_count], damping_time, scale, half_shared;
  float* multipliers[rows_of<Kind>];
  bool stored;
  simd::Pack<Isa> h, inverse_h2, relaxation;

  explicit LocalSet(const SetArrays& set)
      : stored(set.multipliers != nullptr), h(set.h), inverse_h2(set.inverse_h2), relaxation(set.relaxation) {
    for (int k = 0; k < Kind::arity; ++k) records[k] = set.records[k];
    for (int k = 0; k < param_count; ++k) parameters[k].set(set.parameters[k]);
    for (int k = 0; k < alpha_count; ++k) compliances[k].set(set.compliances[k]);
    damping_time.set(set.damping_time);
    scale.set(set.scale);
    half_shared.set(set.half_shared);
    for (int r = 0; r < rows_of<Kind>; ++r) multipliers[r] = stored ? set.multipliers[r] : nullptr;
  }
};

/// Input of the projection of `lanes` neighboring constraints.
template <class Isa, class Kind>
struct Block {
  using T = simd::Pack<Isa>;

  const std::uint32_t* records[Kind::arity];
  /// Records of displacements, to which corrections are added.
  typename Isa::Vector moving[Kind::arity][4];
  typename Kind::template Params<T> params;
  ProjectionInput<Kind, T> in;

  Block(const LocalSet<Isa, Kind>& set, std::size_t i) {
    for (int k = 0; k < Kind::arity; ++k) records[k] = set.records[k] + i;
    T* param = reinterpret_cast<T*>(&params);  // members of type T only
    for (int k = 0; k < LocalSet<Isa, Kind>::param_count; ++k) param[k] = set.parameters[k].load(i);
  }
};

/// Loads (x_k - x_0) + (d_k - d_0) and the inverse masses. Differences are computed record by record before
/// they are transposed: displacements cost additional loads and additions, but no additional transpose.
template <class Isa, class Kind>
SOUPLE_INLINE inline void load_particles(const ParticleArrays& p, Block<Isa, Kind>& block) {
  using T = simd::Pack<Isa>;
  using Vector = typename Isa::Vector;
  auto& d = block.moving;
  Vector first[4];
  static_for<4>([&](auto j) SOUPLE_INLINE {
    first[j] = Isa::load_records(p.position, block.records[0] + j);
    d[0][j] = Isa::load_records(p.moving, block.records[0] + j);
  });
  static_for<Kind::arity - 1>([&](auto before) SOUPLE_INLINE {
    constexpr int k = before + 1;
    Vector u[4];
    static_for<4>([&](auto j) SOUPLE_INLINE {
      const Vector x = Isa::load_records(p.position, block.records[k] + j);
      d[k][j] = Isa::load_records(p.moving, block.records[k] + j);
      u[j] = Isa::difference_but_last(x, first[j]) + (d[k][j] - d[0][j]);  // d.w = 0: u.w = x.w
    });
    simd::transpose<Isa>(u);
    block.in.x[k] = {T(u[0]), T(u[1]), T(u[2])};
    block.in.inverse_mass[k] = T(u[3]);
  });
  simd::transpose<Isa>(first);
  block.in.inverse_mass[0] = T(first[3]);
  if constexpr (has_origin<Kind>) {
    Vector moved[4] = {d[0][0], d[0][1], d[0][2], d[0][3]};
    simd::transpose<Isa>(moved);
    block.in.x[0] = (Vec3<T>{T(first[0]), T(first[1]), T(first[2])} - Kind::origin(block.params)) +
                    Vec3<T>{T(moved[0]), T(moved[1]), T(moved[2])};
  } else {
    block.in.x[0] = {T(0), T(0), T(0)};
  }
}

/// Loads the velocities of the particles, from `corrected`.
template <class Isa, class Kind>
SOUPLE_INLINE inline void load_velocities(const ParticleArrays& p, const Block<Isa, Kind>& block,
                                          DampingInput<Kind, simd::Pack<Isa>>& in) {
  using T = simd::Pack<Isa>;
  static_for<Kind::arity>([&](auto k) SOUPLE_INLINE {
    typename Isa::Vector v[4];
    static_for<4>([&](auto j) SOUPLE_INLINE { v[j] = Isa::load_records(p.corrected, block.records[k] + j); });
    simd::transpose<Isa>(v);
    in.velocity[k] = {T(v[0]), T(v[1]), T(v[2])};
  });
}

/// Adds the corrections to the records of `corrected`; the fourth lane stays. `in_place`: `corrected` is
/// `moving`, which the block still holds. (The general terms read it again: a third less code at the same
/// speed.)
template <class Isa, class Kind, bool in_place>
SOUPLE_INLINE inline void store_corrections(const ParticleArrays& p, const Block<Isa, Kind>& block,
                                            const Vec3<simd::Pack<Isa>> (&dx)[Kind::arity]) {
  using Vector = typename Isa::Vector;
  static_for<Kind::arity>([&](auto k) SOUPLE_INLINE {
    const std::uint32_t* records = block.records[k];
    Vector r[4] = {dx[k].x.v, dx[k].y.v, dx[k].z.v, Vector{}};
    simd::transpose<Isa>(r);
    static_for<4>([&](auto j) SOUPLE_INLINE {
      const Vector before = in_place ? block.moving[k][j] : Isa::load_records(p.corrected, records + j);
      Isa::store_records(p.corrected, records + j, before + r[j]);
    });
  });
}

/// Projects blocks of one register of constraints, from the i-th constraint on.
template <class Isa, class Kind, Terms terms>
[[gnu::flatten]] void project_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays, std::size_t i,
                                     std::size_t end) {
  using T = simd::Pack<Isa>;
  const ParticleArrays p = arrays;
  const LocalSet<Isa, Kind> set(set_arrays);
  for (; i < end; i += Isa::lanes) {
    Block<Isa, Kind> block(set, i);
    load_particles(p, block);
    for (int k = 0; k < LocalSet<Isa, Kind>::alpha_count; ++k)
      block.in.alpha[k] = set.compliances[k].load(i) * set.inverse_h2;
    block.in.scale = set.scale.load(i) * set.relaxation;
    if constexpr (terms == Terms::plain) block.in.half_shared = set.half_shared.load(i);
    if constexpr (terms == Terms::general)
      for (int r = 0; set.stored && r < rows_of<Kind>; ++r)
        block.in.lambda[r] = T::load(set.multipliers[r] + i);
    Vec3<T> dx[Kind::arity];
    T dlambda[rows_of<Kind>];
    project_constraint<Kind, T, terms>(block.in, block.params, dx, dlambda);
    if constexpr (terms == Terms::general)
      for (int r = 0; set.stored && r < rows_of<Kind>; ++r)
        (block.in.lambda[r] + dlambda[r]).store(set.multipliers[r] + i);
    store_corrections<Isa, Kind, terms == Terms::plain>(p, block, dx);
  }
}

/// Damps blocks of one register of constraints, from the i-th constraint on.
template <class Isa, class Kind>
[[gnu::flatten]] void damp_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays, std::size_t i,
                                  std::size_t end) {
  using T = simd::Pack<Isa>;
  const ParticleArrays p = arrays;
  const LocalSet<Isa, Kind> set(set_arrays);
  for (; i < end; i += Isa::lanes) {
    Block<Isa, Kind> block(set, i);
    load_particles(p, block);
    DampingInput<Kind, T> in;
    load_velocities(p, block, in);
    for (int k = 0; k < LocalSet<Isa, Kind>::alpha_count; ++k)
      block.in.alpha[k] = set.compliances[k].load(i) * set.inverse_h2;
    in.constraint = block.in;
    in.gamma = set.damping_time.load(i) / set.h;
    Vec3<T> dv[Kind::arity];
    damp_constraint<Kind, T>(in, block.params, dv);
    store_corrections<Isa, Kind, false>(p, block, dv);
  }
}

/// Adds the elastic forces of blocks of one register of constraints, from the i-th constraint on. Blocks of scale 0
/// have none.
template <class Isa, class Kind>
[[gnu::flatten]] void force_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays, std::size_t i,
                                   std::size_t end) {
  using T = simd::Pack<Isa>;
  const ParticleArrays p = arrays;
  const LocalSet<Isa, Kind> set(set_arrays);
  const T sweep_share(set_arrays.sweep_share);
  for (; i < end; i += Isa::lanes) {
    const T scale = set.scale.load(i);
    if (!any_lane(scale > T(0))) continue;
    Block<Isa, Kind> block(set, i);
    load_particles(p, block);
    for (int k = 0; k < LocalSet<Isa, Kind>::alpha_count; ++k)
      block.in.alpha[k] = set.compliances[k].load(i) * set.inverse_h2;
    block.in.scale = scale;
    Vec3<T> f[Kind::arity];
    elastic_forces<Kind, T>(block.in, block.params, sweep_share, f);
    store_corrections<Isa, Kind, false>(p, block, f);
  }
}

/// Evaluates C of blocks of one register of constraints, from the i-th constraint on.
template <class Isa, class Kind>
[[gnu::flatten]] void evaluate_blocks(const ParticleArrays& arrays, const SetArrays& set_arrays,
                                      std::size_t i, std::size_t end, float* const* values) {
  using T = simd::Pack<Isa>;
  const LocalSet<Isa, Kind> set(set_arrays);
  for (std::size_t at = 0; i < end; i += Isa::lanes, at += Isa::lanes) {
    Block<Isa, Kind> block(set, i);
    load_particles(arrays, block);
    T C[rows_of<Kind>];
    Vec3<T> gradient[rows_of<Kind>][Kind::arity];
    evaluate_rows<Kind, T>(block.in.x, block.params, C, gradient);
    for (int r = 0; r < rows_of<Kind>; ++r) C[r].store(values[r] + at);
  }
}

/// Numbers of particles, parameters, compliances and rows of a constraint kind.
struct KindSize {
  int particles, parameters, compliances, rows;
};

template <class Isa, class Kind>
inline constexpr KindSize size_of_kind{Kind::arity, LocalSet<Isa, Kind>::param_count,
                                       LocalSet<Isa, Kind>::alpha_count, rows_of<Kind>};

/// A copy of the last constraints of a range, padded to a whole block with copies that act on dummy
/// particles. The end of a range thus runs the same code and gives the same bits. One implementation for all
/// kinds: compiled for each kind, it took a quarter of the compile time of the kernels.
template <class Isa>
struct Tail {
  static constexpr int lanes = Isa::lanes;
  static constexpr int max_particles = 4, max_parameters = 16, max_rows = 3;
  static constexpr int max_compliances = max_rows * (max_rows + 1) / 2;
  static constexpr bool fits(const KindSize& size) {
    return size.particles <= max_particles && size.parameters <= max_parameters &&
           size.compliances <= max_compliances && size.rows <= max_rows;
  }

  std::uint32_t indices[max_particles][lanes];
  float parameter[max_parameters][lanes], compliance[max_compliances][lanes], damping[lanes], scale[lanes],
      shared[lanes];
  float lambda[max_rows][lanes];
  alignas(16) float position[max_particles][lanes][4], moving[max_particles][lanes][4],
      corrected[max_particles][lanes][4];
  const std::uint32_t* index_pointers[max_particles];
  ColumnView parameter_views[max_parameters], compliance_views[max_compliances];
  float* lambda_pointers[max_rows];
  KindSize size;
  std::size_t first, count;

  [[gnu::noinline]] Tail(const KindSize& of, const ParticleArrays& p, const SetArrays& set, std::size_t begin,
                         std::size_t end)
      : size(of), first(begin), count(end - begin) {
    for (int k = 0; k < size.particles; ++k) copy_particles(p, set, k);
    for (int k = 0; k < size.parameters; ++k) copy(set.parameters[k], parameter[k]);
    for (int k = 0; k < size.compliances; ++k) copy(set.compliances[k], compliance[k]);
    copy(set.damping_time, damping);
    copy(set.scale, scale);
    copy(set.half_shared, shared);
    for (int r = 0; r < size.rows; ++r)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        lambda[r][lane] = set.multipliers ? set.multipliers[r][source(lane)] : 0;
  }
  std::size_t source(std::size_t lane) const { return first + (lane < count ? lane : 0); }

  ParticleArrays particles() { return {position[0][0], moving[0][0], corrected[0][0]}; }
  [[gnu::noinline]] SetArrays set(const SetArrays& of) {
    SetArrays result = of;
    for (int k = 0; k < size.particles; ++k) index_pointers[k] = indices[k];
    for (int k = 0; k < size.parameters; ++k) parameter_views[k] = {parameter[k], 1};
    for (int k = 0; k < size.compliances; ++k) compliance_views[k] = {compliance[k], 1};
    for (int r = 0; r < size.rows; ++r) lambda_pointers[r] = lambda[r];
    result.records = index_pointers;
    result.parameters = parameter_views;
    result.compliances = compliance_views;
    result.damping_time = {damping, 1};
    result.scale = {scale, 1};
    result.half_shared = {shared, 1};
    if (of.multipliers) result.multipliers = lambda_pointers;
    return result;
  }
  [[gnu::noinline]] void copy_back(const ParticleArrays& p, const SetArrays& of) const {
    for (std::size_t lane = 0; lane < count; ++lane) {
      for (int k = 0; k < size.particles; ++k) {
        float* record = p.corrected + of.records[k][first + lane];
        for (int axis = 0; axis < 3; ++axis) record[axis] = corrected[k][lane][axis];
      }
      if (of.multipliers)
        for (int r = 0; r < size.rows; ++r) of.multipliers[r][first + lane] = lambda[r][lane];
    }
  }

 private:
  void copy(const ColumnView& from, float (&to)[lanes]) const {
    for (std::size_t lane = 0; lane < lanes; ++lane) to[lane] = from.values[source(lane) * from.stride];
  }
  void copy_particles(const ParticleArrays& p, const SetArrays& set, int k) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      indices[k][lane] = 4 * (static_cast<std::uint32_t>(k * lanes) + static_cast<std::uint32_t>(lane));
      const std::size_t record = set.records[k][source(lane)];
      for (std::size_t axis = 0; axis < 4; ++axis) {
        position[k][lane][axis] = p.position[record + axis];
        moving[k][lane][axis] = p.moving[record + axis];
        corrected[k][lane][axis] = p.corrected ? p.corrected[record + axis] : 0;
      }
    }
  }
};

/// The end of the last whole block of [begin, end).
template <class Isa>
std::size_t whole(std::size_t begin, std::size_t end) {
  return end - (end - begin) % Isa::lanes;
}

/// Runs `blocks` on all constraints of [begin, end).
template <class Isa, class Kind, Project blocks>
void run(const ParticleArrays& p, const SetArrays& set, std::size_t begin, std::size_t end) {
  const std::size_t last = whole<Isa>(begin, end);
  if (begin < last) blocks(p, set, begin, last);
  if (last == end) return;
  static_assert(Tail<Isa>::fits(size_of_kind<Isa, Kind>));
  Tail<Isa> tail(size_of_kind<Isa, Kind>, p, set, last, end);
  blocks(tail.particles(), tail.set(set), 0, Isa::lanes);
  tail.copy_back(p, set);
}

template <class Isa, class Kind>
void evaluate(const ParticleArrays& p, const SetArrays& set, std::size_t begin, std::size_t end,
              float* const* values) {
  const std::size_t last = whole<Isa>(begin, end);
  if (begin < last) evaluate_blocks<Isa, Kind>(p, set, begin, last, values);
  if (last == end) return;
  static_assert(Tail<Isa>::fits(size_of_kind<Isa, Kind>));
  Tail<Isa> tail(size_of_kind<Isa, Kind>, p, set, last, end);
  float C[rows_of<Kind>][Isa::lanes];
  float* pointers[rows_of<Kind>];
  for (int r = 0; r < rows_of<Kind>; ++r) pointers[r] = C[r];
  evaluate_blocks<Isa, Kind>(tail.particles(), tail.set(set), 0, Isa::lanes, pointers);
  for (int r = 0; r < rows_of<Kind>; ++r)
    for (std::size_t lane = 0; lane < end - last; ++lane) values[r][last - begin + lane] = C[r][lane];
}

template <class Isa, class Kind>
constexpr Project forces_or_null() {
  if constexpr (requires { Kind::softness; }) return run<Isa, Kind, force_blocks<Isa, Kind>>;
  return nullptr;
}

template <class Isa, class Kind>
const KindKernels& kind_kernels() {
  static constexpr KindKernels kernels{run<Isa, Kind, project_blocks<Isa, Kind, Terms::plain>>,
                                       run<Isa, Kind, project_blocks<Isa, Kind, Terms::general>>,
                                       run<Isa, Kind, damp_blocks<Isa, Kind>>, evaluate<Isa, Kind>,
                                       forces_or_null<Isa, Kind>()};
  return kernels;
}

/// Instantiates the kernels of every kind in a list.
template <class Isa, class List>
struct Compile;
template <class Isa, class... Kinds>
struct Compile<Isa, std::tuple<Kinds...>> {
  using Getter = const KindKernels& (*)();
  static constexpr Getter all[] = {kind_kernels<Isa, Kinds>...};
};

}  // namespace souple::kernels
