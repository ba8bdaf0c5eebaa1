#include "souple/multilevel/level_tower.h"

#include "souple/assert.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace souple {
namespace {

/// Sweeps per level. The last is plain, those before it are over-relaxed. One sweep from lambda = 0 leaves a smooth
/// stretch (1/omega - 1/2) h^2 (w_a + w_b) lambda per link (docs/notes/solvers.md). With omega = 1.6 a quarter of the
/// stretch with omega = 1 remains. A third sweep gains little and makes a flag's worst link worse.
constexpr int level_sweeps = 2, coarsest_sweeps = 4;
/// Additional sweeps of the links around isolated pinned particles, and how many links away they reach.
constexpr int near_sweeps = 12, near_radius = 6;
/// Pieces of fewer particles get none around pinned ones: six links reach across them.
constexpr std::size_t smallest_near_piece = 64;
/// One sweep of the finest links leaves a stretch of this times h^2 (w_a + w_b) lambda (SetProjector::find_shared).
constexpr float finest_share = 0.55f;
/// Minimum number of coarse particles per thread.
constexpr std::size_t sweep_grain = 256;

float inverse(float mass) {
  return mass > 0 ? 1 / mass : 0;
}

bool is_compliant(std::span<const Link> links) {
  return std::any_of(links.begin(), links.end(), [](const Link& link) { return std::isfinite(link.energy); });
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

LevelTower::LevelTower(FinestLevel finest, std::vector<CoarseLevel> levels, const TiedParticles& tied,
                       const ParticleView& particles)
    : finest_(std::move(finest)), compliant_(is_compliant(finest_.links)) {
  SOUPLE_ASSERT(!levels.empty(), "a tower has levels");
  for (CoarseLevel& level : levels) add_level(std::move(level), tied, particles);
}

// The rest of the levels depends on the shape of the links and on the masses.
void LevelTower::set_links(std::vector<Link> links) {
  finest_.links = std::move(links);
  compliant_ = is_compliant(finest_.links);
  gains_for_ = {};
  std::span<const Link> finer = finest_.links;
  for (Level& level : levels_) {
    take_energies(finer, level.map);
    finer = level.map.links;
  }
}

void LevelTower::set_masses(std::vector<float> mass, const TiedParticles& tied,
                            const ParticleView& particles) {
  finest_.mass = std::move(mass);
  gains_for_ = {};
  std::span<const float> finer = finest_.mass;
  std::span<const Link> links = finest_.links;
  for (Level& level : levels_) {
    take_masses(finer, level.map), take_energies(links, level.map);
    for (std::size_t j = 0; j < level.map.mass.size(); ++j)
      level.position[j].w = level.moving[j].w = level.before[j].w = inverse(level.map.mass[j]);
    find_restriction(level, &level == levels_.data(), tied, particles);
    finer = level.map.mass, links = level.map.links;
  }
}

void LevelTower::add_level(CoarseLevel map, const TiedParticles& tied, const ParticleView& particles) {
  const std::span<const std::uint32_t> finer = levels_.empty() ? finest_.particle : levels_.back().particle;
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
  find_prolongation(level, levels_.empty(), tied, particles);
  find_restriction(level, levels_.empty(), tied, particles);
  find_slots(level);
  add_links_near_pins(level);
  levels_.push_back(std::move(level));
}

// Those of the first level act on every particle of the world that is tied to a linked one.
void LevelTower::find_prolongation(Level& level, bool first, const TiedParticles& tied,
                                   const ParticleView& particles) const {
  const CoarseLevel& map = level.map;
  for (std::uint32_t i = 0; i + 1 < map.parent_begin.size(); ++i)
    for_each_tied(i, first, tied, particles, [&](std::uint32_t finer, float) {
      level.finer.push_back(finer);
      for (std::uint32_t k = map.parent_begin[i]; k < map.parent_begin[i + 1]; ++k)
        level.prolongation.add(map.parent[k], map.weight[k]);
      level.prolongation.end_row();
    });
}

void LevelTower::find_restriction(Level& level, bool first, const TiedParticles& tied,
                                  const ParticleView& particles) const {
  const CoarseLevel& map = level.map;
  level.restriction = {};
  for (std::size_t j = 0; j < map.mass.size(); ++j) {
    for (std::uint32_t k = map.child_begin[j]; k < map.child_begin[j + 1]; ++k)
      for_each_tied(map.child[k], first, tied, particles, [&](std::uint32_t finer, float part) {
        if (part > 0) level.restriction.add(finer, map.child_weight[k] * part);
      });
    level.restriction.end_row();
  }
}

// Fills the arrays per slot. Padding measures the distance of a particle from itself.
void LevelTower::find_slots(Level& level) const {
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
  std::vector<bool> near = near_isolated_pins(map.links, map.mass, radius);
  LinkedPieces pieces(map.links, map.mass.size());
  for (std::uint32_t i = 0; i < near.size(); ++i) near[i] = near[i] && pieces.size(i) >= smallest_near_piece;
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

void LevelTower::add_links_near_pins(Level& level) {
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

int LevelTower::sweeps_of(std::size_t l) const {
  return l + 1 == levels_.size() ? coarsest_sweeps : level_sweeps;
}

std::size_t LevelTower::coarse_projections() const {
  std::size_t sum = 0;
  for (std::size_t l = 0; l < levels_.size(); ++l)
    sum += static_cast<std::size_t>(sweeps_of(l)) * levels_[l].all.swept();
  return sum;
}

// Stretch of the paths and limits of the coarse links, at the start of the substep. Links of the first coarse level
// need no path. Their lengths are those of paths across triangles of finer links, so no state that satisfies the finer
// links is longer.
void LevelTower::measure(const ParticleView& particles, Threads& threads) {
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

void LevelTower::measure_paths(std::size_t l, Threads& threads) {
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
void LevelTower::set_gains(const Substep& substep) {
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

void LevelTower::set_gains_of(const Level& level, LevelLinks& links, int n) const {
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
float LevelTower::softening_of(std::size_t l, std::size_t e) const {
  const CoarseLevel& map = levels_[l].map;
  float sum = 0;
  for (std::uint32_t k = map.path_begin[e]; k < map.path_begin[e + 1]; ++k) {
    const std::uint32_t step = map.path[k];
    const Level* const finer = l > 0 ? &levels_[l - 1] : nullptr;
    const Link& link = finer ? finer->map.links[step] : finest_.links[step];
    const float factor = finer ? finer->softening[step] : 1;
    const float w = finer ? finer->position[link.a].w + finer->position[link.b].w
                          : inverse(finest_.mass[link.a]) + inverse(finest_.mass[link.b]);
    const float alpha = factor * link.compliance(), h2_w = gains_for_.h * gains_for_.h * w;
    const float stiffness =
        finer ? supplied(alpha, h2_w) : supplied_finest(alpha, h2_w, gains_for_.iterations);
    sum += h2_w > 0 ? factor / std::fmax(1 - alpha * stiffness, 1e-6f) : factor;
  }
  return sum / static_cast<float>(map.path_begin[e + 1] - map.path_begin[e]);
}

void LevelTower::restrict_particles(const ParticleView& particles, Threads& threads) {
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

void LevelTower::prolong(const Level& from, std::span<const Vec4f> inverse_mass, std::span<Vec4f> to,
                         Threads& threads) {
  threads.for_each(from.prolongation.rows(), 4 * sweep_grain, [&](std::size_t begin, std::size_t end) {
    from.prolongation.add_to(begin, end, from.correction, from.finer, inverse_mass, to);
  });
}

// From the coarsest level to the particles.
void LevelTower::project_levels(const ActivePieces& active, const ParticleView& particles, Threads& threads) {
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
  Level& finest = levels_.front();
  for (std::size_t j = 0; !active.all() && j < finest.particle.size(); ++j)
    if (!active.acts(finest.particle[j])) finest.correction[j] = {};
  prolong(finest, particles.position, particles.moving, threads);
}

void LevelTower::correct(const ActivePieces& active, const ParticleView& particles, const Substep& substep,
                         int iteration, Threads& threads) {
  restrict_particles(particles, threads);
  if (iteration == 0) measure(particles, threads), set_gains(substep);
  project_levels(active, particles, threads);
}

}  // namespace souple
