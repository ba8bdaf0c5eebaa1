#include "souple/multilevel/hierarchical_levels.h"

#include "souple/assert.h"
#include "souple/math/lists.h"
#include "souple/math/sentinels.h"
#include "souple/multilevel/marching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

namespace souple {
namespace {

using Reached = Marcher::Reached;

constexpr std::size_t max_parents = 4;
// Distance between coarse particles, in mean links of the finer level: keeps a fifth to an eighth of a
// cloth's particles. At 1.3 the kinks that a level leaves cancel its gain; at 2 Gauss-Seidel has too far to
// smooth.
constexpr float coarsening = 1.6f;
// Radius around a coarse particle within which lengths are marched, in its spacing. It is at least the first value.
// Until eight coarse particles are reached (with itself), as along edges, it grows up to the second. Each particle then
// has enough coarse ones around it. With 2.7 everywhere a level takes twice as long and is no better; with 1.6
// everywhere particles along edges follow too few.
constexpr float march_radius = 1.6f, border_radius = 2.7f;
constexpr std::size_t enough_coarse = 8;
// eps of find_weights.
constexpr double smoothing = 0.1;
/// Minimum number of particles per thread.
constexpr std::size_t march_chunk = 1024;

bool nearer(const Reached& p, const Reached& q) {
  return std::pair(p.length, p.particle) < std::pair(q.length, q.particle);
}

/// Distance between coarse particles around particle i.
float spacing(const LinkEnds& ends, std::uint32_t i) {
  float sum = 0;
  for (const LinkEnds::End& end : ends.of(i)) sum += end.length;
  return ends.of(i).empty() ? 0 : coarsening * sum / static_cast<float>(ends.of(i).size());
}

/// Rank of each particle, lowest chosen first: fixed particles, then free ones; of each, corners, then edges,
/// then the interior. A coarser level that reaches the edges need not extrapolate there. Edges and corners
/// have few particles within two links. Only so many ends of a neighbor count: those of thousands of triangles at one
/// edge or vertex would cost the square of their number.
std::vector<int> ranks(const LinkEnds& ends, std::span<const char> fixed, Threads& threads) {
  constexpr std::size_t counted_ends = 1024;
  const std::size_t count = ends.size();
  std::vector<std::uint32_t> around(count), max_near(count);
  threads.for_each(count, march_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> seen(count, no_index);
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
      for (const auto& n : ends.of(i))
        for (const auto& m : ends.of(n.to).first(std::min(counted_ends, ends.of(n.to).size())))
          around[i] += std::exchange(seen[m.to], i) != i;
  });
  for (std::uint32_t i = 0; i < count; ++i)
    for (const auto& n : ends.of(i)) max_near[i] = std::max(max_near[i], around[n.to]);
  std::vector<int> result(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t max_around = std::max(around[i], 1u);
    for (const auto& n : ends.of(i)) max_around = std::max(max_around, max_near[n.to]);
    const float part = static_cast<float>(around[i]) / static_cast<float>(max_around);
    result[i] = (fixed[i] != 0 ? 0 : 3) + (part < 0.45f ? 0 : part < 0.75f ? 1 : 2);
  }
  return result;
}

/// Chooses the particles of the coarser level: no two nearer than their spacing, and each as near to those
/// already chosen as that allows.
class Choice {
 public:
  Choice(const LinkEnds& ends, const LinkTriangles& triangles, std::span<const char> fixed, Threads& threads)
      : ends_(ends),
        rank_(ranks(ends, fixed, threads)),
        coarse_(triangles.size()),
        covered_(triangles.size()),
        offered_(triangles.size(), infinity),
        marcher_(triangles) {
    for (int rank = 0; rank < 6; ++rank) choose(rank);
  }
  /// Per particle: 1 if it is chosen.
  const std::vector<char>& coarse() const { return coarse_; }

 private:
  void choose(int rank) {
    for (std::uint32_t i = 0; i < coarse_.size(); ++i)
      if (rank_[i] == rank && covered_[i] == 0 && offered_[i] < infinity) front_.emplace(offered_[i], i);
    for (std::uint32_t i = 0; i < coarse_.size(); ++i) {
      while (!front_.empty()) {
        const std::uint32_t next = front_.top().second;
        front_.pop();
        keep(next);
      }
      if (rank_[i] == rank) keep(i);
    }
  }
  // The nearest particle that is not covered has a neighbor that is.
  void keep(std::uint32_t j) {
    if (covered_[j] != 0) return;
    coarse_[j] = 1;
    for (const Reached& r : marcher_.march(j, spacing(ends_, j))) covered_[r.particle] = 1;
    for (const Reached& r : marcher_.beyond()) {
      if (covered_[r.particle] != 0 || !(r.length < offered_[r.particle])) continue;
      offered_[r.particle] = r.length;
      if (rank_[r.particle] <= rank_[j]) front_.emplace(r.length, r.particle);
    }
  }

  using Entry = std::pair<float, std::uint32_t>;
  const LinkEnds& ends_;
  std::vector<int> rank_;
  std::vector<char> coarse_, covered_;
  std::vector<float> offered_;  // per particle: length from the nearest chosen one
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front_;
  Marcher marcher_;
};

/// Coarse particles around each particle, nearest first, with their lengths along the material.
class Near {
 public:
  /// `coarse`: particle of each coarse particle.
  Near(const LinkEnds& ends, const LinkTriangles& triangles, std::span<const std::uint32_t> coarse,
       std::span<const char> is_coarse, Threads& threads) {
    std::vector<March> marches((coarse.size() + chunk - 1) / chunk);
    threads.for_each(marches.size(), 1, [&](std::size_t begin, std::size_t end) {
      Marcher marcher(triangles);
      for (std::size_t c = begin; c < end; ++c)
        for (std::size_t j = c * chunk; j < std::min((c + 1) * chunk, coarse.size()); ++j) {
          const float unit = spacing(ends, coarse[j]);
          std::size_t found = 0;
          const std::span<const Reached> reached = marcher.march(
              coarse[j], march_radius * unit, border_radius * unit,
              [&](std::uint32_t particle) { return (found += is_coarse[particle] != 0) >= enough_coarse; });
          marches[c].reached.insert(marches[c].reached.end(), reached.begin(), reached.end());
          marches[c].end.push_back(marches[c].reached.size());
        }
    });
    reached_.fill(triangles.size(), [&](const auto& add) { transpose(marches, add); });
    threads.for_each(triangles.size(), march_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) std::sort(reached_[i].begin(), reached_[i].end(), nearer);
    });
  }

  /// Numbers of coarse particles.
  std::span<const Reached> of(std::uint32_t i) const { return reached_[i]; }
  /// The nearest coarse particle.
  std::uint32_t cluster(std::uint32_t i) const { return of(i).front().particle; }
  /// Length from particle i to coarse particle j; infinite if i was not reached from there.
  float length(std::uint32_t i, std::uint32_t j) const {
    for (const Reached& n : of(i))
      if (n.particle == j) return n.length;
    return infinity;
  }

 private:
  // Chunks of marches do not depend on the number of threads.
  static constexpr std::size_t chunk = 128;
  struct March {
    std::vector<Reached> reached;
    std::vector<std::size_t> end;  // per source
  };
  template <class Add>
  static void transpose(std::span<const March> marches, const Add& add) {
    std::uint32_t source = 0;
    for (const March& march : marches) {
      std::size_t k = 0;
      for (const std::size_t end : march.end) {
        for (; k < end; ++k) add(march.reached[k].particle, {source, march.reached[k].length});
        ++source;
      }
    }
  }

  Lists<Reached> reached_;  // per particle
};

/// Lengths between coarse particles: as marched, and of paths straight across two triangles of such lengths.
class CoarseLengths {
 public:
  CoarseLengths(const Near& near, std::span<const std::uint32_t> coarse, Threads& threads)
      : marched_(coarse.size()), unfolded_(coarse.size()) {
    for (std::uint32_t j = 0; j < coarse.size(); ++j)
      for (const Reached& n : near.of(coarse[j]))
        if (n.particle != j) marched_[j].push_back(n), marched_[n.particle].push_back({j, n.length});
    threads.each(coarse.size(), march_chunk / 4, [&](std::size_t j) { keep_shortest(marched_[j]); });
    threads.for_each(coarse.size(), march_chunk / 4, [&](std::size_t begin, std::size_t end) {
      Marks from_j(coarse.size(), {no_index, 0}), from_p(from_j);
      for (auto j = static_cast<std::uint32_t>(begin); j < end; ++j) unfold(j, from_j, from_p);
    });
  }
  /// Infinite if the two are too far apart.
  float operator()(std::uint32_t a, std::uint32_t b) const {
    const auto [j, k] = std::minmax(a, b);
    for (const std::vector<Reached>* lengths : {&marched_[j], &unfolded_[j]})
      for (const Reached& n : *lengths)
        if (n.particle == k) return n.length;
    return infinity;
  }

 private:
  using Marks = std::vector<std::pair<std::uint32_t, float>>;  // per coarse particle: by whom, length

  static void keep_shortest(std::vector<Reached>& lengths) {
    std::sort(lengths.begin(), lengths.end(), [](const Reached& p, const Reached& q) {
      return std::pair(p.particle, p.length) < std::pair(q.particle, q.length);
    });
    lengths.erase(std::unique(lengths.begin(), lengths.end(),
                              [](const Reached& p, const Reached& q) { return p.particle == q.particle; }),
                  lengths.end());
  }
  // From j across the edge p q to k.
  void unfold(std::uint32_t j, Marks& from_j, Marks& from_p) {
    std::vector<Reached>& result = unfolded_[j];
    for (const Reached& n : marched_[j]) from_j[n.particle] = {j, n.length};
    for (const Reached& p : marched_[j]) {
      for (const Reached& n : marched_[p.particle]) from_p[n.particle] = {p.particle, n.length};
      for (const Reached& q : marched_[j]) {
        if (q.particle <= p.particle || from_p[q.particle].first != p.particle) continue;
        for (const Reached& k : marched_[q.particle])
          if (k.particle > j && from_j[k.particle].first != j && from_p[k.particle].first == p.particle) {
            const float length = unfolded_length(p.length, q.length, from_p[q.particle].second,
                                                 from_p[k.particle].second, k.length);
            if (length < infinity) result.push_back({k.particle, length});
          }
      }
      // A neighbor of another j may be p again.
      for (const Reached& n : marched_[p.particle]) from_p[n.particle].first = no_index;
    }
    keep_shortest(result);
  }

  std::vector<std::vector<Reached>> marched_, unfolded_;  // ascending; unfolded: of the higher numbers only
};

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

/// The coarse particles that a particle follows, nearest first.
struct Parents {
  std::size_t count = 0;
  std::array<std::uint32_t, max_parents> number{};
  std::array<float, max_parents> length{}, weight{};

  float sum_of_weights() const { return std::accumulate(weight.begin(), weight.begin() + count, 0.0f); }
  void erase(std::size_t k) {
    --count;
    for (; k < count; ++k) number[k] = number[k + 1], length[k] = length[k + 1];
  }
};

/// Weights that reproduce a particle's position from those of its parents at x_j, from distances alone:
///   minimize |sum_j w_j (x_j - x_i)|^2 + eps sum_j w_j^2 |x_j - x_i|^2,   sum_j w_j = 1,   w_j >= 0.
/// With G_jk = (d_ij^2 + d_ik^2 - d_jk^2)/2 the first term is w^T G w. Müller 2008, section 4.3 uses 1/d_ij,
/// which is wrong even for a uniform stretch unless the parents surround the particle evenly.
void find_weights(const CoarseLengths& lengths, Parents& parents) {
  for (;;) {
    const std::size_t n = parents.count;
    std::array<std::array<double, max_parents>, max_parents> G{};
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k <= j; ++k) {
        const auto dj = static_cast<double>(parents.length[j]), dk = static_cast<double>(parents.length[k]);
        const double djk =
            j == k ? 0
                   : std::min(static_cast<double>(lengths(parents.number[j], parents.number[k])), dj + dk);
        G[j][k] = G[k][j] = 0.5 * (dj * dj + dk * dk - djk * djk) + (j == k ? smoothing * dj * dj : 0);
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
      for (std::size_t j = 0; j < n; ++j) parents.weight[j] = static_cast<float>(w[j] / sum);
      return;
    }
    if (n == 1) {
      parents.weight[0] = 1;
      return;
    }
    parents.erase(worst);
  }
}

/// Builds one level; `number`: per particle, its number in the coarse level, or `no_index`.
class LevelBuilder {
 public:
  LevelBuilder(std::span<const Link> links, std::span<const char> fixed, Threads& threads)
      : links_(links),
        fixed_(fixed),
        threads_(threads),
        ends_(links, fixed.size(), threads),
        triangles_(links, ends_, threads) {}

  CoarseLevel build();

 private:
  void collapse(const Near& near, const CoarseLengths& lengths);
  void add_path(const Near& near, std::uint32_t i, std::uint32_t j, float& length);
  void add_shortest_path(std::uint32_t i, std::uint32_t end, float& length);
  void find_parents(const Near& near, const CoarseLengths& lengths, std::span<const std::uint32_t> number);
  void find_children();

  std::span<const Link> links_;
  std::span<const char> fixed_;
  Threads& threads_;
  LinkEnds ends_;
  LinkTriangles triangles_;
  CoarseLevel level_;
  /// State of a particle in a search for a path.
  struct Visit {
    std::uint32_t search = 0;  // number of the last search that came here
    float length = 0;
    std::uint32_t from = no_index, link = no_index;
  };
  std::vector<Visit> visits_;
  std::uint32_t searches_ = 0;
};

// Müller 2008, section 4.2: a removed particle collapses into its nearest parent together with its links. If
// two coarse particles get several links, the link with the shortest path along finer links is kept.
void LevelBuilder::collapse(const Near& near, const CoarseLengths& lengths) {
  struct Candidate {
    std::uint32_t a, b, link;
    float length;
  };
  const std::size_t count = level_.finer.size();
  const Lists<Candidate> candidates(count, [&](const auto& add) {
    for (std::uint32_t e = 0; e < links_.size(); ++e) {
      const Link& link = links_[e];
      const auto [a, b] = std::minmax({near.cluster(link.a), near.cluster(link.b)});
      if (a != b)
        add(a, {a, b, e, near.of(link.a).front().length + link.length + near.of(link.b).front().length});
    }
  });
  std::vector<std::uint32_t> place(count, no_index);
  level_.energy_to.assign(links_.size(), no_index);
  std::vector<Candidate> best;
  level_.path_begin.push_back(0);
  for (std::uint32_t a = 0; a < count; ++a) {
    best.clear();
    for (const Candidate& candidate : candidates[a]) {
      const std::uint32_t at = place[candidate.b];
      if (at >= best.size() || best[at].b != candidate.b) {
        place[candidate.b] = static_cast<std::uint32_t>(best.size());
        best.push_back(candidate);
      } else if (candidate.length < best[at].length) {
        best[at] = candidate;
      }
    }
    std::sort(best.begin(), best.end(), [](const Candidate& p, const Candidate& q) { return p.b < q.b; });
    const std::size_t first = level_.links.size();
    for (std::size_t k = 0; k < best.size(); ++k) {
      const Link& link = links_[best[k].link];
      place[best[k].b] = static_cast<std::uint32_t>(k);
      float length = link.length;
      level_.path.push_back(best[k].link);
      add_path(near, link.a, near.cluster(link.a), length);
      add_path(near, link.b, near.cluster(link.b), length);
      level_.path_begin.push_back(static_cast<std::uint32_t>(level_.path.size()));
      level_.links.push_back({a, best[k].b, std::min(length, lengths(a, best[k].b))});
    }
    for (const Candidate& candidate : candidates[a])
      level_.energy_to[candidate.link] = static_cast<std::uint32_t>(first + place[candidate.b]);
  }
  for (std::uint32_t e = 0; e < links_.size(); ++e)
    if (level_.energy_to[e] == no_index)
      level_.energy_to[e] = static_cast<std::uint32_t>(level_.links.size()) + near.cluster(links_[e].a);
}

// The links from particle i to coarse particle j, each towards the neighbor that is nearest to j along it. Across an
// obtuse corner a particle may be nearer to j than all its neighbors: the length goes through the edge opposite of it.
void LevelBuilder::add_path(const Near& near, std::uint32_t i, std::uint32_t j, float& length) {
  float left = near.length(i, j);
  while (left > 0) {
    float shortest = infinity, next_left = left;
    const LinkTriangles::Neighbor* next = nullptr;
    for (const LinkTriangles::Neighbor& n : triangles_.of(i)) {
      const float from_there = near.length(n.to, j);
      if (from_there < left && n.length + from_there < shortest)
        shortest = n.length + from_there, next_left = from_there, next = &n;
    }
    if (next == nullptr) return add_shortest_path(i, level_.finer[j], length);
    level_.path.push_back(next->link);
    length += next->length, left = next_left, i = next->to;
  }
}

// The shortest path along links (Dijkstra).
void LevelBuilder::add_shortest_path(std::uint32_t i, std::uint32_t end, float& length) {
  visits_.resize(fixed_.size());
  ++searches_;
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  visits_[i] = {searches_, 0, no_index, no_index};
  front.emplace(0.0f, i);
  while (!front.empty() && front.top().second != end) {
    const auto [reached, u] = front.top();
    front.pop();
    if (reached > visits_[u].length) continue;
    for (const LinkTriangles::Neighbor& n : triangles_.of(u)) {
      Visit& visit = visits_[n.to];
      if (visit.search == searches_ && visit.length <= reached + n.length) continue;
      visit = {searches_, reached + n.length, u, n.link};
      front.emplace(visit.length, n.to);
    }
  }
  SOUPLE_ASSERT(visits_[end].search == searches_, "links connect particles that a march connects");
  length += visits_[end].length;
  for (std::uint32_t k = end; k != i; k = visits_[k].from) level_.path.push_back(visits_[k].link);
}

void LevelBuilder::find_parents(const Near& near, const CoarseLengths& lengths,
                                std::span<const std::uint32_t> number) {
  std::vector<Parents> parents(fixed_.size());
  threads_.for_each(parents.size(), march_chunk, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      Parents& of = parents[i];
      if (number[i] != no_index) {
        of.count = 1, of.number[0] = number[i], of.weight[0] = 1;
        continue;
      }
      for (const Reached& n : near.of(i)) {
        if (of.count == max_parents) break;
        if (fixed_[i] != 0 && fixed_[level_.finer[n.particle]] == 0) continue;
        of.number[of.count] = n.particle, of.length[of.count++] = n.length;
      }
      find_weights(lengths, of);
    }
  });
  level_.parent_begin.push_back(0);
  for (const Parents& of : parents) {
    SOUPLE_ASSERT(of.count > 0 && std::abs(of.sum_of_weights() - 1) < 1e-4f, "weights of parents sum to 1");
    for (std::size_t k = 0; k < of.count; ++k) {
      level_.parent.push_back(of.number[k]);
      level_.weight.push_back(of.weight[k]);
    }
    level_.parent_begin.push_back(static_cast<std::uint32_t>(level_.parent.size()));
  }
}

// The transpose of the parents.
void LevelBuilder::find_children() {
  const std::size_t count = level_.finer.size();
  const auto follows = [&](std::size_t i, std::uint32_t j) {
    return fixed_[level_.finer[j]] != fixed_particle ? fixed_[i] != fixed_particle : level_.finer[j] == i;
  };
  level_.child_begin.assign(count + 1, 0);
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    for (std::uint32_t k = level_.parent_begin[i]; k < level_.parent_begin[i + 1]; ++k)
      if (follows(i, level_.parent[k])) ++level_.child_begin[level_.parent[k] + 1];
  std::partial_sum(level_.child_begin.begin(), level_.child_begin.end(), level_.child_begin.begin());
  level_.child.resize(level_.child_begin[count]);
  std::vector<std::uint32_t> next(level_.child_begin.begin(), level_.child_begin.end() - 1);
  for (std::uint32_t i = 0; i < fixed_.size(); ++i)
    for (std::uint32_t k = level_.parent_begin[i]; k < level_.parent_begin[i + 1]; ++k)
      if (follows(i, level_.parent[k])) level_.child[next[level_.parent[k]]++] = i;
}

CoarseLevel LevelBuilder::build() {
  const std::vector<char> coarse = Choice(ends_, triangles_, fixed_, threads_).coarse();
  std::vector<std::uint32_t> number(fixed_.size(), no_index);
  for (std::uint32_t i = 0; i < fixed_.size(); ++i)
    if (coarse[i] != 0)
      number[i] = static_cast<std::uint32_t>(level_.finer.size()), level_.finer.push_back(i);
  const Near near(ends_, triangles_, level_.finer, coarse, threads_);
  const CoarseLengths lengths(near, level_.finer, threads_);
  collapse(near, lengths);
  find_parents(near, lengths, number);
  find_children();
  SOUPLE_ASSERT(level_.path_begin.size() == level_.links.size() + 1, "one path per coarse link");
  return std::move(level_);
}

}  // namespace

// The energy of the finer links goes to the coarse links. A link between the clusters of two coarse particles gives its
// energy to the link of these two. A link within a cluster gives it to all links of its coarse particle.
void take_energies(std::span<const Link> finer, CoarseLevel& level) {
  const std::size_t count = level.links.size();
  std::vector<double> energy(count + level.finer.size());  // per coarse link, then inside each cluster
  std::vector<std::uint32_t> ends(level.finer.size());
  for (std::size_t e = 0; e < finer.size(); ++e)
    energy[level.energy_to[e]] += static_cast<double>(finer[e].energy);
  for (const Link& link : level.links) ++ends[link.a], ++ends[link.b];
  const auto share = [&](std::uint32_t j) { return energy[count + j] / static_cast<double>(ends[j]); };
  for (std::size_t e = 0; e < count; ++e) {
    Link& link = level.links[e];
    link.energy = static_cast<float>(energy[e] + share(link.a) + share(link.b));
    link.stiffness = finer[level.path[level.path_begin[e]]].stiffness;
  }
}

std::vector<char> classes_of(std::span<const Link> links, std::span<const float> masses) {
  constexpr float heavy = 30;  // times the lightest neighbor's mass
  std::vector<float> lightest(masses.size(), infinity);
  for (const Link& link : links) {
    if (masses[link.b] > 0) lightest[link.a] = std::min(lightest[link.a], masses[link.b]);
    if (masses[link.a] > 0) lightest[link.b] = std::min(lightest[link.b], masses[link.a]);
  }
  std::vector<char> classes;
  for (std::size_t i = 0; i < masses.size(); ++i)
    classes.push_back(!(masses[i] > 0)                  ? fixed_particle
                      : masses[i] > heavy * lightest[i] ? heavy_particle
                                                        : free_particle);
  return classes;
}

CoarseLevel build_level(std::span<const Link> links, std::span<const char> classes, Threads& threads) {
  return LevelBuilder(links, classes, threads).build();
}

// A free coarse particle has the masses of its followers by their weights, and is their mean by these masses.
void take_masses(std::span<const float> finer, CoarseLevel& level) {
  std::vector<double> mass(level.finer.size());
  for (std::size_t i = 0; i < finer.size(); ++i)
    for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k)
      mass[level.parent[k]] += static_cast<double>(level.weight[k]) * static_cast<double>(finer[i]);
  level.mass.resize(mass.size());
  for (std::size_t j = 0; j < mass.size(); ++j)
    level.mass[j] = finer[level.finer[j]] > 0 ? static_cast<float>(mass[j]) : 0;
  level.child_weight.resize(level.child.size());
  std::vector<std::uint32_t> next(level.child_begin.begin(), level.child_begin.end() - 1);
  for (std::uint32_t i = 0; i < finer.size(); ++i)
    for (std::uint32_t k = level.parent_begin[i]; k < level.parent_begin[i + 1]; ++k) {
      const std::uint32_t j = level.parent[k];
      if (next[j] == level.child_begin[j + 1] || level.child[next[j]] != i) continue;
      level.child_weight[next[j]++] = level.mass[j] > 0 ? level.weight[k] * finer[i] / level.mass[j] : 1;
    }
}

std::vector<CoarseLevel> build_levels(std::span<const Link> links, std::span<const float> masses,
                                      std::size_t coarsest_size, Threads& threads) {
  std::vector<CoarseLevel> levels;
  std::vector<char> classes;
  while (masses.size() > coarsest_size) {
    if (levels.empty()) {
      classes = classes_of(links, masses);
    } else {
      std::vector<char> next;
      for (const std::uint32_t i : levels.back().finer) next.push_back(classes[i]);
      classes = std::move(next);
    }
    CoarseLevel level = build_level(links, classes, threads);
    if (level.finer.size() == masses.size()) break;
    take_masses(masses, level), take_energies(links, level);
    levels.push_back(std::move(level));
    links = levels.back().links;
    masses = levels.back().mass;
  }
  return levels;
}

}  // namespace souple
