#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/surface_files.h"
#include "app/vdb.h"
#include "souple/error.h"
#include "souple/io/file.h"
#include "souple/io/playback.h"
#include "souple/io/recorder_names.h"
#include "souple/scene/nearest.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <system_error>
#include <utility>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

SurfaceOrder order_of(const SurfaceRequest& request) {
  SurfaceOrder order;
  order.surface.method = surface_method_of(request.method, "--method");
  order.format = value_of<SurfaceFormat>(
      {{"obj", SurfaceFormat::obj}, {"ply", SurfaceFormat::ply}, {"vdb", SurfaceFormat::vdb}}, request.format,
      "--format");
  if (order.format == SurfaceFormat::vdb) require_vdb();
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
  order.out = request.out.empty() ? surface_folder(request.cache) : request.out;
  return order;
}

/// The objects to mesh: the requested ones, else all fluids, else all grains.
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

/// Spacing from the scene embedded in run.json.
float spacing_of(const Playback& playback, const std::string& object, const fs::path& cache) {
  const std::string& text = playback.manifest().scene;
  if (!text.empty()) {
    const SceneDescription scene = parse_recorded_scene(text, cache.string() + ": embedded scene");
    for (const AnyObjectDescription& description : scene.objects) {
      const float spacing = particle_spacing(description);
      if (common(description).name == object && spacing > 0) return spacing;
    }
  }
  throw Error("--spacing is needed: " + cache.string() + " does not tell how far particles of \"" + object +
              "\" lie apart [m]");
}

/// Meshes frame by frame.
class Work {
 public:
  Work(const SurfaceRequest& request, const SurfaceOrder& order, Playback& playback)
      : order_(order),
        playback_(playback),
        threads_(make_threads(Threading::automatic, request.threads.value_or(0))) {
    FileNames names;
    for (const std::size_t i : chosen_objects(request, playback)) {
      const std::string& name = playback.objects()[i].name;
      const float spacing = request.spacing ? *request.spacing : spacing_of(playback, name, request.cache);
      objects_.push_back(std::make_unique<SurfaceFiles>(order, spacing, name, names.add(name), *threads_));
      indices_.push_back(i);
    }
  }

  /// Returns whether all frames were done.
  bool run(const SurfaceRequest& request) {
    Progress progress(request.cache.string(), playback_.frames(), 0, request.quiet);
    for (std::uint64_t frame = 1; frame <= playback_.frames() && !interrupt_came(); ++frame) {
      playback_.read(frame);
      const double before = frame > 1 ? playback_.time(frame - 1) : 0;
      const double rate = 1 / (playback_.time(frame) - before);
      for (std::size_t i = 0; i < objects_.size(); ++i) {
        const Playback::Object& object = playback_.objects()[indices_[i]];
        objects_[i]->write(frame, object.positions, object.velocities, rate);
      }
      frames_ = frame;
      progress.frame_done(frame);
    }
    for (const auto& object : objects_) object->finish();
    write_manifest(order_.out, surface_manifest(playback_.manifest(), frames_, objects_));
    return frames_ == playback_.frames();
  }

  std::uint64_t frames() const { return frames_; }
  std::string summary() const { return surface_summary(frames_, objects_); }

 private:
  const SurfaceOrder& order_;
  Playback& playback_;
  std::unique_ptr<Threads> threads_;
  ObjectFiles objects_;
  std::vector<std::size_t> indices_;  // per object: its index in the playback
  std::uint64_t frames_ = 0;
};

}  // namespace

int surface(const SurfaceRequest& request) {
  const SurfaceOrder order = order_of(request);
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
  // From here on files exist: an interrupt must leave them complete.
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
