#include "app/run_surfaces.h"

#include "souple/files/file.h"
#include "souple/io/earlier_run.h"
#include "souple/io/recorder_names.h"

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

}  // namespace

RunSurfaces::RunSurfaces(const std::string& method, const SceneDescription& scene, const World& world,
                         const fs::path& run, std::uint64_t done)
    : run_(run),
      rate_(scene.frame_rate),
      threads_(make_threads(Threading::automatic, scene.settings.threads)),
      fluids_(objects_of(world, ObjectKind::fluid)),
      frames_(done),
      done_before_(done) {
  file_options_.surface.method = surface_method_of(method, "--surface");
  file_options_.out = surface_folder(run);
  if (fluids_.empty()) fluids_ = objects_of(world, ObjectKind::grains);
  if (fluids_.empty())
    throw Error("--surface " + method + ": " + scene.source +
                " has neither fluids nor grains; expected an object of particles to mesh");
  const RunManifest before = done > 0 ? read_manifest(file_options_.out) : RunManifest{};
  FileNames names;
  for (const ObjectId fluid : fluids_) {
    const std::string& name = world.name(fluid);
    files_.push_back(std::make_unique<SurfaceFiles>(file_options_, spacing_in(scene, name), name,
                                                    names.add(name), *threads_));
    if (done > 0) files_.back()->resume(before, done);
  }
}

void RunSurfaces::start() {
  create_folder(file_options_.out);
  EarlierRun(file_options_.out).remove();
}

void RunSurfaces::write(const World& world, std::uint64_t frame) {
  for (std::size_t i = 0; i < fluids_.size(); ++i)
    files_[i]->write(frame, world.positions(fluids_[i]), world.velocities(fluids_[i]), rate_);
  frames_ = frame;
}

void RunSurfaces::save() const {
  write_manifest(file_options_.out, surface_manifest(read_manifest(run_), frames_, files_));
}

void RunSurfaces::finish() {
  for (const auto& files : files_) files->finish();
  save();
}

std::string RunSurfaces::summary() const {
  return file_options_.out.string() + ": " + surface_summary(frames_ - done_before_, files_);
}

}  // namespace souple::app
