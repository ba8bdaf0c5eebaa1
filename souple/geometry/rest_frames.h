#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <optional>
#include <vector>

namespace souple {

/// The directions of a woven sheet in a triangle at rest: orthogonal unit vectors in its plane, with warp x
/// weft along the triangle's normal.
struct RestFrame {
  Vec3d warp, weft;
};

/// The UVs of each triangle's corners, also for faces with more than three corners; nullopt if the mesh has
/// no UVs. Throws Error if the UV indices do not match the faces.
std::optional<std::vector<std::array<std::array<float, 2>, 3>>> triangle_uvs(const TriangleMesh& mesh);

/// One frame per triangle. Warp is the direction of increasing U, so a pattern drawn in UV space follows U. Without
/// UVs, or if a triangle's UVs have no area, warp is `fallback` projected into the triangle's plane. If `fallback` is
/// perpendicular to the plane, it is the triangle's first edge. So a sheet without UVs has one grain direction, not one
/// per triangle. Triangles without area get a zero frame. Throws Error as triangle_uvs, or if an index is out of range.
std::vector<RestFrame> rest_frames(const TriangleMesh& mesh, const Vec3d& fallback = {1, 0, 0});

/// A triangle in its frame's plane: the corners b - a and c - a in coordinates (warp, weft) [m].
struct FlatTriangle {
  std::array<double, 2> b, c;
};
FlatTriangle flatten(const RestFrame& frame, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace souple
