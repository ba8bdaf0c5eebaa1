#include "souple/io/export_frames.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/io/material_file.h"
#include "souple/io/recorded_foam.h"
#include "souple/io/split_mesh.h"
#include "souple/mesh_files/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

namespace souple {

namespace fs = std::filesystem;

namespace {

fs::path folder_of(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path : path.parent_path();
}

ExportShape shape_of(const ManifestObject& listed) {
  if (listed.triangles > 0) return ExportShape::surface;
  if (listed.kind == "rope") return ExportShape::line;
  if (listed.kind == "fluid") return ExportShape::fluid;
  return listed.kind == foam_kind_name ? ExportShape::foam : ExportShape::grains;
}

/// The mesh with all that its file states: the rest mesh, or else that of the first frame.
TriangleMesh mesh_of(const fs::path& folder, const ManifestObject& listed) {
  const ManifestFile* chosen = nullptr;
  for (const ManifestFile& file : listed.files) {
    const bool is_mesh = file.format == "obj" || file.format == "ply";
    const bool at_rest = file.frames == 0;
    if (is_mesh && (!chosen || (at_rest && chosen->frames > 0))) chosen = &file;
  }
  return chosen ? read_triangle_mesh(folder / chosen->path) : TriangleMesh{};
}

/// A .mtl that is gone since the run states nothing.
std::vector<ExportLook> material_looks(const ExportLook& look, const FaceAppearance& appearance) {
  std::vector<ExportLook> looks(appearance.materials.size(), look);
  for (const std::string& file : appearance.material_files) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const std::map<std::string, FileMaterial> known = parse_materials(read_whole_file(file));
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const auto found = known.find(appearance.materials[i]);
      if (found == known.end()) continue;
      looks[i].color = found->second.color;
      looks[i].opacity = found->second.opacity;
    }
  }
  return looks;
}

bool has_sequence(const ManifestObject& object) {
  return std::any_of(object.files.begin(), object.files.end(), [](const ManifestFile& file) {
    return (file.format == "obj" || file.format == "ply") && file.frames > 0;
  });
}

}  // namespace

ExportFrames::ExportFrames(const fs::path& path, const FindLook& find_look) : playback_(path) {
  if (playback_.frames() == 0) throw Error(path.string() + ": holds no frame yet; expected at least one");
  const std::vector<ManifestObject>& listed = playback_.manifest().objects;
  playback_.read(1);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const Playback::Object& object = playback_.objects()[i];
    ExportObject result{.name = object.name, .kind = object.kind, .shape = shape_of(listed[i])};
    result.look = find_look(object);
    Part part;
    part.points = object.positions.size();
    if (result.shape == ExportShape::surface) {
      part.home = mesh_of(folder_of(path), listed[i]);
      result.material_looks = material_looks(result.look, part.home.appearance);
      result.smooth = object.kind == "cloth" || object.kind == "fluid" ||
                      is_smooth(part.home.positions, part.home.triangles);
    }
    objects_.push_back(std::move(result));
    parts_.push_back(std::move(part));
  }
}

void ExportFrames::describe(std::size_t i) {
  const Playback::Object& source = playback_.objects()[i];
  Part& part = parts_[i];
  ExportObject& object = objects_[i];
  object.positions = source.positions;
  object.foam_kinds = source.foam_kinds;
  object.first_topology = source.positions.size() == part.points;
  object.mesh = &part.home;
  object.normals = {};
  if (object.shape != ExportShape::surface) return;
  const bool at_home =
      source.triangles == part.home.triangles && source.rest.size() == part.home.positions.size();
  if (!at_home) {
    part.other.positions = source.rest;
    part.other.triangles = source.triangles;
    object.mesh = &part.other;
    object.first_topology = false;
  }
  // A vertex without a face has no normal, and formats expect unit vectors.
  part.normals = source.normals;
  for (Vec3f& n : part.normals)
    if (n == Vec3f{}) n = {0, 1, 0};
  object.normals = part.normals;
}

void ExportFrames::remember() {
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].previous = playback_.objects()[i].positions;
  remembered_ = playback_.frame();
}

/// From the positions that were remembered of frame `from` and those of frame `to`, the current one or the next.
void ExportFrames::find_velocities(std::uint64_t from, std::uint64_t to) {
  const double seconds = playback_.time(to) - playback_.time(from);
  const auto rate = static_cast<float>(std::abs(seconds) > 1e-9 ? 1 / seconds : 0);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Playback::Object& source = playback_.objects()[i];
    Part& part = parts_[i];
    part.velocities = source.velocities;
    const bool known = objects_[i].first_topology && part.previous.size() == source.positions.size();
    if (source.velocities.empty() && known)
      for (std::size_t v = 0; v < source.positions.size(); ++v)
        part.velocities.push_back((source.positions[v] - part.previous[v]) * rate);
    for (Vec3f& v : part.velocities)
      if (!is_finite(v)) v = {};  // JSON has no text for it
    objects_[i].velocities = part.velocities;
  }
}

bool ExportFrames::survey() {
  const std::vector<ManifestObject>& listed = playback_.manifest().objects;
  const bool caches_only = std::none_of(listed.begin(), listed.end(), has_sequence);
  if (caches_only && playback_.manifest().complete) return true;
  bool all = true;
  for (std::uint64_t frame = 1; frame <= playback_.frames(); ++frame) {
    playback_.read(frame);
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      describe(i);
      if (objects_[i].first_topology) continue;
      objects_[i].constant = all = false;
    }
  }
  return all;
}

void ExportFrames::read(std::uint64_t frame) {
  const std::uint64_t other = frame > 1 ? frame - 1 : std::min<std::uint64_t>(2, playback_.frames());
  if (remembered_ != other) {
    playback_.read(other);
    remember();
  }
  playback_.read(frame);
  for (std::size_t i = 0; i < objects_.size(); ++i) describe(i);
  find_velocities(other, frame);
  remember();
}

std::string run_name(const fs::path& path) {
  fs::path folder =
      fs::absolute(path.filename() == "run.json" ? path.parent_path() : path).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.filename().string();
}

}  // namespace souple
