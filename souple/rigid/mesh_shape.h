#pragma once

#include "souple/broad_phase/box_tree.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/rigid/manifold.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace souple {

/// Triangles of a body without mass, such as an obstacle. They may be closed or open, and wound either way.
class MeshShape {
 public:
  /// `positions`: in the body's frame [m].
  MeshShape(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

  ShapeBounds bounds() const { return {Vec3d(tree_.bounds().lo), Vec3d(tree_.bounds().hi)}; }
  std::size_t size() const { return triangles_.size(); }
  /// The triangle as it is met from the side to which it is wound, or from its back.
  ContactTriangle triangle(std::uint32_t t, bool from_back) const;
  /// Triangles of one number are connected, and wound alike.
  std::uint32_t piece(std::uint32_t t) const { return pieces_[t]; }
  /// Calls f(triangle) for all triangles whose bounding boxes touch `box`, always in the same order.
  template <class Function>
  void for_each_in(const Bounds& box, const Function& f) const {
    constexpr double skip = std::numeric_limits<double>::infinity();
    tree_.search([&](const Bounds& node) { return overlap(node, box) ? 0.0 : skip; }, [] { return 0.0; },
                 [&](std::uint32_t t) {
                   if (overlap(box_of(t), box)) f(t);
                 });
  }
  /// The vertex nearest to a point in the body's frame.
  std::uint32_t nearest_vertex(const Vec3d& point) const;
  std::size_t bytes() const;

 private:
  /// The triangle beyond each side, or none: at a border, or where three triangles meet.
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  using Neighbors = std::vector<std::array<std::uint32_t, 3>>;

  Bounds box_of(std::uint32_t t) const;
  Vec3d normal_of(std::uint32_t t) const;
  Neighbors neighbors() const;
  void wind_alike(const Neighbors& next);
  void find_leans(const Neighbors& next);

  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  // Sines of the angles between the normal and those of the neighbors, negative where a neighbor rises. They are 1 or -1
  // where the angle exceeds 90 degrees, and 2 without a neighbor.
  std::vector<std::array<double, 3>> leans_;
  std::vector<std::uint32_t> pieces_;
  BoxTree tree_;
};

}  // namespace souple
