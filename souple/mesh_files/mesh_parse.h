#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"

#include <string>
#include <string_view>

/// The parsers behind mesh_file.h, for bytes in memory. Each takes the content of a file and its name for
/// error messages, and returns a mesh in the file's units or throws Error. For any input they never read
/// outside the bytes, and memory and time stay proportional to the number of bytes.
namespace souple {

/// Wavefront OBJ. Reads `v` with optional colors, `vt`, and `f` with every index form. `o`, `g` and `usemtl` are vertex
/// groups; a material's group is "material:NAME". `p` and `l` count for their groups only. `mtllib`, `usemtl`, `s` and
/// `vn` are the appearance of faces, without normals that are zero or missing. Curves and display attributes are
/// skipped; an unknown word is an error.
TriangleMesh parse_obj(std::string_view text, const std::string& name);

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian; any property type and any extra element.
TriangleMesh parse_ply(std::string_view bytes, const std::string& name);

/// STL, ASCII or binary (recognized by its length, because a binary file may also begin with "solid"). Named
/// ASCII solids become groups.
TriangleMesh parse_stl(std::string_view bytes, const std::string& name);

/// Gmsh MSH 2.2 or 4.1, ASCII.
TetMesh parse_msh(std::string_view text, const std::string& name);

/// TetGen's pair of files; the first node's index, 0 or 1, is the base of all indices.
TetMesh parse_tetgen(std::string_view node_text, const std::string& node_name, std::string_view ele_text,
                     const std::string& ele_name);

/// Legacy VTK, unstructured grid, ASCII or binary, with the CELLS layout before or since version 5.1.
TetMesh parse_vtk(std::string_view bytes, const std::string& name);

}  // namespace souple
