#pragma once

#include "souple/math/mat3.h"
#include "souple/rigid/convex_shape.h"

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

// Types that the parts of find_manifold share.

namespace souple::manifold {

/// A ConvexShape, or arrays of one on the stack.
struct ConvexView {
  std::span<const Vec3d> vertices;
  std::span<const ConvexFace> faces;
  std::span<const ConvexCorner> corners;
  std::span<const ConvexEdge> edges;
  const ConvexFace* edge_faces = nullptr;  // to which the edges refer: the faces, and the sides of a triangle
  double radius = 0;
  Vec3d center{};
  double inner_radius = 0, outer_radius = 0;

  std::span<const ConvexCorner> corners_of(const ConvexFace& face) const {
    return corners.subspan(face.begin, face.end - face.begin);
  }
};

inline ConvexView view_of(const ConvexShape& shape) {
  return {shape.vertices, shape.faces,  shape.corners,      shape.edges,       shape.faces.data(),
          shape.radius,   shape.center, shape.inner_radius, shape.outer_radius};
}

/// Maps points of one frame to another: rotation x + translation.
struct FrameChange {
  Mat3d rotation = Mat3d::identity();
  Vec3d translation{};

  Vec3d direction(const Vec3d& x) const { return rotation * x; }
  Vec3d point(const Vec3d& x) const { return rotation * x + translation; }
  /// Maps a direction back.
  Vec3d back(const Vec3d& x) const {
    return {dot(rotation.column[0], x), dot(rotation.column[1], x), dot(rotation.column[2], x)};
  }
};

inline FrameChange inverse(const FrameChange& change) {
  return {transpose(change.rotation), -change.back(change.translation)};
}

/// From the local frame of `from` to that of `to`.
inline FrameChange frame_change(const BodyPose& from, const BodyPose& to) {
  return {rotation_matrix(conjugate(to.rotation) * from.rotation), to.local_point(from.position)};
}

/// The vertex with the least product with a direction; the first of several.
struct LowestVertex {
  std::uint32_t vertex = 0;
  double height = 0;  ///< product of the vertex and the direction
};

inline LowestVertex lowest_vertex(std::span<const Vec3d> vertices, const Vec3d& direction) {
  LowestVertex lowest{0, dot(vertices[0], direction)};
  for (std::uint32_t v = 1; v < vertices.size(); ++v) {
    const double height = dot(vertices[v], direction);
    if (height < lowest.height) lowest = {v, height};
  }
  return lowest;
}

/// A list on the stack of at most N elements, which are not initialized before they are added.
template <class T, int N>
class StackList {
 public:
  static constexpr int capacity = N;
  int size() const { return size_; }
  bool full() const { return size_ == N; }
  void clear() { size_ = 0; }
  /// Keeps the first `size` elements.
  void shrink(int size) { size_ = size; }
  /// Ignores an element too many.
  void push_back(const T& item) {
    if (size_ < N) ::new (static_cast<void*>(bytes_ + sizeof(T) * static_cast<std::size_t>(size_++))) T(item);
  }
  T& operator[](int i) {
    return *std::launder(reinterpret_cast<T*>(bytes_ + sizeof(T) * static_cast<std::size_t>(i)));
  }
  const T& operator[](int i) const {
    return *std::launder(reinterpret_cast<const T*>(bytes_ + sizeof(T) * static_cast<std::size_t>(i)));
  }

 private:
  alignas(T) std::byte bytes_[sizeof(T) * static_cast<std::size_t>(N)];
  int size_ = 0;
};

/// Names of pairs of features, the same whichever shape is the reference.
enum class FeatureKind : std::uint32_t { vertex_of_b = 0, vertex_of_a = 1, edges = 2, other = 3 };

inline std::uint32_t feature_id(FeatureKind kind, std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>(kind) << 30 | (a & 0x7fff) << 15 | (b & 0x7fff);
}

}  // namespace souple::manifold
