#pragma once

#include "souple/broad_phase/box_tree.h"
#include "souple/geometry/triangle_mesh.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace souple {

struct Object;
struct QueryView;

/// Where queries search: a tree of boxes over the objects, and one for each object over its triangles or, without
/// triangles, its vertices. Boxes of objects are computed at the first query after a change; the tree of an object when a
/// query reaches the object's box. Several threads may search at once.
class QueryIndex {
 public:
  struct Entry {
    const Object* object = nullptr;
    std::span<const Vec3f> x;             ///< user order [m]
    std::span<const Triangle> triangles;  ///< empty: balls
    double radius = 0;                    ///< of the balls; 0 for surfaces [m]
    Bounds box;                           ///< around x [m]
    mutable BoxTree tree;
    mutable std::atomic<std::uint64_t> version{0};  ///< QueryView::version of `tree`
  };

  /// Brings the boxes of the objects up to date.
  void refresh(const QueryView& view);
  /// After refresh: calls visit(index, entry) for the objects whose boxes may be within limit(), nearest first, as
  /// BoxTree::search. Boxes are around vertices: balls reach up to `largest_radius` beyond them.
  template <class Bound, class Limit, class Visit>
  void search(const Bound& bound, const Limit& limit, const Visit& visit) const {
    objects_.search(bound, limit, [&](std::uint32_t k) { visit(filled_[k], *entries_[filled_[k]]); });
  }
  double largest_radius() const { return largest_radius_; }
  const Entry& entry(std::size_t object) const { return *entries_[object]; }
  /// The tree of an object.
  const BoxTree& tree(const QueryView& view, const Entry& entry) const;
  std::size_t bytes() const;

 private:
  void find_boxes(const QueryView& view);

  std::vector<std::unique_ptr<Entry>> entries_;  // per object
  std::vector<std::uint32_t> filled_;            // objects that have vertices
  BoxTree objects_;                              // over filled_
  double largest_radius_ = 0;
  std::atomic<std::uint64_t> version_{0};
};

}  // namespace souple
