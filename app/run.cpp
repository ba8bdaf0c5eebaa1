#include "app/check_pictures.h"
#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "app/interrupt.h"
#include "app/last_picture.h"
#include "app/percent.h"
#include "app/progress.h"
#include "app/run_surfaces.h"
#include "app/step_failure.h"
#include "souple/files/output_lock.h"
#include "souple/io/checkpoint_file.h"
#include "souple/io/recorder.h"
#include "souple/scene/nearest.h"
#include "souple/scene/run_record.h"
#include "souple/scene/scene.h"
#include "souple/version.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* checkpoint_name = "checkpoint.souple";

/// A run that is about to start or to resume.
struct Job {
  RunRecord record;
  SceneDescription scene;
  fs::path out;
  std::uint64_t done = 0;        ///< frames simulated before
  std::vector<std::byte> state;  ///< the world's state after these frames
};

std::vector<CacheFormat> formats_of(const std::vector<std::string>& names) {
  std::vector<CacheFormat> formats;
  for (const std::string& name : names) {
    for (const auto& [known, format] : cache_formats()) {
      const bool again = std::find(formats.begin(), formats.end(), format) != formats.end();
      if (name == known && !again) formats.push_back(format);
    }
  }
  if (formats.empty()) formats.push_back(CacheFormat::pc2);
  return formats;
}

/// Settings from the options --frames, --substeps and --iterations, checked like those of --set.
std::vector<std::string> settings_of(const RunOptions& options) {
  std::vector<std::string> settings;
  if (options.frames) settings.push_back(fmt::format("frames={}", *options.frames));
  if (options.substeps) settings.push_back(fmt::format("substeps={}", *options.substeps));
  if (options.iterations) settings.push_back(fmt::format("iterations={}", *options.iterations));
  return settings;
}

/// The settings for `--fps`; explicit `--frames` and `--substeps` come after them and win.
std::vector<std::string> settings_for_rate(const SceneDescription& scene, double fps) {
  const double ratio = scene.frame_rate / fps;
  const auto scaled = [](double number, double factor) { return std::max(1.0, std::round(number * factor)); };
  return {fmt::format("frame_rate={}", fps), fmt::format("frames={}", scaled(scene.frames, 1 / ratio)),
          fmt::format("substeps={}", scaled(scene.settings.substeps, ratio))};
}

SceneDescription loaded_scene(const fs::path& file, const RunOptions& options) {
  std::vector<std::string> settings = options.settings;
  if (options.fps) {
    if (!(*options.fps > 0 && std::isfinite(*options.fps)))
      throw Error(fmt::format("--fps {}: expected a number of frames per second, above 0", *options.fps));
    for (std::string& setting : settings_for_rate(load_scene(file, settings), *options.fps))
      settings.push_back(std::move(setting));
  }
  for (std::string& setting : settings_of(options)) settings.push_back(std::move(setting));
  return load_scene(file, settings);
}

Job new_job(const RunOptions& options) {
  const fs::path file = find_scene(options.scene);
  Job job;
  job.scene = loaded_scene(file, options);
  job.record.name = file.stem().string();
  job.record.source = job.scene.source;
  job.record.folder = fs::absolute(job.scene.folder / ".").lexically_normal().string();
  job.record.scene = to_json(job.scene);
  job.record.formats = formats_of(options.formats);
  job.record.checkpoint_every = options.checkpoint_every.value_or(0);
  job.record.surface = options.surface;
  job.out = options.out.empty() ? fs::path("out") / job.record.name : options.out;
  return job;
}

void refuse_changes(const RunOptions& options) {
  const bool changes = !options.settings.empty() || options.fps || options.substeps || options.iterations ||
                       !options.formats.empty() || !options.out.empty() || !options.scene.empty() ||
                       !options.surface.empty();
  if (changes) {
    throw Error(
        "--resume uses the scene, the settings and the folder of the stopped run; omit SCENE, "
        "--set, --fps, --substeps, --iterations, --write, --surface and --out (--frames may be larger)");
  }
}

Job stopped_job(const RunOptions& options) {
  refuse_changes(options);
  const fs::path file = options.resume / checkpoint_name;
  if (std::error_code error; !fs::exists(options.resume, error))
    throw Error(options.resume.string() + ": no such folder");
  if (std::error_code error; !fs::exists(file, error)) {
    throw Error(options.resume.string() + ": has no " + checkpoint_name +
                ": holds no checkpoint; the run was not interrupted, or has finished since");
  }
  Checkpoint checkpoint = read_checkpoint(file, version);
  Job job;
  job.record = parse_run_record(checkpoint.scene, file.string());
  if (options.checkpoint_every) job.record.checkpoint_every = *options.checkpoint_every;
  std::vector<std::string> settings;
  if (options.frames) settings.push_back(fmt::format("frames={}", *options.frames));
  job.scene = parse_scene(job.record.scene, job.record.folder, job.record.source, settings);
  job.record.scene = to_json(job.scene);
  job.out = options.resume;
  job.done = checkpoint.frame;
  job.state = std::move(checkpoint.state);
  if (job.done > job.scene.frames) {
    throw Error(fmt::format("--frames {}: the interrupted run already has {} frames; expected at least {}",
                            job.scene.frames, job.done, job.done));
  }
  return job;
}

void save_checkpoint(const Job& job, const World& world, std::uint64_t frame) {
  Checkpoint checkpoint;
  checkpoint.version = version;
  checkpoint.frame = frame;
  checkpoint.scene = run_record_text(job.record);
  checkpoint.state = world.snapshot().bytes;
  write_checkpoint(job.out / checkpoint_name, checkpoint);
}

/// Statistics of a run that are printed after it.
struct RunStatistics {
  std::array<std::uint64_t, 9> flagged{};  ///< number of frames with each flag
  double largest_strain = 0;

  static constexpr std::array<Flag, 9> flags{Flag::non_finite,       Flag::large_strain, Flag::deep_contact,
                                             Flag::callback_failed,  Flag::intersecting, Flag::not_converged,
                                             Flag::shortened_motion, Flag::out_of_range, Flag::jumped};
  void add(const StepReport& report) {
    for (std::size_t i = 0; i < flags.size(); ++i) flagged[i] += report.has(flags[i]) ? 1 : 0;
    largest_strain = std::max(largest_strain, report.largest_strain);
  }
};

void print_diagnostics(const RunStatistics& statistics, const Recorder& recorder) {
  for (const std::string& note : recorder.notes()) std::fprintf(stderr, "souple: %s\n", note.c_str());
  for (std::size_t i = 0; i < RunStatistics::flags.size(); ++i) {
    if (statistics.flagged[i] == 0 || RunStatistics::flags[i] == Flag::non_finite) continue;
    std::fprintf(stderr, "souple: in %llu frames: %s\n",
                 static_cast<unsigned long long>(statistics.flagged[i]),
                 std::string(advice(RunStatistics::flags[i])).c_str());
  }
}

std::string frames_text(std::uint64_t frames) {
  return fmt::format("{} {}", frames, frames == 1 ? "frame" : "frames");
}

void print_summary(const Job& job, const RunStatistics& statistics, double seconds) {
  const std::uint64_t frames = job.scene.frames - job.done;
  const double each = frames > 0 ? 1e3 * seconds / static_cast<double>(frames) : 0;
  std::printf("%s: %s in %.2f s (%.2f ms/frame), largest strain %s, in %s\n", job.record.name.c_str(),
              frames_text(frames).c_str(), seconds, each, percent(statistics.largest_strain).c_str(),
              job.out.string().c_str());
}

int report_failure(const Job& job, const StepReport& report, std::uint64_t frame) {
  std::fprintf(stderr, "souple: %s; the frames before it are in %s%s\n",
               step_failure_text(job.record.source, report, frame).c_str(), job.out.string().c_str(),
               step_remedy(report).c_str());
  return exit_code(report.outcome);
}

int report_interrupted(const Job& job, std::uint64_t frame) {
  std::fprintf(stderr, "souple: interrupted after frame %llu of %u; resume with: souple run --resume %s\n",
               static_cast<unsigned long long>(frame), job.scene.frames, job.out.string().c_str());
  return interrupted;
}

/// Outputs of a run, and whether it prints. Surfaces and picture may be null.
struct Output {
  Recorder& recorder;
  RunSurfaces* surfaces;
  LastPicture* picture;
  bool quiet;

  void capture(const World& world, std::uint64_t frame) const {
    recorder.capture();
    if (surfaces != nullptr) surfaces->write(world, frame);
  }
  /// Called before a checkpoint is written: otherwise a run that is killed later would resume without its
  /// reports.
  void save_manifests() const {
    recorder.save_manifest();
    if (surfaces != nullptr) surfaces->save();
  }
  /// After a failure: completes the files as far as it can.
  void finish_what_is_there() const {
    try {
      recorder.finish();
    } catch (const Error&) {  // the first failure is reported
    }
    try {
      if (surfaces != nullptr) surfaces->finish();
    } catch (const Error&) {
    }
  }
  void finish() const {
    recorder.finish();
    if (surfaces != nullptr) surfaces->finish();
  }
};

/// Simulates and records; leaves complete files however it ends.
int simulate(const Job& job, World& world, const Output& output) {
  const double dt = 1 / job.scene.frame_rate;
  RunStatistics statistics;
  double seconds = 0;
  {
    Progress progress(job.record.name, job.scene.frames, job.done, output.quiet);
    for (std::uint64_t frame = job.done + 1; frame <= job.scene.frames; ++frame) {
      const StepReport& report = world.step(dt);
      statistics.add(report);
      if (!report.ok()) {
        output.finish();
        if (output.picture != nullptr && frame > 1) output.picture->write(world, job.scene);
        return report_failure(job, report, frame);
      }
      output.capture(world, frame);
      progress.frame_done(frame);
      const bool last = frame == job.scene.frames;
      if (!last && interrupt_requested()) {
        output.save_manifests();
        save_checkpoint(job, world, frame);
        output.finish();
        return report_interrupted(job, frame);
      }
      const std::uint32_t every = job.record.checkpoint_every;
      if (!last && every > 0 && frame % every == 0) {
        output.save_manifests();
        save_checkpoint(job, world, frame);
      }
    }
    seconds = progress.seconds();
  }
  output.finish();
  std::error_code error;
  fs::remove(job.out / checkpoint_name, error);  // the run is complete: there is nothing to resume
  if (output.picture != nullptr) output.picture->write(world, job.scene);
  if (!output.quiet) {
    print_diagnostics(statistics, output.recorder);
    print_summary(job, statistics, seconds);
    if (output.surfaces != nullptr) std::printf("%s\n", output.surfaces->summary().c_str());
  }
  return success;
}

/// Completes the files. The world's last step, or the recorder's last frame, is left out.
int end_out_of_memory(const Job& job, const Output& output) {
  output.finish();
  std::fprintf(stderr, "souple: out of memory in frame %llu of %u; the frames before it are in %s\n",
               static_cast<unsigned long long>(output.recorder.frames() + 1), job.scene.frames,
               job.out.string().c_str());
  return bad_input;
}

RecorderOptions recorder_options(const Job& job) {
  RecorderOptions options;
  options.formats = job.record.formats;
  options.frame_rate = job.scene.frame_rate;
  options.frames = job.scene.frames;
  options.scene = job.record.scene;
  options.resume_from = job.done;
  options.locked = true;
  return options;
}

}  // namespace

int run(const RunOptions& options) {
  if (options.resume.empty() && options.scene.empty()) {
    throw Error("expected a scene: souple run SCENE (`souple list` lists the shipped scenes)");
  }
  const bool resuming = !options.resume.empty();
  std::optional<OutputLock> lock;
  std::error_code missing;
  if (resuming && fs::is_directory(options.resume, missing))
    lock.emplace(OutputLock::of_folder(options.resume));
  Job job = resuming ? stopped_job(options) : new_job(options);
  job.scene.settings.threads = options.threads.value_or(0);
  const bool resumes = !job.state.empty();
  World world = build_world(job.scene, [&](LogLevel level, std::string_view warning) {
    if (level != LogLevel::info && !resumes && !options.quiet)
      std::fprintf(stderr, "souple: %s\n", std::string(warning).c_str());
  });
  if (!job.state.empty()) {
    try {
      world.restore(Snapshot{job.state});
    } catch (const Error& error) {
      throw Error((job.out / checkpoint_name).string() +
                  ": does not match the scene (was a mesh changed?): " + error.what());
    }
  }
  prepare(world, job.record.source);
  std::unique_ptr<RunSurfaces> surfaces;
  if (!job.record.surface.empty())
    surfaces = std::make_unique<RunSurfaces>(job.record.surface, job.scene, world, job.out, job.done);
  if (!options.picture.empty()) check_pictures(job.scene);
  const auto picture = options.picture.empty() ? nullptr : std::make_unique<LastPicture>(options.picture);
  if (std::error_code error; fs::exists(job.out, error) && !fs::is_directory(job.out, error))
    throw Error(job.out.string() + ": is a file; expected a folder, or no such name: choose another --out");
  if (!lock) lock.emplace(OutputLock::of_folder(job.out));
  // From here on files are written; an interrupt ends the run with complete files.
  watch_interrupts();
  if (job.done == 0) {
    std::error_code error;
    fs::remove(job.out / checkpoint_name, error);  // of an earlier run
  }
  if (surfaces) surfaces->start();
  Recorder recorder(world, job.out, recorder_options(job));
  const Output output{recorder, surfaces.get(), picture.get(), options.quiet};
  try {
    const int code = simulate(job, world, output);
    if (code == success && picture != nullptr && !options.quiet)
      std::printf("%s: picture of the last frame: %s\n", job.record.name.c_str(), options.picture.c_str());
    return code;
  } catch (const Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    output.finish_what_is_there();
    return failed;
  } catch (const std::bad_alloc&) {
    return end_out_of_memory(job, output);
  }
}

}  // namespace souple::app
