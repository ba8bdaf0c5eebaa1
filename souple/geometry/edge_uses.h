#pragma once

#include "souple/geometry/adjacency.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// An edge of an element.
struct EdgeUse {
  std::uint32_t low, high;  ///< vertices
  std::size_t slot;         ///< element * edges of an element + edge of it
  bool forward;             ///< from the lower to the higher vertex
};

/// The edges of elements in order of their vertices, each with its uses in order of appearance. An edge may join a vertex
/// to itself.
class EdgeUses {
 public:
  /// Edge i of a triangle joins its corners i and (i + 1) % 3.
  explicit EdgeUses(std::span<const Triangle> triangles);
  /// Edge i of a tet joins its corners tet_edge[i].
  explicit EdgeUses(std::span<const Tet> tets);
  static constexpr int tet_edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

  std::size_t size() const { return begin_.size() - 1; }
  std::span<const EdgeUse> operator[](std::size_t edge) const {
    return std::span(uses_).subspan(begin_[edge], begin_[edge + 1] - begin_[edge]);
  }
  /// Calls f(uses) for each edge that joins two vertices.
  template <class Function>
  void for_each_proper(const Function& f) const {
    for (std::size_t edge = 0; edge < size(); ++edge)
      if ((*this)[edge][0].low != (*this)[edge][0].high) f((*this)[edge]);
  }

 private:
  template <class Element, class Ends>
  void find(std::span<const Element> elements, std::size_t edges, const Ends& ends);

  std::vector<EdgeUse> uses_;
  std::vector<std::size_t> begin_;  // per edge, and the end of the last one
};

}  // namespace souple
