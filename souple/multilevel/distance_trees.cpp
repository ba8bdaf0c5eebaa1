#include "souple/multilevel/distance_trees.h"

#include "souple/assert.h"
#include "souple/math/disjoint_sets.h"
#include "souple/math/lists.h"
#include "souple/math/sentinels.h"

#include <algorithm>

namespace souple {
namespace {

/// Links of the shortest path that becomes a tree. In triangle meshes no two neighbors have two links each.
constexpr std::size_t shortest_path = 3;
/// Links of the shortest ring that becomes a tree. Smaller ones are bodies rather than ropes.
constexpr std::size_t shortest_ring = 8;

/// The links of each particle, ascending.
Lists<std::uint32_t> list_links(std::span<const TreeLink> links, std::span<const std::uint32_t> chosen,
                                std::size_t particles) {
  return {particles, [&](const auto& add) {
            for (const std::uint32_t e : chosen) add(links[e].a, e), add(links[e].b, e);
          }};
}

std::uint32_t other_end(const TreeLink& link, std::uint32_t i) {
  return link.a == i ? link.b : link.a;
}

/// Chooses the links of find_trees: they form no cycle.
class Chooser {
 public:
  Chooser(std::span<const TreeLink> links, std::size_t particles)
      : links_(links),
        all_(all_of(links)),
        links_of_(list_links(links, all_, particles)),
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
    for (const std::uint32_t e : links_of_[i])
      if (!removed_[e]) return e;
    return no_index;
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
    for (const std::uint32_t first : links_of_[i]) {
      if (removed_[first]) continue;
      path_.clear();
      std::uint32_t e = first, at = i;
      do {
        removed_[e] = true;
        path_.push_back(e);
        at = other_end(links_[e], at);
        e = degree_[at] == 2 ? remaining_link(at) : no_index;
      } while (e != no_index);
      if (path_.size() >= (at == i ? shortest_ring : shortest_path))
        for (const std::uint32_t link : path_) take(link);
    }
  }

  std::span<const TreeLink> links_;
  std::vector<std::uint32_t> all_;
  Lists<std::uint32_t> links_of_;
  std::vector<std::uint32_t> degree_;
  std::vector<bool> removed_;
  DisjointSets pieces_;
  std::vector<std::uint32_t> chosen_, path_;
};

/// Fills `tree`, root first, breadth first.
void grow(std::uint32_t root, std::span<const TreeLink> links, const Lists<std::uint32_t>& links_of,
          std::vector<bool>& seen, std::vector<TreeNode>& tree) {
  tree.assign(1, {.particle = root});
  seen[root] = true;
  for (std::uint32_t k = 0; k < tree.size(); ++k) {
    for (const std::uint32_t e : links_of[tree[k].particle]) {
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
  const Lists<std::uint32_t> links_of = list_links(links, chosen, particle_count);
  std::vector<bool> seen(particle_count);
  std::vector<TreeNode> tree;
  for (std::uint32_t root = 0; root < particle_count; ++root) {
    if (seen[root] || links_of[root].empty()) continue;
    grow(root, links, links_of, seen, tree);
    if (tree.size() == 2 && !links[links_of[root][0]].has_length) continue;
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
