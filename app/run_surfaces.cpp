#include "app/run_surfaces.h"

#include "souple/files/file.h"
#include "souple/io/earlier_run.h"
#include "souple/io/recorder_names.h"

#include <utility>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

std::vector<ObjectId> objects_of(const World& world, ObjectKind kind) {
  std::vector<ObjectId> found;
  for (const ObjectId object : world.objects())
    if (world.kind(object) == kind) found.push_back(object);
  return found;
}

float spacing_in(const SceneDescription& scene, const std::string& name) {
  for (const AnyObjectDescription& description : scene.objects)
    if (common(description).name == name) return particle_spacing(description);
  return 0;
}

SurfaceFileOptions file_options(const std::string& method, const fs::path& run) {
  SurfaceFileOptions options;
  options.surface.method = surface_method_of(method, "--surface");
  options.out = surface_folder(run);
  return options;
}

/// Contents of the run.json of the whole run.
RunManifest planned(const SceneDescription& scene) {
  RunManifest manifest;
  manifest.scene = to_json(scene);
  manifest.frame_rate = scene.frame_rate;
  manifest.frames = scene.frames;
  return manifest;
}

}  // namespace

RunSurfaces::RunSurfaces(const std::string& method, const SceneDescription& scene, const World& world,
                         const fs::path& run, std::uint64_t done)
    : file_options_(file_options(method, run)),
      rate_(scene.frame_rate),
      threads_(make_threads(Threading::automatic, scene.settings.threads)),
      fluids_(objects_of(world, ObjectKind::fluid)),
      recorder_(file_options_.out, planned(scene)),
      done_before_(done) {
  if (fluids_.empty()) fluids_ = objects_of(world, ObjectKind::grains);
  if (fluids_.empty())
    throw Error("--surface " + method + ": " + scene.source +
                " has neither fluids nor grains; expected an object of particles to mesh");
  if (done > 0) before_ = read_manifest(file_options_.out);
  FileNames names;
  for (const ObjectId fluid : fluids_) {
    const std::string& name = world.name(fluid);
    recorder_.objects().push_back(std::make_unique<SurfaceFiles>(file_options_, spacing_in(scene, name), name,
                                                                 names.add(name), *threads_));
    if (done > 0) recorder_.objects().back()->resume(before_, done);
  }
}

void RunSurfaces::start() {
  if (done_before_ > 0) return recorder_.resume(std::exchange(before_, {}), done_before_);
  create_folder(file_options_.out);
  EarlierRun(file_options_.out).remove();
}

void RunSurfaces::write(const World& world, std::uint64_t frame) {
  for (std::size_t i = 0; i < fluids_.size(); ++i)
    recorder_.objects()[i]->write(frame, world.positions(fluids_[i]), world.velocities(fluids_[i]), rate_);
  recorder_.add(frame, world.time());
}

std::string RunSurfaces::summary() const {
  return file_options_.out.string() + ": " +
         surface_summary(recorder_.frames() - done_before_, recorder_.objects());
}

}  // namespace souple::app
