#include "souple/io/recorder.h"

#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"
#include "souple/io/earlier_run.h"
#include "souple/io/manifest.h"
#include "souple/io/manifest_writer.h"
#include "souple/io/recorded_foam.h"
#include "souple/io/recorded_object.h"
#include "souple/io/recorder_names.h"
#include "souple/io/recorder_report.h"
#include "souple/version.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace fs = std::filesystem;

namespace {

RecordingPlan checked_plan(fs::path folder, const RecorderOptions& options) {
  if (options.formats.empty())
    throw Error("the recorder for " + folder.string() +
                " has no format; give at least one, e.g. CacheFormat::pc2");
  if (!std::isfinite(options.frame_rate) || !(options.frame_rate > 0))
    throw Error(fmt::format("the recorder for {} has a frame rate of {}; expected a number > 0",
                            folder.string(), options.frame_rate));
  return {std::move(folder), options.formats, options.frame_rate, options.frames};
}

}  // namespace

struct Recorder::Impl {
  Impl(const World& recorded, fs::path folder, const RecorderOptions& options)
      : world(recorded),
        plan(checked_plan(std::move(folder), options)),
        scene(options.scene),
        run_json(plan.folder) {
    if (!options.locked) lock.emplace(OutputLock::of_folder(plan.folder));
    if (options.resume_from > 0) {
      resume(options.resume_from);
      save_manifest();
    } else {
      create_folder(plan.folder);
      EarlierRun earlier_run(plan.folder);
      earlier_run.remove();
      start(earlier_run);
    }
  }

  void start(EarlierRun& earlier_run);
  void resume(std::uint64_t from);
  RecordedObject* find(const std::string& name);
  void note_loose_vertices();
  void look_for_changes();
  void look_for_foam();
  void join(ObjectId object);
  void capture();
  void reserve_manifest();
  RunManifest manifest() const;
  void save_manifest();
  void finish();

  const World& world;
  RecordingPlan plan;
  std::optional<OutputLock> lock;
  std::string scene;
  FileNames names;
  std::vector<std::unique_ptr<RecordedObject>> objects;  ///< including removed ones
  std::unique_ptr<RecordedFoam> foam;                    ///< null: no foam so far
  std::vector<ManifestObject> earlier;                   ///< removed before the run resumed
  std::vector<std::string> notes;
  ManifestWriter run_json;
  std::size_t listed = 0;  ///< number of objects and notes in the run.json whose space is reserved
  std::uint64_t frames = 0;
  std::uint64_t next_save = 16;  ///< frame at which capture writes run.json again
  bool finished = false;
  bool broken = false;  ///< files could not be restored after a failure
};

/// Leaves no file behind if one of them cannot be written.
void Recorder::Impl::start(EarlierRun& earlier_run) {
  try {
    for (const ObjectId object : world.objects())
      objects.push_back(std::make_unique<RecordedObject>(plan, world, object, names.add(world.name(object))));
    earlier_run.remove_caches();
    note_loose_vertices();
    look_for_foam();
    save_manifest();
  } catch (...) {
    for (const auto& object : objects) object->discard();
    throw;
  }
}

void Recorder::Impl::resume(std::uint64_t from) {
  RunManifest before = read_manifest(plan.folder / "run.json");
  const auto known = [&](const std::string& name) {
    return std::find_if(before.objects.begin(), before.objects.end(),
                        [&](const ManifestObject& object) { return object.name == name; });
  };
  // Validates everything before any change.
  const std::vector<ObjectId> present = world.objects();
  for (const ObjectId object : present) {
    const auto found = known(world.name(object));
    if (found == before.objects.end())
      throw Error(plan.folder.string() + ": the stopped run has no object \"" + world.name(object) +
                  "\"; resume with the world that was recorded");
    if (!same_topology(world, object, *found))
      throw Error(fmt::format(
          "{}: \"{}\" is not what was recorded: a {} of {} points and {} triangles; resume with the world "
          "that was recorded",
          plan.folder.string(), world.name(object), found->kind, found->points, found->triangles));
  }
  for (const FrameReport& report : before.reports)
    if (report.frame <= from) run_json.add(report);
  run_json.expect(before);
  for (const ObjectId object : present)
    objects.push_back(
        std::make_unique<RecordedObject>(plan, world, object, names.add(world.name(object)),
                                         RecordedObject::Resume{from, known(world.name(object))->points}));
  for (const ManifestObject& object : before.objects) {
    if (object.kind == foam_kind_name) {
      foam = std::make_unique<RecordedFoam>(plan, names.add(foam_kind_name), 0, from);
      continue;
    }
    if (!find(object.name)) earlier.push_back(object), names.add(object.name);
  }
  notes = std::move(before.notes);
  for (const auto& object : objects) {
    if (!object->restore_rest_mesh(world)) continue;
    notes.push_back(fmt::format("{}: its rest mesh was missing and was written again after frame {}",
                                object->name(), from));
  }
  frames = from;
  next_save = frames + frames / 2 + 16;
}

void Recorder::Impl::note_loose_vertices() {
  for (const auto& object : objects) {
    const std::size_t loose = object->loose_vertices();
    if (loose == 0) continue;
    notes.push_back(fmt::format(
        "{}: {} of its vertices belong to no face; Blender drops them from the OBJ and then refuses the "
        "cache: "
        "delete them from the mesh, or put the cache on the object that the mesh was exported from",
        object->name(), loose));
  }
}

RecordedObject* Recorder::Impl::find(const std::string& name) {
  for (const auto& object : objects) {
    if (object->name() == name) return object.get();
  }
  return nullptr;
}

void Recorder::Impl::join(ObjectId object) {
  const std::string& name = world.name(object);
  RecordedObject* known = find(name);
  if (known) {
    if (known->take_over(world, object, frames)) return;
    notes.push_back(fmt::format(
        "{}: is another after frame {}, which PC2 and MDD cannot hold; from then on it is written as {}, ...",
        name, frames, known->next_file()));
    return;
  }
  const std::string file_name = names.add(name);
  if (frames == 0) {
    objects.push_back(std::make_unique<RecordedObject>(plan, world, object, file_name));
    return;
  }
  objects.push_back(
      std::make_unique<RecordedObject>(plan, world, object, file_name, RecordedObject::Late{frames}));
  notes.push_back(fmt::format("{}: was added after frame {}; it is written as {}, ...", name, frames,
                              objects.back()->next_file()));
}

void Recorder::Impl::look_for_changes() {
  const std::vector<ObjectId> present = world.objects();
  for (const ObjectId object : present) {
    const RecordedObject* known = find(world.name(object));
    if (!known || !known->present() || !(known->object() == object)) join(object);
  }
  for (const auto& object : objects) {
    if (!object->present() || world.contains(object->object())) continue;
    object->leave();
    notes.push_back(
        fmt::format("{}: was removed after frame {}; its files end there", object->name(), frames));
  }
  look_for_foam();
}

void Recorder::Impl::look_for_foam() {
  if (!foam && foams(world))
    foam = std::make_unique<RecordedFoam>(plan, names.add(foam_kind_name), frames, 0);
}

void Recorder::Impl::capture() {
  if (finished)
    throw Error(plan.folder.string() + ": the recorder is finished; nothing can be captured any more");
  if (broken)
    throw Error(plan.folder.string() +
                ": an earlier frame could not be written; resume the run from a checkpoint");
  try {
    look_for_changes();
    for (const auto& object : objects) {
      if (object->present()) object->append(world, frames + 1);
    }
    if (foam) foam->append(world);
    run_json.add(frame_report(frames + 1, world.time(), world.report()));
    reserve_manifest();
  } catch (...) {
    try {
      run_json.drop_after(frames);
      for (const auto& object : objects) object->drop_after(frames);
      if (foam) foam->drop_after(frames);
    } catch (...) {
      broken = true;
    }
    throw;
  }
  ++frames;
  if (frames < next_save) return;
  next_save = frames + frames / 2;  // all writes together cost three times the last one
  try {
    save_manifest();
  } catch (const Error&) {
    // The frame is written. A full disk causes an error at the next frame, or at the end.
  }
}

/// The first frame adds caches to run.json, later ones what changed.
void Recorder::Impl::reserve_manifest() {
  const std::size_t now = objects.size() + notes.size() + (foam ? 1 : 0);
  if (frames > 0 && now == listed) return;
  run_json.expect(manifest());
  listed = now;
}

/// run.json without its reports.
RunManifest Recorder::Impl::manifest() const {
  RunManifest manifest;
  manifest.version = version;
  manifest.complete = finished && frames >= plan.frames;
  manifest.scene = scene;
  manifest.settings = settings_text(world.settings());
  manifest.frame_rate = plan.frame_rate;
  manifest.frames = frames;
  manifest.objects = earlier;
  for (const auto& object : objects) manifest.objects.push_back(object->manifest());
  if (foam && foam->has_files()) manifest.objects.push_back(foam->manifest());
  manifest.notes = notes;
  return manifest;
}

void Recorder::Impl::save_manifest() {
  run_json.save(manifest());
}

void Recorder::Impl::finish() {
  if (finished) return;
  std::exception_ptr first;
  const auto try_to = [&](const auto& action) {
    try {
      action();
    } catch (...) {
      if (!first) first = std::current_exception();
    }
  };
  for (const auto& object : objects) try_to([&] { object->finish(); });
  if (foam) try_to([&] { foam->finish(); });
  finished = !first;
  try_to([&] { save_manifest(); });
  finished = !first;
  if (first) std::rethrow_exception(first);
  run_json.release();
  lock.reset();
}

Recorder::Recorder(const World& world, const std::string& folder, const RecorderOptions& options)
    : impl_(std::make_unique<Impl>(world, folder, options)) {}

Recorder::~Recorder() {
  try {
    impl_->finish();
  } catch (...) {
    // Unfinished files remain as .part; finish() throws the reason.
  }
}

void Recorder::capture() {
  impl_->capture();
}

void Recorder::save_manifest() {
  impl_->save_manifest();
}

void Recorder::finish() {
  impl_->finish();
}

std::uint64_t Recorder::frames() const {
  return impl_->frames;
}

const std::vector<std::string>& Recorder::notes() const {
  return impl_->notes;
}

}  // namespace souple
