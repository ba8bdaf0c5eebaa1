#include "souple/solver/hierarchical.h"

#include "souple/constraints/distance.h"
#include "souple/constraints/triangle_membrane.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
/// Particles of the coarsest level, at most: eight sweeps solve it.
constexpr std::size_t coarsest_size = 24;
/// Sweeps per level. One converges as well for hanging cloth and less for swinging cloth; three gain nothing.
constexpr int sweeps = 2, coarsest_sweeps = 8;
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

float inverse(float mass) {
  return mass > 0 ? 1 / mass : 0;
}

float compliance_of(const Link& link) {
  return link.length * link.length / link.energy;
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

void Hierarchical::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  std::vector<Link> links;
  for (const Projector* projector : projectors) {
    if (const auto* distances = dynamic_cast<const SetProjector<Distance>*>(projector))
      add_links(*distances, links);
    if (const auto* membranes = dynamic_cast<const SetProjector<TriangleMembrane>*>(projector))
      add_links(*membranes, links);
  }
  merge(links);
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
  // Steps rewrite these columns: allocate one number per constraint now.
  for (Level& level : levels_) {
    level.max_length = level.at_most.set().parameters.data();
    level.min_length = level.at_least.set().parameters.data();
    level.compliance = level.at_most.set().compliances.data();
    if (level.at_most.size() == 0) continue;
    level.max_length->set(0, 0);
    level.min_length->set(0, 0);
    if (compliant_) level.compliance->set(0, 1);
  }
  h_ = 0;
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

  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  for (const Link& link : map.links) {
    ends.emplace_back(link.a, link.b);
    if (map.mass[link.a] == 0 && map.mass[link.b] == 0) continue;
    level.at_most.add({link.a, link.b}, {link.length}, {0}, 0, link.stiffness);
    level.at_least.add({link.a, link.b}, {link.length});
  }
  level.at_most.prepare(map.mass.size());
  level.at_least.prepare(map.mass.size());
  for (std::uint32_t i = 0; i < level.at_most.size(); ++i) {
    const auto [a, b] = level.at_most.set().indices(i);
    const auto found = std::lower_bound(ends.begin(), ends.end(), std::pair(a, b));
    level.constraint[static_cast<std::size_t>(found - ends.begin())] = i;
  }
  level.map = std::move(map);
  levels_.push_back(std::move(level));
}

int Hierarchical::sweeps_of(std::size_t l) const {
  return l + 1 == levels_.size() ? coarsest_sweeps : sweeps;
}

std::size_t Hierarchical::coarse_projections() const {
  std::size_t sum = 0;
  for (std::size_t l = 0; l < levels_.size(); ++l)
    sum += static_cast<std::size_t>(sweeps_of(l)) * (levels_[l].at_most.size() + levels_[l].at_least.size());
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
    level.max_length->set(level.constraint[e], max_length);
    level.min_length->set(level.constraint[e], std::fmin(max_length, std::fmin(now, length(x + d))));
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

// A sweep from lambda = 0 acts on a smooth stretch like springs of compliance alpha + c h^2 (w_a + w_b), with
// c measured on cloths of 50 to 200. Of the stiffness 1/alpha that a level has to supply, it supplies k; the
// next coarser level supplies the rest:
//
//   k = 1 / (alpha + c h^2 w),   1/alpha - k = 1 / (alpha (1 + alpha / (c h^2 w)))
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
        level.compliance->set(level.constraint[e], compliance_of(level.map.links[e]) * level.softening[e]);
    }
  }
}

// Mean softening that the finer links of the path leave to this link.
float Hierarchical::softening_of(std::size_t l, std::size_t e) const {
  constexpr float c = 0.4f;
  const CoarseLevel& map = levels_[l].map;
  float sum = 0;
  for (std::uint32_t k = map.path_begin[e]; k < map.path_begin[e + 1]; ++k) {
    const std::uint32_t step = map.path[k];
    const Level* const finer = l > 0 ? &levels_[l - 1] : nullptr;
    const Link& link = finer ? finer->map.links[step] : links_[step];
    const float factor = finer ? finer->softening[step] : 1;
    const float w = finer ? finer->position[link.a].w + finer->position[link.b].w : inverse_masses_[step];
    const int n = iterations_ * (finer ? sweeps : 1);
    const float reached = c * h_ * h_ * w / static_cast<float>(n);
    sum += reached > 0 ? factor * (1 + factor * compliance_of(link) / reached) : factor;
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

void Hierarchical::project_levels(const Substep& substep, bool first, Threads& threads) {
  Substep coarse = substep;
  coarse.form = Form::displacement;
  if (substep.mode != Mode::pbd) {
    coarse.mode = compliant_ ? Mode::xpbd : Mode::small_steps;
    coarse.iterations = 1;
  }
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
    if (first) level.at_most.begin_substep(view, coarse), level.at_least.begin_substep(view, coarse);
    for (int s = 0; s < sweeps_of(l); ++s) {
      sweep(level.at_most, view, coarse, threads);
      sweep(level.at_least, view, coarse, threads);
    }
    threads.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        level.correction[i].set_xyz(level.moving[i].xyz() - level.before[i].xyz());
    });
  }
}

void Hierarchical::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads) {
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (!levels_.empty()) {
      restrict_particles(particles, threads);
      if (iteration == 0) measure(particles, threads), set_compliance(substep);
      project_levels(substep, iteration == 0, threads);
      const Level& level = levels_.front();
      threads.for_each(particle_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if (masses_[i] > 0) particles.correct(particle_[i], prolonged(level.map, level.correction, i));
      });
    }
    for (Projector* projector : projectors) sweep(*projector, particles, substep, threads);
  }
}

std::string Hierarchical::diagnostic() const {
  if (!links_.empty()) return {};
  return "the hierarchical solver found no distances or membranes to build levels from: it is Gauss-Seidel";
}

}  // namespace souple
