#include "souple/solver/hierarchical.h"

#include "souple/constraints/distance.h"
#include "souple/constraints/triangle_membrane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
/// Particles of the coarsest level, at most: few sweeps solve it.
constexpr std::size_t coarsest_size = 24;
/// Sweeps per level. The last is plain, those before it are over-relaxed: one sweep from lambda = 0 leaves a
/// smooth stretch (1/omega - 1/2) h^2 (w_a + w_b) lambda per link (docs/solvers.md), and omega = 1.6 leaves a
/// quarter of what omega = 1 does. A third sweep gains little and makes a flag's worst link worse.
constexpr int sweeps = 2, coarsest_sweeps = 4;
constexpr float over_relaxation = 1.6f;
/// Additional sweeps of the links around isolated pinned particles, and how many links away they reach.
constexpr int near_sweeps = 12, near_radius = 6;
/// One sweep of the finest links leaves a stretch of this times h^2 (w_a + w_b) lambda: 1/2 in theory. Measured
/// with the test that a soft cloth keeps its compliance.
constexpr float finest_share = 0.535f;
/// With SolverKind::automatic, pieces of fewer particles get no levels: at 14 x 14 plain sweeps leave a cotton
/// cloth of 1 m 0.18 % too long.
constexpr std::size_t smallest_piece = 200;
/// Minimum number of coarse particles per thread.
constexpr std::size_t grain = 1024;

void add_links(const SetProjector<Distance>& distances, std::vector<Link>& links) {
  const auto& set = distances.set();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto [a, b] = set.indices(i);
    const float length = set.params(i).rest_length;
    if (a == b || !(length > 0)) continue;
    links.push_back(
        {std::min(a, b), std::max(a, b), length, length * length / set.compliance(i)[0], set.stiffness(i)});
  }
}

// The edges of a triangle with rest shape B^-1 divide its stiffness: each edge gets S A of the triangle's
// strain energy, with the mean S of warp and weft.
void add_links(const SetProjector<TriangleMembrane>& membranes, std::vector<Link>& links) {
  const auto& set = membranes.set();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto indices = set.indices(i);
    const auto p = set.params(i);
    const auto alpha = set.compliance(i);
    const float determinant = p.b00 * p.b11 - p.b01 * p.b10;
    const float rest[3][2] = {
        {0, 0}, {p.b11 / determinant, -p.b10 / determinant}, {-p.b01 / determinant, p.b00 / determinant}};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      const float length = std::hypot(rest[k][0] - rest[l][0], rest[k][1] - rest[l][1]);
      if (!(length > 0) || !std::isfinite(length)) continue;
      links.push_back({std::min(indices[k], indices[l]), std::max(indices[k], indices[l]), length,
                       2 / (alpha[0] + alpha[2]), set.stiffness(i)});
    }
  }
}

/// Merges the links of each pair of particles into one as strong as all of them together.
void merge(std::vector<Link>& links) {
  const auto key = [](const Link& link) { return std::tuple(link.a, link.b, link.length, link.energy); };
  std::sort(links.begin(), links.end(), [&](const Link& p, const Link& q) { return key(p) < key(q); });
  std::size_t count = 0;
  for (const Link& link : links) {
    if (count > 0 && links[count - 1].a == link.a && links[count - 1].b == link.b) {
      links[count - 1].energy += link.energy;
    } else {
      links[count++] = link;
    }
  }
  links.resize(count);
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

/// Allocates one number per constraint in a column whose numbers are all equal and not `value`.
void expand(Column& column, float value) {
  if (column.size() > 0) column.set(0, value);
}

/// The link between particles a < b of a level.
std::size_t link_between(const CoarseLevel& level, std::uint32_t a, std::uint32_t b) {
  const auto found =
      std::lower_bound(level.links.begin(), level.links.end(), std::pair(a, b),
                       [](const Link& link, const auto& ends) { return std::pair(link.a, link.b) < ends; });
  return static_cast<std::size_t>(found - level.links.begin());
}

/// The pieces that links connect particles to.
class Components {
 public:
  Components(std::span<const Link> links, std::size_t particles) : root_(particles), size_(particles) {
    std::iota(root_.begin(), root_.end(), 0u);
    for (const Link& link : links) {
      const std::uint32_t a = root(link.a), b = root(link.b);
      root_[std::max(a, b)] = std::min(a, b);
    }
    for (std::uint32_t i = 0; i < particles; ++i) ++size_[root(i)];
  }
  /// The lowest particle of the piece of particle i.
  std::uint32_t root(std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  /// Number of particles in the piece of particle i.
  std::size_t size(std::uint32_t i) { return size_[root(i)]; }

 private:
  std::vector<std::uint32_t> root_, size_;
};

/// Removes the links of small pieces, which plain sweeps solve well.
void remove_small(std::vector<Link>& links, std::size_t particles) {
  Components components(links, particles);
  std::erase_if(links, [&](const Link& link) { return components.size(link.a) < smallest_piece; });
}

/// Per particle of a level: whether it is at most `near_radius` links away from an isolated pinned particle, one
/// of a few that do not form an edge of their piece.
std::vector<bool> near_pins(const CoarseLevel& level) {
  Components components(level.links, level.mass.size());
  std::vector<std::size_t> pinned(level.mass.size());  // per piece, at its root
  for (std::uint32_t i = 0; i < pinned.size(); ++i) pinned[components.root(i)] += level.mass[i] == 0;
  std::vector<bool> near(level.mass.size());
  for (std::uint32_t i = 0; i < near.size(); ++i) {
    const std::size_t pins = pinned[components.root(i)];
    near[i] = level.mass[i] == 0 && 2 * pins * pins < components.size(i) - pins;
  }
  for (int step = 0; step < near_radius; ++step) {
    const std::vector<bool> before = near;
    for (const Link& link : level.links)
      if (before[link.a] || before[link.b]) near[link.a] = near[link.b] = true;
  }
  return near;
}

float inverse(float mass) {
  return mass > 0 ? 1 / mass : 0;
}

float compliance_of(const Link& link) {
  return link.length * link.length / link.energy;
}

/// Stiffness that the n sweeps of a level supply to a smooth stretch. Each starts from lambda = 0, with a
/// compliance n alpha, and acts like springs of compliance n alpha / omega + (1/omega - 1/2) h^2 w side by side
/// with those of the other sweeps (docs/solvers.md). w: sum of the inverse masses of a link.
float supplied(float alpha, float h2_w) {
  const float each = alpha * float{sweeps}, omega = over_relaxation;
  return (sweeps - 1) / (each / omega + (1 / omega - 0.5f) * h2_w) + 1 / (each + 0.5f * h2_w);
}

/// The same of `iterations` sweeps of the finest constraints. One alone subtracts its share (projection.h).
float supplied_finest(float alpha, float h2_w, int iterations) {
  if (iterations == 1) return 1 / std::fmax(alpha, finest_share * h2_w);
  return 1 / (alpha + finest_share * h2_w / static_cast<float>(iterations));
}

/// Weighted sum of records, all four lanes: one instruction each.
struct Sum {
  Vec4f value;
  void add(const Vec4f& v, float scale) {
    value.x += v.x * scale, value.y += v.y * scale, value.z += v.z * scale, value.w += v.w * scale;
  }
};

/// Correction of particle i: weighted sum of its coarse particles' corrections.
Vec3f prolonged(const CoarseLevel& map, std::span<const Vec4f> correction, std::size_t i) {
  Sum sum;
  for (std::uint32_t k = map.parent_begin[i]; k < map.parent_begin[i + 1]; ++k)
    sum.add(correction[map.parent[k]], map.weight[k]);
  return sum.value.xyz();
}

}  // namespace

// Whether constraints or masses changed since the last call. Comparing the links themselves takes as long as
// a frame of a large cloth.
bool Hierarchical::inputs_changed(std::span<Projector* const> projectors, const ParticleView& particles) {
  std::vector<std::pair<const Projector*, std::uint64_t>> revisions;
  for (const Projector* projector : projectors) {
    if (const auto* distances = dynamic_cast<const SetProjector<Distance>*>(projector))
      revisions.emplace_back(projector, distances->revision());
    if (const auto* membranes = dynamic_cast<const SetProjector<TriangleMembrane>*>(projector))
      revisions.emplace_back(projector, membranes->revision());
  }
  bool changed = revisions != revisions_;
  revisions_ = std::move(revisions);
  for (std::size_t i = 0; i < particle_.size() && !changed; ++i)
    changed = masses_[i] != inverse(particles.inverse_mass(particle_[i]));
  return changed;
}

void Hierarchical::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  if (!inputs_changed(projectors, particles)) return;
  std::vector<Link> links;
  for (const Projector* projector : projectors) {
    if (const auto* distances = dynamic_cast<const SetProjector<Distance>*>(projector))
      add_links(*distances, links);
    if (const auto* membranes = dynamic_cast<const SetProjector<TriangleMembrane>*>(projector))
      add_links(*membranes, links);
  }
  merge(links);
  if (automatic_) remove_small(links, particles.position.size());
  std::vector<std::uint32_t> linked_particles = linked(links, particles.position.size());
  std::vector<float> masses;
  masses.reserve(linked_particles.size());
  for (const std::uint32_t i : linked_particles) masses.push_back(inverse(particles.inverse_mass(i)));
  if (links == links_ && masses == masses_) return;

  links_ = links;
  masses_ = std::move(masses);
  particle_ = std::move(linked_particles);
  std::vector<std::uint32_t> number(particles.position.size(), none);
  for (std::uint32_t i = 0; i < particle_.size(); ++i) number[particle_[i]] = i;
  for (Link& link : links) link.a = number[link.a], link.b = number[link.b];
  levels_.clear();
  for (CoarseLevel& level : build_levels(links, masses_, coarsest_size)) add_level(std::move(level));
  compliant_ =
      std::any_of(links_.begin(), links_.end(), [](const Link& link) { return std::isfinite(link.energy); });
  inverse_masses_.clear();
  for (const Link& link : links_)
    inverse_masses_.push_back(particles.inverse_mass(link.a) + particles.inverse_mass(link.b));
  for (Level& level : levels_) level.all.allocate(compliant_), level.near.allocate(compliant_);
  h_ = 0;
}

void Hierarchical::Bounds::add(const Link& link) {
  at_most.add({link.a, link.b}, {link.length}, {0}, 0, link.stiffness);
  at_least.add({link.a, link.b}, {link.length});
}

void Hierarchical::Bounds::prepare(std::size_t particles) {
  at_most.prepare(particles);
  at_least.prepare(particles);
}

void Hierarchical::Bounds::allocate(bool compliant) {
  max_length = at_most.set().parameters.data();
  min_length = at_least.set().parameters.data();
  compliance = at_most.set().compliances.data();
  expand(*max_length, 0), expand(*min_length, 0);
  if (compliant) expand(*compliance, 1);
}

void Hierarchical::add_level(CoarseLevel map) {
  const std::span<const std::uint32_t> finer = levels_.empty() ? particle_ : levels_.back().particle;
  Level level;
  for (const std::uint32_t i : map.finer) level.particle.push_back(finer[i]);
  for (const float mass : map.mass) level.position.push_back({0, 0, 0, inverse(mass)});
  level.moving.resize(map.mass.size());  // w = 0: kernels subtract whole records
  level.correction = level.before = level.moving;
  level.constraint.assign(map.links.size(), none);
  level.stretch.resize(map.links.size());
  level.path_length = level.softening = level.stretch;

  for (std::size_t e = 0; !levels_.empty() && e < map.links.size(); ++e)
    for (std::uint32_t k = map.path_begin[e]; k < map.path_begin[e + 1]; ++k)
      level.path_length[e] += levels_.back().map.links[map.path[k]].length;

  for (const Link& link : map.links) {
    if (map.mass[link.a] == 0 && map.mass[link.b] == 0) continue;
    level.all.add(link);
  }
  level.all.prepare(map.mass.size());
  for (std::uint32_t i = 0; i < level.all.at_most.size(); ++i) {
    const auto [a, b] = level.all.at_most.set().indices(i);
    level.constraint[link_between(map, a, b)] = i;
  }
  level.map = std::move(map);
  add_links_near_pins(level);
  levels_.push_back(std::move(level));
}

void Hierarchical::add_links_near_pins(Level& level) {
  const std::vector<bool> near = near_pins(level.map);
  for (std::uint32_t e = 0; e < level.map.links.size(); ++e) {
    const Link& link = level.map.links[e];
    if (level.constraint[e] == none || !near[link.a] || !near[link.b]) continue;
    level.near.add(link);
  }
  level.near.prepare(level.map.mass.size());
  for (std::uint32_t i = 0; i < level.near.at_most.size(); ++i) {
    const auto [a, b] = level.near.at_most.set().indices(i);
    level.near_constraint.push_back(level.constraint[link_between(level.map, a, b)]);
  }
}

int Hierarchical::sweeps_of(std::size_t l) const {
  return l + 1 == levels_.size() ? coarsest_sweeps : sweeps;
}

std::size_t Hierarchical::coarse_projections() const {
  std::size_t sum = 0;
  for (std::size_t l = 0; l < levels_.size(); ++l)
    sum += static_cast<std::size_t>(sweeps_of(l)) * 2 * levels_[l].all.at_most.size();
  return sum;
}

// Stretch of the paths and length limits of the coarse links, at the start of the substep.
void Hierarchical::measure(const ParticleView& particles, Threads& threads) {
  const std::span<const Vec4f> start = particles.form == Form::plain ? particles.start : particles.position;
  for (std::size_t l = 0; l < levels_.size(); ++l)
    threads.for_each(levels_[l].map.links.size(), grain,
                     [&](std::size_t begin, std::size_t end) { measure_level(l, start, begin, end); });
}

void Hierarchical::measure_level(std::size_t l, std::span<const Vec4f> start, std::size_t begin,
                                 std::size_t end) {
  Level& level = levels_[l];
  for (std::size_t e = begin; e < end; ++e) {
    const float ratio = stretch_ratio(l, e, start);
    if (level.constraint[e] == none) continue;
    const Link& link = level.map.links[e];
    const Vec3f x = level.position[link.a].xyz() - level.position[link.b].xyz();
    const Vec3f d = level.moving[link.a].xyz() - level.moving[link.b].xyz();
    const float now = length(x);
    const float max_length = now * ratio;
    level.all.max_length->set(level.constraint[e], max_length);
    level.all.min_length->set(level.constraint[e], std::fmin(max_length, std::fmin(now, length(x + d))));
  }
}

// Factor from the length of a link to its limit: below 1 it must shrink, above 1 it may grow. Stores the
// link's stretch for the paths of coarser links. Links of the first coarse level need no path: their lengths
// are those of paths across triangles of finer links, so no state that satisfies the finer links is longer.
float Hierarchical::stretch_ratio(std::size_t l, std::size_t e, std::span<const Vec4f> start) {
  Level& level = levels_[l];
  const Link& link = level.map.links[e];
  const float now = length(start[level.particle[link.a]].xyz() - start[level.particle[link.b]].xyz());
  const float length_floor = 1e-6f * link.length;
  const float ratio = link.length / std::fmax(now, length_floor);
  level.stretch[e] = now - link.length;
  if (l == 0) return ratio;
  float stretch = 0;
  for (std::uint32_t k = level.map.path_begin[e]; k < level.map.path_begin[e + 1]; ++k)
    stretch += levels_[l - 1].stretch[level.map.path[k]];
  level.stretch[e] = stretch;
  return std::fmax(ratio, level.path_length[e] / std::fmax(level.path_length[e] + stretch, length_floor));
}

// Of the stiffness 1/alpha that a level has to supply, the next coarser level supplies what the sweeps of this
// one do not:
//
//   1/alpha' = 1/alpha - k
//
// So each level's compliance is the material's times a factor, its softening, which grows towards coarser
// levels. Rigid stays rigid. Without softening each level supplies all of the stiffness, and a soft cloth
// hangs five times too stiff (measured).
void Hierarchical::set_compliance(const Substep& substep) {
  if (!compliant_ || (h_ == substep.h && iterations_ == substep.iterations)) return;
  h_ = substep.h;
  iterations_ = substep.iterations;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    for (std::size_t e = 0; e < level.map.links.size(); ++e) {
      level.softening[e] = softening_of(l, e);
      if (level.constraint[e] != none)
        level.all.compliance->set(level.constraint[e],
                                  compliance_of(level.map.links[e]) * level.softening[e]);
    }
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
    const float alpha = factor * compliance_of(link), h2_w = h_ * h_ * w;
    const float stiffness = finer ? supplied(alpha, h2_w) : supplied_finest(alpha, h2_w, iterations_);
    sum += h2_w > 0 ? factor / std::fmax(1 - alpha * stiffness, 1e-6f) : factor;
  }
  return sum / static_cast<float>(map.path_begin[e + 1] - map.path_begin[e]);
}

void Hierarchical::restrict_particles(const ParticleView& particles, Threads& threads) {
  const bool plain = particles.form == Form::plain;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    threads.for_each(level.particle.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        Sum x, d;
        for (std::uint32_t k = level.map.child_begin[j]; k < level.map.child_begin[j + 1]; ++k) {
          const float child_weight = level.map.child_weight[k];
          const std::uint32_t child = level.map.child[k];
          if (l > 0) {
            x.add(levels_[l - 1].position[child], child_weight);
            d.add(levels_[l - 1].moving[child], child_weight);
          } else {
            const std::uint32_t i = particle_[child];
            x.add(plain ? particles.start[i] : particles.position[i], child_weight);
            d.add(particles.moving[i], child_weight);
          }
        }
        level.position[j].set_xyz(x.value.xyz());
        level.moving[j].set_xyz(plain && l == 0 ? d.value.xyz() - x.value.xyz() : d.value.xyz());
      }
    });
  }
}

// n sweeps, the last one plain. Each starts from lambda = 0 with n times the compliance: then n sweeps of a
// smooth stretch are as compliant as one, and no multipliers are stored.
void Hierarchical::Bounds::project(int n, const ParticleView& view, const Substep& substep,
                                   Threads& threads) {
  Substep part = substep;
  if (substep.mode != Mode::pbd) part.h /= std::sqrt(static_cast<float>(n));
  at_most.begin_substep(view, part), at_least.begin_substep(view, part);
  for (int s = 1; s <= n; ++s) {
    part.relaxation = s < n ? over_relaxation : 1;
    sweep(at_most, view, part, threads);
    sweep(at_least, view, part, threads);
  }
}

void Hierarchical::project_levels(const Substep& substep, Threads& threads) {
  Substep coarse = substep;
  coarse.form = Form::displacement;
  if (substep.mode != Mode::pbd) coarse.mode = Mode::small_steps, coarse.iterations = 1;
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    const std::size_t count = level.particle.size();
    threads.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        level.before[i] = level.moving[i];
        if (l + 1 == levels_.size() || level.position[i].w == 0) continue;
        const Level& above = levels_[l + 1];
        level.moving[i].set_xyz(level.moving[i].xyz() + prolonged(above.map, above.correction, i));
      }
    });
    const ParticleView view{level.position, level.moving, level.before, Form::displacement};
    project_near_pins(level, view, coarse, threads);
    level.all.project(sweeps_of(l), view, coarse, threads);
    threads.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        level.correction[i].set_xyz(level.moving[i].xyz() - level.before[i].xyz());
    });
  }
}

void Hierarchical::project_near_pins(Level& level, const ParticleView& view, const Substep& substep,
                                     Threads& threads) {
  if (level.near_constraint.empty()) return;
  for (std::size_t i = 0; i < level.near_constraint.size(); ++i) {
    const std::uint32_t constraint = level.near_constraint[i];
    level.near.max_length->set(i, (*level.all.max_length)[constraint]);
    level.near.min_length->set(i, (*level.all.min_length)[constraint]);
    level.near.compliance->set(i, (*level.all.compliance)[constraint]);
  }
  level.near.project(near_sweeps, view, substep, threads);
}

void Hierarchical::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads) {
  const bool with_levels = !levels_.empty() && (!automatic_ || substep.mode == Mode::small_steps);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (with_levels) {
      restrict_particles(particles, threads);
      if (iteration == 0) measure(particles, threads), set_compliance(substep);
      project_levels(substep, threads);
      const Level& level = levels_.front();
      threads.for_each(particle_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if (masses_[i] > 0 && particles.inverse_mass(particle_[i]) > 0)
            particles.correct(particle_[i], prolonged(level.map, level.correction, i));
      });
    }
    if (automatic_) {
      sweep_as_needed(projectors, particles, substep, threads, motion_);
    } else {
      for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
    }
  }
}

std::string Hierarchical::diagnostic() const {
  if (automatic_ || !links_.empty()) return {};
  return "the hierarchical solver found no distances or membranes to build levels from: it is Gauss-Seidel";
}

}  // namespace souple
