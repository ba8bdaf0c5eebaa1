#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/option_names.h"
#include "app/progress.h"
#include "app/surface_files.h"
#include "app/surface_recorder.h"
#include "app/vdb.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"
#include "souple/io/earlier_run.h"
#include "souple/io/playback.h"
#include "souple/io/recorder_names.h"
#include "souple/scene/nearest.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

SurfaceFileOptions file_options_of(const SurfaceRequest& request) {
  SurfaceFileOptions file_options;
  file_options.surface.method = surface_method_of(request.method, "--method");
  file_options.format = value_of<SurfaceFormat>(
      {{"obj", SurfaceFormat::obj}, {"ply", SurfaceFormat::ply}, {"vdb", SurfaceFormat::vdb}}, request.format,
      "--format");
  if (file_options.format == SurfaceFormat::vdb) require_vdb();
  file_options.particles = value_of<std::optional<ParticleFormat>>({{"none", std::nullopt},
                                                                    {"ply", ParticleFormat::ply},
                                                                    {"vtk", ParticleFormat::vtk},
                                                                    {"bgeo", ParticleFormat::bgeo}},
                                                                   request.particles, "--particles");
  const auto take_length = [](const std::optional<float>& given, const char* option, float& value) {
    if (given && !(*given > 0)) throw Error(std::string(option) + ": expected a length above 0 [m]");
    value = given.value_or(0);
  };
  take_length(request.spacing, "--spacing", file_options.surface.spacing);
  take_length(request.cell, "--cell", file_options.surface.cell);
  if (request.smoothing) {
    if (*request.smoothing > 1000) throw Error("--smoothing: expected at most 1000 passes");
    file_options.surface.smoothing_passes = static_cast<int>(*request.smoothing);
  }
  file_options.out = request.out.empty() ? surface_folder(request.cache) : request.out;
  return file_options;
}

/// Indices of particle objects to mesh: the requested objects; by default all fluids; without fluids all
/// grains.
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
                  ": has neither fluids nor grains; expected an object of particles to mesh");
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

/// The particle spacing from the scene that run.json embeds.
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

/// The run.json of the run, without reports.
RunManifest source_of(const Playback& playback) {
  const RunManifest& manifest = playback.manifest();
  RunManifest source;
  source.scene = manifest.scene;
  source.frame_rate = manifest.frame_rate;
  source.frames = manifest.frames;
  return source;
}

/// Meshes frame by frame.
class MeshingJob {
 public:
  MeshingJob(const SurfaceRequest& request, const SurfaceFileOptions& file_options, Playback& playback)
      : file_options_(file_options),
        playback_(playback),
        threads_(make_threads(Threading::automatic, request.threads.value_or(0))),
        recorder_(file_options.out, source_of(playback)) {
    FileNames names;
    for (const std::size_t i : chosen_objects(request, playback)) {
      const std::string& name = playback.objects()[i].name;
      const float spacing = request.spacing ? *request.spacing : spacing_of(playback, name, request.cache);
      recorder_.objects().push_back(
          std::make_unique<SurfaceFiles>(file_options, spacing, name, names.add(name), *threads_));
      indices_.push_back(i);
    }
  }

  /// Returns whether all frames are complete. Where one fails, the folder holds those before it.
  bool run(const SurfaceRequest& request) {
    const bool complete = playback_.manifest().complete;
    try {
      mesh(request);
    } catch (...) {
      try {
        recorder_.finish(complete);
      } catch (...) {  // the first failure says more
      }
      throw;
    }
    recorder_.finish(complete);
    return frames() == playback_.frames();
  }

  std::uint64_t frames() const { return recorder_.frames(); }
  std::string summary() const { return surface_summary(frames(), recorder_.objects()); }

 private:
  void mesh(const SurfaceRequest& request) {
    bool announced = false;
    Progress progress(request.cache.string(), playback_.frames(), 0, request.quiet);
    for (std::uint64_t frame = 1; frame <= playback_.frames() && !interrupt_requested(); ++frame) {
      playback_.read(frame);
      const double before = frame > 1 ? playback_.time(frame - 1) : 0;
      const double rate = 1 / (playback_.time(frame) - before);
      for (std::size_t i = 0; i < indices_.size(); ++i) {
        const Playback::Object& object = playback_.objects()[indices_[i]];
        recorder_.objects()[i]->write(frame, object.positions, object.velocities, rate);
      }
      recorder_.add(frame, time_of_report(frame));
      if (!announced && !request.quiet) announced = announce(frame, progress.seconds());
      progress.frame_done(frame);
    }
  }

  /// Without a value for a frame of a killed run, whose run.json lacks its last frames.
  std::optional<double> time_of_report(std::uint64_t frame) const {
    const std::vector<FrameReport>& reports = playback_.manifest().reports;
    const auto found =
        std::lower_bound(reports.begin(), reports.end(), frame,
                         [](const FrameReport& report, std::uint64_t f) { return report.frame < f; });
    if (found == reports.end() || found->frame != frame) return std::nullopt;
    return found->time;
  }

  /// After the first frame with a mesh: what all will take, in time and on the disk.
  bool announce(std::uint64_t frame, double seconds) const {
    std::uint64_t bytes = 0;
    for (const auto& object : recorder_.objects()) bytes += object->bytes_of(frame);
    if (bytes == 0) return false;
    const auto left = static_cast<double>(playback_.frames() - frame + 1);
    std::printf("%s: about %s in %llu frames, about %s\n", file_options_.out.string().c_str(),
                bytes_text(static_cast<double>(bytes) * left).c_str(),
                static_cast<unsigned long long>(playback_.frames()),
                duration_text(seconds / static_cast<double>(frame) * left).c_str());
    std::fflush(stdout);
    return true;
  }

  const SurfaceFileOptions& file_options_;
  Playback& playback_;
  std::unique_ptr<Threads> threads_;
  SurfaceRecorder recorder_;
  std::vector<std::size_t> indices_;  // per object: index in the playback
};

}  // namespace

int surface(const SurfaceRequest& request) {
  const SurfaceFileOptions file_options = file_options_of(request);
  Playback playback(request.cache);
  if (playback.frames() == 0)
    throw Error(request.cache.string() + ": holds no frame yet; expected at least one");
  MeshingJob job(request, file_options, playback);
  std::error_code ignored;
  const fs::path source =
      request.cache.filename() == "run.json" ? request.cache.parent_path() : request.cache;
  if (fs::equivalent(source.empty() ? "." : source, file_options.out, ignored))
    throw Error("--out " + file_options.out.string() + ": is the input folder; choose another");
  const OutputLock lock = OutputLock::of_folder(file_options.out);
  create_folder(file_options.out);
  EarlierRun(file_options.out).remove();
  // From here on files are written; an interrupt ends the work with complete files.
  watch_interrupts();
  try {
    if (!job.run(request)) {
      std::fprintf(stderr, "souple: interrupted after frame %llu of %llu; %s holds these frames\n",
                   static_cast<unsigned long long>(job.frames()),
                   static_cast<unsigned long long>(playback.frames()), file_options.out.string().c_str());
      return interrupted;
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  }
  if (!request.quiet) std::printf("%s: %s\n", file_options.out.string().c_str(), job.summary().c_str());
  return success;
}

}  // namespace souple::app
