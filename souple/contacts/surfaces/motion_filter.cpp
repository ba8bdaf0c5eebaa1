#include "souple/contacts/surfaces/motion_filter.h"

#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/surfaces/element_motion.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace souple {
namespace {

// If 4 passes leave violations with rigid bodies, 20 hardly ever resolve them (scenes/brick_wall.json: in 30 of 1600
// substeps). A body that pinches a cloth has them in every substep.
constexpr int correction_passes = 20, clamping_passes = 4, stopping_passes = 100, passes_with_bodies = 4;

}  // namespace

void MotionFilter::set_count() {
  // The number of violations varies between substeps.
  correction_pair_.reserve(256), correction_toi_.reserve(256), violations_.reserve(256);
  corrected_particles_.reserve(2048);
  corrections_.resize(256);
  pushes_.reserve(2048), stopped_.reserve(2048), grips_.reserve(2048), pinches_.reserve(2048);
}

void MotionFilter::find_violations(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase,
                                   const ParticleView& particles, Threads& threads) {
  candidates.measure(particles, threads);
  narrow_phase.find_violations(candidates, particles, true, violations_, threads);
}

// After a pass. It moved only particles of violations and of correction contacts, so only their pairs are
// tested: all other pairs have no violation, as before.
std::size_t MotionFilter::refind_violations(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase,
                                            const ParticleView& particles, const Substep& substep,
                                            Threads& threads) {
  corrected_particles_.assign(held_particles_.begin(), held_particles_.end());
  held_particles_.clear();
  for (const PairToi& violation : violations_)
    for (const std::uint32_t i : candidates.pair(violation.pair).particle) corrected_particles_.push_back(i);
  for (const std::uint32_t* const column : corrections_.columns().particle)
    corrected_particles_.insert(corrected_particles_.end(), column, column + correction_pair_.size());
  std::sort(corrected_particles_.begin(), corrected_particles_.end());
  corrected_particles_.erase(std::unique(corrected_particles_.begin(), corrected_particles_.end()),
                             corrected_particles_.end());
  const std::size_t first_new = candidates.update(particles, substep.h, corrected_particles_, threads);
  candidates.measure(particles, corrected_particles_);
  narrow_phase.find_violations(candidates, particles, false, violations_, threads);
  return first_new;
}

// Adds correction contacts of the violations to correct.
void MotionFilter::append_corrections(ElementPairs& candidates, const SurfaceNarrowPhase& narrow_phase,
                                      const ParticleView& particles) {
  const std::size_t begin = correction_pair_.size();
  const auto append = [&](bool edges) {
    for (const PairToi& violation : corrected_) {
      const NearPair& pair = candidates.pair(violation.pair);
      if (candidates.are_edges(violation.pair) != edges ||
          !has_normal(pair, motion_of(pair, particles), violation.toi, edges, particles))
        continue;
      correction_pair_.push_back(violation.pair);
      correction_toi_.push_back(violation.toi);
    }
  };
  append(false);
  const std::size_t edges = correction_pair_.size();
  append(true);
  corrections_.resize(correction_pair_.size());
  const kernels::ContactColumns columns = corrections_.columns();
  narrow_phase.describe(candidates, false, begin, edges, particles, correction_pair_, correction_toi_,
                        columns);
  narrow_phase.describe(candidates, true, edges, correction_pair_.size(), particles, correction_pair_,
                        correction_toi_, columns);
}

// The group of a pair's surfaces that give way; that of its first surface if none does.
std::uint32_t MotionFilter::group_of(const ElementPairs& candidates, std::span<const std::uint32_t, 4> pair,
                                     const ParticleView& particles) {
  const std::uint32_t i = particles.first_movable(pair);
  return groups_.root(candidates.surfaces().of(i == no_particle ? pair[0] : i));
}

// Surfaces that give way in a violation or in a correction contact are of one group.
void MotionFilter::find_groups(const ElementPairs& candidates, const ParticleView& particles) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  groups_.reset(surfaces.size());
  const auto join = [&](const auto& pair) {
    const std::uint32_t first = particles.first_movable(pair);
    for (const std::uint32_t i : pair)
      if (first != no_particle && particles.inverse_mass(i) > 0)
        groups_.join(surfaces.of(first), surfaces.of(i));
  };
  for (const PairToi& violation : violations_) join(candidates.pair(violation.pair).particle);
  for (std::size_t c = 0; c < correction_pair_.size(); ++c)
    join(anchor_of(corrections_.columns(), c).particle);
}

// Solves the correction contacts of the groups that have violations to correct, one after the other. They conserve
// momentum.
void MotionFilter::solve_corrections(ElementPairs& candidates, const ParticleView& particles) {
  acts_.assign(candidates.surfaces().size(), 0);
  for (const PairToi& violation : corrected_)
    acts_[group_of(candidates, candidates.pair(violation.pair).particle, particles)] = 1;
  const kernels::ContactColumns columns = corrections_.columns();
  const kernels::ElementPairKernels& scalar_kernels =
      kernels::find_element_pair_kernels(InstructionSet::scalar);
  const auto acts = [&](std::size_t c) {
    return acts_[group_of(candidates, anchor_of(columns, c).particle, particles)] != 0;
  };
  constexpr int sweeps = 4;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t begin = 0, end = 0; begin < correction_pair_.size(); begin = end + 1) {
      for (end = begin; end < correction_pair_.size() && acts(end);) ++end;
      if (begin < end) scalar_kernels.project(candidates.particle_records(particles), columns, begin, end);
    }
}

// Particles of violations keep the part of their motion that is safe.
void MotionFilter::clamp_to_toi(const ElementPairs& candidates, const ParticleView& particles) {
  clamp_toi_.assign(candidates.surfaces().particle_count(), 1);
  for (const PairToi& violation : clamped_)
    for (const std::uint32_t i : candidates.pair(violation.pair).particle)
      clamp_toi_[i] = min(clamp_toi_[i], violation.toi);
  for (std::size_t i = 0; i < clamp_toi_.size(); ++i)
    if (clamp_toi_[i] < 1 && particles.inverse_mass(i) > 0)
      particles.moving[i].set_xyz(particles.start[i].xyz() + particles.moved(i) * clamp_toi_[i]);
}

// Particles of violations stay where they were at the substep's start. Returns whether any had moved.
bool MotionFilter::stop(const ElementPairs& candidates, const ParticleView& particles) const {
  bool any_moved = false;
  for (const PairToi& violation : stopped_pairs_)
    for (const std::uint32_t i : candidates.pair(violation.pair).particle) {
      if (particles.inverse_mass(i) == 0 || particles.moved(i) == Vec3f{}) continue;
      particles.moving[i].set_xyz(particles.start[i].xyz());
      any_moved = true;
    }
  return any_moved;
}

// Stops the driven particles of surfaces with violations. All of a surface stop, so that an obstacle keeps its shape.
bool MotionFilter::hold_driven(const ElementPairs& candidates, const ParticleView& particles) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  for (const PairToi& violation : stopped_pairs_)
    for (const std::uint32_t particle : candidates.pair(violation.pair).particle) {
      if (particles.inverse_mass(particle) > 0 || particles.moved(particle) == Vec3f{}) continue;
      const std::uint32_t surface = surfaces.of(particle);
      for (std::uint32_t i = surfaces[surface].begin; i < surfaces[surface].end; ++i) {
        if (particles.inverse_mass(i) > 0 || particles.moved(i) == Vec3f{}) continue;
        if (length(particles.moved(i)) > held_.speed) held_ = {surface, length(particles.moved(i)), 0};
        particles.moving[i].set_xyz(particles.start[i].xyz());
        held_particles_.push_back(i);
      }
    }
  return !held_particles_.empty();
}

// A pile of sheets that is flattened in one substep has more violations than passes can correct: it is stopped.
void MotionFilter::stop_crowded_groups(const ElementPairs& candidates, const ParticleView& particles) {
  constexpr int corrections_per_particle = 2;
  const ElementSurfaces& surfaces = candidates.surfaces();
  room_.assign(surfaces.size(), 0);
  for (std::uint32_t a = 0; a < surfaces.size(); ++a)
    room_[groups_.root(a)] +=
        corrections_per_particle * static_cast<int>(surfaces[a].end - surfaces[a].begin);
  const auto take = [&](const auto& pair) { --room_[group_of(candidates, pair, particles)]; };
  for (const PairToi& violation : violations_) take(candidates.pair(violation.pair).particle);
  for (std::size_t c = 0; c < correction_pair_.size(); ++c)
    take(anchor_of(corrections_.columns(), c).particle);
  for (std::uint32_t a = 0; a < surfaces.size(); ++a)
    if (room_[groups_.root(a)] < 0) ahead_[a] = correction_passes + clamping_passes;
}

// Groups whose violations are all with rigid bodies, which are driven here, leave out further corrections. Particles
// between such a body and another one, or between two surfaces, can only go back and forth.
void MotionFilter::advance_groups_with_bodies(const ElementPairs& candidates, const ParticleView& particles) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  acts_.assign(surfaces.size(), 1);
  for (const PairToi& violation : violations_) {
    const NearPair& pair = candidates.pair(violation.pair);
    const auto is_rigid = [&](std::uint32_t i) { return surfaces[surfaces.of(i)].rigid; };
    if (std::none_of(std::begin(pair.particle), std::end(pair.particle), is_rigid))
      acts_[group_of(candidates, pair.particle, particles)] = 0;
  }
  for (std::uint32_t a = 0; a < surfaces.size(); ++a)
    if (acts_[groups_.root(a)] != 0) ahead_[a] = correction_passes - passes_with_bodies;
}

// Lists the violations of a pass by what is done about them.
void MotionFilter::divide_violations(const ElementPairs& candidates, const ParticleView& particles,
                                     int pass) {
  corrected_.clear(), clamped_.clear(), stopped_pairs_.clear();
  find_groups(candidates, particles);
  if (pass == passes_with_bodies) advance_groups_with_bodies(candidates, particles);
  stop_crowded_groups(candidates, particles);
  const ElementSurfaces& surfaces = candidates.surfaces();
  for (const PairToi& violation : violations_) {
    int own = pass;
    for (const std::uint32_t i : candidates.pair(violation.pair).particle)
      if (particles.inverse_mass(i) > 0) own = std::max(own, pass + ahead_[surfaces.of(i)]);
    (own < correction_passes                     ? corrected_
     : own < correction_passes + clamping_passes ? clamped_
                                                 : stopped_pairs_)
        .push_back(violation);
  }
}

// Lists the free particles of violations with rigid bodies, before a pass that does not conserve momentum.
void MotionFilter::begin_pushes(const ElementPairs& candidates, const ParticleView& particles) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  stopped_.clear();
  const auto begin = [&](const PairToi& violation) {
    const auto& pair = candidates.pair(violation.pair).particle;
    const std::uint32_t one = surfaces.of(pair[0]), other = surfaces.of(pair[3]);
    const auto gives_way = [&](std::uint32_t i) { return particles.inverse_mass(i) > 0; };
    for (const std::uint32_t i : pair) {
      if (!gives_way(i)) continue;
      if (!gives_way(pair[0])) grips_.push_back({one, i, {}});
      if (!gives_way(pair[3])) grips_.push_back({other, i, {}});
      if (surfaces[one].rigid || surfaces[other].rigid)
        stopped_.push_back({surfaces[one].rigid ? one : other, i, particles.moved(i)});
    }
  };
  std::for_each(clamped_.begin(), clamped_.end(), begin);
  std::for_each(stopped_pairs_.begin(), stopped_pairs_.end(), begin);
  // One of several bodies receives the whole push.
  std::sort(stopped_.begin(), stopped_.end(), [](const BodyPush& a, const BodyPush& b) {
    return std::tie(a.particle, a.object) < std::tie(b.particle, b.object);
  });
  stopped_.erase(std::unique(stopped_.begin(), stopped_.end(),
                             [](const BodyPush& a, const BodyPush& b) { return a.particle == b.particle; }),
                 stopped_.end());
}

// Two surfaces that grip one particle.
void MotionFilter::find_pinches(const ElementPairs& candidates) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  const auto key = [](const BodyPush& grip) { return std::tie(grip.particle, grip.object); };
  std::sort(grips_.begin(), grips_.end(),
            [&](const BodyPush& a, const BodyPush& b) { return key(a) < key(b); });
  for (std::size_t k = 1; k < grips_.size(); ++k) {
    const std::uint32_t a = grips_[k - 1].object, b = grips_[k].object;
    if (grips_[k - 1].particle != grips_[k].particle || a == b) continue;
    if (surfaces[a].rigid || surfaces[b].rigid)
      pinches_.push_back(surfaces[a].rigid ? Pinch{a, b} : Pinch{b, a});
  }
}

void MotionFilter::end_pushes(const ParticleView& particles) {
  for (const BodyPush& stopped : stopped_)
    pushes_.push_back({stopped.object, stopped.particle, particles.moved(stopped.particle) - stopped.moved});
}

// Adds the motions of free particles by correction contacts with rigid bodies.
void MotionFilter::add_corrections(const ElementPairs& candidates, const ParticleView& particles) {
  const ElementSurfaces& surfaces = candidates.surfaces();
  const kernels::ContactColumns columns = corrections_.columns();
  for (std::size_t c = 0; c < correction_pair_.size(); ++c) {
    const Anchor<4> anchor = anchor_of(columns, c);
    const std::uint32_t one = surfaces.of(anchor.particle[0]), other = surfaces.of(anchor.particle[3]);
    if (!(surfaces[one].rigid || surfaces[other].rigid) || !(columns.normal_sum[c] > 0)) continue;
    anchor.distribute(particles, correction_of(columns, c), columns.inverse_mass[c],
                      [&](std::uint32_t i, const Vec3f& moved) {
                        pushes_.push_back({surfaces[one].rigid ? one : other, i, moved});
                      });
  }
}

// Equal keys are in order of their motions, so that sums have the same bits everywhere: a stable sort would allocate.
void MotionFilter::merge_pushes() {
  const auto key = [](const BodyPush& push) {
    return std::tie(push.object, push.particle, push.moved.x, push.moved.y, push.moved.z);
  };
  std::sort(pushes_.begin(), pushes_.end(),
            [&](const BodyPush& a, const BodyPush& b) { return key(a) < key(b); });
  std::size_t count = 0;
  for (const BodyPush& push : pushes_) {
    if (count > 0 && pushes_[count - 1].object == push.object && pushes_[count - 1].particle == push.particle)
      pushes_[count - 1].moved += push.moved;
    else
      pushes_[count++] = push;
  }
  pushes_.resize(count);
}

// First correction contacts, which conserve momentum. Then the motions of remaining violations are clamped. Another
// particle may hit a clamped one, so at last particles are stopped. Driven ones are stopped only where they would pass
// through stopped ones. Each pass stops further particles, until no violation is left.
MotionFilter::Result MotionFilter::apply(ElementPairs& candidates, SurfaceNarrowPhase& narrow_phase,
                                         const ParticleView& particles, const Substep& substep,
                                         Threads& threads) {
  correction_pair_.clear(), correction_toi_.clear(), grips_.clear();
  ahead_.assign(candidates.surfaces().size(), 0);
  clear_pushes();
  Result result;
  held_ = {};
  result.first_new = candidates.update(particles, substep.h, threads);
  find_violations(candidates, narrow_phase, particles, threads);
  constexpr int passes = correction_passes + clamping_passes + stopping_passes;
  for (int pass = 0; pass < passes && !violations_.empty(); ++pass) {
    divide_violations(candidates, particles, pass);
    if (!corrected_.empty()) {
      append_corrections(candidates, narrow_phase, particles);
      find_groups(candidates, particles);
      solve_corrections(candidates, particles);
    }
    if (corrected_.size() < violations_.size()) {
      result.clamped += violations_.size() - corrected_.size();
      begin_pushes(candidates, particles);
      clamp_to_toi(candidates, particles);
      const bool moves = stop(candidates, particles) || hold_driven(candidates, particles);
      if (!moves && corrected_.empty() && clamped_.empty()) break;
      end_pushes(particles);
    }
    result.first_new =
        std::min(result.first_new, refind_violations(candidates, narrow_phase, particles, substep, threads));
  }
  add_corrections(candidates, particles);
  merge_pushes();
  find_pinches(candidates);
  held_.speed /= substep.h;
  result.held = held_;
  return result;
}

std::size_t MotionFilter::bytes() const {
  return bytes_of(clamp_toi_, pushes_, stopped_, grips_, pinches_) + corrections_.bytes();
}

}  // namespace souple
