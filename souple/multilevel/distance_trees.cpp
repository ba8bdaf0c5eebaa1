#include "souple/multilevel/distance_trees.h"

#include "souple/assert.h"

#include <algorithm>
#include <numeric>

namespace souple {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
/// Links of the shortest path that becomes a tree. In triangle meshes no two neighbors have two links each.
constexpr std::size_t shortest_path = 3;
/// Links of the shortest ring that becomes a tree. Smaller ones are bodies rather than ropes.
constexpr std::size_t shortest_ring = 8;

/// The links of each particle, ascending.
class LinksOf {
 public:
  LinksOf(std::span<const TreeLink> links, std::span<const std::uint32_t> chosen, std::size_t particles)
      : begin_(particles + 1), items_(2 * chosen.size()) {
    for (const std::uint32_t e : chosen) ++begin_[links[e].a + 1], ++begin_[links[e].b + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (const std::uint32_t e : chosen) items_[next[links[e].a]++] = items_[next[links[e].b]++] = e;
  }
  std::span<const std::uint32_t> operator()(std::uint32_t i) const {
    return std::span(items_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }

 private:
  std::vector<std::uint32_t> begin_, items_;
};

std::uint32_t other_end(const TreeLink& link, std::uint32_t i) {
  return link.a == i ? link.b : link.a;
}

/// Joins particles to pieces.
class Pieces {
 public:
  explicit Pieces(std::size_t particles) : root_(particles) { std::iota(root_.begin(), root_.end(), 0u); }
  /// False if the two were joined already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    root_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::uint32_t root(std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  std::vector<std::uint32_t> root_;
};

/// Chooses the links of find_trees: they form no cycle.
class Chooser {
 public:
  Chooser(std::span<const TreeLink> links, std::size_t particles)
      : links_(links),
        all_(all_of(links)),
        links_of_(links, all_, particles),
        degree_(particles),
        removed_(links.size()),
        pieces_(particles) {
    for (const std::uint32_t e : all_) ++degree_[links[e].a], ++degree_[links[e].b];
  }

  /// Ascending.
  std::vector<std::uint32_t> choose() {
    for (std::uint32_t i = 0; i < degree_.size(); ++i) strip(i);
    for (std::uint32_t i = 0; i < degree_.size(); ++i)
      if (degree_[i] > 2) walk_from(i);
    for (std::uint32_t i = 0; i < degree_.size(); ++i)
      if (degree_[i] == 2) walk_from(i);  // rings
    std::sort(chosen_.begin(), chosen_.end());
    return std::move(chosen_);
  }

 private:
  static std::vector<std::uint32_t> all_of(std::span<const TreeLink> links) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t e = 0; e < links.size(); ++e)
      if (links[e].a != links[e].b) all.push_back(e);
    return all;
  }
  std::uint32_t remaining_link(std::uint32_t i) const {
    for (const std::uint32_t e : links_of_(i))
      if (!removed_[e]) return e;
    return none;
  }
  void take(std::uint32_t e) {
    if (pieces_.join(links_[e].a, links_[e].b)) chosen_.push_back(e);
  }
  // Removes particle i while it has one link, then its neighbor, and so on.
  void strip(std::uint32_t i) {
    while (degree_[i] == 1) {
      const std::uint32_t e = remaining_link(i);
      removed_[e] = true;
      take(e);
      --degree_[i];
      i = other_end(links_[e], i);
      --degree_[i];
    }
  }
  // The unbranched paths that begin at particle i.
  void walk_from(std::uint32_t i) {
    for (const std::uint32_t first : links_of_(i)) {
      if (removed_[first]) continue;
      path_.clear();
      std::uint32_t e = first, at = i;
      do {
        removed_[e] = true;
        path_.push_back(e);
        at = other_end(links_[e], at);
        e = degree_[at] == 2 ? remaining_link(at) : none;
      } while (e != none);
      if (path_.size() >= (at == i ? shortest_ring : shortest_path))
        for (const std::uint32_t link : path_) take(link);
    }
  }

  std::span<const TreeLink> links_;
  std::vector<std::uint32_t> all_;
  LinksOf links_of_;
  std::vector<std::uint32_t> degree_;
  std::vector<bool> removed_;
  Pieces pieces_;
  std::vector<std::uint32_t> chosen_, path_;
};

/// Fills `tree`, root first, breadth first.
void grow(std::uint32_t root, std::span<const TreeLink> links, const LinksOf& links_of,
          std::vector<bool>& seen, std::vector<TreeNode>& tree) {
  tree.assign(1, {.particle = root});
  seen[root] = true;
  for (std::uint32_t k = 0; k < tree.size(); ++k) {
    for (const std::uint32_t e : links_of(tree[k].particle)) {
      const std::uint32_t child = other_end(links[e], tree[k].particle);
      if (seen[child]) continue;
      seen[child] = true;
      tree.push_back({child, k, links[e].set, links[e].constraint});
    }
  }
}

}  // namespace

DistanceTrees find_trees(std::span<const TreeLink> links, std::size_t particle_count) {
  const std::vector<std::uint32_t> chosen = Chooser(links, particle_count).choose();
  DistanceTrees trees;
  if (chosen.empty()) return trees;
  const LinksOf links_of(links, chosen, particle_count);
  std::vector<bool> seen(particle_count);
  std::vector<TreeNode> tree;
  for (std::uint32_t root = 0; root < particle_count; ++root) {
    if (seen[root] || links_of(root).empty()) continue;
    grow(root, links, links_of, seen, tree);
    if (tree.size() == 2 && !links[links_of(root)[0]].has_length) continue;
    const auto last = static_cast<std::uint32_t>(trees.nodes.size() + tree.size() - 1);
    for (auto node = tree.rbegin(); node != tree.rend(); ++node) {
      trees.nodes.push_back(*node);
      trees.nodes.back().parent = last - node->parent;
      SOUPLE_ASSERT(trees.nodes.back().parent >= trees.nodes.size() - 1,
                    "children come before their parents");
    }
    trees.begin.push_back(last + 1);
  }
  return trees;
}

}  // namespace souple
