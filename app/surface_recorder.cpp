#include "app/surface_recorder.h"

#include <utility>

namespace souple::app {

SurfaceRecorder::SurfaceRecorder(std::filesystem::path folder, RunManifest source)
    : source_(std::move(source)), run_json_(std::move(folder)) {
  source_.reports.clear();
}

void SurfaceRecorder::resume(const RunManifest& before, std::uint64_t done) {
  frames_ = done;
  for (const FrameReport& report : before.reports)
    if (report.frame <= done) run_json_.add(report);
}

void SurfaceRecorder::add(std::uint64_t frame, const std::optional<double>& time) {
  if (time) run_json_.add({frame, *time, {}, {}, {}});
  std::size_t listed = 1;
  for (const auto& object : objects_) listed += object->manifest_object().files.empty() ? 0 : 1;
  if (listed != listed_) run_json_.expect(manifest(false));
  listed_ = listed;
  frames_ = frame;
}

RunManifest SurfaceRecorder::manifest(bool complete) const {
  RunManifest result = surface_manifest(source_, frames_, objects_);
  result.complete = complete && frames_ == source_.frames;
  return result;
}

void SurfaceRecorder::save(bool complete) {
  run_json_.save(manifest(complete));
}

void SurfaceRecorder::finish(bool complete) {
  for (const auto& object : objects_) object->drop_after(frames_);
  for (const auto& object : objects_) object->finish();
  run_json_.drop_after(frames_);
  save(complete);
  run_json_.release();
}

}  // namespace souple::app
