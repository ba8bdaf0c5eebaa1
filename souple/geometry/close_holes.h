#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace souple {

/// A hole of a surface: a closed loop of its boundary.
struct Hole {
  std::vector<std::uint32_t> loop;  ///< vertices, in the direction of the triangles beside them
  Vec3d center{};                   ///< mean of the vertices [m]
  double width{};                   ///< largest distance of two opposite vertices along the loop [m]
  double area{};                    ///< of the fan of triangles about the center [m^2]
};

/// The holes of a consistently wound surface, in order of their lowest vertices. Where a surface is closed, the
/// directions of each edge cancel; the other edges form closed loops.
std::vector<Hole> find_holes(std::span<const Vec3d> positions, std::span<const Triangle> triangles);

/// A repaired surface without holes, so that it has an inside.
struct ClosedSurface {
  TriangleMesh mesh;        ///< welded and wound outward; its last vertices are the centers of `holes`
  std::vector<Hole> holes;  ///< those that were closed
  /// "Closed 2 holes (...)."; empty if there were none.
  std::vector<std::string> sentences() const;
};

/// Repairs a surface (mesh_report.h), and closes its holes with fans of triangles about their centers, such as the eyes
/// of a head. Whatever needs the inside of a mesh calls this function. Afterwards the winding number at a point is 1
/// inside and 0 outside. For the open surface it is a fraction (Jacobson et al. 2013, "Robust inside-outside segmentation
/// using generalized winding numbers", section 3).
///
/// Throws Error, starting with `name`, if the holes have a fifth of the surface's area: a sheet has no inside. Also throws
/// if there are no triangles, an index is out of range, or a position is not finite. The message names the holes.
ClosedSurface closed_surface(const TriangleMesh& mesh, const std::string& name);

/// "2 holes (0.1 m wide at (0, 1, 2), ...)"; names at most three.
std::string describe(std::span<const Hole> holes);

}  // namespace souple
