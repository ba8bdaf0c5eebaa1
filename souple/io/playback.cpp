#include "souple/io/playback.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/geometry/measures.h"
#include "souple/io/mdd.h"
#include "souple/io/particle_file.h"
#include "souple/io/pc2.h"
#include "souple/io/recorded_foam.h"
#include "souple/io/recorder_names.h"
#include "souple/io/sequence.h"
#include "souple/mesh_files/mesh_file.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/core.h>

namespace souple {

namespace fs = std::filesystem;

namespace {

/// The number of points varies between frames.
bool is_loose(const std::string& kind) {
  return kind == "fluid" || kind == foam_kind_name;
}

using Cache = std::variant<Pc2Reader, MddReader>;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

const ManifestFile* find_file(const ManifestObject& object, const char* format, bool at_rest) {
  for (const ManifestFile& file : object.files)
    if (file.format == format && (file.frames == 0) == at_rest) return &file;
  return nullptr;
}

void require_known_formats(const ManifestObject& object, const fs::path& folder) {
  for (const ManifestFile& file : object.files) {
    if (file.format == "vdb")
      throw Error((folder / "run.json").string() + ": " + object.name +
                  " has volumes (vdb), which cannot be played; `souple surface` writes meshes as well, with "
                  "--format obj or ply");
    if (file.format != "pc2" && file.format != "mdd" && file.format != "obj" && file.format != "ply")
      throw Error((folder / "run.json").string() + ": " + object.name + " has a file of format \"" +
                  file.format + "\"; this version plays pc2, mdd, obj and ply");
  }
}

struct Topology {
  std::vector<Triangle> triangles;
  std::vector<Vec3d> rest;
};

/// The files of one object.
class Track {
 public:
  /// Folder of a track's files, and whether it may contain files of an unfinished run.
  struct Run {
    fs::path folder;
    bool complete;
    std::uint64_t frames;
  };

  Track(const Run& run, const ManifestObject& listed, Playback::Object& object);

  /// Number of frames of a growing cache; equal for all objects of the run.
  std::optional<std::uint64_t> growing_frames() const;
  /// The run has more frames than its manifest lists; the sequence may have them too.
  void extend_to(std::uint64_t frames);
  void read(std::uint64_t frame, Playback::Object& object);

 private:
  void open_cache(const Run& run, const ManifestObject& listed, const char* format, const std::string& stem);
  void open_sequence(const Run& run, const ManifestFile& file);
  void read_rest(const Run& run, const ManifestObject& listed, Playback::Object& object) const;
  void read_cache(std::uint64_t frame, Playback::Object& object);
  void read_file(const fs::path& path, Playback::Object& object);
  void go_home(Playback::Object& object);

  std::optional<Cache> cache_;
  std::string cache_name_;
  bool grows_ = false;
  std::uint64_t points_ = 0, cache_frames_ = 0;
  std::vector<SequenceFrame> files_;   // by number
  std::vector<SequenceFrame> beyond_;  // files that the manifest does not list
  std::optional<Topology> home_;       // the object's own topology while it has another one
};

Track::Track(const Run& run, const ManifestObject& listed, Playback::Object& object) {
  object.name = listed.name;
  object.kind = listed.kind;
  require_known_formats(listed, run.folder);
  const ManifestFile* rest = find_file(listed, "obj", true);
  const std::string stem = rest ? fs::path(rest->path).stem().string() : safe_file_name(listed.name);
  for (const char* format : {"pc2", "mdd"})
    if (!cache_) open_cache(run, listed, format, stem);
  for (const char* format : {"ply", "obj"}) {
    const ManifestFile* file = find_file(listed, format, false);
    if (file && files_.empty()) open_sequence(run, *file);
  }
  read_rest(run, listed, object);
}

void Track::open_cache(const Run& run, const ManifestObject& listed, const char* format,
                       const std::string& stem) {
  const ManifestFile* file = find_file(listed, format, false);
  const fs::path whole = run.folder / (file ? file->path : stem + "." + format);
  // A killed run leaves the file that it was writing; the manifest may not list it.
  grows_ = !run.complete && is_file(part_path(whole));
  if (!file && !grows_) return;
  const fs::path path = grows_ ? part_path(whole) : whole;
  cache_name_ = path.string();
  if (std::string_view(format) == "pc2") {
    cache_ = grows_ ? Pc2Reader::of_part(ByteSource(path)) : Pc2Reader(path);
  } else {
    cache_ = grows_ ? MddReader::of_part(ByteSource(path)) : MddReader(path);
  }
  points_ = std::visit([](const auto& reader) { return reader.points(); }, *cache_);
  cache_frames_ = std::visit([](const auto& reader) { return reader.frames(); }, *cache_);
  if (file && cache_frames_ < file->frames)
    throw Error(fmt::format("{}: holds {} frames, run.json says {}; it is another run's, or damaged",
                            cache_name_, cache_frames_, file->frames));
  if (points_ != listed.points)
    throw Error(
        fmt::format("{}: holds {} points, run.json says that {} has {}; it is another run's, or damaged",
                    cache_name_, points_, listed.name, listed.points));
}

void Track::open_sequence(const Run& run, const ManifestFile& file) {
  const fs::path first = run.folder / file.path;
  if (!is_file(first)) throw Error(first.string() + ": is missing, and run.json says it is there");
  const std::vector<SequenceFrame> all = find_sequence(first);
  const auto is_first = [&](const SequenceFrame& f) { return f.path.filename() == first.filename(); };
  const auto begin = std::find_if(all.begin(), all.end(), is_first);
  const auto held = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(file.frames, all.size()));
  const auto end = all.end() - begin > held ? begin + held : all.end();
  files_.assign(begin, end);
  if (files_.size() < file.frames || files_.back().number > run.frames)
    throw Error(
        fmt::format("{}: run.json says that {} files begin with this one, but some of them are missing",
                    first.string(), file.frames));
  if (!run.complete) beyond_.assign(end, all.end());
}

void Track::read_rest(const Run& run, const ManifestObject& listed, Playback::Object& object) const {
  const ManifestFile* file = find_file(listed, "obj", true);
  if (!file && files_.empty()) return;
  const fs::path path = file ? run.folder / file->path : files_.front().path;
  if (is_loose(listed.kind) && read_particle_ply(path)) return;
  TriangleMesh mesh = read_triangle_mesh(path);
  if (mesh.positions.size() != listed.points || mesh.triangles.size() != listed.triangles)
    throw Error(
        fmt::format("{}: has {} vertices and {} triangles, run.json says that {} has {} and {}; it is "
                    "another run's, or damaged",
                    path.string(), mesh.positions.size(), mesh.triangles.size(), listed.name, listed.points,
                    listed.triangles));
  object.triangles = std::move(mesh.triangles);
  object.rest = std::move(mesh.positions);
}

std::optional<std::uint64_t> Track::growing_frames() const {
  return grows_ ? std::optional(cache_frames_) : std::nullopt;
}

void Track::extend_to(std::uint64_t frames) {
  cache_frames_ = std::min(cache_frames_, frames);
  for (const SequenceFrame& file : beyond_) {
    if (files_.empty() || file.number != files_.back().number + 1 || file.number > frames) break;
    files_.push_back(file);
  }
  beyond_.clear();
}

void Track::read(std::uint64_t frame, Playback::Object& object) {
  const auto file = std::lower_bound(files_.begin(), files_.end(), frame,
                                     [](const SequenceFrame& f, std::uint64_t n) { return f.number < n; });
  object.positions.clear();
  object.normals.clear();
  object.velocities.clear();
  object.foam_kinds.clear();
  if (cache_ && frame <= cache_frames_) {
    read_cache(frame, object);
  } else if (file != files_.end() && file->number == frame) {
    read_file(file->path, object);
  } else {
    go_home(object);
  }
  if (object.positions.empty() || object.triangles.empty()) return;
  object.normals.resize(object.positions.size());
  vertex_normals<float>(object.positions, object.triangles, object.normals);
}

void require_finite(const std::vector<Vec3f>& positions, const std::string& where) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!is_finite(positions[i]))
      throw Error(fmt::format("{}: point {} is not finite; the file is damaged", where, i));
}

void Track::read_cache(std::uint64_t frame, Playback::Object& object) {
  go_home(object);
  object.positions.resize(points_);
  std::visit([&](auto& reader) { reader.read(frame - 1, object.positions); }, *cache_);
  require_finite(object.positions, fmt::format("{}: frame {}", cache_name_, frame));
}

void Track::read_file(const fs::path& path, Playback::Object& object) {
  if (is_loose(object.kind) && path.extension() == ".ply") {
    if (std::optional<ParticleFrame> frame = read_particle_ply(path)) {
      go_home(object);
      require_finite(frame->positions, path.string());
      object.positions = std::move(frame->positions);
      object.velocities = std::move(frame->velocities);
      object.foam_kinds = std::move(frame->kinds);
      return;
    }
  }
  TriangleMesh mesh = read_triangle_mesh(path);
  for (const Vec3d& x : mesh.positions) object.positions.push_back(Vec3f(x));
  require_finite(object.positions, path.string());
  if (path.extension() == ".ply") object.velocities = read_ply_velocities(path);
  const auto is_as = [&](const std::vector<Triangle>& triangles, const std::vector<Vec3d>& rest) {
    return mesh.positions.size() == rest.size() && mesh.triangles == triangles;
  };
  if (is_as(object.triangles, object.rest)) return;
  if (home_ && is_as(home_->triangles, home_->rest)) return go_home(object);
  if (!home_) home_ = {std::move(object.triangles), std::move(object.rest)};
  object.triangles = std::move(mesh.triangles);
  object.rest = std::move(mesh.positions);
}

void Track::go_home(Playback::Object& object) {
  if (!home_) return;
  object.triangles = std::move(home_->triangles);
  object.rest = std::move(home_->rest);
  home_.reset();
}

}  // namespace

struct Playback::Impl {
  explicit Impl(const fs::path& path);
  void find_frames();

  RunManifest manifest;
  std::vector<Track> tracks;
  std::vector<Object> objects;
  std::uint64_t frames = 0, frame = 0;
};

Playback::Impl::Impl(const fs::path& path) : manifest(read_manifest(path)) {
  std::error_code ignored;
  const Track::Run run{fs::is_directory(path, ignored) ? path : path.parent_path(), manifest.complete,
                       manifest.frames};
  objects.resize(manifest.objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) tracks.emplace_back(run, manifest.objects[i], objects[i]);
  find_frames();
}

// A killed run has frames that its manifest does not list; a frame missing in some cache is incomplete.
void Playback::Impl::find_frames() {
  std::optional<std::uint64_t> whole;
  for (const Track& track : tracks)
    if (const auto held = track.growing_frames()) whole = std::min(*held, whole.value_or(*held));
  frames = std::max(manifest.frames, whole.value_or(0));
  for (Track& track : tracks) track.extend_to(frames);
}

Playback::Playback(const fs::path& path) : impl_(std::make_unique<Impl>(path)) {}
Playback::~Playback() = default;
Playback::Playback(Playback&&) noexcept = default;
Playback& Playback::operator=(Playback&&) noexcept = default;

const RunManifest& Playback::manifest() const {
  return impl_->manifest;
}

std::uint64_t Playback::frames() const {
  return impl_->frames;
}

double Playback::time(std::uint64_t frame) const {
  // Reports are ascending; frames without one follow the last before them at the frame rate.
  const auto& reports = impl_->manifest.reports;
  const auto after =
      std::upper_bound(reports.begin(), reports.end(), frame,
                       [](std::uint64_t f, const FrameReport& report) { return f < report.frame; });
  const double rate = impl_->manifest.frame_rate;
  if (after == reports.begin()) return static_cast<double>(frame) / rate;
  const FrameReport& known = *(after - 1);
  return known.time + static_cast<double>(frame - known.frame) / rate;
}

void Playback::read(std::uint64_t frame) {
  Impl& impl = *impl_;
  if (frame < 1 || frame > impl.frames)
    throw Error(fmt::format("frame {} cannot be read: the run has {}", frame,
                            impl.frames == 0 ? "no frames" : fmt::format("frames 1 to {}", impl.frames)));
  if (frame == impl.frame) return;
  impl.frame = 0;
  try {
    for (std::size_t i = 0; i < impl.tracks.size(); ++i) impl.tracks[i].read(frame, impl.objects[i]);
  } catch (...) {
    for (Object& object : impl.objects)
      object.positions.clear(), object.normals.clear(), object.velocities.clear();
    throw;
  }
  impl.frame = frame;
}

std::uint64_t Playback::frame() const {
  return impl_->frame;
}

std::span<const Playback::Object> Playback::objects() const {
  return impl_->objects;
}

}  // namespace souple
