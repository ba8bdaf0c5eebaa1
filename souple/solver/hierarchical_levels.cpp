#include "souple/solver/hierarchical_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
constexpr std::size_t max_parents = 4;
// Links per particle along which lengths are measured. Longer links add no information.
constexpr std::size_t max_links = 8;
// Distance between coarse particles, in mean links of the finer level: keeps a fifth to an eighth of a
// cloth's particles. At 1.3 the kinks that a level leaves cancel its gain; at 2 Gauss-Seidel has too far to
// smooth.
constexpr float coarsening = 1.6f;
// Radius around a coarse particle within which lengths are computed, in its spacing. With 2.2 levels take a third
// less time to build, but links are found too long: a cloth of 100 x 100 that hangs by two corners stretches by
// 3.8 % instead of 2.8, with 1.9 by 16 %.
constexpr float march_radius = 2.7f;
// eps of weights_of.
constexpr double smoothing = 0.1;

struct Neighbor {
  std::uint32_t to = 0;
  float length = 0;
  std::uint32_t link = 0;
};

/// The links of each particle, shortest first.
struct Graph {
  std::vector<std::uint32_t> begin;
  std::vector<Neighbor> neighbors;

  Graph(std::span<const Link> links, std::size_t particles) : begin(particles + 1) {
    for (const Link& link : links) ++begin[link.a + 1], ++begin[link.b + 1];
    for (std::size_t i = 0; i < particles; ++i) begin[i + 1] += begin[i];
    neighbors.resize(2 * links.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t e = 0; e < links.size(); ++e) {
      neighbors[next[links[e].a]++] = {links[e].b, links[e].length, e};
      neighbors[next[links[e].b]++] = {links[e].a, links[e].length, e};
    }
    for (std::size_t i = 0; i < particles; ++i)
      std::sort(neighbors.begin() + begin[i], neighbors.begin() + begin[i + 1],
                [](const Neighbor& p, const Neighbor& q) {
                  return std::pair(p.length, p.to) < std::pair(q.length, q.to);
                });
  }
  std::size_t size() const { return begin.size() - 1; }
  std::span<const Neighbor> of(std::uint32_t i) const {
    return {neighbors.data() + begin[i], neighbors.data() + begin[i + 1]};
  }
};

/// Lengths of the shortest paths along the material, from rest lengths alone. Paths cross triangles of links
/// and do not only follow links, so lengths do not depend on the triangulation (fast marching, Kimmel and
/// Sethian 1998, with the unfolding of a triangle's known edge).
class Marcher {
 public:
  struct Reached {
    std::uint32_t particle = 0;
    float length = 0;
  };

  Marcher(std::span<const Link> links, const Graph& graph)
      : graph_(short_links(links, graph), graph.size()),
        length_(graph.size()),
        state_(graph.size()),
        across_(graph.size()) {}

  /// Particles no farther than `radius` from `source`, nearest first.
  std::span<const Reached> march(std::uint32_t source, float radius) {
    reached_.clear();
    heap_.clear();
    radius_ = radius;
    ++source_;
    offer(source, 0);
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end(), later);
      const auto [length, u] = heap_.back();
      heap_.pop_back();
      if (state_[u].settled == source_) continue;
      state_[u].settled = source_;
      reached_.push_back({u, length});
      relax_neighbors(u);
    }
    return reached_;
  }

 private:
  using Entry = std::pair<float, std::uint32_t>;
  static bool later(const Entry& p, const Entry& q) { return p > q; }
  struct State {
    std::uint32_t seen = 0, settled = 0;
  };
  struct Mark {
    std::uint32_t source = none;
    float length = 0;
  };

  static std::vector<Link> short_links(std::span<const Link> links, const Graph& graph) {
    std::vector<bool> kept(links.size());
    for (std::uint32_t i = 0; i < graph.size(); ++i)
      for (const Neighbor& n : graph.of(i).first(std::min(max_links, graph.of(i).size())))
        kept[n.link] = true;
    std::vector<Link> result;
    for (std::size_t e = 0; e < links.size(); ++e)
      if (kept[e]) result.push_back(links[e]);
    return result;
  }

  void offer(std::uint32_t v, float length) {
    if (length > radius_ || (state_[v].seen == source_ && length_[v] <= length)) return;
    state_[v].seen = source_;
    length_[v] = length;
    heap_.emplace_back(length, v);
    std::push_heap(heap_.begin(), heap_.end(), later);
  }

  void relax_neighbors(std::uint32_t u) {
    for (const Neighbor& n : graph_.of(u)) across_[n.to] = {u, n.length};
    for (const Neighbor& n : graph_.of(u)) {
      const std::uint32_t v = n.to;
      if (state_[v].settled == source_) continue;
      float best = length_[u] + n.length;
      for (const Neighbor& m : graph_.of(v)) {
        const std::uint32_t w = m.to;
        if (state_[w].settled == source_ && across_[w].source == u)
          best = std::min(best, unfold(length_[u], length_[w], across_[w].length, n.length, m.length));
      }
      offer(v, best);
    }
  }

  /// Distance from the source straight across the edge u w of length c to v. du, dw: distances of u and w
  /// from the source; a, b: distances of v from u and w. Infinite if the path does not cross the edge.
  static float unfold(float du, float dw, float c, float a, float b) {
    constexpr float never = std::numeric_limits<float>::infinity();
    const float sx = (du * du - dw * dw + c * c) / (2 * c), vx = (a * a - b * b + c * c) / (2 * c);
    const float sy2 = du * du - sx * sx, vy2 = a * a - vx * vx;
    if (!(sy2 > 0) || !(vy2 > 0)) return never;
    const float sy = std::sqrt(sy2), vy = std::sqrt(vy2);
    const float x = sx + (vx - sx) * sy / (sy + vy);
    if (!(x >= 0 && x <= c)) return never;
    return std::sqrt((vx - sx) * (vx - sx) + (vy + sy) * (vy + sy));
  }

  Graph graph_;
  std::uint32_t source_ = 0;
  float radius_ = 0;
  std::vector<float> length_;
  std::vector<State> state_;
  std::vector<Mark> across_;
  std::vector<Entry> heap_;
  std::vector<Reached> reached_;
};

/// The coarse particles around a particle, nearest first, with their distances.
using Near = std::vector<Marcher::Reached>;

/// Length along the material from particle i to coarse particle j; infinite beyond the march radius.
float length_between(const std::vector<Near>& near, std::uint32_t i, std::uint32_t j) {
  for (const Marcher::Reached& n : near[i])
    if (n.particle == j) return n.length;
  return std::numeric_limits<float>::infinity();
}

/// Distance between coarse particles around particle i: the mean length of its links times `coarsening`.
float spacing(const Graph& graph, std::uint32_t i) {
  const auto around = graph.of(i);
  float sum = 0;
  for (const Neighbor& n : around) sum += n.length;
  return around.empty() ? 0 : coarsening * sum / static_cast<float>(around.size());
}

/// Rank of each particle, lowest chosen first: fixed particles, then free ones; of each, corners, then edges,
/// then the interior. A coarser level that reaches the edges need not extrapolate there. Edges and corners
/// have few particles within two links.
std::vector<int> ranks(const Graph& graph, std::span<const float> masses) {
  std::vector<std::uint32_t> around(graph.size()), seen(graph.size(), none);
  for (std::uint32_t i = 0; i < graph.size(); ++i)
    for (const Neighbor& n : graph.of(i))
      for (const Neighbor& m : graph.of(n.to)) around[i] += std::exchange(seen[m.to], i) != i;
  std::vector<int> result(graph.size());
  for (std::uint32_t i = 0; i < graph.size(); ++i) {
    std::uint32_t max_around = around[i];
    for (const Neighbor& n : graph.of(i))
      for (const Neighbor& m : graph.of(n.to)) max_around = std::max(max_around, around[m.to]);
    const float part = static_cast<float>(around[i]) / static_cast<float>(std::max(max_around, 1u));
    result[i] = (masses[i] > 0 ? 3 : 0) + (part < 0.45f ? 0 : part < 0.75f ? 1 : 2);
  }
  return result;
}

/// Chooses the particles of the coarser level: no two nearer than their spacing, and each as near to those
/// already chosen as that allows. Fills `near` for all particles.
std::vector<bool> choose_coarse(std::span<const Link> links, const Graph& graph,
                                std::span<const float> masses, std::vector<Near>& near) {
  using Entry = std::pair<float, std::uint32_t>;
  std::vector<bool> coarse(graph.size()), covered(graph.size());
  const std::vector<int> rank = ranks(graph, masses);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  std::vector<float> offered(graph.size(), std::numeric_limits<float>::infinity());
  const auto offer = [&](std::uint32_t i, float length) {
    if (length < offered[i]) offered[i] = length, front.emplace(length, i);
  };
  Marcher marcher(links, graph);
  const auto keep = [&](std::uint32_t j) {
    if (covered[j]) return;
    coarse[j] = true;
    const float radius = spacing(graph, j);
    for (const Marcher::Reached& r : marcher.march(j, march_radius * radius)) {
      near[r.particle].push_back({j, r.length});
      covered[r.particle] = covered[r.particle] || r.length <= radius;
      if (!covered[r.particle] && rank[r.particle] <= rank[j]) offer(r.particle, r.length);
    }
  };
  for (int now = 0; now < 6; ++now) {
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
      if (rank[i] != now || covered[i]) continue;
      float nearest = std::numeric_limits<float>::infinity();
      for (const Marcher::Reached& n : near[i]) nearest = std::min(nearest, n.length);
      if (!near[i].empty()) offer(i, nearest);
    }
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
      while (!front.empty()) {
        const std::uint32_t next = front.top().second;
        front.pop();
        keep(next);
      }
      if (rank[i] == now) keep(i);
    }
  }
  for (Near& n : near)
    std::sort(n.begin(), n.end(), [](const Marcher::Reached& p, const Marcher::Reached& q) {
      return std::pair(p.length, p.particle) < std::pair(q.length, q.particle);
    });
  return coarse;
}

using Parents = std::vector<std::uint32_t>;  // of one particle, nearest first

// Gaussian elimination of A w = 1, A symmetric positive definite.
void solve_ones(std::array<std::array<double, max_parents>, max_parents> A, std::size_t n,
                std::array<double, max_parents>& w) {
  w.fill(1);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      w[i] -= factor * w[k];
    }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) w[i] -= A[i][j] * w[j];
    w[i] /= A[i][i];
  }
}

/// Weights that reproduce a particle's position from those of its parents at x_j, from distances alone:
///   minimize |sum_j w_j (x_j - x_i)|^2 + eps sum_j w_j^2 |x_j - x_i|^2,   sum_j w_j = 1,   w_j >= 0.
/// With G_jk = (d_ij^2 + d_ik^2 - d_jk^2)/2 the first term is w^T G w. Müller 2008, section 4.3 uses 1/d_ij,
/// which is wrong even for a uniform stretch unless the parents surround the particle evenly.
std::vector<float> weights_of(std::span<const float> to_parent, std::vector<std::uint32_t>& parents,
                              const std::vector<Near>& near) {
  std::vector<float> d(to_parent.begin(), to_parent.end());
  for (;;) {
    const std::size_t n = parents.size();
    std::array<std::array<double, max_parents>, max_parents> G{};
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k) {
        const double dj = static_cast<double>(d[j]), dk = static_cast<double>(d[k]);
        const double djk =
            std::min(static_cast<double>(length_between(near, parents[j], parents[k])), dj + dk);
        G[j][k] = 0.5 * (dj * dj + dk * dk - djk * djk) + (j == k ? smoothing * dj * dj : 0);
      }
    std::array<double, max_parents> w{};
    solve_ones(G, n, w);
    double sum = 0;
    std::size_t worst = 0;
    for (std::size_t j = 0; j < n; ++j) {
      sum += w[j];
      if (w[j] < w[worst]) worst = j;
    }
    if (w[worst] >= 0 && sum > 0) {
      std::vector<float> result;
      for (std::size_t j = 0; j < n; ++j) result.push_back(static_cast<float>(w[j] / sum));
      return result;
    }
    if (n == 1) return {1};
    parents.erase(parents.begin() + static_cast<std::ptrdiff_t>(worst));
    d.erase(d.begin() + static_cast<std::ptrdiff_t>(worst));
  }
}

/// Distributes the energy of the finer links among the coarse links. A link between the clusters of two
/// coarse particles adds to the link of these two; a link within a cluster adds to all links of its coarse
/// particle.
void distribute_energy(std::span<const Link> links, std::span<const std::uint32_t> cluster,
                       std::size_t particles, std::vector<Link>& coarse) {
  const Graph graph(coarse, particles);
  std::vector<double> energy(coarse.size());
  for (const Link& link : links) {
    const std::uint32_t a = cluster[link.a], b = cluster[link.b];
    const auto around = graph.of(a);
    for (const Neighbor& n : around) {
      if (a != b && n.to != b) continue;
      energy[n.link] += static_cast<double>(link.energy) / (a == b ? static_cast<double>(around.size()) : 1);
    }
  }
  for (std::size_t e = 0; e < coarse.size(); ++e) coarse[e].energy = static_cast<float>(energy[e]);
}

/// Assigns each particle to the coarse particle nearest along links, and stores the link towards it.
struct Clusters {
  std::vector<std::uint32_t> of;
  std::vector<float> length;
  /// Per particle: link towards its coarse particle; `none` for a coarse particle.
  std::vector<std::uint32_t> towards;

  Clusters(const Graph& graph, const std::vector<bool>& coarse)
      : of(graph.size(), none),
        length(graph.size(), std::numeric_limits<float>::infinity()),
        towards(graph.size(), none) {
    using Entry = std::pair<float, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    for (std::uint32_t i = 0; i < graph.size(); ++i)
      if (coarse[i]) of[i] = i, length[i] = 0, front.emplace(0.0f, i);
    while (!front.empty()) {
      const auto [reached, u] = front.top();
      front.pop();
      if (reached > length[u]) continue;
      for (const Neighbor& n : graph.of(u)) {
        if (!(reached + n.length < length[n.to])) continue;
        length[n.to] = reached + n.length;
        of[n.to] = of[u];
        towards[n.to] = n.link;
        front.emplace(length[n.to], n.to);
      }
    }
  }
};

// Müller 2008, section 4.2: a removed particle collapses into its nearest parent together with its links. If
// two coarse particles get several links, the link with the shortest path along finer links is kept.
void collapse(std::span<const Link> links, const Clusters& clusters, std::span<const std::uint32_t> number,
              CoarseLevel& level) {
  struct Candidate {
    std::uint32_t a, b;
    float length;
    std::uint32_t link;
    auto key() const { return std::tuple(a, b, length, link); }
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t e = 0; e < links.size(); ++e) {
    const Link& link = links[e];
    const std::uint32_t a = number[clusters.of[link.a]], b = number[clusters.of[link.b]];
    if (a == b) continue;
    candidates.push_back(
        {std::min(a, b), std::max(a, b), clusters.length[link.a] + link.length + clusters.length[link.b], e});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& p, const Candidate& q) { return p.key() < q.key(); });
  level.path_begin.push_back(0);
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Candidate& best = candidates[c];
    if (c > 0 && candidates[c - 1].a == best.a && candidates[c - 1].b == best.b) continue;
    level.links.push_back({best.a, best.b, best.length, 0, links[best.link].stiffness});
    level.path.push_back(best.link);
    for (std::uint32_t i : {links[best.link].a, links[best.link].b})
      while (clusters.towards[i] != none) {
        const Link& step = links[clusters.towards[i]];
        level.path.push_back(clusters.towards[i]);
        i = step.a == i ? step.b : step.a;
      }
    level.path_begin.push_back(static_cast<std::uint32_t>(level.path.size()));
  }
}

// The transpose of the parents, weighted by mass.
void add_children(std::span<const float> masses, CoarseLevel& level) {
  const std::size_t count = level.finer.size();
  const auto follows = [&](std::size_t i, std::uint32_t j) {
    return level.mass[j] > 0 ? masses[i] > 0 : level.finer[j] == i;
  };
  level.child_begin.assign(count + 1, 0);
  for (std::size_t i = 0; i < masses.size(); ++i)
    for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k)
      if (follows(i, level.parent[k])) ++level.child_begin[level.parent[k] + 1];
  for (std::size_t j = 0; j < count; ++j) level.child_begin[j + 1] += level.child_begin[j];
  level.child.resize(level.child_begin[count]);
  level.child_weight.resize(level.child.size());
  std::vector<std::uint32_t> next(level.child_begin.begin(), level.child_begin.end() - 1);
  for (std::uint32_t i = 0; i < masses.size(); ++i)
    for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k) {
      const std::uint32_t j = level.parent[k];
      if (!follows(i, j)) continue;
      level.child[next[j]] = i;
      level.child_weight[next[j]++] = level.mass[j] > 0 ? level.weight[k] * masses[i] / level.mass[j] : 1;
    }
}

CoarseLevel build_level(std::span<const Link> links, std::span<const float> masses) {
  const Graph graph(links, masses.size());
  std::vector<Near> near(masses.size());
  const std::vector<bool> coarse = choose_coarse(links, graph, masses, near);
  CoarseLevel level;
  std::vector<std::uint32_t> number(masses.size(), none), cluster(masses.size());
  for (std::uint32_t i = 0; i < masses.size(); ++i)
    if (coarse[i]) number[i] = static_cast<std::uint32_t>(level.finer.size()), level.finer.push_back(i);
  if (level.finer.size() == masses.size()) return {};
  const Clusters clusters(graph, coarse);
  collapse(links, clusters, number, level);
  for (std::uint32_t i = 0; i < masses.size(); ++i) cluster[i] = number[clusters.of[i]];
  for (Link& link : level.links)
    link.length = std::min(link.length, length_between(near, level.finer[link.a], level.finer[link.b]));

  std::vector<double> mass(level.finer.size());
  level.parent_begin.push_back(0);
  for (std::uint32_t i = 0; i < masses.size(); ++i) {
    Parents parents{i};
    std::vector<float> weight{1};
    if (!coarse[i]) {
      parents.clear();
      std::vector<float> d;
      for (const Marcher::Reached& n : near[i])
        if (parents.size() < max_parents && (masses[i] > 0 || masses[n.particle] == 0))
          parents.push_back(n.particle), d.push_back(n.length);
      weight = weights_of(d, parents, near);
    }
    for (std::size_t k = 0; k < weight.size(); ++k) {
      level.parent.push_back(number[parents[k]]);
      level.weight.push_back(weight[k]);
      mass[number[parents[k]]] += static_cast<double>(weight[k]) * static_cast<double>(masses[i]);
    }
    level.parent_begin.push_back(static_cast<std::uint32_t>(level.parent.size()));
  }
  for (std::size_t j = 0; j < mass.size(); ++j)
    level.mass.push_back(masses[level.finer[j]] > 0 ? static_cast<float>(mass[j]) : 0);
  add_children(masses, level);
  distribute_energy(links, cluster, level.finer.size(), level.links);
  return level;
}

}  // namespace

std::vector<CoarseLevel> build_levels(std::span<const Link> links, std::span<const float> masses,
                                      std::size_t coarsest_size) {
  std::vector<CoarseLevel> levels;
  while (masses.size() > coarsest_size) {
    CoarseLevel level = build_level(links, masses);
    if (level.finer.empty()) break;
    levels.push_back(std::move(level));
    links = levels.back().links;
    masses = levels.back().mass;
  }
  return levels;
}

}  // namespace souple
