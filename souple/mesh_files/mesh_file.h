#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <filesystem>
#include <string>

namespace souple {

/// The up axis of a file. Souple is right-handed with Y up. Files with another axis are rotated, never mirrored: Z up
/// (x, y, z) -> (x, z, -y), X up (x, y, z) -> (-y, x, z).
enum class UpAxis { x, y, z };

/// Conversion of a mesh file's coordinates to meters.
struct MeshImport {
  double scale = 1.0;     ///< meters per unit of the file; finite and > 0
  UpAxis up = UpAxis::y;  ///< the file's up axis
  /// Reads only this object (or group) of the file: an `o` or `g` of OBJ, a node of glTF, FBX, ...; empty:
  /// the whole file.
  std::string node{};
};

/// A point of a file in Souple's axes and meters.
Vec3d imported(const Vec3d& x, const MeshImport& options);

/// Reads a triangle mesh. The extension, in any letter case, determines the format. Souple reads .obj, .ply and .stl
/// itself, and all others (.gltf, .glb, .fbx, .dae, ...) with assimp if built with it. Vertices, their order, polygons,
/// UVs, colors, groups and appearance are those of the file. FBX states its unit and its up and front axes, which are
/// heeded: `scale` and `up` then apply to meters with Y up. Vertices are not welded (an STL has three per triangle). A
/// file may hold only vertices; a file without vertices is an error. Throws Error: "FILE:LINE: ..." (text) or "FILE:
/// byte N: ..." (binary), with the text found and the text expected.
TriangleMesh read_triangle_mesh(const std::filesystem::path& path, const MeshImport& options = {});

/// Reads a tet mesh: Gmsh .msh (2.2 and 4.1, ASCII), TetGen .node and .ele, or legacy VTK .vtk (unstructured grid,
/// ASCII or binary). Either name of TetGen's files serves; both must exist. Tets are reordered to positive orientation.
/// Flat tets and other volume elements are errors. Unused vertices are kept, so that indices are those of the file.
/// Groups: Gmsh's physical groups, TetGen's regions ("region_1", ...). Throws Error like read_triangle_mesh.
TetMesh read_tet_mesh(const std::filesystem::path& path, const MeshImport& options = {});

/// Whether Souple was built with assimp.
bool mesh_import_has_assimp();

}  // namespace souple
