#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <string>
#include <string_view>

/// The readers behind mesh_file.h, on a file's bytes in memory. Each takes what the file holds and the name
/// that errors give it; each returns a whole mesh in the file's own units, or throws Error. Whatever the
/// bytes are, they never read outside them and never take memory or time out of proportion to their number.
namespace souple {

/// Wavefront OBJ. `v` with optional colors, `vt`, `f` with every index form, `o`, `g` and `usemtl` (as
/// vertex groups; a material's is named "material:NAME"), `p` and `l` (for their groups only). Normals,
/// curves and display attributes are skipped; a word that OBJ does not know is an error.
TriangleMesh parse_obj(std::string_view text, const std::string& name);

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian; any property type and any extra element.
TriangleMesh parse_ply(std::string_view bytes, const std::string& name);

/// STL, ASCII or binary (known by its length, since a binary file may begin with "solid" too). Named ASCII
/// solids become groups.
TriangleMesh parse_stl(std::string_view bytes, const std::string& name);

/// Gmsh MSH 2.2 or 4.1, ASCII.
TetMesh parse_msh(std::string_view text, const std::string& name);

/// TetGen's pair of files; indices start at 0 or 1, as the first node says.
TetMesh parse_tetgen(std::string_view node_text, const std::string& node_name, std::string_view ele_text,
                     const std::string& ele_name);

/// Legacy VTK, unstructured grid, ASCII or binary, with CELLS as before or since version 5.1.
TetMesh parse_vtk(std::string_view bytes, const std::string& name);

}  // namespace souple
