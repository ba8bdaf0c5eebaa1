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
/// Sweeps per level. The last is plain, those before it are over-relaxed. One sweep from lambda = 0 leaves a smooth
/// stretch (1/omega - 1/2) h^2 (w_a + w_b) lambda per link (docs/notes/solvers.md). With omega = 1.6 a quarter of the
/// stretch with omega = 1 remains. A third sweep gains little and makes a flag's worst link worse.
constexpr int level_sweeps = 2, coarsest_sweeps = 4;
/// Additional sweeps of the links around isolated pinned particles, and how many links away they reach.
constexpr int near_sweeps = 12, near_radius = 6;
/// Levels of fewer particles get none around pinned ones: six links reach across them.
constexpr std::size_t smallest_near_level = 64;
/// One sweep of the finest links leaves a stretch of this times h^2 (w_a + w_b) lambda (SetProjector::find_shared).
constexpr float finest_share = 0.55f;
/// With Pieces::large, pieces of fewer particles get no levels: at 14 x 14 plain sweeps leave a cotton
/// cloth of 1 m 0.18 % too long.
constexpr std::size_t smallest_piece = 200;
/// Smaller ones that are long get levels: so many links across, and their square so many times the particles. A strip
/// of 17 x 3 has 16 links and 5 times.
constexpr std::size_t shortest_strip = 16, slenderness = 5;
/// Minimum number of coarse particles per thread.
constexpr std::size_t sweep_grain = 256;

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

float inverse(float mass) {
  return mass > 0 ? 1 / mass : 0;
}

/// Stiffness that the n sweeps of a level supply to a smooth stretch. Each starts from lambda = 0, with a compliance n
/// alpha. It acts like springs of compliance n alpha / omega + (1/omega - 1/2) h^2 w beside those of the other sweeps
/// (docs/notes/solvers.md). w: sum of the inverse masses of a link.
float supplied(float alpha, float h2_w) {
  const float each = alpha * float{level_sweeps}, omega = over_relaxation;
  return (level_sweeps - 1) / (each / omega + (1 / omega - 0.5f) * h2_w) + 1 / (each + 0.5f * h2_w);
}

/// Stiffness of `iterations` sweeps of the finest constraints. One alone subtracts its share (projection.h).
float supplied_finest(float alpha, float h2_w, int iterations) {
  if (iterations == 1) return 1 / std::fmax(alpha, finest_share * h2_w);
  return 1 / (alpha + finest_share * h2_w / static_cast<float>(iterations));
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

// Updates the data of levels that depends on the stiffness of the finest links alone. The rest depends on their shape
// and the masses.
void Hierarchical::take_stiffness() {
  std::span<const Link> finer = links_;
  for (Level& level : levels_) {
    take_energies(finer, level.map);
    finer = level.map.links;
  }
  compliant_ =
      std::any_of(links_.begin(), links_.end(), [](const Link& link) { return std::isfinite(link.energy); });
  stretched_.take_stiffness(links_);
  gains_for_ = {};
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
  if (!links_changed && !masses_changed(particles)) {
    if (stiffness_changed) take_stiffness();
    return;
  }
  masses_.clear();
  for (const std::uint32_t i : particle_) masses_.push_back(tied_.mass(i, particles));
  compliant_ =
      std::any_of(links_.begin(), links_.end(), [](const Link& link) { return std::isfinite(link.energy); });
  inverse_masses_.clear();
  for (const Link& link : links_)
    inverse_masses_.push_back(inverse(tied_.mass(link.a, particles)) +
                              inverse(tied_.mass(link.b, particles)));
  stretched_ = {};
  gains_for_ = {};
  std::vector<std::uint32_t> number(particles.position.size(), no_index);
  for (std::uint32_t i = 0; i < particle_.size(); ++i) number[particle_[i]] = i;
  std::vector<Link> links = links_;
  for (Link& link : links) link.a = number[link.a], link.b = number[link.b];
  const std::vector<char> before = std::exchange(classes_, classes_of(links, masses_));
  if (!links_changed && before == classes_) return update_masses(particles);
  build(links, particles, threads);
}

void Hierarchical::build(std::span<const Link> links, const ParticleView& particles, Threads& threads) {
  const ActiveScope awake(threads);
  levels_.clear();
  for (CoarseLevel& level : cache_.build(links, masses_, coarsest_level_size, threads))
    add_level(std::move(level), particles);
  double length = 0;
  for (const Link& link : links_) length += static_cast<double>(link.length);
  mean_length_ = static_cast<float>(length / static_cast<double>(std::max<std::size_t>(links_.size(), 1)));
}

// Updates the data of levels that depends on the masses and the stiffness of the finest particles and links.
void Hierarchical::update_masses(const ParticleView& particles) {
  std::span<const float> finer = masses_;
  std::span<const Link> links = links_;
  for (Level& level : levels_) {
    take_masses(finer, level.map), take_energies(links, level.map);
    for (std::size_t j = 0; j < level.map.mass.size(); ++j)
      level.position[j].w = level.moving[j].w = level.before[j].w = inverse(level.map.mass[j]);
    find_restriction(level, &level == levels_.data(), particles);
    finer = level.map.mass, links = level.map.links;
  }
}

void Hierarchical::add_level(CoarseLevel map, const ParticleView& particles) {
  const std::span<const std::uint32_t> finer = levels_.empty() ? particle_ : levels_.back().particle;
  Level level;
  for (const std::uint32_t i : map.finer) level.particle.push_back(finer[i]);
  for (const float mass : map.mass) {
    level.position.push_back({0, 0, 0, inverse(mass)});
    level.moving.push_back({0, 0, 0, inverse(mass)});
  }
  level.position.emplace_back(), level.moving.emplace_back();
  level.correction = level.before = level.moving;
  level.softening.resize(map.links.size());
  std::vector<std::uint32_t> links(map.links.size());
  std::iota(links.begin(), links.end(), 0u);
  level.all = LevelLinks(map, links);
  level.map = std::move(map);
  find_prolongation(level, levels_.empty(), particles);
  find_restriction(level, levels_.empty(), particles);
  find_slots(level);
  add_links_near_pins(level);
  levels_.push_back(std::move(level));
}

// Those of the first level act on every particle of the world that is tied to a linked one.
void Hierarchical::find_prolongation(Level& level, bool first, const ParticleView& particles) const {
  const CoarseLevel& map = level.map;
  for (std::uint32_t i = 0; i + 1 < map.parent_begin.size(); ++i)
    for_each_tied(i, first, particles, [&](std::uint32_t finer, float) {
      level.finer.push_back(finer);
      for (std::uint32_t k = map.parent_begin[i]; k < map.parent_begin[i + 1]; ++k)
        level.prolongation.add(map.parent[k], map.weight[k]);
      level.prolongation.end_row();
    });
}

void Hierarchical::find_restriction(Level& level, bool first, const ParticleView& particles) const {
  const CoarseLevel& map = level.map;
  level.restriction = {};
  for (std::size_t j = 0; j < map.mass.size(); ++j) {
    for (std::uint32_t k = map.child_begin[j]; k < map.child_begin[j + 1]; ++k)
      for_each_tied(map.child[k], first, particles, [&](std::uint32_t finer, float part) {
        if (part > 0) level.restriction.add(finer, map.child_weight[k] * part);
      });
    level.restriction.end_row();
  }
}

// Fills the arrays per slot. Padding measures the distance of a particle from itself.
void Hierarchical::find_slots(Level& level) const {
  const Level* const finer = levels_.empty() ? nullptr : &levels_.back();
  const std::vector<std::uint32_t> finer_slot =
      finer ? finer->all.slot_of_link() : std::vector<std::uint32_t>{};
  const CoarseLevel& map = level.map;
  level.path_begin.push_back(0);
  for (std::size_t s = 0; s < level.all.slots(); ++s) {
    const std::uint32_t e = level.all.link(s);
    const bool padding = e == LevelLinks::none;
    const Link link = padding ? Link{.length = 1} : map.links[e];
    float path_length = 0;
    for (std::uint32_t k = padding ? 0 : map.path_begin[e]; finer && !padding && k < map.path_begin[e + 1];
         ++k) {
      level.path.push_back(finer_slot[map.path[k]]);
      path_length += finer->map.links[map.path[k]].length;
    }
    level.start_a.push_back(4 * level.particle[link.a]), level.start_b.push_back(4 * level.particle[link.b]);
    level.rest_length.push_back(link.length);
    level.path_length.push_back(path_length);
    level.path_begin.push_back(static_cast<std::uint32_t>(level.path.size()));
  }
  level.stretch.resize(level.all.slots());
}

namespace {

/// Whether a particle is near an isolated pinned or an isolated heavy one.
std::vector<bool> near_isolated(const CoarseLevel& map, int radius) {
  std::vector<bool> near(map.mass.size());
  if (near.size() >= smallest_near_level) near = near_isolated_pins(map.links, map.mass, radius);
  const std::vector<char> classes = classes_of(map.links, map.mass);
  if (std::find(classes.begin(), classes.end(), heavy_particle) == classes.end()) return near;
  std::vector<float> as_pinned;
  as_pinned.reserve(classes.size());
  for (const char c : classes) as_pinned.push_back(c == heavy_particle ? 0.0f : 1.0f);
  const std::vector<bool> near_heavy = near_isolated_pins(map.links, as_pinned, radius);
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = near[i] || near_heavy[i];
  return near;
}

}  // namespace

void Hierarchical::add_links_near_pins(Level& level) {
  const CoarseLevel& map = level.map;
  const std::vector<bool> near = near_isolated(map, near_radius);
  std::vector<std::uint32_t> links;
  for (std::uint32_t e = 0; e < map.links.size(); ++e) {
    const Link& link = map.links[e];
    if (near[link.a] && near[link.b] && map.mass[link.a] + map.mass[link.b] > 0) links.push_back(e);
  }
  level.near = LevelLinks(map, links);
  const std::vector<std::uint32_t> slot = level.all.slot_of_link();
  for (std::size_t s = 0; s < level.near.slots(); ++s)
    level.near_slot.push_back(level.near.link(s) != LevelLinks::none ? slot[level.near.link(s)]
                                                                     : LevelLinks::none);
}

int Hierarchical::sweeps_of(std::size_t l) const {
  return l + 1 == levels_.size() ? coarsest_sweeps : level_sweeps;
}

std::size_t Hierarchical::coarse_projections() const {
  std::size_t sum = 0;
  for (std::size_t l = 0; l < levels_.size(); ++l)
    sum += static_cast<std::size_t>(sweeps_of(l)) * levels_[l].all.swept();
  return sum;
}

// Stretch of the paths and limits of the coarse links, at the start of the substep. Links of the first coarse level
// need no path. Their lengths are those of paths across triangles of finer links, so no state that satisfies the finer
// links is longer.
void Hierarchical::measure(const ParticleView& particles, Threads& threads) {
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    if (l > 0) measure_paths(l, threads);
    level.all.measure({.position = &level.position.data()->x,
                       .moving = &level.moving.data()->x,
                       .start = &particles.position.data()->x,
                       .start_a = level.start_a.data(),
                       .start_b = level.start_b.data(),
                       .rest_length = level.rest_length.data(),
                       .path_length = l > 0 ? level.path_length.data() : nullptr,
                       .stretch = level.stretch.data()},
                      threads);
    level.near.copy_limits(level.all, level.near_slot);
  }
}

void Hierarchical::measure_paths(std::size_t l, Threads& threads) {
  Level& level = levels_[l];
  const std::span<const float> finer = levels_[l - 1].stretch;
  threads.each(level.stretch.size(), sweep_grain, [&](std::size_t s) {
    float stretch = 0;
    for (std::uint32_t k = level.path_begin[s]; k < level.path_begin[s + 1]; ++k)
      stretch += finer[level.path[k]];
    level.stretch[s] = stretch;
  });
}

// The sweeps of a level do not supply all of its stiffness 1/alpha; the next coarser level supplies the rest:
//
//   1/alpha' = 1/alpha - k
//
// So each level's compliance is the material's times a factor, its softening, which grows towards coarser
// levels. Rigid stays rigid. Without softening each level supplies all of the stiffness, and a soft cloth
// hangs five times too stiff (measured).
//
// n sweeps of n times the compliance, each from lambda = 0, are as compliant to a smooth stretch as one, and no
// multipliers are stored. In PBD mode a link's k' takes the place of its compliance:
//
//   g = 1 / (w_J + w_K + n alpha'/h^2),   PBD: g = k' / (w_J + w_K)
void Hierarchical::set_gains(const Substep& substep) {
  const auto key = [](const Substep& of) { return std::tuple(of.h, of.iterations, of.mode); };
  if (key(gains_for_) == key(substep)) return;
  gains_for_ = substep;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    for (std::size_t e = 0; compliant_ && e < level.map.links.size(); ++e)
      level.softening[e] = softening_of(l, e);
    set_gains_of(level, level.all, sweeps_of(l)), set_gains_of(level, level.near, near_sweeps);
  }
}

void Hierarchical::set_gains_of(const Level& level, LevelLinks& links, int n) const {
  const float h = gains_for_.h;
  for (std::size_t s = 0; s < links.slots(); ++s) {
    const std::uint32_t e = links.link(s);
    if (e == LevelLinks::none) continue;
    const Link& link = level.map.links[e];
    const float w = level.position[link.a].w + level.position[link.b].w;
    const float alpha = compliant_ ? link.compliance() * level.softening[e] : 0;
    const float gain = gains_for_.mode == Mode::pbd
                           ? stiffness_per_iteration(link.stiffness, gains_for_.iterations) / w
                           : 1 / (w + static_cast<float>(n) * alpha / (h * h));
    links.set_gain(s, w > 0 ? gain : 0);
  }
}

// Mean softening that the finer links of the path leave to this link.
float Hierarchical::softening_of(std::size_t l, std::size_t e) const {
  const CoarseLevel& map = levels_[l].map;
  float sum = 0;
  for (std::uint32_t k = map.path_begin[e]; k < map.path_begin[e + 1]; ++k) {
    const std::uint32_t step = map.path[k];
    const Level* const finer = l > 0 ? &levels_[l - 1] : nullptr;
    const Link& link = finer ? finer->map.links[step] : links_[step];
    const float factor = finer ? finer->softening[step] : 1;
    const float w = finer ? finer->position[link.a].w + finer->position[link.b].w : inverse_masses_[step];
    const float alpha = factor * link.compliance(), h2_w = gains_for_.h * gains_for_.h * w;
    const float stiffness =
        finer ? supplied(alpha, h2_w) : supplied_finest(alpha, h2_w, gains_for_.iterations);
    sum += h2_w > 0 ? factor / std::fmax(1 - alpha * stiffness, 1e-6f) : factor;
  }
  return sum / static_cast<float>(map.path_begin[e + 1] - map.path_begin[e]);
}

void Hierarchical::restrict_particles(const ParticleView& particles, Threads& threads) {
  std::span<const Vec4f> position = particles.position, moving = particles.moving;
  for (Level& level : levels_) {
    threads.for_each(level.restriction.rows(), sweep_grain, [&](std::size_t begin, std::size_t end) {
      level.restriction.assign(begin, end, position, moving, level.position, level.moving);
      std::copy(level.moving.begin() + static_cast<std::ptrdiff_t>(begin),
                level.moving.begin() + static_cast<std::ptrdiff_t>(end),
                level.before.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    position = level.position, moving = level.moving;
  }
}

void Hierarchical::prolong(const Level& from, std::span<const Vec4f> inverse_mass, std::span<Vec4f> to,
                           Threads& threads) {
  threads.for_each(from.prolongation.rows(), 4 * sweep_grain, [&](std::size_t begin, std::size_t end) {
    from.prolongation.add_to(begin, end, from.correction, from.finer, inverse_mass, to);
  });
}

// From the coarsest level to the particles.
void Hierarchical::project_levels(const ParticleView& particles, Threads& threads) {
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    if (l + 1 < levels_.size()) prolong(levels_[l + 1], level.position, level.moving, threads);
    level.near.sweep(near_sweeps, over_relaxation, level.moving, threads);
    level.all.sweep(sweeps_of(l), over_relaxation, level.moving, threads);
    threads.each(level.moving.size(), 4 * sweep_grain, [&](std::size_t i) {
      // whole records: w becomes 0
      level.correction[i] = {level.moving[i].x - level.before[i].x, level.moving[i].y - level.before[i].y,
                             level.moving[i].z - level.before[i].z, 0};
    });
  }
  prolong(levels_.front(), particles.position, particles.moving, threads);
}

// Levels take attached particles for fixed: they move first.
bool Hierarchical::begin_substep(std::span<Projector* const> projectors, const ParticleView& particles,
                                 const Substep& substep, Threads& threads) {
  if (levels_.empty() || !tied_.closed(mean_length_, particles)) return false;
  for (Projector* projector : projectors)
    if (tied_.has_attached() && projector->facets().attachments != nullptr)
      sweep(*projector, particles, substep, threads);
  return true;
}

void Hierarchical::correct(const ParticleView& particles, const Substep& substep, int iteration,
                           Threads& threads) {
  restrict_particles(particles, threads);
  if (iteration == 0) measure(particles, threads), set_gains(substep);
  project_levels(particles, threads);
}

void Hierarchical::shorten_stretched(std::span<Projector* const> projectors, const ParticleView& particles,
                                     const Substep& substep, Threads& threads) {
  stretched_.sweep(links_, tied_, projectors, particles, substep, threads);
}

void Hierarchical::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads) {
  const bool with_levels = begin_substep(projectors, particles, substep, threads);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (with_levels) correct(particles, substep, iteration, threads);
    for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
    if (with_levels) shorten_stretched(projectors, particles, substep, threads);
  }
}

std::string Hierarchical::diagnostic() const {
  if (!links_.empty()) return {};
  return "the hierarchical solver found no distances or membranes to build levels from: it is Gauss-Seidel";
}

}  // namespace souple
