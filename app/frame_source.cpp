#include "app/frame_source.h"

#include "app/cache_subject.h"
#include "app/check_pictures.h"
#include "app/find_scene.h"
#include "app/pictures.h"
#include "app/scene_colors.h"
#include "app/step_failure.h"
#include "souple/error.h"
#include "souple/io/export_frames.h"

#include <optional>
#include <utility>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

class SceneFrames : public FrameSource {
 public:
  SceneFrames(const fs::path& file, const std::vector<std::string>& settings)
      : name_(file.stem().string()), scene_(load_scene(file, settings)), world_(build_world(scene_)) {
    check_pictures(scene_);
  }

  std::string name() const override { return name_; }
  std::uint64_t frames() const override { return scene_.frames; }
  double frame_rate() const override { return scene_.frame_rate; }
  const CameraDescription* camera() const override { return &scene_.camera; }
  bool has_world() const override { return true; }

  AdvanceResult advance_to(std::uint64_t frame, const ShouldContinue& should_continue) override {
    while (frame_ < frame) {
      if (frame_ > 0 && !should_continue(frame_)) return AdvanceResult::stopped;
      const StepReport& report = world_.step(1 / scene_.frame_rate);
      if (!report.ok()) {
        failure_ = step_failure_text(scene_.source, report, frame_ + 1);
        if (report.outcome == StepOutcome::refused) throw Error(failure_);
        return AdvanceResult::non_finite;
      }
      ++frame_;
    }
    return AdvanceResult::reached;
  }
  render::ExtremePoints covered(const std::vector<std::uint64_t>& frames,
                                const ShouldContinue& should_continue) override {
    render::ExtremePoints extent;
    World world = build_world(scene_);
    std::uint64_t done = 0;
    for (const std::uint64_t frame : frames) {
      for (; done < frame; ++done) {
        if (done > 0 && !should_continue(done)) return extent;
        if (!world.step(1 / scene_.frame_rate).ok()) return extent;
      }
      extent.add(extent_with_colliders(render::subject_of(world)));
    }
    return extent;
  }
  std::uint64_t frame() const override { return frame_; }
  double time() const override { return static_cast<double>(frame_) / scene_.frame_rate; }
  const render::Subject& subject() override {
    subject_ = render::subject_of(world_);
    add_colors(scene_, subject_);
    return subject_;
  }
  std::string failure() const override { return failure_; }

 private:
  std::string name_, failure_;
  SceneDescription scene_;
  World world_;
  std::uint64_t frame_ = 0;
  render::Subject subject_;
};

class CacheFrames : public FrameSource {
 public:
  CacheFrames(const fs::path& path, bool velocities)
      : name_(run_name(path)), cache_(path), velocities_(velocities) {
    if (cache_.frames() == 0) throw Error(path.string() + ": holds no frame yet; expected at least one");
  }

  std::string name() const override { return name_; }
  std::uint64_t frames() const override { return cache_.frames(); }
  double frame_rate() const override { return cache_.playback().manifest().frame_rate; }
  const CameraDescription* camera() const override {
    return cache_.scene() ? &cache_.scene()->camera : nullptr;
  }
  bool has_world() const override { return false; }

  AdvanceResult advance_to(std::uint64_t frame, const ShouldContinue& should_continue) override {
    if (frame_ > 0 && !should_continue(frame_)) return AdvanceResult::stopped;
    subject_ = &cache_.read(frame, velocities_);
    frame_ = frame;
    return AdvanceResult::reached;
  }
  render::ExtremePoints covered(const std::vector<std::uint64_t>& frames,
                                const ShouldContinue& should_continue) override {
    constexpr std::size_t most = 100;  // of a long run, evenly chosen
    render::ExtremePoints extent;
    const std::size_t step = 1 + frames.size() / most;
    for (std::size_t i = 0; i < frames.size() && should_continue(frames[i]); i += step)
      extent.add(extent_with_colliders(cache_.read(frames[i], false)));
    return extent;
  }
  std::uint64_t frame() const override { return frame_; }
  double time() const override { return frame_ > 0 ? cache_.playback().time(frame_) : 0; }
  const render::Subject& subject() override { return *subject_; }

 private:
  std::string name_;
  CacheSubject cache_;
  bool velocities_;
  std::uint64_t frame_ = 0;
  const render::Subject* subject_ = nullptr;
};

/// Whether `path` is a run's folder or its run.json.
bool is_run(const fs::path& path) {
  std::error_code error;
  if (path.filename() == "run.json") return fs::exists(path, error);
  return fs::is_directory(path, error) && fs::exists(path / "run.json", error);
}

}  // namespace

std::unique_ptr<FrameSource> open_source(const SourceRequest& request) {
  if (is_run(request.path)) {
    if (!request.settings.empty()) {
      throw Error("--set is for scenes: " + request.path +
                  " is a finished run; render the scene, or run it again with other settings");
    }
    return std::make_unique<CacheFrames>(request.path, request.velocities);
  }
  std::error_code error;
  if (fs::is_directory(request.path, error)) {
    for (const ShippedScene& scene : shipped_scenes()) {
      if (scene.name == request.path) return std::make_unique<SceneFrames>(scene.file, request.settings);
    }
    throw Error(request.path + ": the folder has no run.json; expected the folder of a run, or a scene");
  }
  return std::make_unique<SceneFrames>(find_scene(request.path), request.settings);
}

}  // namespace souple::app
