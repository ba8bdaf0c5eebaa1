#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <string>

/// Meshes as the bytes of a file. Numbers are the shortest decimals that read back to an equal float. Callers
/// write the bytes to disk.
namespace souple {

/// A complete OBJ: obj_vertices_text, then obj_topology_text. `positions` replaces mesh.positions and has one
/// entry per vertex of `mesh`; throws Error otherwise.
std::string obj_text(const TriangleMesh& mesh, std::span<const Vec3f> positions);

/// A point cloud: `v` lines only.
std::string obj_text(std::span<const Vec3f> points);

/// The `v` lines with the colors of `mesh`: the part that changes from frame to frame.
std::string obj_vertices_text(const TriangleMesh& mesh, std::span<const Vec3f> positions);

/// The `mtllib`, `vt`, `vn`, `g`, `usemtl`, `s` and `f` lines: the constant part of a sequence. Faces keep
/// their order and corners. A face is listed in each group that holds all its corners, so that groups read
/// back unchanged; `usemtl` alone gives the groups of materials.
std::string obj_topology_text(const TriangleMesh& mesh);

/// A binary little-endian PLY. It has float positions, faces as polygons and, unless empty, velocities as vx, vy, vz
/// [m/s]. It has uchar colors, if any, and per-vertex UVs if each vertex has exactly one.
std::string ply_bytes(const TriangleMesh& mesh, std::span<const Vec3f> positions,
                      std::span<const Vec3f> velocities = {});

/// A surface with a normal per position: `v`, `vn` and `f a//a` lines.
std::string obj_text(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                     std::span<const Triangle> triangles);

/// A surface with a normal per position as a binary little-endian PLY. It has x, y, z, nx, ny, nz and, unless empty,
/// velocities as vx, vy, vz [m/s].
std::string ply_bytes(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                      std::span<const Triangle> triangles, std::span<const Vec3f> velocities);

/// Particles: float positions and, unless empty, velocities as vx, vy, vz [m/s] and kinds as uchar kind.
std::string ply_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities,
                      std::span<const std::uint8_t> kinds = {});

}  // namespace souple
