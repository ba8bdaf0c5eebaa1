#include "souple/multilevel/stretched_links.h"

#include "souple/multilevel/level_links.h"
#include "souple/solver/coloring.h"
#include "souple/solver/external_moves.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace souple {
namespace {

/// A link is stretched above this strain. Links around it are shortened to it. With 0.01, cloth that touches nothing costs
/// more and is stiffer than its material; with 0.02, it is stretched more where it touches colliders.
constexpr float threshold = 0.015f;
/// A link is torn above this strain.
constexpr float tearing = 1;
/// Links of more compliance than this times h^2 (w_a + w_b) are stretched because their material is soft.
constexpr float softest = 0.25f;
/// Minimum number of links per thread.
constexpr std::size_t stretch_grain = 2048;
/// Links that kernels take at once, the stretch_lanes of the widest register, and bits of a word.
constexpr std::size_t stretch_lanes = 16, word = 64;

/// Null if the projector's constraints are no contacts with colliders.
ContactFacet* collider_contacts(Projector& projector) {
  ContactFacet* const contact = projector.facets().contact;
  return contact != nullptr && contact->is_collider_contact() ? contact : nullptr;
}

/// Lets colliders take the contacts of chosen particles. Lists these.
void take_contacts(std::span<Projector* const> projectors, std::span<const std::uint32_t> chosen,
                   std::vector<std::uint32_t>& taken) {
  taken.clear();
  for (Projector* projector : projectors)
    if (ContactFacet* const contact = projector->facets().contact) contact->take_some(chosen, taken);
}

void project_contacts(std::span<Projector* const> projectors, const ParticleView& particles,
                      const Substep& substep, bool again) {
  for (Projector* projector : projectors) {
    ContactFacet* const contact = collider_contacts(*projector);
    if (contact == nullptr) continue;
    ExternalMoves* const external =
        substep.external != nullptr && substep.external->concerns(*projector) ? substep.external : nullptr;
    if (external != nullptr) external->before(particles);
    contact->project_some(particles, again);
    if (external != nullptr) external->after(particles);
  }
}

/// Calls f with the numbers of the bits that are set in [begin, end), ascending.
template <class Function>
void for_each_bit(std::span<const std::uint64_t> words, std::size_t begin, std::size_t end,
                  const Function& f) {
  for (std::size_t k = begin / word; k * word < end; ++k) {
    std::uint64_t bits = words[k];
    if (k * word < begin) bits &= ~std::uint64_t{0} << (begin % word);
    if ((k + 1) * word > end) bits &= (std::uint64_t{1} << (end % word)) - 1;
    for (; bits != 0; bits &= bits - 1) f(k * word + static_cast<std::size_t>(std::countr_zero(bits)));
  }
}

/// Calls f with the numbers of the bits that are set in the first blocks, ascending.
template <class Function>
void for_each_bit(std::span<const std::uint16_t> blocks, std::size_t count, const Function& f) {
  for (std::size_t k = 0; k < count; ++k)
    for (unsigned bits = blocks[k]; bits != 0; bits &= bits - 1)
      f(stretch_lanes * k + static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace

// Where contacts act, rounds count more than sweeps: 8 rounds leave a box's corners stretched by 19 % at impact, 12 by 15 %.
// Where none acts, a link may become as short as at rest. Kept at the length that stretched links are shortened to,
// sweeps hold it there. A cloth with no link stretched by more than 1.5 % without them is then stretched by 3.5 % in
// lines along its pins. On colliders this limit lets coarse cloth enter a cylinder by 10 mm instead of 8 at impact. 12
// sweeps leave cotton stretched by 8.5 % in gusts of 30 m/s (converged 12), 8 by 10 %.
const StretchedLinks::Rounds StretchedLinks::with_contacts{12, 2, 2, 1},
    StretchedLinks::without_contacts{1, 12, 1, 1 / (1 + threshold)};

void StretchedLinks::Region::resize(std::size_t slots) {
  a.resize(slots), b.resize(slots);
  for (auto* column : {&longest, &compliance, &inverse_mass, &x, &y, &z, &min_length, &max_length, &gain})
    column->resize(slots);
}

void StretchedLinks::Region::set(std::size_t slot, const Swept& link) {
  a[slot] = link.a, b[slot] = link.b;
  longest[slot] = link.longest, compliance[slot] = link.compliance, inverse_mass[slot] = link.inverse_mass;
}

kernels::LinkArrays StretchedLinks::Region::arrays() {
  return {a.data(), b.data(),          x.data(),          y.data(),
          z.data(), min_length.data(), max_length.data(), gain.data()};
}

// Padding is as long as nothing.
void StretchedLinks::prepare_search(std::span<const Link> of_level) {
  const std::size_t slots = (of_level.size() + stretch_lanes - 1) / stretch_lanes * stretch_lanes;
  search_a_.assign(slots, 0), search_b_.assign(slots, 0), search_longest_.assign(slots, 1);
  for (std::size_t e = 0; e < of_level.size(); ++e) {
    search_a_[e] = 4 * of_level[e].a, search_b_[e] = 4 * of_level[e].b;
    search_longest_[e] = of_level[e].length * (1 + threshold);
  }
  stretched_.assign(slots / stretch_lanes, 0);
  found_.reserve(of_level.size());
}

void StretchedLinks::take_stiffness(std::span<const Link> of_level) {
  for (Swept& swept : links_) swept.compliance = of_level[swept.link].compliance();
}

void StretchedLinks::build(std::span<const Link> of_level, const TiedParticles& tied,
                           const ParticleView& particles) {
  const std::size_t count = particles.position.size();
  std::vector<std::uint32_t> counted, ends;
  counted_.clear();
  for (std::uint32_t e = 0; e < of_level.size(); ++e) {
    const Link& link = of_level[e];
    const bool counts = tied.is_alone(link.a) && tied.is_alone(link.b);
    counted_.push_back(counts ? particles.inverse_mass(link.a) + particles.inverse_mass(link.b) : 0);
    if (counted_.back() > 0) counted.push_back(e), ends.push_back(link.a), ends.push_back(link.b);
  }
  const Coloring colors = color_constraints(ends, 2, count);
  color_begin_.assign(colors.color_begin.begin(), colors.color_begin.end());
  links_.clear();
  for (const std::uint32_t e : colors.order) {
    const Link& link = of_level[counted[e]];
    links_.push_back({4 * link.a, 4 * link.b, link.length * (1 + threshold), link.compliance(),
                      particles.inverse_mass(link.a) + particles.inverse_mass(link.b), counted[e]});
  }
  neighbors_.fill(count, [&](const auto& add) {
    for (std::uint32_t e = 0; e < links_.size(); ++e) {
      const std::uint32_t i = links_[e].a / 4, j = links_[e].b / 4;
      add(i, {j, e}), add(j, {i, e});
    }
  });
  barred_.assign(count, 0);
  number_.assign(count, ContactFacet::unchosen);
  chosen_.reserve(count);
  position_.assign(count + 1, {}), moving_.assign(count + 1, {});
  marked_.assign(links_.size() / word + 1, 0);
  region_.resize(links_.size() + stretch_lanes * color_begin_.size());
  region_.color_begin.reserve(color_begin_.size() + 1);
}

void StretchedLinks::stop_overlapping(std::span<Projector* const> projectors) {
  for (Projector* projector : projectors)
    if (const ContactFacet* const contact = collider_contacts(*projector))
      contact->visit_overlaps([this](std::uint32_t particle) { pieces_.stop(particle); });
}

void StretchedLinks::leave_out_stopped(std::span<const Link> of_level) {
  std::erase_if(found_, [&](std::uint32_t e) { return !pieces_.acts(of_level[e].a); });
}

// Fills found_ with the stretched links of pieces that are swept. Returns whether there are any.
bool StretchedLinks::find_stretched(std::span<const Link> of_level, const ParticleView& particles,
                                    Threads& threads) {
  const kernels::ParticleLinks links{search_a_.data(), search_b_.data(), search_longest_.data()};
  const float* const position = &particles.position.data()->x;
  const float* const moving = &particles.moving.data()->x;
  threads.for_each(stretched_.size(), stretch_grain / stretch_lanes, [&](std::size_t begin, std::size_t end) {
    link_kernels().find_stretched(links, position, moving, stretched_.data(), begin, end);
  });
  found_.clear();
  for_each_bit(stretched_, stretched_.size(),
               [&](std::size_t e) { found_.push_back(static_cast<std::uint32_t>(e)); });
  leave_out_stopped(of_level);
  for (const std::uint32_t e : found_)
    if (is_torn(of_level[e], particles)) pieces_.stop(of_level[e].a);
  leave_out_stopped(of_level);
  return !found_.empty();
}

bool StretchedLinks::is_torn(const Link& link, const ParticleView& particles) const {
  return length_squared(particles.difference(link.a, link.b)) >
         link.length * link.length * ((1 + tearing) * (1 + tearing));
}

void StretchedLinks::bar(std::span<Projector* const> projectors, const ParticleView& particles) {
  barred_.assign(barred_.size(), 0);
  for (Projector* projector : projectors)
    if (const Facets facets = projector->facets();
        facets.contact != nullptr ? !facets.contact->is_collider_contact() : facets.attachments != nullptr)
      projector->visit(particles, [this](const ConstraintState& contact) {
        for (const std::uint32_t i : contact.particles) barred_[i] = 1;
      });
}

void StretchedLinks::choose(std::uint32_t particle) {
  if (number_[particle] != ContactFacet::unchosen || barred_[particle] != 0) return;
  number_[particle] = static_cast<std::uint32_t>(chosen_.size());
  chosen_.push_back(particle);
}

template <class Chooses>
bool StretchedLinks::choose_particles(std::span<const Link> of_level, float h2, int radius,
                                      const Chooses& chooses) {
  for (const std::uint32_t i : chosen_) number_[i] = ContactFacet::unchosen;
  chosen_.clear();
  for (const std::uint32_t e : found_)
    if (chooses(of_level[e]) && of_level[e].compliance() < softest * h2 * counted_[e])
      choose(of_level[e].a), choose(of_level[e].b);
  std::size_t next = 0;
  for (int step = 0; step < radius; ++step) {
    for (const std::size_t last = chosen_.size(); next < last; ++next) {
      const std::uint32_t i = chosen_[next];
      for (const Neighbor& neighbor : neighbors_[i]) choose(neighbor.particle);
    }
  }
  return !chosen_.empty();
}

void StretchedLinks::mark_links() {
  std::fill(marked_.begin(), marked_.end(), 0);
  for (const std::uint32_t i : chosen_) {
    for (const auto& [j, e] : neighbors_[i]) {
      if (j > i && number_[j] != ContactFacet::unchosen) marked_[e / word] |= std::uint64_t{1} << (e % word);
    }
  }
}

// Those between chosen particles. Padding links the fixed particle to itself.
void StretchedLinks::gather_links() {
  mark_links();
  const auto fixed = static_cast<std::uint32_t>(4 * number_.size());
  const Swept padding{fixed, fixed, 0, 0, 1, 0};
  std::size_t slot = 0;
  region_.color_begin.assign(1, 0);
  for (std::size_t c = 0; c + 1 < color_begin_.size(); ++c) {
    for_each_bit(marked_, color_begin_[c], color_begin_[c + 1],
                 [&](std::size_t e) { region_.set(slot++, links_[e]); });
    if (slot == region_.size()) continue;
    while (slot % stretch_lanes != 0) region_.set(slot++, padding);
    region_.color_begin.push_back(slot);
  }
}

// n sweeps of n times the compliance, each from lambda = 0, as on the levels.
void StretchedLinks::measure_links(const Rounds& rounds, float h, Threads& threads) {
  const float h2 = h * h, n = static_cast<float>(rounds.count * rounds.sweeps);
  const kernels::StretchedMeasures from{region_.longest.data(),
                                        region_.compliance.data(),
                                        region_.inverse_mass.data(),
                                        rounds.shortest_part,
                                        softest * h2,
                                        n / h2};
  threads.for_each(
      region_.size() / stretch_lanes, stretch_grain / stretch_lanes, [&](std::size_t begin, std::size_t end) {
        link_kernels().measure_stretched(region_.arrays(), from, &position_.data()->x, &moving_.data()->x,
                                         region_.gain.data(), begin * stretch_lanes, end * stretch_lanes);
      });
}

// Returns the particles with moving_ in place of what the solver modifies. `all`: of all particles, not of the chosen
// alone.
ParticleView StretchedLinks::load(const ParticleView& particles, bool all) {
  const auto load = [&](std::size_t i) {
    const Vec3f d = particles.moving[i].xyz();
    position_[i] = particles.position[i];
    moving_[i] = {d.x, d.y, d.z, particles.inverse_mass(i)};
  };
  for (std::size_t i = 0; all && i < number_.size(); ++i) load(i);
  for (const std::uint32_t i : chosen_) load(i);
  ParticleView result = particles;
  result.moving = std::span(moving_).first(number_.size());
  return result;
}

void StretchedLinks::store(const ParticleView& particles) const {
  for (const std::uint32_t i : chosen_)
    if (moving_[i].w > 0) particles.moving[i].set_xyz(moving_[i].xyz());
}

void StretchedLinks::sweep_pieces(std::span<const Link> of_level, bool touching,
                                  std::span<Projector* const> projectors, const ParticleView& particles,
                                  const Substep& substep, Threads& threads) {
  const Rounds& rounds = touching ? with_contacts : without_contacts;
  const auto chooses = [&](const Link& link) { return (touches_[pieces_.of(link.a)] != 0) == touching; };
  if (!choose_particles(of_level, substep.h * substep.h, rounds.radius, chooses)) return;
  gather_links();
  const ParticleView view = load(particles, substep.external != nullptr);
  measure_links(rounds, substep.h, threads);
  for (int round = 0; round < rounds.count; ++round) {
    sweep_colors(region_.arrays(), region_.color_begin, rounds.sweeps, over_relaxation, moving_, threads);
    if (touching) project_contacts(projectors, view, substep, round > 0);
  }
  store(particles);
}

void StretchedLinks::sweep(std::span<const Link> of_level, const TiedParticles& tied,
                           const ActivePieces& pieces, std::span<Projector* const> projectors,
                           const ParticleView& particles, const Substep& substep, Threads& threads) {
  if (substep.mode != Mode::small_steps) return;
  // At once, not when the first link is stretched: that may be late, and warm steps allocate nothing.
  if (number_.size() != particles.position.size()) prepare_search(of_level), build(of_level, tied, particles);
  pieces_ = pieces;
  stop_overlapping(projectors);
  if (!find_stretched(of_level, particles, threads)) return;
  bar(projectors, particles);
  const auto all = [](const Link&) { return true; };
  if (!choose_particles(of_level, substep.h * substep.h, with_contacts.radius, all)) return;
  take_contacts(projectors, number_, touched_);
  touches_.assign(pieces_.count(), 0);
  for (const std::uint32_t i : touched_) touches_[pieces_.of(i)] = 1;
  for (const bool touching : {true, false})
    sweep_pieces(of_level, touching, projectors, particles, substep, threads);
  for (Projector* projector : projectors)
    if (ContactFacet* const contact = projector->facets().contact) contact->put_back_some();
}

}  // namespace souple
