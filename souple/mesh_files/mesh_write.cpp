#include "souple/mesh_files/mesh_write.h"

#include "souple/error.h"
#include "souple/mesh_files/mesh_bytes.h"
#include "souple/mesh_files/mesh_groups.h"
#include "souple/mesh_files/number_text.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace souple {

namespace {

void append_number(std::string& out, std::uint64_t value) {
  out += fmt::format_int(value).c_str();
}

void append_vector(std::string& out, const Vec3f& v) {
  for (float component : {v.x, v.y, v.z}) {
    out += ' ';
    mesh_detail::append_real(out, component);
  }
}

void require_positions(const TriangleMesh& mesh, std::span<const Vec3f> positions) {
  if (positions.size() == mesh.positions.size()) return;
  throw Error(fmt::format("writing a mesh: found {} positions, expected {}, one for each of its vertices",
                          positions.size(), mesh.positions.size()));
}

void require_one_each(const char* what, std::size_t found, std::size_t points) {
  if (found == 0 || found == points) return;
  throw Error(fmt::format("writing particles: found {} {}, expected {}, one for each point, or none", found,
                          what, points));
}

constexpr const char* velocity_properties = "property float vx\nproperty float vy\nproperty float vz\n";

std::size_t face_count(const TriangleMesh& mesh) {
  return mesh.faces.empty() ? mesh.triangles.size() : mesh.faces.size();
}

std::span<const std::uint32_t> face_corners(const TriangleMesh& mesh, std::size_t face) {
  if (mesh.faces.empty()) return mesh.triangles[face];
  return mesh.faces[face];
}

/// A group's name as a word of OBJ; "default" is changed, because it means "no group".
std::string word_from(const std::string& name) {
  std::string word = name;
  for (char& c : word) {
    const bool blank = c == ' ' || (c >= '\t' && c <= '\r');
    if (blank || c == '\\' || c == '#') c = '_';
  }
  if (word == "default") word += '_';
  return word;
}

/// The groups of materials that the `usemtl` lines of the faces give when they are read back.
std::map<std::string, std::vector<std::uint32_t>> groups_of_materials(const TriangleMesh& mesh) {
  const FaceAppearance& appearance = mesh.appearance;
  mesh_detail::GroupBuilder groups;
  for (std::size_t face = 0; face < appearance.face_materials.size(); ++face) {
    if (appearance.face_materials[face] == FaceAppearance::no_material) continue;
    std::vector<std::uint32_t>& group =
        groups["material:" + appearance.materials[appearance.face_materials[face]]];
    const auto corners = face_corners(mesh, face);
    group.insert(group.end(), corners.begin(), corners.end());
  }
  return groups.finish();
}

/// The groups of each vertex as a sorted list of their numbers, in two flat arrays.
struct VertexGroups {
  std::vector<std::string> names;
  std::vector<const std::vector<std::uint32_t>*> members;  ///< of each group
  std::vector<std::size_t> begins;
  std::vector<std::uint32_t> groups;

  /// Limit of the groups of a corner that groups_of_face compares: without one, n faces of the same vertices in
  /// n groups take n^2 steps.
  static constexpr std::size_t most_compared = 64;

  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(groups).subspan(begins[vertex], begins[vertex + 1] - begins[vertex]);
  }
  std::span<const std::uint32_t> compared(std::uint32_t vertex) const {
    const auto all = of(vertex);
    return all.first(std::min(all.size(), most_compared));
  }
  /// The place of a vertex's group in `groups`, or groups.size() if the vertex is not in it.
  std::size_t place(std::uint32_t vertex, std::uint32_t group) const {
    const auto all = of(vertex);
    const auto found = std::lower_bound(all.begin(), all.end(), group);
    if (found == all.end() || *found != group) return groups.size();
    return begins[vertex] + std::size_t(found - all.begin());
  }
};

VertexGroups groups_by_vertex(const TriangleMesh& mesh) {
  VertexGroups result;
  result.begins.assign(mesh.positions.size() + 1, 0);
  const auto of_materials = groups_of_materials(mesh);
  for (const auto& [name, vertices] : mesh.groups) {
    const auto by_usemtl = of_materials.find(name);
    if (by_usemtl != of_materials.end() && by_usemtl->second == vertices) continue;
    result.names.push_back(word_from(name));
    result.members.push_back(&vertices);
    for (std::uint32_t vertex : vertices) ++result.begins[vertex + 1];
  }
  for (std::size_t i = 1; i < result.begins.size(); ++i) result.begins[i] += result.begins[i - 1];
  result.groups.resize(result.begins.back());
  std::vector<std::size_t> next(result.begins.begin(), result.begins.end() - 1);
  for (std::uint32_t group = 0; group < result.members.size(); ++group)
    for (std::uint32_t vertex : *result.members[group]) result.groups[next[vertex]++] = group;
  return result;
}

/// The groups that hold every corner of a face, up to the limits of a `g` line and of `most_compared`;
/// write_loose writes the others.
std::vector<std::uint32_t> groups_of_face(const VertexGroups& groups,
                                          std::span<const std::uint32_t> corners) {
  const auto first = groups.compared(corners[0]);
  std::vector<std::uint32_t> common(first.begin(), first.end()), next;
  for (std::uint32_t corner : corners.subspan(1)) {
    if (common.empty()) break;
    const auto other = groups.compared(corner);
    next.clear();
    std::set_intersection(common.begin(), common.end(), other.begin(), other.end(), std::back_inserter(next));
    common.swap(next);
  }
  if (common.size() > mesh_detail::most_groups_at_once) common.resize(mesh_detail::most_groups_at_once);
  return common;
}

class TopologyWriter {
 public:
  explicit TopologyWriter(const TriangleMesh& mesh) : mesh_(mesh), groups_(groups_by_vertex(mesh)) {}

  std::string write() {
    for (const std::string& file : mesh_.appearance.material_files) out_ += "mtllib " + file + '\n';
    for (const auto& uv : mesh_.uvs) {
      out_ += "vt ";
      mesh_detail::append_real(out_, uv[0]);
      out_ += ' ';
      mesh_detail::append_real(out_, uv[1]);
      out_ += '\n';
    }
    for (const Vec3f& normal : mesh_.appearance.normals) {
      out_ += "vn";
      append_vector(out_, normal);
      out_ += '\n';
    }
    // Per entry of groups_.groups: whether a face has written it.
    written_.assign(groups_.groups.size(), false);
    for (std::size_t face = 0; face < face_count(mesh_); ++face) write_face(face);
    write_loose();
    return std::move(out_);
  }

 private:
  void write_face(std::size_t face) {
    const auto corners = face_corners(mesh_, face);
    if (!groups_.names.empty()) write_groups(groups_of_face(groups_, corners));
    for (std::uint32_t corner : corners) mark_written(corner);
    write_appearance(face);
    const auto uvs = of_face(mesh_.face_uvs, face), normals = of_face(mesh_.appearance.face_normals, face);
    out_ += 'f';
    for (std::size_t i = 0; i < corners.size(); ++i) {
      out_ += ' ';
      append_index(corners[i]);
      if (!uvs.empty() || !normals.empty()) out_ += '/';
      if (!uvs.empty()) append_index(uvs[i]);
      if (normals.empty()) continue;
      out_ += '/';
      append_index(normals[i]);
    }
    out_ += '\n';
  }

  void append_index(std::uint32_t index) { append_number(out_, std::uint64_t(index) + 1); }

  static std::span<const std::uint32_t> of_face(const std::vector<std::vector<std::uint32_t>>& lists,
                                                std::size_t face) {
    return lists.empty() ? std::span<const std::uint32_t>() : std::span<const std::uint32_t>(lists[face]);
  }

  void write_appearance(std::size_t face) {
    const FaceAppearance& appearance = mesh_.appearance;
    if (!appearance.face_materials.empty() && appearance.face_materials[face] != material_) {
      material_ = appearance.face_materials[face];
      // Without a name: no material.
      out_ += "usemtl";
      if (material_ != FaceAppearance::no_material) out_ += ' ' + appearance.materials[material_];
      out_ += '\n';
    }
    if (appearance.smoothing.empty() || appearance.smoothing[face] == smoothing_) return;
    smoothing_ = appearance.smoothing[face];
    out_ += "s ";
    append_number(out_, *smoothing_);
    out_ += '\n';
  }

  void write_groups(const std::vector<std::uint32_t>& groups) {
    if (groups == current_) return;
    current_ = groups;
    out_ += 'g';
    for (std::uint32_t group : groups) out_ += ' ' + groups_.names[group];
    if (groups.empty()) out_ += " default";
    out_ += '\n';
  }

  void mark_written(std::uint32_t vertex) {
    for (std::uint32_t group : current_) {
      const std::size_t place = groups_.place(vertex, group);
      if (place < written_.size()) written_[place] = true;
    }
  }

  /// Writes vertices whose groups no face has written, as points.
  void write_loose() {
    for (std::uint32_t group = 0; group < groups_.names.size(); ++group) {
      for (std::uint32_t vertex : *groups_.members[group]) {
        if (written_[groups_.place(vertex, group)]) continue;
        write_groups({group});
        out_ += "p ";
        append_number(out_, std::uint64_t(vertex) + 1);
        out_ += '\n';
      }
    }
  }

  const TriangleMesh& mesh_;
  VertexGroups groups_;
  std::vector<bool> written_;
  std::vector<std::uint32_t> current_;
  std::uint32_t material_ = FaceAppearance::no_material;
  std::optional<std::uint32_t> smoothing_;
  std::string out_;
};

std::string ply_header(std::size_t vertices) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by Souple\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      vertices);
}

void append_bytes(std::string& out, const Vec3f& v) {
  for (float component : {v.x, v.y, v.z}) append_binary<ByteOrder::little>(out, component);
}

std::uint8_t color_byte(float channel) {
  return std::uint8_t(std::lround(std::clamp(channel, 0.0f, 1.0f) * 255.0f));
}

/// Whether each corner's UV is that of its vertex, as PLY requires.
bool has_uv_per_vertex(const TriangleMesh& mesh) {
  if (mesh.uvs.size() != mesh.positions.size() || mesh.face_uvs.size() != face_count(mesh)) return false;
  for (std::size_t face = 0; face < face_count(mesh); ++face) {
    const auto corners = face_corners(mesh, face);
    const auto& uvs = mesh.face_uvs[face];
    if (!std::equal(corners.begin(), corners.end(), uvs.begin(), uvs.end())) return false;
  }
  return true;
}

void append_ply_faces(std::string& out, const TriangleMesh& mesh, bool long_lists) {
  for (std::size_t face = 0; face < face_count(mesh); ++face) {
    const auto corners = face_corners(mesh, face);
    if (long_lists)
      append_binary<ByteOrder::little>(out, std::uint32_t(corners.size()));
    else
      append_binary<ByteOrder::little>(out, std::uint8_t(corners.size()));
    for (std::uint32_t corner : corners) append_binary<ByteOrder::little>(out, corner);
  }
}

}  // namespace

std::string obj_text(const TriangleMesh& mesh, std::span<const Vec3f> positions) {
  return obj_vertices_text(mesh, positions) + obj_topology_text(mesh);
}

std::string obj_text(std::span<const Vec3f> points) {
  return obj_text(points, {}, {});
}

std::string obj_vertices_text(const TriangleMesh& mesh, std::span<const Vec3f> positions) {
  require_positions(mesh, positions);
  if (mesh.colors.empty()) return obj_text(positions);
  std::string out;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    out += 'v';
    append_vector(out, positions[i]);
    append_vector(out, mesh.colors[i]);
    out += '\n';
  }
  return out;
}

std::string obj_topology_text(const TriangleMesh& mesh) {
  return TopologyWriter(mesh).write();
}

std::string ply_bytes(const TriangleMesh& mesh, std::span<const Vec3f> positions,
                      std::span<const Vec3f> velocities) {
  require_positions(mesh, positions);
  require_one_each("velocities", velocities.size(), positions.size());
  const bool has_uvs = has_uv_per_vertex(mesh) && !mesh.uvs.empty();
  const bool long_lists =
      std::any_of(mesh.faces.begin(), mesh.faces.end(), [](const auto& f) { return f.size() > 255; });
  std::string out = ply_header(positions.size());
  if (!velocities.empty()) out += velocity_properties;
  if (!mesh.colors.empty()) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (has_uvs) out += "property float u\nproperty float v\n";
  out += fmt::format("element face {}\nproperty list {} uint vertex_indices\nend_header\n", face_count(mesh),
                     long_lists ? "uint" : "uchar");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    append_bytes(out, positions[i]);
    if (!velocities.empty()) append_bytes(out, velocities[i]);
    if (!mesh.colors.empty()) {
      const Vec3f& c = mesh.colors[i];
      for (float channel : {c.x, c.y, c.z}) append_binary<ByteOrder::little>(out, color_byte(channel));
    }
    if (has_uvs) {
      for (float coordinate : mesh.uvs[i]) append_binary<ByteOrder::little>(out, coordinate);
    }
  }
  append_ply_faces(out, mesh, long_lists);
  return out;
}

std::string ply_bytes(std::span<const Vec3f> points, std::span<const Vec3f> velocities,
                      std::span<const std::uint8_t> kinds) {
  require_one_each("velocities", velocities.size(), points.size());
  require_one_each("kinds", kinds.size(), points.size());
  std::string out = ply_header(points.size());
  if (!velocities.empty()) out += velocity_properties;
  if (!kinds.empty()) out += "property uchar kind\n";
  out += "end_header\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    append_bytes(out, points[i]);
    if (!velocities.empty()) append_bytes(out, velocities[i]);
    if (!kinds.empty()) append_binary<ByteOrder::little>(out, kinds[i]);
  }
  return out;
}

std::string obj_text(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                     std::span<const Triangle> triangles) {
  std::string out;
  const auto append_line = [&](const char* what, const Vec3f& v) {
    out += what;
    append_vector(out, v);
    out += '\n';
  };
  for (const Vec3f& x : positions) append_line("v", x);
  for (const Vec3f& n : normals) append_line("vn", n);
  for (const Triangle& triangle : triangles) {
    out += 'f';
    for (const std::uint32_t corner : triangle) {
      out += ' ';
      append_number(out, std::uint64_t(corner) + 1);
      out += "//";
      append_number(out, std::uint64_t(corner) + 1);
    }
    out += '\n';
  }
  return out;
}

std::string ply_bytes(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
                      std::span<const Triangle> triangles, std::span<const Vec3f> velocities) {
  if (normals.size() != positions.size())
    throw Error(fmt::format("a PLY of {} positions: found {} normals, expected as many", positions.size(),
                            normals.size()));
  require_one_each("velocities", velocities.size(), positions.size());
  std::string out = ply_header(positions.size());
  out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!velocities.empty()) out += velocity_properties;
  out +=
      fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", triangles.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    append_bytes(out, positions[i]), append_bytes(out, normals[i]);
    if (!velocities.empty()) append_bytes(out, velocities[i]);
  }
  for (const Triangle& triangle : triangles) {
    append_binary<ByteOrder::little>(out, std::uint8_t{3});
    for (const std::uint32_t corner : triangle) append_binary<ByteOrder::little>(out, corner);
  }
  return out;
}

}  // namespace souple
