#include "souple/solver/sweep_regions.h"

#include "souple/assert.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <numeric>

namespace souple {
namespace {

bool same_ranges(std::span<const IndexRange> a, std::span<const IndexRange> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const IndexRange& p, const IndexRange& q) {
    return p.begin == q.begin && p.end == q.end;
  });
}

}  // namespace

void SweepRegions::set_objects(std::span<const IndexRange> objects, std::vector<ObjectPair> joined) {
  objects_.assign(objects.begin(), objects.end());
  object_of_.assign(objects.empty() ? 0 : objects.back().end, 0);
  for (std::uint32_t o = 0; o < objects.size(); ++o)
    std::fill(object_of_.begin() + static_cast<std::ptrdiff_t>(objects[o].begin),
              object_of_.begin() + static_cast<std::ptrdiff_t>(objects[o].end), o);
  joined_ = std::move(joined);
  by_region_.resize(objects.size()), class_of_.resize(objects.size()), chosen_.resize(objects.size());
  listed_.clear();
  found_ = false;
}

// Particles that nothing moves connect nothing.
void SweepRegions::find(std::span<Projector* const> projectors, const ParticleView& particles) {
  if (found_) return;
  found_ = true;
  connected_.reset(objects_.size());
  for (const auto& [a, b] : joined_) connected_.join(a, b);
  for (Projector* const projector : projectors) {
    const ContactFacet* const contact = projector->facets().contact;
    if (contact == nullptr || contact->is_collider_contact()) continue;
    projector->visit(particles, [&](const ConstraintState& constraint) {
      std::uint32_t first = none;
      for (const std::uint32_t i : constraint.particles) {
        if (!(particles.inverse_mass(i) > 0)) continue;
        if (first != none) connected_.join(first, object_of_[i]);
        first = object_of_[i];
      }
    });
  }
  std::iota(by_region_.begin(), by_region_.end(), 0u);
  std::sort(by_region_.begin(), by_region_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(connected_.root(a), a) < std::pair(connected_.root(b), b);
  });
}

std::uint32_t SweepRegions::class_with(std::span<const int> sweeps) {
  for (std::uint32_t c = 0; c < class_count_; ++c)
    if (std::equal(sweeps.begin(), sweeps.end(), classes_[c].sweeps.begin(), classes_[c].sweeps.end()))
      return c;
  if (classes_.size() == class_count_) classes_.emplace_back();
  SweepClass& added = classes_[class_count_];
  added.sweeps.assign(sweeps.begin(), sweeps.end());
  added.particles.clear();
  return static_cast<std::uint32_t>(class_count_++);
}

void SweepRegions::sort_into_classes(std::span<Projector* const> projectors, const Substep& substep) {
  class_count_ = 0;
  for (std::size_t begin = 0, end = 0; begin < by_region_.size(); begin = end) {
    const std::uint32_t root = connected_.root(by_region_[begin]);
    own_.clear();
    for (; end < by_region_.size() && connected_.root(by_region_[end]) == root; ++end)
      own_.push_back(objects_[by_region_[end]]);
    sweeps_.clear();
    for (Projector* const projector : projectors) {
      const ElasticFacet* const elastic = projector->facets().elastic;
      sweeps_.push_back(elastic != nullptr ? elastic->sweeps_needed(substep, own_) : 1);
    }
    const std::uint32_t c = class_with(sweeps_);
    for (std::size_t k = begin; k < end; ++k) class_of_[by_region_[k]] = c;
  }
  for (std::uint32_t o = 0; o < objects_.size(); ++o) classes_[class_of_[o]].particles.push_back(objects_[o]);
}

// Appends each constraint to the runs that runs_of(its particle) returns; null: to none. Joins neighbors.
template <class RunsOf>
void SweepRegions::list(const Projector& projector, const ParticleView& particles,
                        const RunsOf& runs_of) const {
  for (int color = 0; color < projector.color_count(); ++color)
    for (std::size_t k = 0; k < projector.color_size(color); ++k) {
      const std::uint32_t i = projector.particle_of(color, k, particles);
      std::vector<SweptRun>* const runs = i != no_particle ? runs_of(i) : nullptr;
      if (runs == nullptr) continue;
      if (!runs->empty() && runs->back().color == color && runs->back().end == k)
        ++runs->back().end;
      else
        runs->push_back({color, k, k + 1});
    }
}

void SweepRegions::list_ranges(const Projector& projector, const LinearFacet& set, std::size_t of_class,
                               std::vector<SweptRun>& runs) {
  runs.clear(), found_ranges_.clear();
  set.append_constraints_of(classes_[of_class].particles, found_ranges_);
  auto range = found_ranges_.begin();
  std::size_t first = 0;
  for (int color = 0; color < projector.color_count(); ++color) {
    const std::size_t last = first + projector.color_size(color);
    for (; range != found_ranges_.end() && range->end <= last; ++range) {
      SOUPLE_ASSERT(first <= range->begin, "a range of one color");
      runs.push_back({color, range->begin - first, range->end - first});
    }
    first = last;
  }
}

// Those of sets remain while the objects of the class do.
void SweepRegions::list_runs(std::span<Projector* const> projectors, const ParticleView& particles) {
  if (listed_.size() < classes_.size()) listed_.resize(classes_.size());
  const std::span<SweepClass> classes = std::span(classes_).first(class_count_);
  for (std::size_t c = 0; c < class_count_; ++c) {
    if (classes[c].runs.size() != projectors.size()) listed_[c].clear();
    classes[c].runs.resize(projectors.size());
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const LinearFacet* const set = projectors[p]->facets().linear;
    for (std::size_t c = 0; c < class_count_; ++c)
      if (set == nullptr)
        classes[c].runs[p].clear();
      else if (!same_ranges(listed_[c], classes[c].particles))
        list_ranges(*projectors[p], *set, c, classes[c].runs[p]);
    if (set == nullptr)
      list(*projectors[p], particles,
           [&](std::uint32_t i) { return &classes[class_of_[object_of_[i]]].runs[p]; });
  }
  for (std::size_t c = 0; c < class_count_; ++c)
    listed_[c].assign(classes[c].particles.begin(), classes[c].particles.end());
}

std::span<const SweepClass> SweepRegions::classes(std::span<Projector* const> projectors,
                                                  const ParticleView& particles, const Substep& substep) {
  const auto needs_one = [&](Projector* projector) { return sweeps_needed(*projector, substep) == 1; };
  const auto is_unknown = [&](Projector* projector) {
    return projector->color_count() > 0 && projector->color_size(0) > 0 &&
           projector->particle_of(0, 0, particles) == unknown_particle;
  };
  if (objects_.size() < 2 || std::all_of(projectors.begin(), projectors.end(), needs_one) ||
      std::any_of(projectors.begin(), projectors.end(), is_unknown))
    return {};
  find(projectors, particles);
  sort_into_classes(projectors, substep);
  if (class_count_ < 2) return {};
  list_runs(projectors, particles);
  return std::span(classes_).first(class_count_);
}

void SweepRegions::choose_none(std::span<Projector* const> projectors, const ParticleView& particles) {
  find(projectors, particles);
  std::fill(chosen_.begin(), chosen_.end(), std::uint8_t{0});
}

void SweepRegions::list_particles(std::uint32_t particle, std::vector<IndexRange>& out) {
  SOUPLE_ASSERT(found_, "regions are found before they are listed");
  out.clear();
  const std::uint32_t root = root_of(particle);
  auto object = std::lower_bound(by_region_.begin(), by_region_.end(), root,
                                 [&](std::uint32_t o, std::uint32_t r) { return connected_.root(o) < r; });
  for (; object != by_region_.end() && connected_.root(*object) == root; ++object)
    out.push_back(objects_[*object]);
}

void SweepRegions::list_chosen(const Projector& projector, const ParticleView& particles,
                               std::vector<SweptRun>& runs) {
  runs.clear();
  list(projector, particles, [&](std::uint32_t i) { return chosen_[root_of(i)] != 0 ? &runs : nullptr; });
}

}  // namespace souple
