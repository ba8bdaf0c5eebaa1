#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/vdb.h"
#include "souple/error.h"
#include "souple/io/file.h"
#include "souple/io/mesh_write.h"
#include "souple/io/particle_file.h"
#include "souple/io/playback.h"
#include "souple/io/recorder_names.h"
#include "souple/io/sequence.h"
#include "souple/scene/nearest.h"
#include "souple/scene/scene.h"
#include "souple/surface/fluid_surface.h"
#include "souple/version.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <system_error>
#include <utility>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

template <class Value>
Value value_of(const Words<Value>& words, const std::string& word, const char* option) {
  std::vector<std::string> known;
  for (const auto& [name, value] : words) {
    if (name == word) return value;
    known.push_back(name);
  }
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw Error(std::string(option) + " \"" + word + "\": expected one of " + list +
              scene_format::suggestion(word, known));
}

enum class Format { obj, ply, vdb };

const char* extension_of(Format format) {
  return format == Format::vdb ? "vdb" : format == Format::ply ? "ply" : "obj";
}

/// Of the band around the surface that a volume holds, on each side. [cells]
constexpr int band_cells = 3;

/// All that the command line says, understood.
struct Order {
  SurfaceOptions surface;
  Format format = Format::obj;
  std::optional<ParticleFormat> particles;
  fs::path out;
};

/// out/dam to out/dam_surface.
fs::path default_out(const fs::path& cache) {
  fs::path folder = (cache.filename() == "run.json" ? cache.parent_path() : cache).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (folder.empty() || folder == "." || folder == "..") folder = fs::absolute(folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  folder += "_surface";
  return folder;
}

Order order_of(const SurfaceRequest& request) {
  Order order;
  order.surface.method = value_of<SurfaceMethod>(
      {{"anisotropic", SurfaceMethod::anisotropic}, {"isotropic", SurfaceMethod::isotropic}}, request.method,
      "--method");
  order.format = value_of<Format>({{"obj", Format::obj}, {"ply", Format::ply}, {"vdb", Format::vdb}},
                                  request.format, "--format");
  if (order.format == Format::vdb) require_vdb();
  order.particles = value_of<std::optional<ParticleFormat>>({{"none", std::nullopt},
                                                             {"ply", ParticleFormat::ply},
                                                             {"vtk", ParticleFormat::vtk},
                                                             {"bgeo", ParticleFormat::bgeo}},
                                                            request.particles, "--particles");
  const auto take_length = [](const std::optional<float>& given, const char* option, float& value) {
    if (given && !(*given > 0)) throw Error(std::string(option) + ": expected a length above 0 [m]");
    value = given.value_or(0);
  };
  take_length(request.spacing, "--spacing", order.surface.spacing);
  take_length(request.cell, "--cell", order.surface.cell);
  if (request.smoothing) {
    if (*request.smoothing > 1000) throw Error("--smoothing: expected at most 1000 passes");
    order.surface.smoothing_passes = static_cast<int>(*request.smoothing);
  }
  order.out = request.out.empty() ? default_out(request.cache) : request.out;
  return order;
}

/// Objects made of particles: those that were asked for; else all fluids; else all grains.
std::vector<std::size_t> chosen_objects(const SurfaceRequest& request, const Playback& playback) {
  const auto of_kind = [&](const char* kind) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < playback.objects().size(); ++i)
      if (playback.objects()[i].kind == kind) found.push_back(i);
    return found;
  };
  std::vector<std::size_t> chosen = of_kind("fluid");
  const std::vector<std::size_t> grains = of_kind("grains");
  if (request.objects.empty()) {
    if (chosen.empty()) chosen = grains;
    if (chosen.empty())
      throw Error(request.cache.string() +
                  ": has neither fluids nor grains; only of particles a surface is made");
    return chosen;
  }
  chosen.insert(chosen.end(), grains.begin(), grains.end());
  std::vector<std::string> known;
  known.reserve(chosen.size());
  for (const std::size_t i : chosen) known.push_back(playback.objects()[i].name);
  std::vector<std::size_t> result;
  for (const std::string& name : request.objects) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw Error("--object \"" + name + "\": " + request.cache.string() +
                  " has no fluid or grains of that name" + scene_format::suggestion(name, known));
    result.push_back(chosen[static_cast<std::size_t>(found - known.begin())]);
  }
  return result;
}

struct Spacing {
  float operator()(const FluidDescription& fluid) const { return fluid.material.spacing; }
  float operator()(const GrainsDescription& grains) const { return 2 * grains.material.radius; }
  float operator()(const ObjectDescription&) const { return 0; }
};

/// As the scene that run.json embeds says.
float spacing_of(const Playback& playback, const std::string& object, const fs::path& cache) {
  const std::string& text = playback.manifest().scene;
  if (!text.empty()) {
    const SceneDescription scene = parse_recorded_scene(text, cache.string() + ": embedded scene");
    for (const AnyObjectDescription& description : scene.objects) {
      const float spacing = std::visit(Spacing{}, description);
      if (common(description).name == object && spacing > 0) return spacing;
    }
  }
  throw Error("--spacing is needed: " + cache.string() + " does not tell how far particles of \"" + object +
              "\" lie apart [m]");
}

/// The files of one object.
class SurfaceFiles {
 public:
  SurfaceFiles(const Order& order, float spacing, std::string object, const std::string& file_name,
               Threads& threads)
      : object_(std::move(object)),
        file_name_(file_name),
        format_(order.format),
        threads_(threads),
        surface_(with_spacing(order.surface, spacing)),
        meshes_(order.out, file_name, extension_of(format_), [this](auto, auto) { return bytes(); }) {
    if (order.particles) {
      const ParticleFormat format = *order.particles;
      particles_.emplace(order.out, file_name + "_particles", std::string(particle_format_name(format)),
                         [format](auto positions, auto velocities) {
                           return particle_bytes(format, positions, velocities);
                         });
    }
  }
  SurfaceFiles(const SurfaceFiles&) = delete;
  SurfaceFiles& operator=(const SurfaceFiles&) = delete;

  /// `rate` of frames [1/s]. An object that is not there, or too thin for the grid, has no file.
  void write(std::uint64_t frame, const Playback::Object& object, double rate) {
    const std::span<const Vec3f> positions = object.positions;
    const SurfaceMesh& mesh = surface_.build(positions, threads_);
    vertices_ += mesh.positions.size();
    triangles_ += mesh.triangles.size();
    milliseconds_ += surface_.times().all();
    if (!mesh.triangles.empty()) {
      meshes_.skip_to(frame);
      meshes_.append(mesh.positions, {});
      if (listed_.files.empty()) list_first(frame, mesh);
      ++listed_.files.front().frames;
    }
    if (particles_ && !positions.empty()) {
      particles_->skip_to(frame);
      particles_->append(positions, object.velocities.empty()
                                        ? differences(positions, static_cast<float>(rate))
                                        : std::span<const Vec3f>(object.velocities));
    }
    before_.assign(positions.begin(), positions.end());
  }
  void finish() {
    meshes_.finish();
    if (particles_) particles_->finish();
  }
  const ManifestObject& listed() const { return listed_; }
  std::uint64_t triangles() const { return triangles_; }
  double milliseconds() const { return milliseconds_; }

 private:
  static SurfaceOptions with_spacing(SurfaceOptions options, float spacing) {
    options.spacing = spacing;
    return options;
  }
  std::string bytes() {
    const SurfaceMesh& mesh = surface_.mesh();
    if (format_ == Format::obj) return obj_text(mesh.positions, mesh.normals, mesh.triangles);
    if (format_ == Format::ply) return ply_bytes(mesh.positions, mesh.normals, mesh.triangles);
    const float cell = surface_.options().cell;
    return vdb_bytes(narrow_band(mesh.positions, mesh.triangles, cell, band_cells, threads_), object_);
  }
  void list_first(std::uint64_t frame, const SurfaceMesh& mesh) {
    const std::string extension = extension_of(format_);
    listed_ = {object_, "fluid", {{extension, frame_file_name(file_name_, frame, extension), 0}}, 0, 0};
    if (format_ == Format::vdb) return;  // has neither
    listed_.points = mesh.positions.size();
    listed_.triangles = mesh.triangles.size();
  }
  /// Where the cache holds positions only: the way since the frame before, over its time. 0 where there was
  /// no such frame, or another number of particles.
  std::span<const Vec3f> differences(std::span<const Vec3f> positions, float rate) {
    velocities_.assign(positions.size(), {});
    if (before_.size() == positions.size())
      for (std::size_t i = 0; i < positions.size(); ++i) velocities_[i] = (positions[i] - before_[i]) * rate;
    return velocities_;
  }

  std::string object_, file_name_;
  Format format_;
  Threads& threads_;
  FluidSurface surface_;
  SequenceWriter meshes_;
  std::optional<SequenceWriter> particles_;
  ManifestObject listed_;
  std::vector<Vec3f> before_, velocities_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  double milliseconds_ = 0;
};

/// Frame by frame.
class Work {
 public:
  Work(const SurfaceRequest& request, const Order& order, Playback& playback)
      : order_(order),
        playback_(playback),
        threads_(make_threads(Threading::automatic, request.threads.value_or(0))) {
    FileNames names;
    for (const std::size_t i : chosen_objects(request, playback)) {
      const std::string& name = playback.objects()[i].name;
      const float spacing = request.spacing ? *request.spacing : spacing_of(playback, name, request.cache);
      objects_.push_back(
          {i, std::make_unique<SurfaceFiles>(order, spacing, name, names.add(name), *threads_)});
    }
  }

  /// Returns whether all frames were done.
  bool run(const SurfaceRequest& request) {
    Progress progress(request.cache.string(), playback_.frames(), 0, request.quiet);
    for (std::uint64_t frame = 1; frame <= playback_.frames() && !interrupt_came(); ++frame) {
      playback_.read(frame);
      const double before = frame > 1 ? playback_.time(frame - 1) : 0;
      const double rate = 1 / (playback_.time(frame) - before);
      for (const auto& [index, files] : objects_) files->write(frame, playback_.objects()[index], rate);
      frames_ = frame;
      progress.frame_done(frame);
    }
    for (const auto& object : objects_) object.second->finish();
    write_manifest(order_.out, manifest());
    return frames_ == playback_.frames();
  }

  std::uint64_t frames() const { return frames_; }
  std::string summary() const {
    std::uint64_t triangles = 0;
    double milliseconds = 0;
    for (const auto& object : objects_)
      triangles += object.second->triangles(), milliseconds += object.second->milliseconds();
    char text[160];
    const double count = static_cast<double>(std::max<std::uint64_t>(1, frames_));
    std::snprintf(text, sizeof text, "%llu frames, %.0f triangles and %.1f ms each",
                  static_cast<unsigned long long>(frames_), static_cast<double>(triangles) / count,
                  milliseconds / count);
    return text;
  }

 private:
  RunManifest manifest() const {
    const RunManifest& source = playback_.manifest();
    RunManifest result;
    result.version = version;
    result.complete = source.complete && frames_ == playback_.frames();
    result.scene = source.scene;
    result.frame_rate = source.frame_rate;
    result.frames = frames_;
    for (const auto& object : objects_)
      if (!object.second->listed().files.empty()) result.objects.push_back(object.second->listed());
    result.notes = {"surfaces of particles, by souple surface"};
    for (const FrameReport& report : source.reports)
      if (report.frame <= frames_) result.reports.push_back({report.frame, report.time, {}, {}, {}});
    return result;
  }

  const Order& order_;
  Playback& playback_;
  std::unique_ptr<Threads> threads_;
  std::vector<std::pair<std::size_t, std::unique_ptr<SurfaceFiles>>> objects_;
  std::uint64_t frames_ = 0;
};

}  // namespace

int surface(const SurfaceRequest& request) {
  const Order order = order_of(request);
  Playback playback(request.cache);
  if (playback.frames() == 0)
    throw Error(request.cache.string() + ": holds no frame yet; expected at least one");
  Work work(request, order, playback);
  std::error_code ignored;
  const fs::path source =
      request.cache.filename() == "run.json" ? request.cache.parent_path() : request.cache;
  if (fs::equivalent(source.empty() ? "." : source, order.out, ignored))
    throw Error("--out " + order.out.string() + ": is the folder that is read; choose another");
  create_folder(order.out);
  // From here on files appear; an interrupt ends the work in good order.
  watch_interrupts();
  try {
    if (!work.run(request)) {
      std::fprintf(stderr, "souple: interrupted after frame %llu of %llu; %s holds these\n",
                   static_cast<unsigned long long>(work.frames()),
                   static_cast<unsigned long long>(playback.frames()), order.out.string().c_str());
      return interrupted;
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  }
  if (!request.quiet) std::printf("%s: %s\n", order.out.string().c_str(), work.summary().c_str());
  return fine;
}

}  // namespace souple::app
