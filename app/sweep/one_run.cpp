#include "app/sweep/one_run.h"

#include "app/check_pictures.h"
#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/last_picture.h"
#include "app/step_failure.h"
#include "app/sweep/result.h"
#include "app/sweep/sheet.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"
#include "souple/files/write_error.h"
#include "souple/io/recorder_report.h"
#include "souple/scene/scene.h"
#include "souple/world/world.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <thread>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

/// Waits for another process. Nothing where an interrupt ends the waiting.
std::optional<OutputLock> lock_of_run(const fs::path& folder) {
  constexpr auto pause = std::chrono::milliseconds(100);
  while (!interrupt_requested()) {
    try {
      return OutputLock::of_folder(folder);
    } catch (const Error&) {  // locked
      std::this_thread::sleep_for(pause);
    }
  }
  return std::nullopt;
}

/// Values of the reports of a run.
class Measures {
 public:
  void add(std::uint64_t frame, const World& world) {
    last_ = frame_report(frame, world.time(), world.report());
    largest_strain_ = std::max(largest_strain_, world.report().largest_strain);
    deepest_contact_ = std::max(deepest_contact_, world.report().deepest_contact);
    for (const std::string& flag : last_.flags) ++flagged_[flag];
  }

  NamedNumbers values(const World& world) const {
    NamedNumbers values = last_.values;
    for (auto& [name, value] : values) {
      if (name == "largest_strain") value = largest_strain_;
      if (name == "deepest_contact") value = deepest_contact_;
    }
    for (const ObjectId object : world.objects()) {
      const std::string& name = world.name(object);
      const Vec3d center = world.center_of_mass(object);
      values.emplace_back("center." + name + ".x", center.x);
      values.emplace_back("center." + name + ".y", center.y);
      values.emplace_back("center." + name + ".z", center.z);
      values.emplace_back("kinetic_energy." + name, world.kinetic_energy(object));
    }
    for (const auto& [flag, frames] : flagged_)
      values.emplace_back("frames." + flag, static_cast<double>(frames));
    return values;
  }

 private:
  FrameReport last_;
  double largest_strain_ = 0, deepest_contact_ = 0;
  std::map<std::string, std::uint64_t> flagged_;  // number of frames with each flag
};

/// A run on its way.
class Run {
 public:
  Run(const Sweep& sweep, std::uint64_t number)
      : sweep_(sweep), number_(number), folder_(sweep.folder_of(number)), scene_(sweep.scene_of(number)) {
    scene_.settings.threads = 1;
  }

  /// Returns an ExitCode and fills the result. Throws Error.
  int simulate(RunResult& result) {
    const bool first = number_ == 1;
    World world = build_world(scene_, [&](LogLevel level, std::string_view warning) {
      if (level != LogLevel::info && first && !sweep_.quiet)
        std::fprintf(stderr, "souple: %s\n", std::string(warning).c_str());
    });
    prepare(world, scene_.source);
    open_picture();
    open_recorder(world);
    const int code = step(world, result);
    if (recorder_) recorder_->finish();
    if (code == interrupted) return code;
    result.hash = fmt::format("{:016x}", world.hash());
    result.values = measures_.values(world);
    if (picture_) without_errors([&] { picture_->write(world, scene_); });
    return code;
  }

 private:
  /// Pictures are an addition: a machine that makes none still simulates.
  void open_picture() {
    std::error_code error;
    fs::remove(folder_ / run_picture_name, error);
    if (!sweep_.pictures) return;
    const PictureLook look{sheet_cell_width, sheet_cell_height,
                           fmt::format("{}: {}", number_, sweep_.plan.short_label_of(number_))};
    without_errors([&] {
      check_pictures(scene_);
      picture_ = std::make_unique<LastPicture>(folder_ / run_picture_name, look);
    });
  }

  /// Calls what makes pictures. An error is told once, by the first run.
  template <class Function>
  void without_errors(Function make) {
    try {
      make();
    } catch (const WriteError&) {
      throw;
    } catch (const Error& reason) {
      if (number_ == 1 && !sweep_.quiet) std::fprintf(stderr, "souple: no pictures: %s\n", reason.what());
    }
  }

  void open_recorder(const World& world) {
    if (sweep_.formats.empty()) return;
    RecorderOptions options;
    options.formats = sweep_.formats;
    options.frame_rate = scene_.frame_rate;
    options.frames = scene_.frames;
    options.scene = to_json(scene_);
    options.locked = true;
    recorder_ = std::make_unique<Recorder>(world, folder_.string(), options);
  }

  int step(World& world, RunResult& result) {
    const double dt = 1 / scene_.frame_rate;
    for (std::uint64_t frame = 1; frame <= scene_.frames; ++frame) {
      if (interrupt_requested()) return interrupted;
      const StepReport& report = world.step(dt);
      if (!report.ok()) {
        const bool diverged = report.outcome == StepOutcome::diverged;
        result.status = diverged ? RunResult::Status::diverged : RunResult::Status::failed;
        result.error = step_failure_text(scene_.source, report, frame);
        return exit_code(report.outcome);
      }
      if (recorder_) recorder_->capture();
      measures_.add(frame, world);
      result.frames = frame;
    }
    result.status = RunResult::Status::finished;
    return success;
  }

  const Sweep& sweep_;
  std::uint64_t number_;
  fs::path folder_;
  SceneDescription scene_;
  std::unique_ptr<LastPicture> picture_;
  std::unique_ptr<Recorder> recorder_;
  Measures measures_;
};

/// Throws WriteError.
int simulate_with_errors(const Sweep& sweep, std::uint64_t number, RunResult& result) {
  try {
    return Run(sweep, number).simulate(result);
  } catch (const WriteError&) {
    throw;
  } catch (const Error& error) {
    result.error = error.what();
  } catch (const std::bad_alloc&) {
    result.error = "out of memory: the scene is too large for this machine";
  }
  result.status = RunResult::Status::failed;
  return bad_input;
}

int code_of(RunResult::Status status) {
  return status == RunResult::Status::diverged ? non_finite : success;
}

}  // namespace

int simulate_run(const Sweep& sweep, std::uint64_t run) {
  using Clock = std::chrono::steady_clock;
  watch_interrupts();
  const fs::path folder = sweep.folder_of(run);
  create_folder(folder);
  const std::optional<OutputLock> lock = lock_of_run(folder);
  if (!lock) return interrupted;
  if (const RunResult before = read_result(sweep, run); before.is_final()) return code_of(before.status);
  const Clock::time_point start = Clock::now();
  RunResult result;
  const int code = simulate_with_errors(sweep, run, result);
  if (code == interrupted) return code;
  result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  write_result(sweep, run, result);
  if (code != success)
    std::fprintf(stderr, "souple: run %llu (%s): %s\n", static_cast<unsigned long long>(run),
                 sweep.plan.label_of(run).c_str(), result.error.c_str());
  return code;
}

bool is_running(const Sweep& sweep, std::uint64_t run) {
  const fs::path folder = sweep.folder_of(run);
  std::error_code error;
  if (!fs::exists(folder, error)) return false;
  try {
    OutputLock::of_folder(folder);
    return false;
  } catch (const Error&) {
    return true;
  }
}

}  // namespace souple::app
