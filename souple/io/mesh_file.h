#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <filesystem>

namespace souple {

/// The axis that points up in a file. Souple is right-handed with Y up; the others are rotated, never
/// mirrored: Z up (x, y, z) -> (x, z, -y), X up (x, y, z) -> (-y, x, z).
enum class UpAxis { x, y, z };

/// How a mesh file's numbers become meters.
struct MeshImport {
  double scale = 1.0;     ///< meters per unit of the file; finite and > 0
  UpAxis up = UpAxis::y;  ///< the file's up axis
};

/// Reads a surface. The format follows the extension, in any case: .obj, .ply and .stl by readers of our own,
/// anything else (.gltf, .glb, .fbx, .dae, ...) through assimp, where Souple was built with it.
/// Vertices, their order, polygons, UVs, colors and groups are the file's; nothing is welded (an STL gives
/// three vertices per triangle). A file may hold vertices alone; one without vertices is an error. Throws
/// Error: "FILE:LINE: ..." (text) or "FILE: byte N: ..." (binary), what was found, what was expected.
TriangleMesh read_triangle_mesh(const std::filesystem::path& path, const MeshImport& options = {});

/// Reads a tet mesh: Gmsh .msh (2.2 and 4.1, ASCII), TetGen .node and .ele (either name, both files must be
/// there), legacy VTK .vtk (unstructured grid, ASCII or binary). Tets are turned to be positively oriented;
/// flat ones are an error, and so are other volume elements. Vertices that no tet uses are kept, so that
/// indices are the file's. Groups: Gmsh's physical groups, TetGen's regions ("region_1", ...). Throws Error
/// as read_triangle_mesh.
TetMesh read_tet_mesh(const std::filesystem::path& path, const MeshImport& options = {});

/// True where Souple was built with assimp.
bool mesh_import_has_assimp();

}  // namespace souple
