#include "souple/solver/hierarchical.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t smallest_level = 24;
constexpr std::size_t grain = 2048;
constexpr std::uint32_t none = ~std::uint32_t{0};

void add_links(const SetProjector<Distance>& distances, const ParticleView& particles,
               std::vector<Link>& links) {
  const auto& set = distances.set();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto [a, b] = set.indices(i);
    const float w = particles.inverse_mass(a) + particles.inverse_mass(b);
    const float length = set.params(i).rest_length, alpha = set.compliance(i)[0];
    if (a == b || !(length > 0)) continue;
    links.push_back({a, b, length, length * length / alpha, w > 0 ? alpha / w : 0});
  }
}

/// Numbers the linked particles without gaps, in order; returns them.
std::vector<std::uint32_t> compact(std::vector<Link>& links, std::size_t particles) {
  std::vector<std::uint32_t> number(particles, none), result;
  for (const Link& link : links) number[link.a] = number[link.b] = 0;
  for (std::uint32_t i = 0; i < particles; ++i)
    if (number[i] != none) number[i] = static_cast<std::uint32_t>(result.size()), result.push_back(i);
  for (Link& link : links) link.a = number[link.a], link.b = number[link.b];
  return result;
}

}  // namespace

void Hierarchical::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  std::vector<Link> links;
  for (const Projector* projector : projectors)
    if (const auto* distances = dynamic_cast<const SetProjector<Distance>*>(projector))
      add_links(*distances, particles, links);
  particle_ = compact(links, particles.position.size());
  std::vector<float> masses;
  for (const std::uint32_t i : particle_)
    masses.push_back(particles.inverse_mass(i) > 0 ? 1 / particles.inverse_mass(i) : 0);

  links_ = links;
  levels_.clear();
  std::span<const std::uint32_t> finer = particle_;
  for (CoarseLevel& map : build_levels(links, masses, smallest_level)) {
    Level& level = levels_.emplace_back();
    level.map = std::move(map);
    for (const std::uint32_t i : level.map.finer) level.particle.push_back(finer[i]);
    for (const float mass : level.map.mass) level.position.push_back({0, 0, 0, mass > 0 ? 1 / mass : 0});
    level.moving.resize(level.position.size());
    level.before.resize(level.position.size());
    for (const Link& link : level.map.links)
      if (level.map.mass[link.a] > 0 || level.map.mass[link.b] > 0)
        level.constraints.add({link.a, link.b}, {link.length}, {0});
    level.constraints.prepare(level.particle.size());
    level.excess.resize(level.map.links.size()), level.path = level.ratio = level.excess;
    for (std::size_t i = 0; i < level.constraints.size(); ++i) {
      const auto [a, b] = level.constraints.set().indices(i);
      const auto found = std::lower_bound(
          level.map.links.begin(), level.map.links.end(), std::pair(a, b),
          [](const Link& link, const std::pair<std::uint32_t, std::uint32_t>& ends) {
            return std::pair(link.a, link.b) < ends;
          });
      level.link.push_back(static_cast<std::uint32_t>(found - level.map.links.begin()));
    }
    finer = level.particle;
  }
  compliant_ = false;
  h_ = 0;
}

void Hierarchical::restrict_to(std::size_t l, const ParticleView& particles, Threads& threads) {
  Level& level = levels_[l];
  const CoarseLevel& map = level.map;
  threads.for_each(level.particle.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Vec3f x{}, d{};
      for (std::uint32_t k = map.child_begin[j]; k < map.child_begin[j + 1]; ++k) {
        const std::uint32_t i = map.child[k];
        if (l > 0) {
          x += levels_[l - 1].position[i].xyz() * map.share[k];
          d += levels_[l - 1].moving[i].xyz() * map.share[k];
        } else if (particles.form == Form::plain) {
          x += particles.start[particle_[i]].xyz() * map.share[k];
          d += particles.moved(particle_[i]) * map.share[k];
        } else {
          x += particles.position[particle_[i]].xyz() * map.share[k];
          d += particles.moving[particle_[i]].xyz() * map.share[k];
        }
      }
      level.position[j].set_xyz(x);
      level.moving[j].set_xyz(d);
    }
  });
}

void Hierarchical::measure(const ParticleView& particles, Threads& threads) {
  const std::span<const Vec4f> start = particles.form == Form::plain ? particles.start : particles.position;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    Level& level = levels_[l];
    threads.for_each(level.excess.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) {
        float sum = 0, path = 0;
        for (std::uint32_t k = level.map.way_begin[e]; k < level.map.way_begin[e + 1]; ++k) {
          const std::uint32_t step = level.map.way[k];
          if (l > 0) {
            sum += levels_[l - 1].excess[step];
            path += levels_[l - 1].path[step];
          } else {
            const Link& link = links_[step];
            sum += length(start[particle_[link.a]].xyz() - start[particle_[link.b]].xyz()) - link.length;
            path += link.length;
          }
        }
        level.excess[e] = sum;
        level.path[e] = path;
        const Link& link = level.map.links[e];
        const float now = length(start[level.particle[link.a]].xyz() - start[level.particle[link.b]].xyz());
        float ratio = path / (path + sum);
        if (geo) ratio = fas ? std::max(ratio, link.length / now) : link.length / now;
        level.ratio[e] = now > 0 ? 1 + beta * (ratio - 1) : 1;
      }
    });
  }
}

void Hierarchical::prolong(const Level& from, std::span<const std::uint32_t> to, std::span<Vec4f> moving,
                           std::span<const Vec4f> masses, bool scattered, Threads& threads) const {
  const CoarseLevel& map = from.map;
  threads.for_each(map.begin.size() - 1, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t target = scattered ? to[i] : i;
      if (masses[target].w == 0) continue;
      Vec3f dx{};
      for (std::uint32_t k = map.begin[i]; k < map.begin[i + 1]; ++k) {
        const std::uint32_t j = map.parent[k];
        dx += (from.moving[j].xyz() - from.before[j].xyz()) * map.weight[k];
      }
      moving[target].set_xyz(moving[target].xyz() + dx);
    }
  });
}

void Hierarchical::descend(const ParticleView& particles, const Substep& substep, Threads& threads) {
  Substep coarse = substep;
  coarse.form = Form::displacement;
  coarse.mode = compliant_ ? Mode::xpbd : Mode::small_steps;
  coarse.iterations = 1;
  for (std::size_t l = 0; l < levels_.size(); ++l) restrict_to(l, particles, threads);
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    level.before = level.moving;
    if (l + 1 < levels_.size()) prolong(levels_[l + 1], {}, level.moving, level.position, false, threads);
    const ParticleView view{level.position, level.moving, level.before, Form::displacement};
    auto& set = level.constraints.set();
    for (std::size_t i = 0; i < set.size(); ++i) {
      const auto [a, b] = set.indices(i);
      set.parameters[0].set(
          i, level.ratio[level.link[i]] * length(level.position[a].xyz() - level.position[b].xyz()));
    }
    level.constraints.begin_substep(view, coarse);
    const int n = l + 1 == levels_.size() ? coarsest_sweeps : sweeps;
    projections += double(n) * double(level.constraints.size());
    for (int s = 0; s < n; ++s) sweep(level.constraints, view, coarse, threads);
  }
  prolong(levels_.front(), particle_, particles.moving, particles.position, true, threads);
}

void Hierarchical::solve(std::span<Projector* const> projectors, const ParticleView& particles,
                         const Substep& substep, Threads& threads) {
  measure(particles, threads);
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    for (int k = 0; k < pre; ++k) for (Projector* projector : projectors) { sweep(*projector, particles, substep, threads);
      projections += double(projector->size());}
    if (!levels_.empty())
      for (int c = 0; c < cycles; ++c) descend(particles, substep, threads);
    for (int k = 0; k < post; ++k) for (Projector* projector : projectors) {
      sweep(*projector, particles, substep, threads);
      projections += double(projector->size());
    }
  }
}

std::string Hierarchical::remark() const {
  if (!levels_.empty()) return {};
  return "the hierarchical solver found no distance constraints to coarsen, and is plain Gauss-Seidel here";
}

}  // namespace souple
