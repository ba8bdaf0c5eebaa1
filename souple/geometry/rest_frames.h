#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <array>
#include <optional>
#include <vector>

namespace souple {

/// The directions of a woven sheet in a triangle at rest: unit vectors in its plane, at right angles, with
/// warp x weft along the triangle's normal.
struct RestFrame {
  Vec3d warp, weft;
};

/// The UVs of each triangle's corners, also where faces have more than three corners; nothing if the mesh has
/// none. Throws Error if the UV indices do not match the faces.
std::optional<std::vector<std::array<std::array<float, 2>, 3>>> triangle_uvs(const TriangleMesh& mesh);

/// One frame per triangle. Warp is where U grows (a pattern drawn in UV space lies along U); without UVs, or
/// where a triangle's UVs have no area, it is `fallback` laid into the triangle's plane, and where that
/// stands upright on it, the triangle's first edge. So a sheet without UVs still has one grain all over,
/// rather than one per triangle. Triangles without area get a zero frame. Throws Error as triangle_uvs, or if
/// an index is out of range.
std::vector<RestFrame> rest_frames(const TriangleMesh& mesh, const Vec3d& fallback = {1, 0, 0});

/// A triangle in its frame's plane: corners b - a and c - a in coordinates (warp, weft), meters.
struct FlatTriangle {
  std::array<double, 2> b, c;
};
FlatTriangle flatten(const RestFrame& frame, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace souple
