#pragma once

#include "souple/assert.h"
#include "souple/constraints/constraint_set.h"
#include "souple/constraints/dihedral_bending.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/rope_bending.h"
#include "souple/constraints/tet_volume.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/error.h"
#include "souple/geometry/reorder.h"
#include "souple/math/reductions.h"
#include "souple/simd/instruction_set.h"
#include "souple/solver/coloring.h"
#include "souple/solver/facets.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/projection.h"
#include "souple/solver/left_out.h"
#include "souple/solver/projector.h"
#include "souple/solver/set_merger.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace souple {

namespace detail {

/// Throws Error: constraint number `constraint` of this kind names a particle that does not exist.
[[noreturn]] void throw_missing_particle(std::string_view kind, std::size_t constraint,
                                         std::uint32_t particle, std::size_t particle_count);

/// Per constraint: the lowest particle of all that constraints connect with it.
std::vector<std::uint32_t> lowest_connected(std::span<const std::uint32_t> indices, std::size_t arity,
                                            std::size_t particle_count);

/// A number that no call returned before.
std::uint64_t next_revision();

}  // namespace detail

/// Many constraints of one kind behind the Projector interface. Solvers, colors and reports work for a user's
/// struct through this template.
template <class Kind>
class SetProjector final : public Projector,
                           public ElasticFacet,
                           public LinearFacet,
                           public MemoryFacet,
                           public StructureFacet,
                           public StudyFacet {
 public:
  using Set = ConstraintSet<Kind>;
  using Indices = typename Set::Indices;
  using Params = typename Set::Params;
  using Compliance = typename Set::Compliance;

  /// Adds one constraint; `prepare` must follow before the next substep.
  void add(const Indices& indices, const Params& params, const Compliance& compliance = {},
           float damping_time = 0, float stiffness = 1) {
    set_.add(indices, params, compliance, damping_time, stiffness);
    dirty_ = true;
  }

  /// The arrays. Values may be changed in place; indices only through add and erase_particles.
  Set& set() {
    scales_for_ = -1;  // stiffnesses may change
    dirty_sweeps_ = true;
    revision_ = detail::next_revision();
    return set_;
  }
  const Set& set() const { return set_; }
  std::string_view kind() const override { return Kind::name; }
  std::size_t size() const override { return set_.size(); }
  Facets facets() override {
    Facets facets{.grain = grain, .elastic = this, .linear = this, .memory = this, .study = this};
    if constexpr (has_rest_length || requires { Kind::links; }) facets.links = this;
    if constexpr (has_rest_length) facets.distances = this;
    if constexpr (has_target) facets.attachments = this;
    if constexpr (has_flat_gradient) facets.bendings = this;
    if constexpr (std::is_same_v<Kind, NeoHookean>) facets.tets = this;
    return facets;
  }
  std::size_t bytes() const override {
    return set_.bytes() + scales_.bytes() + half_shared_.bytes() + 3 * in_level_.capacity() * sizeof(float) +
           partial_.capacity() * sizeof(Residual);
  }
  int color_count() const override { return static_cast<int>(set_.color_count()); }

  /// Throws Error when a constraint names a particle that does not exist.
  void prepare(std::size_t particle_count) override {
    if (!dirty_) return;
    kernels_ = find_kernels<Kind>(instruction_set());
    for (std::size_t i = 0; i < set_.size(); ++i)
      for (const std::uint32_t index : set_.indices(i))
        if (index >= particle_count) detail::throw_missing_particle(kind(), i, index, particle_count);
    dirty_ = false;
    replaced_ = {};
    clear_levels();
    forget_shared();
    arrange(color_constraints(set_.flat_indices(), Kind::arity, particle_count));
  }

  /// Replaces the constraints of objects, in place of add and prepare. Parts are ascending by particle, before and
  /// after; constraints of particles in none of them are removed. `fresh`, per part: the object's new constraints, with
  /// particles numbered from 0, not prepared; null: it keeps those it has. Each object has colors of its own, so that
  /// its constraints do not depend on the others. Those that link the same particles as before keep their colors.
  /// Returns whether only values changed: parameters, compliances, damping times, stiffnesses.
  bool merge(std::span<const ObjectPart> parts, std::span<SetProjector* const> fresh) {
    restore();
    std::vector<Set*> fresh_sets;
    for (SetProjector* const projector : fresh)
      fresh_sets.push_back(projector != nullptr ? &projector->set_ : nullptr);
    const SetMerger<Kind> merger(set_, parts);
    const bool values_only = merger.color_as_before(fresh_sets);
    set_ = merger.join(fresh_sets);
    kernels_ = find_kernels<Kind>(instruction_set());
    reset_values();
    if (!values_only) forget_shared();
    dirty_softness_ = true;
    dirty_ = false;
    return values_only;
  }

  void prepare_sweeps(const ParticleView& particles, bool masses_changed) override {
    if constexpr (Kind::sense == Sense::equality && Kind::arity > 1) {
      const bool shared = masses_changed || dirty_sweeps_;
      if (shared) find_shared(particles);
      if (shared || dirty_softness_) find_softness(particles);
      dirty_sweeps_ = dirty_softness_ = false;
    }
  }
  /// n sweeps supply the stiffness if n >= softness h^2. The gradient of a tet's shear turns while it is projected,
  /// which costs as much again and more. This was measured on hanging bars of 1e6 to 1e7 Pa.
  int sweeps_needed(const Substep& substep) const override {
    float softness = 0;
    for (const Piece& piece : pieces_) softness = max(softness, softness_of(piece));
    return sweeps_needed(substep, softness);
  }
  int sweeps_needed(const Substep& substep, std::span<const IndexRange> particles) const override {
    const auto before = [](const Piece& piece, std::size_t particle) { return piece.particle < particle; };
    float softness = 0;
    auto piece = pieces_.begin();
    for (const IndexRange& range : particles)
      for (piece = std::lower_bound(piece, pieces_.end(), range.begin, before);
           piece != pieces_.end() && piece->particle < range.end; ++piece)
        softness = max(softness, softness_of(*piece));
    return sweeps_needed(substep, softness);
  }

  static float sweeps_for(float softness, float h) { return std::round(1 + 2.5f * softness * h * h); }

  /// Tells sweeps of which pieces' constraints levels carry a part of the load (TetLevels). Such pieces need one sweep.
  void set_levels(std::span<const std::uint8_t> in_level) {
    SOUPLE_ASSERT(in_level.size() == set_.size(), "one entry per constraint");
    for (std::vector<float>* values : {&in_level_, &level_scales_, &level_shared_})
      values->resize(in_level.size());
    for (std::size_t i = 0; i < in_level.size(); ++i) {
      in_level_[i] = in_level[i];
      level_scales_[i] = in_level[i] ? level_relaxation : 1;
      level_shared_[i] = in_level[i] ? 0 : half_shared_[i];
    }
  }
  void clear_levels() {
    for (std::vector<float>* values : {&in_level_, &level_scales_, &level_shared_}) values->clear();
  }
  /// Adds the forces that the sweeps leave to the levels, times h^2, of constraints [begin, end) of a color; see
  /// elastic_forces.
  void add_forces(int color, std::size_t first, std::size_t last, const ParticleView& particles,
                  const Substep& substep, float sweep_share) requires(requires { Kind::softness; }) {
    const std::size_t color_begin = set_.color_begin[static_cast<std::size_t>(color)];
    if (!kernels_) {
      for (std::size_t i = color_begin + first; i < color_begin + last; ++i)
        if (in_level_[i] > 0) add_forces_of(i, particles, substep, sweep_share);
      return;
    }
    Arrays arrays(set_);
    arrays.set.scale = {in_level_.data(), 1};
    arrays.set.h = substep.h;
    arrays.set.inverse_h2 = inverse_h2(substep);
    arrays.set.sweep_share = sweep_share;
    kernels_->forces(arrays_of(particles), arrays.set, color_begin + first, color_begin + last);
  }

  void begin_substep(const ParticleView&, const Substep& substep) override {
    if (substep.stores_multipliers())
      for (std::vector<float>& lambda : set_.multipliers) lambda.assign(set_.size(), 0);
    find_scales(substep);
  }

  std::size_t color_size(int color) const override {
    const auto c = static_cast<std::size_t>(color);
    return set_.color_begin[c + 1] - set_.color_begin[c];
  }
  using Projector::project;
  void project(int color, std::size_t first, std::size_t last, const ParticleView& particles,
               const Substep& substep) override {
    SOUPLE_ASSERT(first <= last && last <= color_size(color), "a range of the color's constraints");
    SOUPLE_ASSERT(!dirty_, "prepare comes before project");
    const std::size_t color_begin = set_.color_begin[static_cast<std::size_t>(color)];
    const std::size_t begin = color_begin + first, end = color_begin + last;
    const auto project_awake = [&](std::size_t from, std::size_t to) {
      if (substep.asleep == nullptr) return project_range(from, to, particles, substep);
      substep.asleep->for_each_kept(*this, from, to, [&](std::size_t kept_from, std::size_t kept_to) {
        project_range(kept_from, kept_to, particles, substep);
      });
    };
    if (substep.left_out == nullptr) return project_awake(begin, end);
    substep.left_out->for_each_kept(*this, begin, end, project_awake);
  }

  void damp(const ParticleView& particles, std::span<Vec4f> velocity, const Substep& substep,
            Threads& threads) override {
    const Column& times = set_.damping_times;
    if (std::none_of(times.data(), times.data() + times.distinct(), [](float tau) { return tau > 0; }))
      return;
    if (!kernels_ || is_replaced()) {  // constraints of one color may share a particle
      for (std::size_t i = 0; i < set_.size(); ++i) damp_one(i, particles, velocity, substep);
      return;
    }
    Arrays arrays(set_);
    arrays.set.scale = {scales_.data(), scales_.stride()};
    arrays.set.h = substep.h;
    arrays.set.inverse_h2 = inverse_h2(substep);
    kernels::ParticleArrays p = arrays_of(particles);
    p.corrected = &velocity.data()->x;
    const kernels::Project kernel = kernels_->damp;
    for (int color = 0; color < color_count(); ++color) {
      const std::size_t first = set_.color_begin[static_cast<std::size_t>(color)];
      threads.for_each(color_size(color), grain, [&](std::size_t begin, std::size_t end) {
        kernel(p, arrays.set, first + begin, first + end);
      });
    }
  }

  Residual residual(const ParticleView& particles, Threads* threads = nullptr) const override {
    Residual result;
    if (threads == nullptr) {
      for (std::size_t chunk = 0; chunk < chunk_count(); ++chunk)
        result.add(residual_of(chunk, particles, true));
      return result;
    }
    partial_.resize(chunk_count());
    threads->each(chunk_count(), 8,
                  [&](std::size_t chunk) { partial_[chunk] = residual_of(chunk, particles, false); });
    for (const Residual& partial : partial_) result.add(partial);
    return result;
  }

  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override {
    for (int color = 0; color < color_count(); ++color) {
      const auto c = static_cast<std::size_t>(color);
      for (std::size_t i = set_.color_begin[c]; i < set_.color_begin[c + 1]; ++i) {
        float C[rows_of<Kind>];
        evaluate(i, particles, C);
        float largest = 0;
        for (const float value : C) largest = std::fmax(largest, violation_of(value));
        const Indices indices = set_.indices(i);
        visitor({indices, color, strain_of(i, C), largest});
      }
    }
  }

  void linearize(const ParticleView& particles, const Substep& substep,
                 const LinearVisitor& visitor) const override {
    for (std::size_t i = 0; i < set_.size(); ++i) linearize_one(i, particles, substep, visitor);
  }
  void append_constraints_of(std::span<const IndexRange> particles,
                             std::vector<IndexRange>& out) const override {
    if (is_replaced()) return;  // not in order of particles
    const std::vector<std::uint32_t>& first = set_.records[0];
    for (std::size_t c = 0; c + 1 < set_.color_begin.size(); ++c) {
      const auto at = [&](std::size_t i) { return first.begin() + static_cast<std::ptrdiff_t>(i); };
      const auto before = [&](std::size_t from, std::size_t particle) {
        return static_cast<std::size_t>(
            std::partition_point(at(from), at(set_.color_begin[c + 1]),
                                 [&](std::uint32_t record) { return record / 4 < particle; }) -
            first.begin());
      };
      std::size_t i = set_.color_begin[c];
      for (const IndexRange& range : particles) {
        const std::size_t begin = before(i, range.begin);
        i = before(begin, range.end);
        if (begin < i) out.push_back({begin, i});
      }
    }
  }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override {
    return particles.first_movable(set_.indices(set_.color_begin[static_cast<std::size_t>(color)] + index));
  }
  void linearize_some(std::span<const std::uint32_t> constraints, const ParticleView& particles,
                      const Substep& substep, const LinearVisitor& visitor) const override {
    for (const std::uint32_t i : constraints) linearize_one(i, particles, substep, visitor);
  }

  std::uint64_t revision() const override { return revision_; }
  void append_links(std::size_t begin, std::size_t end, std::vector<Link>& out) const override {
    for (std::size_t i = begin; i < end; ++i) {
      const Indices indices = set_.indices(i);
      for (const KindLink& link : links_of(i)) {
        const std::uint32_t a = indices[static_cast<std::size_t>(link.a)],
                            b = indices[static_cast<std::size_t>(link.b)];
        if (a != b && link.length > 0 && std::isfinite(link.length))
          out.push_back({std::min(a, b), std::max(a, b), link.length, link.energy, set_.stiffness(i)});
      }
    }
  }
  Pull pull(std::size_t i) const override {
    const Indices indices = set_.indices(i);
    Pull pull{.particle = {indices.front(), indices.back()}, .compliance = set_.compliance(i)[0]};
    if constexpr (has_rest_length) pull.rest_length = Kind::rest_length(set_.params(i));
    if constexpr (has_target) pull.target = Kind::target(set_.params(i));
    return pull;
  }
  Bending bending(std::size_t i) const override {
    Bending result;
    if constexpr (has_flat_gradient) {
      const Indices indices = set_.indices(i);
      const Params params = set_.params(i);
      const auto K = Kind::flat_gradient(params);
      result.particle.fill(indices[0]);
      std::copy(indices.begin(), indices.end(), result.particle.begin());
      std::copy(K.begin(), K.end(), result.K.begin());
      result.compliance = set_.compliance(i)[0];
      if constexpr (requires { Kind::is_flat; })
        if (!Kind::is_flat(params)) result.compliance = 0;
    }
    return result;
  }

  void multipliers(const std::function<void(std::span<float>)>& visitor) override {
    for (std::vector<float>& lambda : set_.multipliers) visitor(lambda);
  }
  int arity() const override { return Kind::arity; }
  std::vector<std::uint32_t> indices() const override { return set_.flat_indices(); }
  std::span<const std::uint32_t> color_begin() const override { return set_.color_begin; }
  void replace(Coloring coloring, std::span<const std::uint32_t> particles) override {
    restore();
    replaced_.former = {inverse_order(coloring.order), set_.color_begin};
    for (std::size_t k = 0; k < particles.size(); ++k)
      replaced_.records[k % Set::arity].push_back(4 * particles[k]);
    arrange(std::move(coloring));
  }
  void restore() override {
    clear_levels();
    if (is_replaced()) arrange(std::move(replaced_.former));
    replaced_ = {};
  }

  void erase_particles(std::uint32_t begin, std::uint32_t end) override {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < set_.size(); ++i) {
      const Indices indices = set_.indices(i);
      if (std::none_of(indices.begin(), indices.end(),
                       [&](std::uint32_t index) { return index >= begin && index < end; }))
        kept.push_back(i);
    }
    if (kept.size() != set_.size()) set_.reorder(kept), dirty_ = true;
    revision_ = detail::next_revision();
    for (std::vector<std::uint32_t>& records : set_.records)
      for (std::uint32_t& record : records)
        if (record / 4 >= end) record -= 4 * (end - begin);
  }

 private:
  static constexpr std::size_t grain = 256;
  static constexpr bool has_rest_length = requires(const Params& params) { Kind::rest_length(params); };
  static constexpr bool has_target = requires(const Params& params) { Kind::target(params); };
  static constexpr bool has_flat_gradient = requires(const Params& params) { Kind::flat_gradient(params); };

  auto links_of(std::size_t i) const {
    const Params params = set_.params(i);
    const auto alpha = set_.compliance(i);
    if constexpr (has_rest_length) {
      const float length = Kind::rest_length(params);
      return std::array{KindLink{0, 1, length, length * length / alpha[0]}};
    } else if constexpr (requires { Kind::links(params, alpha); }) {
      return Kind::links(params, alpha);
    } else {
      return std::array<KindLink, 0>{};
    }
  }

  void forget_shared() {
    half_shared_ = {};
    for (std::size_t i = 0; i < set_.size(); ++i) half_shared_.push_back(0);
    dirty_sweeps_ = true;
  }

  void arrange(Coloring coloring) {
    half_shared_.reorder(coloring.order);
    set_.reorder(coloring.order);
    set_.color_begin = std::move(coloring.color_begin);
    SOUPLE_ASSERT(set_.color_begin.back() == set_.size(), "colors divide all constraints");
    reset_values();
  }
  void reset_values() {
    scales_for_ = -1;
    find_scales({});  // a solver may linearize before the first substep
    revision_ = detail::next_revision();
  }
  // phi / 2 of every constraint: half the share of inverse mass of particles that have other constraints too.
  // It is 0.55 instead of 1/2. The links that carry a load were added first, get early colors and are softer than the
  // mean. On hanging cloths and bars with 10 substeps, the result is within 1 % of converged; with 1/2, 3 %.
  void find_shared(const ParticleView& particles) {
    std::vector<bool> seen(particles.position.size()), shared(seen);
    for (std::size_t i = 0; i < set_.size(); ++i)
      for (const std::uint32_t particle : set_.indices(i)) {
        if (seen[particle]) shared[particle] = true;
        seen[particle] = true;
      }
    half_shared_ = {};
    for (std::size_t i = 0; i < set_.size(); ++i) {
      float sum = 0, all = 0;
      for (const std::uint32_t particle : set_.indices(i)) {
        all += particles.inverse_mass(particle);
        if (shared[particle]) sum += particles.inverse_mass(particle);
      }
      half_shared_.push_back(sum > 0 ? 0.55f * (sum / all) : 0);
    }
  }
  // Mean over the constraints of what one sweep adds to their compliance, relative to it. [1/s^2]
  /// The mean over each piece.
  void find_softness(const ParticleView& particles) {
    if constexpr (requires { Kind::softness; }) {
      const std::vector<std::uint32_t> lowest =
          detail::lowest_connected(set_.flat_indices(), Set::arity, particles.position.size());
      std::vector<std::uint32_t> piece_at(particles.position.size(), no_particle);
      std::vector<double> sum, count;
      pieces_.clear();
      for (std::size_t i = 0; i < set_.size(); ++i) {
        const Indices indices = set_.indices(i);
        std::uint32_t& piece = piece_at[lowest[i]];
        if (piece == no_particle) {
          piece = static_cast<std::uint32_t>(pieces_.size());
          pieces_.push_back({lowest[i], static_cast<std::uint32_t>(i), 0});
          sum.push_back(0), count.push_back(0);
        }
        float w[Kind::arity];
        for (std::size_t k = 0; k < Set::arity; ++k) w[k] = particles.inverse_mass(indices[k]);
        sum[piece] += static_cast<double>(Kind::softness(set_.params(i), set_.compliance(i), w));
        ++count[piece];
      }
      for (std::size_t p = 0; p < pieces_.size(); ++p)
        pieces_[p].softness = static_cast<float>(sum[p] / count[p]);
      std::sort(pieces_.begin(), pieces_.end(),
                [](const Piece& a, const Piece& b) { return a.particle < b.particle; });
    }
  }
  int sweeps_needed(const Substep& substep, float softness) const {
    if (substep.mode == Mode::pbd) return 1;
    const float needed = sweeps_for(softness, substep.h);
    return static_cast<int>(std::fmin(needed, static_cast<float>(max_sweeps(substep))));
  }
  bool is_replaced() const { return !replaced_.former.order.empty(); }
  // Particles that `project` acts on.
  const std::array<std::vector<std::uint32_t>, Set::arity>& projected_records() const {
    return is_replaced() ? replaced_.records : set_.records;
  }

  // Positions relative to the constraint's origin, or to its first particle. So no digit is lost far from the world's
  // origin and in small steps.
  void load(const Indices& indices, std::size_t i, const ParticleView& particles,
            ProjectionInput<Kind, float>& in) const {
    for (int k = 0; k < Kind::arity; ++k) {
      const std::uint32_t particle = indices[static_cast<std::size_t>(k)];
      in.inverse_mass[k] = particles.inverse_mass(particle);
      if constexpr (has_origin<Kind>) {
        in.x[k] = particles.relative(particle, Kind::template origin<float>(set_.params(i)));
      } else {
        in.x[k] = particles.difference(particle, indices[0]);
      }
    }
  }

  static constexpr std::size_t residual_chunk = 512;

  // C of constraints [begin, end), at most residual_chunk of them.
  void evaluate(std::size_t begin, std::size_t end, const ParticleView& particles,
                float (&C)[rows_of<Kind>][residual_chunk]) const {
    if (kernels_) {
      float* rows[rows_of<Kind>];
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) rows[r] = C[r];
      Arrays arrays(set_);
      arrays.set.scale = {scales_.data(), scales_.stride()};
      kernels_->evaluate(arrays_of(particles), arrays.set, begin, end, rows);
      return;
    }
    for (std::size_t i = begin; i < end; ++i) {
      float values[rows_of<Kind>];
      evaluate(i, particles, values);
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) C[r][i - begin] = values[r];
    }
  }

  std::size_t chunk_count() const { return (set_.size() + residual_chunk - 1) / residual_chunk; }

  // Chunks do not depend on the number of threads, so the bits of the result do not either.
  Residual residual_of(std::size_t chunk, const ParticleView& particles, bool with_energy) const {
    const std::size_t begin = chunk * residual_chunk, end = std::min(begin + residual_chunk, set_.size());
    const std::size_t count = end - begin;
    float C[rows_of<Kind>][residual_chunk], values[residual_chunk];
    evaluate(begin, end, particles, C);
    Residual result;
    result.count = count * rows_of<Kind>;
    for (const auto& row : C) {
      for (std::size_t i = 0; i < count; ++i) values[i] = violation_of(row[i]);
      result.largest = std::max(result.largest, static_cast<double>(largest_of(values, count)));
      result.sum += static_cast<double>(sum_of(values, count));
    }
    if constexpr (has_strain) {
      find_strains(begin, count, C, values);
      result.largest_strain = static_cast<double>(largest_of(values, count));
    }
    for (std::size_t i = 0; with_energy && i < count; ++i) {
      float of_one[rows_of<Kind>];
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) of_one[r] = C[r][i];
      result.energy += energy(of_one, set_.compliance(begin + i));
    }
    return result;
  }

  // First copies the parameters to plain arrays: the loop over them then has neither strides nor aliasing.
  void find_strains(std::size_t begin, std::size_t count, const float (&C)[rows_of<Kind>][residual_chunk],
                    float (&strains)[residual_chunk]) const {
    float parameters[Set::param_count][residual_chunk];
    for (std::size_t k = 0; k < Set::param_count; ++k)
      for (std::size_t i = 0; i < count; ++i) parameters[k][i] = set_.parameters[k][begin + i];
    for (std::size_t i = 0; i < count; ++i) {
      float of_one[Set::param_count];
      for (std::size_t k = 0; k < Set::param_count; ++k) of_one[k] = parameters[k][i];
      Params params;
      std::memcpy(&params, of_one, sizeof params);
      float rows[rows_of<Kind>];
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) rows[r] = C[r][i];
      if constexpr (has_strain) strains[i] = Kind::strain(params, rows);
    }
  }

  void linearize_one(std::size_t i, const ParticleView& particles, const Substep& substep,
                     const LinearVisitor& visitor) const {
    ProjectionInput<Kind, float> in;
    const Indices indices = set_.indices(i);
    load(indices, i, particles, in);
    set_terms(i, substep, in);
    float C[rows_of<Kind>];
    Vec3f gradient[rows_of<Kind>][Kind::arity];
    evaluate_rows<Kind, float>(in.x, set_.params(i), C, gradient);
    visitor({indices,
             C,
             {&gradient[0][0], std::size_t{rows_of<Kind>} * Kind::arity},
             in.alpha,
             in.scale,
             Kind::sense == Sense::non_negative});
  }

  // Pointers to the arrays of a set, as kernels use them.
  struct Arrays {
    const std::uint32_t* records[Kind::arity];
    kernels::ColumnView parameters[Set::param_count], compliances[compliance_size<Kind>];
    kernels::SetArrays set;

    explicit Arrays(const Set& of) {
      const auto view = [](const Column& column) {
        return kernels::ColumnView{column.data(), column.stride()};
      };
      for (std::size_t k = 0; k < Kind::arity; ++k) records[k] = of.records[k].data();
      for (std::size_t k = 0; k < Set::param_count; ++k) parameters[k] = view(of.parameters[k]);
      for (std::size_t k = 0; k < compliance_size<Kind>; ++k) compliances[k] = view(of.compliances[k]);
      set.records = records;
      set.parameters = parameters;
      set.compliances = compliances;
      set.damping_time = view(of.damping_times);
      set.half_shared = set.damping_time;  // read by plain projections only, which set it
    }
    Arrays(const Arrays&) = delete;
    Arrays& operator=(const Arrays&) = delete;
  };

  static kernels::ParticleArrays arrays_of(const ParticleView& particles) {
    const std::span<Vec4f> corrected = particles.corrected.empty() ? particles.moving : particles.corrected;
    return {&particles.position.data()->x, &particles.moving.data()->x, &corrected.data()->x};
  }

  void project_range(std::size_t begin, std::size_t end, const ParticleView& particles,
                     const Substep& substep) {
    // The plain kernels correct in place.
    const bool general = substep.stores_multipliers() || !particles.corrected.empty();
    if (kernels_) {
      project_packed(begin, end, particles, substep, general);
    } else {
      project_scalar(begin, end, particles, substep, general);
    }
  }
  void project_packed(std::size_t begin, std::size_t end, const ParticleView& particles,
                      const Substep& substep, bool general) {
    Arrays arrays(set_);
    for (std::size_t k = 0; k < Kind::arity; ++k) arrays.records[k] = projected_records()[k].data();
    arrays.set.scale = {scales_.data(), scales_.stride()};
    arrays.set.h = substep.h;
    arrays.set.inverse_h2 = inverse_h2(substep);
    arrays.set.relaxation = substep.relaxation;
    static constexpr float zero = 0;
    arrays.set.half_shared = {&zero, 0};
    if (!in_level_.empty()) {
      arrays.set.scale = {level_scales_.data(), 1};
      arrays.set.half_shared = {level_shared_.data(), 1};
    } else if (substep.relaxation == 1) {
      arrays.set.half_shared = {half_shared_.data(), half_shared_.stride()};
    }
    float* multipliers[rows_of<Kind>];
    for (std::size_t r = 0; r < rows_of<Kind>; ++r) multipliers[r] = set_.multipliers[r].data();
    if (substep.stores_multipliers()) arrays.set.multipliers = multipliers;
    (general ? kernels_->general : kernels_->plain)(arrays_of(particles), arrays.set, begin, end);
  }

  // The scalar, readable version: the reference for the packed kernels, and the code for a user's own kinds.
  void project_scalar(std::size_t begin, std::size_t end, const ParticleView& view, const Substep& of,
                      bool general) {
    const ParticleView particles = view;  // local copies: the loop's stores cannot alias them
    const Substep substep = of;
    if (general) {
      for (std::size_t i = begin; i < end; ++i) project_one<Terms::general>(i, particles, substep);
    } else {
      for (std::size_t i = begin; i < end; ++i) project_one<Terms::plain>(i, particles, substep);
    }
  }

  static float inverse_h2(const Substep& substep) {
    return substep.mode == Mode::pbd ? 0 : 1 / (substep.h * substep.h);
  }

  // k' of every constraint in PBD mode, 1 otherwise.
  void find_scales(const Substep& substep) {
    const int iterations = substep.mode == Mode::pbd ? substep.iterations : 0;
    if (iterations == scales_for_ && scales_.size() == set_.size()) return;
    scales_for_ = iterations;
    scales_ = {};
    for (std::size_t i = 0; i < set_.size(); ++i)
      scales_.push_back(iterations > 0 ? stiffness_per_iteration(set_.stiffness(i), iterations) : 1);
  }

  void evaluate(std::size_t i, const ParticleView& particles, float (&C)[rows_of<Kind>]) const {
    ProjectionInput<Kind, float> in;
    load(set_.indices(i), i, particles, in);
    Vec3f gradient[rows_of<Kind>][Kind::arity];
    evaluate_rows<Kind, float>(in.x, set_.params(i), C, gradient);
  }

  static float violation_of(float C) {
    // std::fmax would be a function call; a NaN of an inequality gives 0 with both.
    return Kind::sense == Sense::equality ? std::fabs(C) : -C > 0 ? -C : 0;
  }

  static constexpr bool has_strain = requires(const Params& params, const float (&C)[rows_of<Kind>]) {
    Kind::strain(params, C);
  };

  float strain_of(std::size_t i, const float (&C)[rows_of<Kind>]) const {
    if constexpr (has_strain) return Kind::strain(set_.params(i), C);
    return 0;
  }

  // 1/2 C^T alpha^-1 C. Rows without compliance and satisfied inequalities store no energy.
  static double energy(const float (&C)[rows_of<Kind>], const Compliance& compliance) {
    if (Kind::sense == Sense::non_negative && C[0] >= 0) return 0;
    double alpha[compliance_size<Kind>], y[rows_of<Kind>], sum = 0;
    for (std::size_t k = 0; k < compliance_size<Kind>; ++k) alpha[k] = static_cast<double>(compliance[k]);
    for (std::size_t r = 0; r < rows_of<Kind>; ++r) y[r] = static_cast<double>(C[r]);
    solve_symmetric<rows_of<Kind>>(alpha, y);
    for (std::size_t r = 0; r < rows_of<Kind>; ++r) sum += 0.5 * y[r] * static_cast<double>(C[r]);
    return sum;
  }

  // alpha~ and k' of the substep.
  void set_terms(std::size_t i, const Substep& substep, ProjectionInput<Kind, float>& in) const {
    for (std::size_t k = 0; k < compliance_size<Kind>; ++k)
      in.alpha[k] = set_.compliances[k][i] * inverse_h2(substep);
    in.scale = scales_[i] * substep.relaxation;
    if (substep.relaxation == 1) in.half_shared = half_shared_[i];
  }

  template <Terms terms>
  void project_one(std::size_t i, const ParticleView& particles, const Substep& substep) {
    Indices indices;
    for (std::size_t k = 0; k < Set::arity; ++k) indices[k] = projected_records()[k][i] / 4;
    ProjectionInput<Kind, float> in;
    load(indices, i, particles, in);
    set_terms(i, substep, in);
    if (!in_level_.empty()) in.scale = level_scales_[i], in.half_shared = level_shared_[i];
    const bool stored = terms == Terms::general && substep.stores_multipliers();
    if (stored)
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) in.lambda[r] = set_.multipliers[r][i];
    Vec3f dx[Kind::arity];
    float dlambda[rows_of<Kind>];
    project_constraint<Kind, float, terms>(in, set_.params(i), dx, dlambda);
    if (stored)
      for (std::size_t r = 0; r < rows_of<Kind>; ++r) set_.multipliers[r][i] += dlambda[r];
    for (int k = 0; k < Kind::arity; ++k) particles.correct(indices[static_cast<std::size_t>(k)], dx[k]);
  }

  // The scalar version of the packed kernel.
  void add_forces_of(std::size_t i, const ParticleView& particles, const Substep& substep,
                     float sweep_share) {
    const Indices indices = set_.indices(i);
    ProjectionInput<Kind, float> in;
    load(indices, i, particles, in);
    set_terms(i, substep, in);
    in.scale = in_level_[i];
    Vec3f f[Kind::arity];
    elastic_forces<Kind, float>(in, set_.params(i), sweep_share, f);
    for (std::size_t k = 0; k < Set::arity; ++k) particles.correct(indices[k], f[k]);
  }

  // The scalar version of the packed kernel.
  void damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                const Substep& substep) const {
    const Indices indices = set_.indices(i);
    DampingInput<Kind, float> in;
    load(indices, i, particles, in.constraint);
    set_terms(i, substep, in.constraint);
    in.gamma = set_.damping_time(i) / substep.h;
    for (std::size_t k = 0; k < Set::arity; ++k) in.velocity[k] = velocity[indices[k]].xyz();
    Vec3f dv[Kind::arity];
    damp_constraint<Kind, float>(in, set_.params(i), dv);
    for (std::size_t k = 0; k < Set::arity; ++k)
      velocity[indices[k]].set_xyz(velocity[indices[k]].xyz() + dv[k]);
  }

  Set set_;
  mutable std::vector<Residual> partial_;  // per chunk
  Column half_shared_;                     // phi / 2 of each constraint
  /// Connected constraints, with their softness [1/s^2].
  struct Piece {
    std::uint32_t particle, constraint;  // the lowest particle, a constraint
    float softness;
  };
  float softness_of(const Piece& piece) const {
    return in_level_.empty() || !(in_level_[piece.constraint] > 0) ? piece.softness : 0;
  }
  std::vector<Piece> pieces_;                                  // see find_softness; ascending by particle
  std::vector<float> in_level_, level_scales_, level_shared_;  // see set_levels; empty: no levels
  bool dirty_sweeps_ = true;                                   // half_shared_ and pieces_ are out of date
  bool dirty_softness_ = true;                                 // pieces_ are out of date
  std::uint64_t revision_ = detail::next_revision();
  Column scales_;        // k' of each constraint, for scales_for_
  int scales_for_ = -1;  // number of iterations in PBD mode, else 0
  const kernels::KindKernels* kernels_ = nullptr;
  struct Replaced {
    std::array<std::vector<std::uint32_t>, Set::arity> records;  // as set_.records
    Coloring former;  // restores order and colors; empty: nothing is replaced
  } replaced_;
  bool dirty_ = true;
};

// The kinds that worlds use are compiled once, in set_projector.cpp.
extern template class SetProjector<Distance>;
extern template class SetProjector<DihedralBending>;
extern template class SetProjector<IsometricBending>;
extern template class SetProjector<TriangleMembrane>;
extern template class SetProjector<TetVolume>;
extern template class SetProjector<NeoHookean>;
extern template class SetProjector<RopeBending>;

}  // namespace souple
