#include "formats.h"

#include "souple/error.h"
#include "souple/io/checkpoint_file.h"
#include "souple/io/manifest.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/math/fnv1a.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"
#include "souple/scene/scene.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace souple::fuzz {

namespace {

/// A reader may reject a file, but its results must be valid. A fuzzer reports an abort.
void require(bool sound) {
  if (!sound) std::abort();
}

/// Returns the result of `read` for valid files that Souple wrote; an Error aborts too.
template <class Read>
auto must_read(Read&& read) {
  try {
    return read();
  } catch (const Error&) {
    std::abort();
  }
}

// --- meshes

/// All indices of all lists are below `count`.
template <class Lists>
void require_below(const Lists& lists, std::size_t count) {
  for (const auto& list : lists)
    for (std::uint32_t i : list) require(i < count);
}

/// Points that floats hold, and groups of them.
template <class Mesh>
void check_points(const Mesh& mesh) {
  for (const Vec3d& p : mesh.positions) require(is_finite(Vec3f(p)));
  for (const auto& group : mesh.groups)
    for (std::uint32_t i : group.second) require(i < mesh.positions.size());
}

void check(const TriangleMesh& mesh) {
  const auto count = mesh.positions.size();
  check_points(mesh);
  require_below(mesh.triangles, count);
  require_below(mesh.faces, count);
  for (const auto& face : mesh.faces) require(face.size() >= 3);
  require_below(mesh.face_uvs, mesh.uvs.size());
  const FaceAppearance& a = mesh.appearance;
  const auto faces = mesh.faces.empty() ? mesh.triangles.size() : mesh.faces.size();
  require(a.face_materials.empty() || a.face_materials.size() == faces);
  for (std::uint32_t i : a.face_materials)
    require(i < a.materials.size() || i == FaceAppearance::no_material);
  require(a.smoothing.empty() || a.smoothing.size() == faces);
  require(a.face_normals.empty() || a.face_normals.size() == faces);
  require_below(a.face_normals, a.normals.size());
  require(mesh.colors.empty() || mesh.colors.size() == count);
}

void check(const TetMesh& mesh) {
  check_points(mesh);
  require(!mesh.tets.empty());
  require_below(mesh.tets, mesh.positions.size());
}

template <auto parse>
void read_mesh(std::string_view bytes) {
  check(parse(bytes, "fuzz"));
}

/// A mesh that was read is written and read again: it must survive the writer's own groups and faces.
void read_obj(std::string_view bytes) {
  const TriangleMesh mesh = parse_obj(bytes, "fuzz.obj");
  check(mesh);
  std::vector<Vec3f> positions;
  for (const Vec3d& p : mesh.positions) positions.emplace_back(p);
  const TriangleMesh again = must_read([&] { return parse_obj(obj_text(mesh, positions), "again.obj"); });
  require(again.triangles == mesh.triangles && again.face_uvs == mesh.face_uvs);
}

/// Both files in one: the .node, a line "--- ele ---", the .ele.
void read_tetgen(std::string_view bytes) {
  constexpr std::string_view separator = "--- ele ---\n";
  const std::size_t at = bytes.find(separator);
  const bool both = at != std::string_view::npos;
  check(parse_tetgen(bytes.substr(0, at), "fuzz.node",
                     both ? bytes.substr(at + separator.size()) : std::string_view(), "fuzz.ele"));
}

// --- caches, manifests, scenes

/// Reads the first and the last frame, which detects headers with too many frames.
template <class Reader>
void read_cache(std::string_view bytes) {
  Reader reader(ByteSource(std::string(bytes), "fuzz"));
  if (reader.frames() == 0) return;
  std::vector<Vec3f> positions(reader.points());
  reader.read(0, positions);
  reader.read(reader.frames() - 1, positions);
}

void read_manifest_text(std::string_view bytes) {
  const std::string text = manifest_text(parse_manifest(bytes, "fuzz.json"));
  require(must_read([&] { return manifest_text(parse_manifest(text, "again.json")); }) == text);
}

/// Mesh files are looked for where the shipped scenes have theirs, and never read.
void read_scene(std::string_view bytes) {
  const char* const folder = SOUPLE_SOURCE_DIR "/scenes";
  const std::string text = to_json(parse_scene(bytes, folder, "fuzz.json"));
  require(must_read([&] { return to_json(parse_scene(text, folder, "again.json")); }) == text);
}

// --- checkpoints

void put_number(std::string& bytes, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<char>((value >> (8 * i)) & 0xff);
}

void read_and_write(std::string_view bytes) {
  const Checkpoint checkpoint = parse_checkpoint(bytes, "fuzz", "0.1.0");
  const std::string written = must_read([&] { return checkpoint_bytes(checkpoint); });
  require(must_read([&] { return parse_checkpoint(written, "again", "0.1.0"); }) == checkpoint);
}

/// `bytes` with its size and both checksums made right: they would keep all changes out of the decoder.
std::string mended(std::string_view bytes) {
  constexpr std::size_t header_size = 64;
  std::string text(bytes);
  if (text.size() < header_size) return text;
  const std::string_view view = text;
  put_number(text, 32, text.size() - header_size);
  put_number(text, 40, fnv1a64(view.substr(header_size)));
  put_number(text, 56, fnv1a64(view.substr(0, 56)));
  return text;
}

void read_checkpoint_bytes(std::string_view bytes) {
  try {
    read_and_write(bytes);
  } catch (const Error&) {
    read_and_write(mended(bytes));
  }
}

constexpr Format formats[] = {
    {"checkpoint", read_checkpoint_bytes},
    {"manifest", read_manifest_text},
    {"mdd", read_cache<MddReader>},
    {"msh", read_mesh<parse_msh>},
    {"obj", read_obj},
    {"pc2", read_cache<Pc2Reader>},
    {"ply", read_mesh<parse_ply>},
    {"scene", read_scene},
    {"stl", read_mesh<parse_stl>},
    {"tetgen", read_tetgen},
    {"vtk", read_mesh<parse_vtk>},
};

}  // namespace

const Format* find_format(std::string_view name) {
  for (const Format& format : formats) {
    if (format.name == name) return &format;
  }
  return nullptr;
}

}  // namespace souple::fuzz
