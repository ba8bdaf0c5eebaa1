#include "formats.h"

#include "check_mesh.h"
#include "require.h"
#include "souple/io/manifest.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/mesh_files/mesh_parse.h"
#include "souple/mesh_files/mesh_write.h"
#include "souple/scene/scene.h"

#include <string>
#include <vector>

namespace souple::fuzz {

namespace {

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
