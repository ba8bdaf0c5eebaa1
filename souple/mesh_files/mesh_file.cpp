#include "souple/mesh_files/mesh_file.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/geometry/submesh.h"
#include "souple/mesh_files/assimp_reader.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_text.h"
#include "souple/mesh_files/read_mesh_bytes.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>

#include <fmt/core.h>

namespace souple {

namespace {

// Formats of assimp, for the error message of builds without it.
constexpr const char* assimp_examples = ".gltf, .glb, .fbx, .dae, .3ds, .blend, .off, .x3d";

template <class T>
Vec3<T> with_y_up(const Vec3<T>& x, UpAxis up) {
  if (up == UpAxis::z) return {x.x, x.z, -x.y};
  if (up == UpAxis::x) return {-x.y, x.x, x.z};
  return x;
}

void import_positions(std::vector<Vec3d>& positions, const MeshImport& options) {
  for (Vec3d& p : positions) p = imported(p, options);
}

/// Material files in a mesh file are relative to its folder.
void find_material_files(std::vector<std::string>& files, const std::filesystem::path& mesh_file) {
  for (std::string& file : files)
    file = std::filesystem::absolute(mesh_file.parent_path() / file).lexically_normal().string();
}

/// The part of a mesh in the group `node`.
TriangleMesh part_of(const TriangleMesh& mesh, const std::string& node, const std::string& file) {
  const auto group = mesh.groups.find(node);
  if (group != mesh.groups.end()) return submesh(mesh, group->second);
  std::string names;
  constexpr std::size_t most = 20;
  std::size_t count = 0;
  for (const auto& [name, vertices] : mesh.groups) {
    if (name.starts_with("material:") || ++count > most) continue;
    names += (names.empty() ? "\"" : ", \"") + name + "\"";
  }
  if (count > most) names += fmt::format(" and {} more", count - most);
  throw Error(fmt::format("{}: holds no object \"{}\"; expected {}", file, node,
                          names.empty() ? "no \"node\": the file names no objects" : "one of " + names));
}

void check_scale(const std::filesystem::path& path, const MeshImport& options) {
  // Up to 1e18 units of 1e9 m still fit a float.
  constexpr double largest_scale = 1e9;
  if (options.scale > 0.0 && options.scale <= largest_scale) return;
  throw Error(fmt::format(
      "{}: found the scale {}, expected meters per unit of the file, greater than 0 and at most 1e9",
      path.string(), options.scale));
}

TriangleMesh read_surface(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path), name = path.string();
  if (extension == ".obj") return parse_obj(read_mesh_bytes(path), name);
  if (extension == ".ply") return parse_ply(read_mesh_bytes(path), name);
  if (extension == ".stl") return parse_stl(read_mesh_bytes(path), name);
  if (extension == ".msh" || extension == ".node" || extension == ".ele" || extension == ".vtk") {
    throw Error(name + ": found a tet mesh by its extension " + extension +
                ", expected a surface (.obj, .ply, .stl)");
  }
  if (mesh_detail::assimp_knows(extension)) {
    read_mesh_bytes(path);  // for its errors, which are more specific than assimp's
    return mesh_detail::read_with_assimp(path);
  }
  const std::string known =
      std::string("expected .obj, .ply, .stl or, through assimp, another such as ") + assimp_examples;
  if (mesh_import_has_assimp())
    throw Error(name + ": found the unknown extension \"" + extension + "\", " + known);
  throw Error(name + ": found the extension \"" + extension + "\", which this build does not read, " + known +
              "; assimp was not there when Souple was built: install the Debian package libassimp-dev and "
              "build again");
}

TetMesh read_tetgen(const std::filesystem::path& path) {
  std::filesystem::path node_path = path, ele_path = path;
  // The other file's extension follows the case of the one given.
  const bool capitals = path.extension() == ".NODE" || path.extension() == ".ELE";
  if (lower_extension(path) == ".node")
    ele_path.replace_extension(capitals ? ".ELE" : ".ele");
  else
    node_path.replace_extension(capitals ? ".NODE" : ".node");
  const std::string nodes = read_mesh_bytes(node_path), tets = read_mesh_bytes(ele_path);
  return parse_tetgen(nodes, node_path.string(), tets, ele_path.string());
}

TetMesh read_volume(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".msh") return parse_msh(read_mesh_bytes(path), path.string());
  if (extension == ".vtk") return parse_vtk(read_mesh_bytes(path), path.string());
  if (extension == ".node" || extension == ".ele") return read_tetgen(path);
  throw Error(path.string() + ": found the unknown extension \"" + extension +
              "\", expected a tet mesh: .msh (Gmsh), .node or .ele (TetGen) or .vtk");
}

/// Whether the path is a link to a file outside its folder.
bool links_elsewhere(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_symlink(std::filesystem::symlink_status(path, error))) return false;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const std::filesystem::path target = std::filesystem::canonical(path, error),
                              within = std::filesystem::canonical(folder, error);
  return !error &&
         std::mismatch(within.begin(), within.end(), target.begin(), target.end()).first != within.end();
}

/// Treats a file too large for memory as invalid input. A scene of a stranger could link to any file: a message about
/// such a file does not repeat what the file holds.
template <class Read>
auto within_memory(const std::filesystem::path& path, Read read) {
  try {
    return read(path);
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  } catch (const Error&) {
    if (!links_elsewhere(path)) throw;
    throw Error(path.string() +
                ": is a link to a file in another folder, which is no mesh that Souple reads");
  }
  throw Error(path.string() + ": is too large for the memory of this machine");
}

}  // namespace

std::string read_mesh_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(path.string() + ": no such file, expected a mesh file");
  if (std::filesystem::is_directory(status))
    throw Error(path.string() + ": is a folder, expected a mesh file");
  if (!std::filesystem::is_regular_file(status))
    throw Error(path.string() + ": is no regular file, expected a mesh file");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file)
    throw Error(path.string() + ": cannot be opened, expected a file that this user may read");
  std::string bytes = within_memory(path, [&](const auto&) { return std::string(std::size_t(size), '\0'); });
  file.read(bytes.data(), std::streamsize(size));
  if (file.bad() || std::uintmax_t(file.gcount()) != size)
    throw Error(path.string() + ": cannot be read to its end");
  return bytes;
}

Vec3d imported(const Vec3d& x, const MeshImport& options) {
  return with_y_up(x, options.up) * options.scale;
}

TriangleMesh read_triangle_mesh(const std::filesystem::path& path, const MeshImport& options) {
  check_scale(path, options);
  TriangleMesh mesh = within_memory(path, read_surface);
  if (!options.node.empty()) mesh = part_of(mesh, options.node, path.string());
  import_positions(mesh.positions, options);
  for (Vec3f& normal : mesh.appearance.normals) normal = with_y_up(normal, options.up);
  find_material_files(mesh.appearance.material_files, path);
  return mesh;
}

TetMesh read_tet_mesh(const std::filesystem::path& path, const MeshImport& options) {
  check_scale(path, options);
  TetMesh mesh = within_memory(path, read_volume);
  import_positions(mesh.positions, options);
  return mesh;
}

}  // namespace souple
