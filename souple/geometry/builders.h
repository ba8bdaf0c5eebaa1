#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <array>

namespace souple {

// Generated meshes. Lengths are in meters; all meshes are centered at the origin, Y up. Counts are of cells
// unless stated otherwise. Closed surfaces are watertight (shared vertices, no seam) and wound outward. Every builder
// throws Error for a count below its minimum or a length that is not finite and positive. The limit is
// `max_built_vertices` vertices, triangles or tets. Open surfaces have UVs, one per vertex, in meters scaled to [0, 1]
// by the larger side.

inline constexpr double max_built_vertices = 100e6;

/// How the squares of a grid are split. Alternating diagonals favor no direction; one_way favors one and
/// serves for comparison.
enum class Diagonals { alternating, one_way };

/// A flat sheet in the XZ plane, normals +Y. Counts are of VERTICES: columns >= 2 along +X, rows >= 2 along
/// +Z; vertex index = row * columns + column. `size` is the width along X; cells are square, so the depth
/// along Z is size (rows - 1) / (columns - 1).
TriangleMesh grid(int columns, int rows, double size, Diagonals diagonals = Diagonals::alternating);

/// A flat disk in the XZ plane with normals +Y. Vertex 0 is the center. Vertex 1 + (ring - 1) segments + s is on ring
/// 1..rings at angle 2 pi s / segments from +X toward +Z. rings >= 1, segments >= 3.
TriangleMesh disk(int rings, int segments, double radius);

/// An icosphere: an icosahedron whose triangles are split into four `subdivisions` >= 0 times, vertices on
/// the sphere; 20 * 4^subdivisions triangles of nearly equal size, no poles.
TriangleMesh sphere(int subdivisions, double radius);

/// A closed box with the given side lengths, each side split into `divisions` >= 1 cells (one number, or one
/// per axis).
TriangleMesh box(const Vec3d& size, int divisions = 1);
TriangleMesh box(const Vec3d& size, const std::array<int, 3>& divisions);

/// A closed ring around the Y axis. `major_radius`: from the axis to the center of the tube; `minor_radius`: of the
/// tube, smaller than the major radius. Vertex index = i * minor_segments + j, i around the axis. Segments >= 3.
TriangleMesh torus(double major_radius, double minor_radius, int major_segments, int minor_segments);

/// A closed capsule along Y: a cylinder of the given `length` between two hemispheres (total height length +
/// 2 radius). `segments` >= 3 around, `rings` >= 1 per hemisphere, `divisions` >= 1 along the length.
TriangleMesh capsule(double radius, double length, int segments, int rings, int divisions = 1);

/// A closed cylinder along Y with flat caps. `segments` >= 3 around, `divisions` >= 1 along the height,
/// `cap_rings` >= 1 from the rim to the center of a cap.
TriangleMesh cylinder(double radius, double height, int segments, int divisions = 1, int cap_rings = 1);

/// A solid box of nx x ny x nz cells, each split into 5 tets, mirrored between neighbors (a checkerboard).
/// Vertex index = (k (ny + 1) + j) (nx + 1) + i. Mirroring makes the bar symmetric about its middle planes
/// for even counts, so it bends and stretches without twisting. The 6-tet Kuhn split, whose diagonals all
/// have one direction, couples bending to twist.
TetMesh tet_bar(int nx, int ny, int nz, const Vec3d& size);

/// A solid ball with the surface of `sphere`, in `layers` >= 1 shells of equal thickness around a center
/// vertex. Vertices are ordered shell by shell from the outside, each as in `sphere`, then the center.
TetMesh tet_ball(int subdivisions, int layers, double radius);

}  // namespace souple
