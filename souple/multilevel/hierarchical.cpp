#include "souple/multilevel/hierarchical.h"

#include "souple/math/lists.h"
#include "souple/math/sentinels.h"
#include "souple/multilevel/pieces.h"
#include "souple/solver/facets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace souple {
namespace {

/// Particles of the coarsest level, at most: few sweeps solve it.
constexpr std::size_t coarsest_level_size = 24;
/// With Pieces::large, pieces of fewer particles get no levels: at 14 x 14 plain sweeps leave a cotton
/// cloth of 1 m 0.18 % too long.
constexpr std::size_t smallest_piece = 200;
/// Smaller ones that are long get levels: so many links across, and their square so many times the particles. A strip
/// of 17 x 3 has 16 links and 5 times.
constexpr std::size_t shortest_strip = 16, slenderness = 5;
/// Merges the links of each pair of particles into one as strong as all of them together; sorts them.
void merge(std::vector<Link>& links, std::size_t particles) {
  Lists<Link> by_a(particles, [&](const auto& add) {
    for (const Link& link : links) add(link.a, link);
  });
  const auto key = [](const Link& link) { return std::tuple(link.b, link.length, link.energy); };
  std::size_t count = 0;
  for (std::size_t a = 0; a < particles; ++a) {
    std::sort(by_a[a].begin(), by_a[a].end(), [&](const Link& p, const Link& q) { return key(p) < key(q); });
    for (const Link& link : by_a[a]) {
      if (count > 0 && links[count - 1].a == link.a && links[count - 1].b == link.b) {
        links[count - 1].energy += link.energy;
      } else {
        links[count++] = link;
      }
    }
  }
  links.resize(count);
}

/// Tied particles become one; links within them vanish.
void contract(const TiedParticles& tied, std::vector<Link>& links) {
  for (Link& link : links) {
    const std::uint32_t a = tied.representative(link.a), b = tied.representative(link.b);
    link.a = std::min(a, b), link.b = std::max(a, b);
  }
  std::erase_if(links, [](const Link& link) { return link.a == link.b; });
}

/// The particles of the links, ascending.
std::vector<std::uint32_t> linked(std::span<const Link> links, std::size_t particles) {
  std::vector<bool> named(particles);
  for (const Link& link : links) named[link.a] = named[link.b] = true;
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < particles; ++i)
    if (named[i]) result.push_back(i);
  return result;
}

/// Finds how many links lie between the ends of pieces.
class Extents {
 public:
  Extents(std::span<const Link> links, std::size_t particles)
      : neighbors_(particles,
                   [&](const auto& add) {
                     for (const Link& link : links) add(link.a, link.b), add(link.b, link.a);
                   }),
        reached_(particles) {}
  /// Links from the particle farthest from i to that farthest from there.
  std::size_t across(std::uint32_t i) { return farthest(farthest(i).first).second; }

 private:
  std::pair<std::uint32_t, std::size_t> farthest(std::uint32_t from) {
    ++search_;
    std::vector<std::uint32_t> front{from}, next;
    reached_[from] = search_;
    for (std::size_t links = 0;; ++links, std::swap(front, next)) {
      next.clear();
      for (const std::uint32_t i : front)
        for (const std::uint32_t j : neighbors_[i])
          if (std::exchange(reached_[j], search_) != search_) next.push_back(j);
      if (next.empty()) return {front.front(), links};
    }
  }
  Lists<std::uint32_t> neighbors_;  // per particle
  std::vector<std::uint32_t> reached_;
  std::uint32_t search_ = 0;
};

/// Removes the links of pieces that plain sweeps solve well: small ones, unless they are long strips or carry a heavy load.
/// `masses`: per particle.
void remove_small(std::vector<Link>& links, std::span<const float> masses) {
  const std::size_t particles = masses.size();
  LinkedPieces components(links, particles);
  std::vector<std::size_t> count(particles);  // of links, per piece, at its root
  for (const Link& link : links) ++count[components.root(link.a)];
  std::vector<bool> loaded(particles);  // per piece, at its root
  const std::vector<char> classes = classes_of(links, masses);
  for (std::uint32_t i = 0; i < particles; ++i)
    if (classes[i] == heavy_particle) loaded[components.root(i)] = true;
  std::vector<bool> removed(particles);
  std::unique_ptr<Extents> extents;
  for (std::uint32_t i = 0; i < particles; ++i) {
    const std::size_t size = components.size(i);
    if (components.root(i) != i || size >= smallest_piece || loaded[i]) continue;
    removed[i] = true;
    if (size < shortest_strip || count[i] < size) continue;  // ropes are no strips
    if (!extents) extents = std::make_unique<Extents>(links, particles);
    const std::size_t across = extents->across(i);
    removed[i] = across < shortest_strip || across * across < slenderness * size;
  }
  std::erase_if(links, [&](const Link& link) { return removed[components.root(link.a)]; });
}

/// Whether links differ in their stiffness at most.
bool same_shape(std::span<const Link> links, std::span<const Link> others) {
  return std::equal(
      links.begin(), links.end(), others.begin(), others.end(),
      [](const Link& p, const Link& q) { return p.a == q.a && p.b == q.b && p.length == q.length; });
}

}  // namespace

// Whether constraints changed since the last call. Comparing the links themselves takes as long as a frame of a
// large cloth.
bool Hierarchical::constraints_changed(std::span<Projector* const> projectors) {
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions;
  for (Projector* projector : projectors)
    if (const StructureFacet* const set = projector->facets().links)
      revisions.emplace_back(projector, set->revision());
  const bool changed = revisions != revisions_;
  revisions_ = std::move(revisions);
  return changed;
}

bool Hierarchical::any_mass_changed(const ParticleView& particles) {
  const auto same = [](float w, const Vec4f& x) { return w == x.w; };
  if (std::equal(seen_.begin(), seen_.end(), particles.position.begin(), particles.position.end(), same))
    return false;
  seen_.clear();
  for (const Vec4f& x : particles.position) seen_.push_back(x.w);
  return true;
}

bool Hierarchical::masses_changed(const ParticleView& particles) const {
  for (std::size_t i = 0; i < particle_.size(); ++i)
    if (masses_[i] != tied_.mass(particle_[i], particles)) return true;
  return false;
}

std::vector<Link> Hierarchical::links_of(std::span<Projector* const> projectors, const LeftOut& left_out,
                                         const ParticleView& particles) const {
  std::vector<Link> links;
  for (Projector* projector : projectors)
    if (const StructureFacet* const set = projector->facets().links)
      left_out.for_each_kept(*projector, 0, projector->size(), [&](std::size_t begin, std::size_t end) {
        set->append_links(begin, end, links);
      });
  contract(tied_, links);
  merge(links, particles.position.size());
  if (pieces_ == Pieces::large) {
    std::vector<float> masses(particles.position.size());
    for (const Link& link : links)
      for (const std::uint32_t i : {link.a, link.b}) masses[i] = tied_.mass(i, particles);
    remove_small(links, masses);
  }
  return links;
}

// The links of a tower, between its particles.
std::vector<Link> Hierarchical::links_of(const Tower& tower) const {
  const std::span<const std::uint32_t> particles = tower.levels.particles();
  const auto number = [&](std::uint32_t particle) {
    return static_cast<std::uint32_t>(std::lower_bound(particles.begin(), particles.end(), particle) -
                                      particles.begin());
  };
  std::vector<Link> result;
  for (const IndexRange& range : tower.links)
    for (std::size_t e = range.begin; e < range.end; ++e) {
      result.push_back(links_[e]);
      result.back().a = number(links_[e].a), result.back().b = number(links_[e].b);
    }
  return result;
}

std::vector<float> Hierarchical::masses_of(const Tower& tower) const {
  std::vector<float> result;
  for (const IndexRange& range : tower.particles)
    for (std::size_t i = range.begin; i < range.end; ++i) result.push_back(masses_[i]);
  return result;
}

void Hierarchical::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  prepare(projectors, particles, *make_threads(Threading::serial, 1));
}

void Hierarchical::prepare(std::span<Projector* const> projectors, const LeftOut& left_out,
                           const ParticleView& particles, Threads& threads) {
  TiedParticles tied(projectors, particles);
  bool links_changed = tied != tied_, stiffness_changed = false;
  tied_ = std::move(tied);
  // Another mass may make a small piece carry a load.
  const bool relink = any_mass_changed(particles);
  if (constraints_changed(projectors) || links_changed || relink) {
    std::vector<Link> links = links_of(projectors, left_out, particles);
    links_changed = links_changed || !same_shape(links, links_);
    stiffness_changed = links != links_;
    links_ = std::move(links);
    particle_ = linked(links_, particles.position.size());
  }
  if (links_changed || active_.particles() != particles.position.size())
    find_pieces(particles.position.size());
  if (!links_changed && !masses_changed(particles)) {
    if (!stiffness_changed) return;
    for (Tower& tower : towers_) tower.levels.set_links(links_of(tower));
    stretched_.take_stiffness(links_);
    return;
  }
  masses_.clear();
  for (const std::uint32_t i : particle_) masses_.push_back(tied_.mass(i, particles));
  stretched_ = {};
  std::vector<std::uint32_t> number(particles.position.size(), no_index);
  for (std::uint32_t i = 0; i < particle_.size(); ++i) number[particle_[i]] = i;
  std::vector<Link> links = links_;
  for (Link& link : links) link.a = number[link.a], link.b = number[link.b];
  const std::vector<char> before = std::exchange(classes_, classes_of(links, masses_));
  if (links_changed || before != classes_) return build(links, particles, threads);
  for (Tower& tower : towers_) {
    tower.levels.set_links(links_of(tower));
    tower.levels.set_masses(masses_of(tower), tied_, particles);
  }
}

// `links`: ends are linked particles.
void Hierarchical::build(std::span<const Link> links, const ParticleView& particles, Threads& threads) {
  const ActiveScope awake(threads);
  towers_.clear();
  for (JoinedLevels& joined : cache_.build(links, masses_, coarsest_level_size, threads)) {
    FinestLevel finest;
    for (std::size_t b = 0; b < joined.particles.size(); ++b) {
      const IndexRange &own = joined.particles[b], &own_links = joined.links[b];
      const auto offset = static_cast<std::uint32_t>(own.begin - finest.particle.size());
      for (std::size_t i = own.begin; i < own.end; ++i)
        finest.particle.push_back(particle_[i]), finest.mass.push_back(masses_[i]);
      for (std::size_t e = own_links.begin; e < own_links.end; ++e) {
        finest.links.push_back(links[e]);
        finest.links.back().a -= offset, finest.links.back().b -= offset;
      }
    }
    towers_.push_back({{std::move(finest), std::move(joined.levels), tied_, particles},
                       std::move(joined.particles),
                       std::move(joined.links)});
  }
}

void Hierarchical::find_pieces(std::size_t particles) {
  LinkedPieces pieces(links_, particles);
  active_.reset(particles);
  for (const std::uint32_t i : particle_)  // the root is the lowest of its piece
    active_.set(i, pieces.root(i) == i ? active_.add() : active_.of(pieces.root(i)));
  tied_.for_each_tied(
      [this](std::uint32_t i, std::uint32_t representative) { active_.set(i, active_.of(representative)); });
  std::vector<double> length(active_.count()), count(active_.count());
  for (const Link& link : links_) {
    length[active_.of(link.a)] += static_cast<double>(link.length);
    ++count[active_.of(link.a)];
  }
  mean_length_.clear();
  for (std::size_t p = 0; p < length.size(); ++p)
    mean_length_.push_back(static_cast<float>(length[p] / count[p]));
}

std::size_t Hierarchical::coarse_projections() const {
  std::size_t sum = 0;
  for (const Tower& tower : towers_) sum += tower.levels.coarse_projections();
  return sum;
}

void Hierarchical::start_pieces(const ParticleView& particles, const Substep& substep) {
  active_.start_all();
  tied_.for_each_tied([&](std::uint32_t i, std::uint32_t representative) {
    if (active_.of(i) == ActivePieces::none) return;
    const float distance = mean_length_[active_.of(i)];
    if (length_squared(particles.difference(i, representative)) > distance * distance) active_.stop(i);
  });
  for (const IndexRange& range : substep.without_levels)
    for (std::size_t i = range.begin; i < range.end; ++i) active_.stop(static_cast<std::uint32_t>(i));
}

void Hierarchical::sweep_attached(Projector& projector, const ParticleView& particles,
                                  const Substep& substep) const {
  const StructureFacet& set = *projector.facets().attachments;
  std::size_t i = 0;
  for (int color = 0; color < projector.color_count(); ++color)
    for (std::size_t k = 0; k < projector.color_size(color); ++k)
      if (active_.acts(set.pull(i++).particle[0])) projector.project(color, k, k + 1, particles, substep);
}

// Levels take attached particles for fixed: they move first.
bool Hierarchical::begin_substep(std::span<Projector* const> projectors, const ParticleView& particles,
                                 const Substep& substep) {
  if (towers_.empty()) return false;
  start_pieces(particles, substep);
  for (Projector* projector : projectors)
    if (tied_.has_attached() && projector->facets().attachments != nullptr)
      sweep_attached(*projector, particles, substep);
  return active_.any();
}

void Hierarchical::correct(const ParticleView& particles, const Substep& substep, int iteration,
                           Threads& threads) {
  for (Tower& tower : towers_) tower.levels.correct(active_, particles, substep, iteration, threads);
}

void Hierarchical::shorten_stretched(std::span<Projector* const> projectors, const ParticleView& particles,
                                     const Substep& substep, Threads& threads) {
  stretched_.sweep(links_, tied_, active_, projectors, particles, substep, threads);
}

void Hierarchical::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads) {
  const bool with_levels = begin_substep(projectors, particles, substep);
  Substep swept = substep;
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (with_levels) correct(particles, substep, iteration, threads);
    swept.sweep = substep.first_sweep() + iteration;
    for (Projector* projector : projectors) sweep(*projector, particles, swept, threads);
    if (with_levels) shorten_stretched(projectors, particles, substep, threads);
  }
}

std::string Hierarchical::diagnostic() const {
  if (!links_.empty()) return {};
  return "the hierarchical solver found no distances or membranes to build levels from: it is Gauss-Seidel";
}

}  // namespace souple
