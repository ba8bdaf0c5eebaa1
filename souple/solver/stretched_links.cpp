#include "souple/solver/stretched_links.h"

#include "souple/constraints/attachment.h"
#include "souple/solver/coloring.h"
#include "souple/solver/external_moves.h"
#include "souple/solver/pieces.h"
#include "souple/solver/set_projector.h"
#include "souple/solver/weighted_sums.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace souple {
namespace {

using detail::FourFloats;

/// A link is stretched above this strain. Links around it are shortened to it. With 0.01, cloth that touches nothing costs
/// more and is stiffer than its material; with 0.02, it is stretched more where it touches colliders.
constexpr float threshold = 0.015f;
/// A link is torn above this strain.
constexpr float tearing = 1;
/// How many links the sweeps reach beyond a stretched link. 4 and 5 cost more and gain nothing.
constexpr int radius = 2;
/// Links that are so few links away from an isolated pin do not count as stretched.
constexpr int near_radius = 6;
/// Sweeps between two projections of the contacts, and rounds of both. Rounds count more than sweeps: 3 rounds of 8
/// sweeps leave a box's corners stretched by 14 %, 12 rounds of 2 by 8 %.
constexpr int contact_rounds = 12, contact_sweeps = 2;
/// Sweeps where no contact is between the particles, in one round. With 6, gusts of 30 m/s stretch cotton by 13 %, with 24
/// by 7 % (converged 12).
constexpr int free_sweeps = 12;
constexpr float over_relaxation = 1.6f;
/// Links of more compliance than this times h^2 (w_a + w_b) are stretched because their material is soft.
constexpr float softest = 0.25f;
/// Minimum number of links per thread.
constexpr std::size_t grain = 2048;

float compliance_of(const Link& link) {
  return std::isfinite(link.energy) ? link.length * link.length / link.energy : 0;
}

bool is_attachment(const Projector& projector) {
  return dynamic_cast<const SetProjector<Attachment>*>(&projector) != nullptr;
}

bool removes_overlaps(std::span<Projector* const> projectors) {
  return std::any_of(projectors.begin(), projectors.end(), [](const Projector* projector) {
    return projector->is_collider_contact() && projector->removes_overlaps();
  });
}

}  // namespace

void StretchedLinks::set_counted(std::span<const Link> of_level, const TiedParticles& tied,
                                 const ParticleView& particles) {
  std::vector<float> masses;
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const float w = particles.inverse_mass(i);
    masses.push_back(w > 0 ? 1 / w : 0);
  }
  const std::vector<bool> near = near_isolated_pins(of_level, masses, near_radius);
  counted_.clear();
  for (const Link& link : of_level) {
    const bool counts = !near[link.a] && !near[link.b] && tied.is_alone(link.a) && tied.is_alone(link.b);
    counted_.push_back(counts ? particles.inverse_mass(link.a) + particles.inverse_mass(link.b) : 0);
  }
}

void StretchedLinks::build(std::span<const Link> of_level, const TiedParticles& tied,
                           const ParticleView& particles) {
  const std::size_t count = particles.position.size();
  std::vector<Link> links;
  for (const Link& link : of_level)
    if (tied.is_alone(link.a) && tied.is_alone(link.b)) links.push_back(link);
  std::vector<std::uint32_t> ends;
  for (const Link& link : links) ends.push_back(link.a), ends.push_back(link.b);
  const Coloring colors = color_constraints(ends, 2, count);
  links_.clear(), inverse_mass_.clear(), color_.clear();
  neighbors_begin_.assign(count + 1, 0);
  for (std::uint32_t c = 0; c + 1 < colors.color_begin.size(); ++c) {
    for (std::uint32_t k = colors.color_begin[c]; k < colors.color_begin[c + 1]; ++k) {
      const Link& link = links[colors.order[k]];
      links_.push_back(link), color_.push_back(c);
      inverse_mass_.push_back(particles.inverse_mass(link.a) + particles.inverse_mass(link.b));
      ++neighbors_begin_[link.a + 1], ++neighbors_begin_[link.b + 1];
    }
  }
  for (std::size_t i = 0; i < count; ++i) neighbors_begin_[i + 1] += neighbors_begin_[i];
  neighbors_.resize(2 * links_.size());
  std::vector<std::uint32_t> next(neighbors_begin_.begin(), neighbors_begin_.end() - 1);
  for (std::uint32_t e = 0; e < links_.size(); ++e) {
    neighbors_[next[links_[e].a]++] = {links_[e].b, e};
    neighbors_[next[links_[e].b]++] = {links_[e].a, e};
  }
  set_counted(of_level, tied, particles);
  barred_.assign(count, 0);
  number_.assign(count, Projector::unchosen);
  chosen_links_.assign(colors.color_begin.size() - 1, {});
  for (std::size_t c = 0; c < chosen_links_.size(); ++c)
    chosen_links_[c].reserve(colors.color_begin[c + 1] - colors.color_begin[c]);
  chosen_.reserve(count);
  moving_.reserve(count + 1);
  swept_.reserve(links_.size(), chosen_links_.size());
}

// Returns whether any link is stretched and none is torn.
bool StretchedLinks::find_stretched(std::span<const Link> links, const ParticleView& particles,
                                    Threads& threads) {
  stretched_.resize(links.size());
  const auto between = [](std::span<const Vec4f> of, const Link& link) {
    return detail::load(of[link.a]) - detail::load(of[link.b]);
  };
  const auto difference = [&](const Link& link) {
    const FourFloats x = between(particles.position, link);
    return particles.form == Form::displacement ? x + between(particles.moving, link) : x;
  };
  const auto counts = [this](std::size_t e) { return counted_.empty() || counted_[e] > 0; };
  std::atomic<bool> any = false, torn = false;
  threads.for_each(links.size(), grain, [&](std::size_t begin, std::size_t end) {
    bool any_here = false, torn_here = false;
    for (std::size_t e = begin; e < end; ++e) {
      const Link& link = links[e];
      const FourFloats d = difference(link), squares = d * d;
      const float squared = squares[0] + squares[1] + squares[2], rest = link.length * link.length;
      stretched_[e] = squared > rest * ((1 + threshold) * (1 + threshold)) && counts(e);
      any_here |= stretched_[e] != 0, torn_here |= squared > rest * ((1 + tearing) * (1 + tearing));
    }
    if (any_here) any = true;
    if (torn_here) torn = true;
  });
  return any && !torn;
}

void StretchedLinks::bar(std::span<Projector* const> projectors, const ParticleView& particles) {
  barred_.assign(barred_.size(), 0);
  for (const Projector* projector : projectors)
    if (projector->is_contact() ? !projector->is_collider_contact() : is_attachment(*projector))
      projector->visit(particles, [this](const ConstraintState& contact) {
        for (const std::uint32_t i : contact.particles) barred_[i] = 1;
      });
}

void StretchedLinks::choose(std::uint32_t particle) {
  if (number_[particle] != Projector::unchosen || barred_[particle] != 0) return;
  number_[particle] = static_cast<std::uint32_t>(chosen_.size());
  chosen_.push_back(particle);
}

bool StretchedLinks::choose_particles(std::span<const Link> of_level, float h2) {
  for (const std::uint32_t i : chosen_) number_[i] = Projector::unchosen;
  chosen_.clear();
  for (std::size_t e = 0; e < of_level.size(); ++e)
    if (stretched_[e] != 0 && compliance_of(of_level[e]) < softest * h2 * counted_[e])
      choose(of_level[e].a), choose(of_level[e].b);
  std::size_t next = 0;
  for (int step = 0; step < radius; ++step) {
    for (const std::size_t last = chosen_.size(); next < last; ++next) {
      const std::uint32_t i = chosen_[next];
      for (std::uint32_t k = neighbors_begin_[i]; k < neighbors_begin_[i + 1]; ++k)
        choose(neighbors_[k].particle);
    }
  }
  return !chosen_.empty();
}

void StretchedLinks::gather_links(const ParticleView& particles, float h2, float n) {
  for (auto& links : chosen_links_) links.clear();
  for (const std::uint32_t i : chosen_) {
    for (std::uint32_t k = neighbors_begin_[i]; k < neighbors_begin_[i + 1]; ++k) {
      const auto [j, e] = neighbors_[k];
      if (links_[e].a == i && number_[j] != Projector::unchosen && inverse_mass_[e] > 0)
        chosen_links_[color_[e]].push_back(e);
    }
  }
  swept_.clear();
  for (const auto& links : chosen_links_) {
    for (const std::uint32_t e : links) append(e, particles, h2, n);
    swept_.end_color(static_cast<std::uint32_t>(chosen_.size()));
  }
}

// n sweeps of n times the compliance, each from lambda = 0, as on the levels. Levels and the finest sweep supply the
// stiffness of soft links, so that these sweeps add less the softer the link is.
void StretchedLinks::append(std::uint32_t e, const ParticleView& particles, float h2, float n) {
  const Link& link = links_[e];
  const std::span<const Vec4f> x =
      particles.form == Form::displacement ? particles.position : particles.start;
  const float longest = link.length * (1 + threshold);
  const float now = length(particles.difference(link.a, link.b));
  const float alpha = compliance_of(link), rest = 1 - alpha / (softest * h2 * inverse_mass_[e]);
  if (rest <= 0) return;
  swept_.append(number_[link.a], number_[link.b], x[link.a].xyz() - x[link.b].xyz(), std::fmin(now, longest),
                longest, 1 / (inverse_mass_[e] + n * alpha / (rest * h2)));
}

void StretchedLinks::load(const ParticleView& particles) {
  moving_.resize(chosen_.size() + 1);
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    const std::uint32_t i = chosen_[k];
    const Vec3f d = particles.form == Form::displacement ? particles.moving[i].xyz() : particles.moved(i);
    moving_[k] = {d.x, d.y, d.z, particles.inverse_mass(i)};
  }
  moving_.back() = {0, 0, 0, 0};
}

void StretchedLinks::store(const ParticleView& particles) const {
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    const std::uint32_t i = chosen_[k];
    if (!(moving_[k].w > 0)) continue;
    const Vec3f d = moving_[k].xyz();
    particles.moving[i].set_xyz(particles.form == Form::displacement ? d : particles.start[i].xyz() + d);
  }
}

void StretchedLinks::find_contacts(std::span<Projector* const> projectors) {
  contacts_.resize(projectors.size());
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    contacts_[p].clear();
    // At first enough for a contact of each particle with one collider.
    if (projectors[p]->is_collider_contact() && contacts_[p].capacity() < projectors[p]->size())
      contacts_[p].reserve(std::max(number_.size(), 2 * projectors[p]->size()));
    projectors[p]->find_touching(number_, contacts_[p]);
  }
}

void StretchedLinks::project_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                                      const Substep& substep, bool again) const {
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    if (contacts_[p].empty()) continue;
    Projector& projector = *projectors[p];
    ExternalMoves* const external =
        substep.external != nullptr && substep.external->concerns(projector) ? substep.external : nullptr;
    if (external != nullptr) external->before(particles);
    projector.project_some(contacts_[p], particles, again);
    if (external != nullptr) external->after(particles);
  }
}

void StretchedLinks::sweep(std::span<const Link> links, const TiedParticles& tied,
                           std::span<Projector* const> projectors, const ParticleView& particles,
                           const Substep& substep, Threads& threads) {
  if (substep.mode != Mode::small_steps || removes_overlaps(projectors)) return;
  if (!find_stretched(links, particles, threads)) return;
  if (number_.size() != particles.position.size()) build(links, tied, particles);
  bar(projectors, particles);
  const float h2 = substep.h * substep.h;
  if (!choose_particles(links, h2)) return;
  find_contacts(projectors);
  const bool touches =
      std::any_of(contacts_.begin(), contacts_.end(), [](const auto& contacts) { return !contacts.empty(); });
  const int rounds = touches ? contact_rounds : 1, sweeps = touches ? contact_sweeps : free_sweeps;
  gather_links(particles, h2, static_cast<float>(rounds * sweeps));
  for (int round = 0; round < rounds; ++round) {
    load(particles);
    swept_.sweep(sweeps, over_relaxation, moving_, threads);
    store(particles);
    project_contacts(projectors, particles, substep, round > 0);
  }
}

}  // namespace souple
