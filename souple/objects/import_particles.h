#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"
#include "souple/objects/new_object.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

// Steps that the imports of several kinds of objects share.

namespace souple {

/// Throws Error if a point is then not finite, or too far from the origin. `name`: of the object.
void transform_points(std::vector<Vec3d>& points, const Transform& transform, const std::string& name);
/// Moves a mesh to its place: positions and the normals of its file.
void place(TriangleMesh& mesh, const Transform& transform, const std::string& name);

std::vector<std::uint32_t> identity(std::size_t count);
/// Throws Error if a cube of this width [m], the width of a particle, contains more than a hundred points. The number
/// of neighbors would grow with the square. `name`: of the object.
void require_apart(std::span<const Vec3d> points, double width, const std::string& name);
/// Particles at these points, in their order.
void import_points(Object& object, std::vector<Vec3d> points);
/// Imports the welded vertices of a surface as particles, and its valid triangles over them.
void import_surface(NewObject& made, const TriangleMesh& mesh, const Transform& transform);
/// Imports the nodes of a tet mesh as particles, and its tets over them.
void import_tets(Object& object, const TetMesh& mesh);

/// Vertices without elements have no mass. They get the smallest mass of the other vertices, so that they
/// fall and collide like specks.
void fill_missing_masses(std::vector<double>& mass, const std::string& name);

}  // namespace souple
