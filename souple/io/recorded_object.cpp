#include "souple/io/recorded_object.h"

#include "souple/files/atomic_file.h"
#include "souple/geometry/submesh.h"
#include "souple/mesh_files/mesh_write.h"
#include "souple/objects/kind_traits.h"
#include "souple/world/world.h"

#include <algorithm>
#include <numeric>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

bool is_points(ObjectKind kind) {
  const ObjectShape shape = traits_of(kind).shape;
  return shape == ObjectShape::line || shape == ObjectShape::balls;
}

/// OBJ names material files relative to its own folder.
void make_relative(std::vector<std::string>& files, const std::filesystem::path& folder) {
  for (std::string& file : files) {
    std::error_code error;
    const std::filesystem::path relative = std::filesystem::relative(file, folder, error);
    if (!error && !relative.empty()) file = relative.generic_string();
  }
}

/// A line element per segment: importers such as Blender's read only the first segment of a longer one. OBJ
/// counts vertices from 1.
std::string segments_text(std::uint64_t points) {
  std::string text;
  for (std::uint64_t i = 1; i < points; ++i) text += fmt::format("l {} {}\n", i, i + 1);
  return text;
}

TriangleMesh written_mesh(const TriangleMesh& whole, const std::vector<std::uint32_t>& vertices) {
  return vertices.empty() ? whole : submesh(whole, vertices);
}

RecordedShape shape_of(const World& world, ObjectId object, const std::filesystem::path& folder) {
  RecordedShape shape;
  shape.kind = world.kind(object);
  shape.points = world.positions(object).size();
  if (is_points(shape.kind)) {
    if (traits_of(shape.kind).shape == ObjectShape::line) shape.topology = segments_text(shape.points);
    return shape;
  }
  shape.vertices = recorded_vertices(world, object);
  if (shape.vertices.size() == shape.points) shape.vertices.clear();
  shape.mesh = written_mesh(world.mesh(object), shape.vertices);
  shape.points = shape.mesh.positions.size();
  // Normals of the rest shape would be wrong in the frames.
  shape.mesh.appearance.normals.clear();
  shape.mesh.appearance.face_normals.clear();
  make_relative(shape.mesh.appearance.material_files, folder);
  shape.topology = obj_topology_text(shape.mesh);
  return shape;
}

bool same(const RecordedShape& a, const RecordedShape& b) {
  const bool as_many = traits_of(a.kind).flows || a.points == b.points;
  return a.kind == b.kind && as_many && a.topology == b.topology;
}

std::string obj_bytes(const RecordedShape& shape, std::span<const Vec3f> positions) {
  const std::string vertices =
      is_points(shape.kind) ? obj_text(positions) : obj_vertices_text(shape.mesh, positions);
  return vertices + shape.topology;
}

std::string ply_bytes_of(const RecordedShape& shape, std::span<const Vec3f> positions,
                         std::span<const Vec3f> velocities) {
  return is_points(shape.kind) ? ply_bytes(positions, velocities)
                               : ply_bytes(shape.mesh, positions, velocities);
}

}  // namespace

std::vector<std::uint32_t> recorded_vertices(const World& world, ObjectId object) {
  const World::TetStatistics tets = world.tet_statistics(object);
  const std::size_t count = world.positions(object).size();
  std::vector<std::uint32_t> result(count);
  std::iota(result.begin(), result.end(), 0u);
  if (tets.tets == 0 || tets.cell_size > 0) return result;
  std::vector<char> on_surface(count, 0);
  for (const Triangle& t : world.triangles(object))
    for (const std::uint32_t v : t) on_surface[v] = 1;
  std::erase_if(result, [&](std::uint32_t v) { return !on_surface[v]; });
  return result;
}

bool same_topology(const World& world, ObjectId object, const ManifestObject& known) {
  const bool as_many =
      traits_of(world.kind(object)).flows || known.points == recorded_vertices(world, object).size();
  return known.kind == kind_name(world.kind(object)) && as_many &&
         known.triangles == world.triangles(object).size();
}

RecordedObject::RecordedObject(const RecordingPlan& plan, std::string name, ObjectId object,
                               std::string file_name, std::shared_ptr<RecordedShape> shape)
    : plan_(plan),
      name_(std::move(name)),
      file_name_(std::move(file_name)),
      object_(object),
      shape_(std::move(shape)) {
  first_shape_.points = shape_->points;
  first_shape_.triangles = shape_->mesh.triangles.size();
}

RecordedObject::RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object,
                               std::string file_name)
    : RecordedObject(plan, world.name(object), object, std::move(file_name),
                     std::make_shared<RecordedShape>(shape_of(world, object, plan.folder))) {
  has_rest_mesh_ = wants(CacheFormat::pc2) || wants(CacheFormat::mdd);
  try {
    if (has_rest_mesh_) write_rest_mesh(world);
    if (wants(CacheFormat::pc2)) pc2_.emplace(path("pc2"), shape_->points);
    if (wants(CacheFormat::mdd)) mdd_.emplace(path("mdd"), shape_->points, plan_.frames);
  } catch (...) {
    discard();
    throw;
  }
  if (wants(CacheFormat::obj)) add_sequence("obj", 0);
  if (wants(CacheFormat::ply)) add_sequence("ply", 0);
}

RecordedObject::RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object,
                               std::string file_name, const Resume& resume)
    : RecordedObject(plan, world.name(object), object, std::move(file_name),
                     std::make_shared<RecordedShape>(shape_of(world, object, plan.folder))) {
  first_shape_.points = resume.points;
  has_rest_mesh_ = wants(CacheFormat::pc2) || wants(CacheFormat::mdd);
  if (wants(CacheFormat::pc2)) pc2_.emplace(Pc2Writer::resume(path("pc2"), shape_->points, resume.frames));
  if (wants(CacheFormat::mdd))
    mdd_.emplace(MddWriter::resume(path("mdd"), shape_->points, resume.frames, plan_.frames));
  if (wants(CacheFormat::obj)) add_sequence("obj", resume.frames);
  if (wants(CacheFormat::ply)) add_sequence("ply", resume.frames);
}

RecordedObject::RecordedObject(const RecordingPlan& plan, const World& world, ObjectId object,
                               std::string file_name, const Late& late)
    : RecordedObject(plan, world.name(object), object, std::move(file_name),
                     std::make_shared<RecordedShape>(shape_of(world, object, plan.folder))) {
  begin_late(late.frames);
}

// A fluid's number of particles changes: it is always written as PLY.
bool RecordedObject::wants(CacheFormat format) const {
  if (traits_of(shape_->kind).flows) return format == CacheFormat::ply;
  return std::find(plan_.formats.begin(), plan_.formats.end(), format) != plan_.formats.end();
}

std::filesystem::path RecordedObject::path(const char* extension) const {
  return plan_.folder / (file_name_ + "." + extension);
}

void RecordedObject::write_rest_mesh(const World& world) const {
  if (is_points(shape_->kind)) {
    write_file_atomically(path("obj"), obj_bytes(*shape_, world.positions(object_)));
    return;
  }
  TriangleMesh mesh = written_mesh(world.mesh(object_), shape_->vertices);
  make_relative(mesh.appearance.material_files, plan_.folder);
  const std::vector<Vec3f> rest(mesh.positions.begin(), mesh.positions.end());
  write_file_atomically(path("obj"), obj_text(mesh, rest));
}

void RecordedObject::add_sequence(const char* extension, std::uint64_t kept) {
  const bool obj = std::string_view(extension) == "obj";
  const auto bytes = [shape = shape_, obj](std::span<const Vec3f> positions,
                                           std::span<const Vec3f> velocities) {
    return obj ? obj_bytes(*shape, positions) : ply_bytes_of(*shape, positions, velocities);
  };
  const std::uint64_t first = kept > 0 ? 1 : 0;
  sequences_.push_back(
      {extension, first, 0, SequenceWriter(plan_.folder, file_name_, extension, bytes, kept)});
}

/// From frame number frames + 1 on, one file per frame: in the formats that support it, else OBJ.
void RecordedObject::begin_late(std::uint64_t frames) {
  if (sequences_.empty()) {
    if (wants(CacheFormat::ply)) add_sequence("ply", 0);
    if (wants(CacheFormat::obj) || !wants(CacheFormat::ply)) add_sequence("obj", 0);
  }
  for (Sequence& sequence : sequences_) {
    const std::uint64_t before = sequence.writer.frames();
    sequence.writer.skip_to(frames + 1);
    sequence.skipped += sequence.writer.frames() - before;
  }
}

bool RecordedObject::take_over(const World& world, ObjectId object, std::uint64_t frames) {
  RecordedShape shape = shape_of(world, object, plan_.folder);
  const bool goes_on = present_ && same(shape, *shape_);
  if (!goes_on) {
    close_caches();
    *shape_ = std::move(shape);
    begin_late(frames);
  }
  object_ = object;
  present_ = true;
  return goes_on;
}

std::span<const Vec3f> RecordedObject::written(std::span<const Vec3f> values,
                                               std::vector<Vec3f>& buffer) const {
  if (shape_->vertices.empty()) return values;
  buffer.clear();
  for (const std::uint32_t v : shape_->vertices) buffer.push_back(values[v]);
  return buffer;
}

void RecordedObject::append(const World& world, std::uint64_t frame) {
  const auto positions = written(world.positions(object_), positions_);
  if (pc2_ && caches_open_) pc2_->append(positions);
  if (mdd_ && caches_open_) mdd_->append(static_cast<double>(frame - 1) / plan_.frame_rate, positions);
  for (Sequence& sequence : sequences_) {
    sequence.writer.append(positions, written(world.velocities(object_), velocities_));
    if (sequence.first == 0) sequence.first = frame;
  }
}

void RecordedObject::drop_after(std::uint64_t frames) {
  // Reopens the file: buffered data of a failed write must not appear later.
  if (pc2_ && caches_open_) {
    pc2_.reset();
    pc2_.emplace(Pc2Writer::resume(path("pc2"), first_shape_.points, frames));
  }
  if (mdd_ && caches_open_) {
    mdd_.reset();
    mdd_.emplace(MddWriter::resume(path("mdd"), first_shape_.points, frames, plan_.frames));
  }
  for (Sequence& sequence : sequences_) {
    sequence.writer.drop_after(frames);
    if (sequence.first > frames) sequence.first = 0;
  }
}

void RecordedObject::close_caches() {
  if (!caches_open_) return;
  // Blender refuses a cache without frames.
  if (pc2_) pc2_->frames() > 0 ? pc2_->finish() : pc2_->discard();
  if (mdd_) mdd_->frames() > 0 ? mdd_->finish() : mdd_->discard();
  caches_open_ = false;
}

void RecordedObject::discard() {
  if (pc2_) pc2_->discard();
  if (mdd_) mdd_->discard();
  std::error_code ignored;
  if (has_rest_mesh_) std::filesystem::remove(path("obj"), ignored);
}

bool RecordedObject::restore_rest_mesh(const World& world) const {
  std::error_code ignored;
  if (!has_rest_mesh_ || std::filesystem::exists(path("obj"), ignored)) return false;
  write_rest_mesh(world);
  return true;
}

void RecordedObject::leave() {
  close_caches();
  present_ = false;
}

void RecordedObject::finish() {
  close_caches();
  for (Sequence& sequence : sequences_) sequence.writer.finish();
}

std::size_t RecordedObject::loose_vertices() const {
  if (shape_->mesh.triangles.empty()) return 0;
  std::vector<char> in_face(shape_->mesh.positions.size(), 0);
  for (const Triangle& t : shape_->mesh.triangles)
    for (const std::uint32_t v : t) in_face[v] = 1;
  return static_cast<std::size_t>(std::count(in_face.begin(), in_face.end(), char(0)));
}

std::string RecordedObject::next_file() const {
  if (sequences_.empty()) return {};
  return frame_file_name(file_name_, sequences_.back().writer.frames() + 1, sequences_.back().extension);
}

ManifestObject RecordedObject::manifest() const {
  ManifestObject object = first_shape_;
  object.name = name_;
  object.kind = std::string(kind_name(shape_->kind));
  if (has_rest_mesh_) object.files.push_back({"obj", file_name_ + ".obj", 0});
  if (pc2_ && pc2_->frames() > 0) object.files.push_back({"pc2", file_name_ + ".pc2", pc2_->frames()});
  if (mdd_ && mdd_->frames() > 0) object.files.push_back({"mdd", file_name_ + ".mdd", mdd_->frames()});
  for (const Sequence& sequence : sequences_) {
    const std::uint64_t held = sequence.writer.frames() - sequence.skipped;
    if (sequence.first == 0) continue;
    object.files.push_back(
        {sequence.extension, frame_file_name(file_name_, sequence.first, sequence.extension), held});
  }
  return object;
}

}  // namespace souple
