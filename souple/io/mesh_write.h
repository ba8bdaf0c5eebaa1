#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <span>
#include <string>

/// Meshes as the bytes of a file. Numbers are the shortest that read back to the same float. What is written
/// to disk and when is the caller's affair.
namespace souple {

/// A whole OBJ: obj_vertices_text, then obj_topology_text.
/// `positions` has one entry per vertex of `mesh` (else Error) and stands in for mesh.positions.
std::string obj_text(const TriangleMesh& mesh, std::span<const Vec3f> positions);

/// A point cloud: `v` lines only.
std::string obj_text(std::span<const Vec3f> points);

/// The `v` lines alone, with the colors of `mesh`: what changes from frame to frame.
std::string obj_vertices_text(const TriangleMesh& mesh, std::span<const Vec3f> positions);

/// `vt`, `g` and `f` lines alone, the same for each frame of a sequence. Faces keep their order and corners;
/// a face is listed in each group that holds all of its corners, so that groups read back as they were.
std::string obj_topology_text(const TriangleMesh& mesh);

/// A binary little-endian PLY: float positions, uchar colors (if any), per-vertex UVs (if every vertex has
/// one of its own), faces as polygons.
std::string ply_bytes(const TriangleMesh& mesh, std::span<const Vec3f> positions);

/// A surface with normals, one for each position: `v`, `vn` and `f a//a` lines.
std::string obj_text(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                     std::span<const Triangle> triangles);

/// The same as a binary little-endian PLY: x, y, z, nx, ny, nz.
std::string ply_bytes(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                      std::span<const Triangle> triangles);

/// Particles: float positions and, unless empty, velocities as vx, vy, vz [m/s].
std::string ply_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities);

}  // namespace souple
