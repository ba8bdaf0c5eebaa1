#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <array>

namespace souple {

// Meshes made from numbers. Lengths in meters; all are centered at the origin, Y up. Counts are of cells
// unless said otherwise. Closed surfaces are watertight (vertices shared, no seam) and wound outward. Every
// builder throws Error for a count below its minimum, a length that is not finite and positive, or more than
// `max_built_vertices` vertices or triangles or tets.
// The open ones carry UVs, one per vertex, in meters scaled to [0, 1] by the larger side.

inline constexpr double max_built_vertices = 100e6;

/// How the squares of a grid are cut. Alternating has no preferred direction; one_way does, and is there to
/// compare with.
enum class Diagonals { alternating, one_way };

/// A flat sheet in the XZ plane, normals +Y. Counts VERTICES: columns >= 2 along +X, rows >= 2 along +Z;
/// vertex index = row * columns + column. `size` is the width along X; cells are square, so the depth along Z
/// is size (rows - 1) / (columns - 1).
TriangleMesh grid(int columns, int rows, double size, Diagonals diagonals = Diagonals::alternating);

/// A flat disk in the XZ plane, normals +Y: vertex 0 is the center, vertex 1 + (ring - 1) segments + s lies
/// on ring 1..rings at angle 2 pi s / segments from +X towards +Z. rings >= 1, segments >= 3.
TriangleMesh disk(int rings, int segments, double radius);

/// An icosphere: an icosahedron whose triangles are cut in four `subdivisions` >= 0 times, vertices on the
/// sphere; 20 * 4^subdivisions triangles of nearly equal size, no poles.
TriangleMesh sphere(int subdivisions, double radius);

/// A closed box with the given side lengths, each side cut in `divisions` >= 1 (the same, or per axis).
TriangleMesh box(const Vec3d& size, int divisions = 1);
TriangleMesh box(const Vec3d& size, const std::array<int, 3>& divisions);

/// A closed ring around the Y axis: `major_radius` from the axis to the middle of the tube, `minor_radius` of
/// the tube, smaller than the major one. Vertex index = i * minor_segments + j, i around the axis.
/// Segments >= 3.
TriangleMesh torus(double major_radius, double minor_radius, int major_segments, int minor_segments);

/// A closed capsule along Y: a cylinder of the given `length` between two half spheres (total height
/// length + 2 radius). `segments` >= 3 around, `rings` >= 1 per half sphere, `divisions` >= 1 along the
/// length.
TriangleMesh capsule(double radius, double length, int segments, int rings, int divisions = 1);

/// A closed cylinder along Y with flat caps. `segments` >= 3 around, `divisions` >= 1 along the height,
/// `cap_rings` >= 1 from the rim to the middle of a cap.
TriangleMesh cylinder(double radius, double height, int segments, int divisions = 1, int cap_rings = 1);

/// A solid box of nx x ny x nz cells, each cut in 5 tets, the cut mirrored from cell to neighbor (a
/// checkerboard). Vertex index = (k (ny + 1) + j) (nx + 1) + i. The mirroring makes the bar symmetric about
/// its middle planes for even counts, so it bends and stretches without twisting; the 6-tet Kuhn cut, whose
/// diagonals all point the same way, couples bending to twist.
TetMesh tet_bar(int nx, int ny, int nz, const Vec3d& size);

/// A solid ball whose surface is that of `sphere`, in `layers` >= 1 shells of equal thickness about a vertex
/// in the middle. Vertices shell by shell from the outer one inwards, each as in `sphere`, the middle last.
TetMesh tet_ball(int subdivisions, int layers, double radius);

}  // namespace souple
