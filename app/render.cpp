#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/frame_source.h"
#include "app/interrupt.h"
#include "app/option_names.h"
#include "app/out_of_memory.h"
#include "app/picture_files.h"
#include "app/picture_sink.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

/// The command line's request, parsed and completed.
struct RenderJob {
  OutputKind kind = OutputKind::picture;
  fs::path out;
  PictureStyle style;
  CameraRequest camera;
  SheetShape sheet;
  std::vector<std::uint64_t> frames;  ///< frames to render, ascending
  double film_rate = 60;              ///< pictures per second
  std::uint64_t film_bytes = 0;       ///< largest size of a .webp; 0: any
  int colors = 0;                     ///< colors of a picture; 0: all
  bool quiet = false;
};

void choose_liquids(const RenderRequest& request, PictureStyle& style) {
  style.display.liquid_splats = value_of(option_values<render::splat_shape_count>(render::splat_shape_name),
                                         request.liquid_splats, "--liquid-splats");
  style.liquid_filter = value_of(option_values<render::liquid_filter_count>(render::liquid_filter_name),
                                 request.liquid_filter, "--liquid-filter");
  if (!request.liquid_steps) return;
  if (*request.liquid_steps < 1 || *request.liquid_steps > render::max_liquid_steps)
    throw Error(
        fmt::format("--liquid-steps {}: expected 1 to {}", *request.liquid_steps, render::max_liquid_steps));
  style.liquid_steps = static_cast<int>(*request.liquid_steps);
}

/// Depth of field. The exposure follows from the source's frame rate.
void choose_lens(const RenderRequest& request, PictureStyle& style) {
  constexpr double farthest = 1e5;
  const auto require = [](const char* option, double value, double most, const char* unit) {
    if (!(value > 0 && value <= most))
      throw Error(
          fmt::format("{} {}: expected a number above 0 and at most {}{}", option, value, most, unit));
  };
  if (request.focus) require("--focus", *request.focus, farthest, " m");
  if (request.aperture) require("--aperture", *request.aperture, farthest, " m");
  if (request.shutter) require("--shutter", *request.shutter, 1, "");
  constexpr double standard = 1.0 / 40;  // of the distance in focus
  style.focus = static_cast<float>(request.focus.value_or(0));
  style.aperture = static_cast<float>(request.aperture.value_or(standard * request.focus.value_or(0)));
}

PictureStyle style_of(const RenderRequest& request) {
  PictureStyle style;
  style.display.display =
      value_of(option_values<render::display_count>(render::display_name), request.display, "--display");
  style.display.constraints =
      value_of(option_values<render::constraint_display_count>(render::constraint_display_name),
               request.constraints, "--constraints");
  style.display.pins = false;
  choose_liquids(request, style);
  choose_lens(request, style);
  style.caustics = request.caustics;
  if (!request.sky.empty()) style.sky = sky_of({.file = request.sky.string()}, {});
  if (request.samples) {
    constexpr std::uint32_t most = 1024;
    if (*request.samples < 1 || *request.samples > most)
      throw Error(fmt::format("--samples {}: expected 1 to 1024", *request.samples));
    style.samples = static_cast<int>(*request.samples);
  }
  return style;
}

/// Default output: a film of several frames, a picture of one.
fs::path default_out(const RenderRequest& request, const FrameSource& source) {
  const bool several = request.sheet.empty() && !request.frames.empty() &&
                       parse_frames(request.frames, source.frames()).size() > 1;
  return fs::path("out") / (source.name() + (several ? ".mp4" : ".png"));
}

/// Whether the film repeats forever, and is small unless the user chooses otherwise.
bool is_loop(const fs::path& out) {
  return lower_extension(out) == ".gif" || lower_extension(out) == ".webp";
}

/// Step between the frames of a film that shows fewer pictures a second than there are frames: frames in between
/// are not rendered.
std::uint64_t film_step(const fs::path& out, double frame_rate) {
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(frame_rate / render::highest_rate(out) - 1e-9)));
}

/// Film options without a film, or with one that cannot have them, are mistakes.
void choose_film(const RenderRequest& request, RenderJob& job) {
  if (request.film_rate) {
    const double rate = *request.film_rate, highest = std::min(1000.0, render::highest_rate(job.out));
    const std::string option = fmt::format("--film-rate {:g}", rate);
    if (job.kind != OutputKind::film) throw Error(option + ": is for a film .mp4, .gif or .webp");
    if (!(rate >= 0.1 && rate <= highest))
      throw Error(fmt::format("{}: expected 0.1 to {:g} pictures a second", option, highest));
    job.film_rate = rate;
  }
  if (request.film_bytes) {
    const std::string option = fmt::format("--film-bytes {}", *request.film_bytes);
    if (job.kind != OutputKind::film || lower_extension(job.out) != ".webp")
      throw Error(option + ": is for a film .webp");
    if (*request.film_bytes == 0) throw Error(option + ": expected at least 1");
    job.film_bytes = *request.film_bytes;
  }
}

void choose_frames(const RenderRequest& request, const FrameSource& source, RenderJob& job) {
  std::string words = request.frames;
  if (words.empty()) words = job.kind == OutputKind::picture ? "last" : "all";
  job.frames = parse_frames(words, source.frames());
  if (job.kind == OutputKind::picture && job.frames.size() > 1) {
    throw Error(
        fmt::format("--out {}: {} frames do not fit into one picture: give --sheet, a film .mp4, .gif or "
                    ".webp, or a folder",
                    job.out.string(), job.frames.size()));
  }
  std::uint64_t step = step_of_frames(words);
  if (job.kind == OutputKind::film && !request.film_rate) {
    const std::uint64_t every = film_step(job.out, source.frame_rate() / static_cast<double>(step));
    std::vector<std::uint64_t> kept;
    for (std::size_t i = 0; i < job.frames.size(); i += every) kept.push_back(job.frames[i]);
    job.frames = std::move(kept);
    step *= every;
  }
  job.film_rate = source.frame_rate() / static_cast<double>(step);
  if (job.kind == OutputKind::sheet) {
    const auto cells = static_cast<std::size_t>(job.sheet.columns) * static_cast<std::size_t>(job.sheet.rows);
    std::vector<std::uint64_t> shown;
    for (const std::uint64_t position : render::sheet_frames(job.frames.size(), cells))
      shown.push_back(job.frames[position - 1]);
    job.frames = std::move(shown);
  }
}

/// Default size and samples. Small or numerous pictures are rendered small and fast unless the user chooses
/// otherwise.
void choose_size(const RenderRequest& request, RenderJob& job) {
  const bool still = job.kind == OutputKind::picture || job.kind == OutputKind::sheet;
  const bool blurred = job.style.aperture > 0 || request.shutter;
  if (!request.samples) job.style.samples = still ? 16 : 4;
  if (!request.samples && blurred) job.style.samples *= 4;
  if (!request.size.empty()) {
    job.style.size = parse_size(request.size);
  } else if (job.kind == OutputKind::sheet) {
    job.style.size = {480, 270};
  } else if (is_loop(job.out)) {
    job.style.size = {640, 360};
  }
  if (job.kind != OutputKind::sheet) return;
  constexpr int longest = 16384;
  if (job.sheet.columns * job.style.size.width > longest || job.sheet.rows * job.style.size.height > longest)
    throw Error("--sheet: the page would be more than 16384 pixels wide or high; give a smaller --size");
}

/// Throws Error for displays that show the inside of a world, which caches do not hold.
void require_world(const RenderJob& job, const RenderRequest& request, const FrameSource& source) {
  if (source.has_world()) return;
  const auto refuse = [&](const std::string& option) {
    throw Error(option + ": " + request.source +
                " holds positions only; render the scene instead of the folder to see this");
  };
  const render::Display display = job.style.display.display;
  if (display == render::Display::lattice || display == render::Display::contacts)
    refuse("--display " + request.display);
  if (job.style.display.constraints != render::ConstraintDisplay::none)
    refuse("--constraints " + request.constraints);
}

int colors_of(std::uint32_t colors, const RenderJob& job) {
  const std::string option = fmt::format("--colors {}", colors);
  if (colors < 2 || colors > 256) throw Error(option + ": expected 2 to 256");
  if (job.kind == OutputKind::film)
    throw Error(option + ": is for pictures; " + job.out.string() + " is a film");
  return static_cast<int>(colors);
}

RenderJob job_of(const RenderRequest& request, const FrameSource& source, PictureStyle style,
                 CameraRequest camera, SheetShape sheet) {
  RenderJob job;
  job.style = std::move(style);
  job.camera = camera;
  job.sheet = sheet;
  job.quiet = request.quiet;
  job.out = request.out.empty() ? default_out(request, source) : request.out;
  job.kind = output_kind(job.out, !request.sheet.empty());
  if (request.colors) job.colors = colors_of(*request.colors, job);
  choose_frames(request, source, job);
  choose_film(request, job);
  choose_size(request, job);
  if (request.shutter) job.style.exposure = *request.shutter / source.frame_rate();
  require_world(job, request, source);
  return job;
}

std::string counted(std::uint64_t count, const std::string& one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

/// Renders frame by frame.
class Rendering {
 public:
  Rendering(const RenderJob& job, FrameSource& source, PictureMaker& maker, PictureSink& sink)
      : job_(job), source_(source), maker_(maker), sink_(sink) {}

  AdvanceResult run() {
    choose_camera();
    const std::uint64_t first = source_.has_world() ? 0 : job_.frames.front() - 1;
    Progress progress(source_.name(), job_.frames.back(), first, job_.quiet);
    const FrameSource::ShouldContinue should_continue = [&](std::uint64_t frame) {
      progress.frame_done(frame);
      return !interrupt_requested();
    };
    AdvanceResult result = AdvanceResult::reached;
    for (const std::uint64_t frame : job_.frames) {
      result = source_.advance_to(frame, should_continue);
      // Where a scene becomes non-finite before the first picture, its last valid frame is rendered.
      const bool show_last_valid =
          result == AdvanceResult::non_finite && pictures_ == 0 && source_.frame() > 0;
      if (result == AdvanceResult::reached || show_last_valid) render_one();
      if (result != AdvanceResult::reached) break;
    }
    sink_.finish();
    seconds_ = progress.seconds();
    return result;
  }

  std::uint64_t pictures() const { return pictures_; }
  /// Fractions of the width and the height that the subject fills, each in the picture where it is least.
  render::Fraction filled() const { return filled_; }
  double seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Several pictures without a camera show what the run covers: a first picture that fits would lose what
  /// moves.
  void choose_camera() {
    if (job_.frames.size() < 2 || !is_automatic(job_.camera, source_.camera())) return;
    Progress progress(source_.name() + ", framing", job_.frames.back(), 0, job_.quiet);
    const render::ExtremePoints extent = source_.covered(job_.frames, [&](std::uint64_t frame) {
      progress.frame_done(frame);
      return !interrupt_requested();
    });
    if (!extent.empty()) camera_ = camera_for(job_.camera, source_.camera(), extent, job_.style.aspect());
  }

  /// After the first picture: how long all will take.
  void announce(double first_picture) const {
    constexpr double long_wait = 20;  // s
    const std::size_t left = job_.frames.size() - 1;
    const double seconds = first_picture * static_cast<double>(left);
    if (job_.quiet || left == 0 || seconds < long_wait) return;
    std::printf("%s: %s of %dx%d at %d samples, about %s; --size 640x360 --samples 1 makes a draft\n",
                source_.name().c_str(), counted(job_.frames.size(), "picture").c_str(), job_.style.size.width,
                job_.style.size.height, job_.style.samples, duration_text(seconds).c_str());
    std::fflush(stdout);
  }

  void render_one() {
    const render::Subject& subject = source_.subject();
    if (!camera_)
      camera_ = camera_for(job_.camera, source_.camera(), extent_of(subject), job_.style.aspect());
    const render::Fraction filled =
        camera_->filled(extent_with_colliders(subject).points(), job_.style.aspect());
    filled_.width = std::min(filled_.width, filled.width);
    filled_.height = std::min(filled_.height, filled.height);
    const Clock::time_point start = Clock::now();
    const std::string label = job_.kind == OutputKind::sheet
                                  ? fmt::format("frame {}, {:.2f} s", source_.frame(), source_.time())
                                  : "";
    sink_.add(maker_.picture(subject, *camera_, job_.style, label), source_.frame());
    if (++pictures_ == 1) announce(std::chrono::duration<double>(Clock::now() - start).count());
  }

  const RenderJob& job_;
  FrameSource& source_;
  PictureMaker& maker_;
  PictureSink& sink_;
  std::optional<render::Camera> camera_;
  std::uint64_t pictures_ = 0;
  render::Fraction filled_{1, 1};
  double seconds_ = 0;
};

int report_non_finite(const RenderJob& job, const FrameSource& source, std::uint64_t pictures) {
  const std::string left =
      pictures == 0 ? "no picture was written"
      : job.kind == OutputKind::picture
          ? fmt::format("{} shows the last valid frame, {}", job.out.string(), source.frame())
          : job.out.string() + " shows " + counted(pictures, "frame") + " before it";
  std::fprintf(stderr, "souple: %s; %s. %s\n", source.failure().c_str(), left.c_str(),
               std::string(advice(Flag::non_finite)).c_str());
  return non_finite;
}

int report_interrupted(const RenderJob& job, const FrameSource& source, std::uint64_t pictures) {
  const std::string left =
      pictures == 0 ? "nothing was written" : job.out.string() + " holds " + counted(pictures, "picture");
  std::fprintf(stderr, "souple: interrupted after frame %llu; %s\n",
               static_cast<unsigned long long>(source.frame()), left.c_str());
  return interrupted;
}

void print_summary(const RenderJob& job, const FrameSource& source, const Rendering& rendering) {
  std::string what = counted(rendering.pictures(), "picture");
  if (job.kind == OutputKind::picture) what = fmt::format("frame {}", job.frames.front());
  const render::Fraction filled = rendering.filled();
  std::printf(
      "%s: %s of %dx%d in %.2f s, in %s; the subject fills %.0f %% of the width, %.0f %% of the height\n",
      source.name().c_str(), what.c_str(), job.style.size.width, job.style.size.height, rendering.seconds(),
      job.out.string().c_str(), 100 * static_cast<double>(filled.width),
      100 * static_cast<double>(filled.height));
}

}  // namespace

int render_frames(const RenderRequest& request) {
  const PictureStyle style = style_of(request);
  const CameraRequest camera = parse_camera(request.camera);
  const SheetShape sheet = request.sheet.empty() ? SheetShape{} : parse_sheet(request.sheet);
  if (!request.size.empty()) parse_size(request.size);
  SourceRequest wanted{request.source, request.settings,
                       style.display.display == render::Display::speed || request.shutter};
  const std::unique_ptr<FrameSource> source = open_source(wanted);
  const RenderJob job = job_of(request, *source, style, camera, sheet);
  expect_driver_crashes();
  PictureMaker maker;
  const OutputLock lock =
      job.kind == OutputKind::folder ? OutputLock::of_folder(job.out) : OutputLock::of_file(job.out);
  const std::unique_ptr<PictureSink> sink =
      open_sink({job.kind, job.out, source->name(), job.film_rate, job.film_bytes, job.sheet, job.colors});
  // From here on files are written; an interrupt ends the work with complete files.
  watch_interrupts();
  Rendering rendering(job, *source, maker, *sink);
  const AdvanceResult result = rendering.run();
  if (result == AdvanceResult::non_finite) return report_non_finite(job, *source, rendering.pictures());
  if (result == AdvanceResult::stopped) return report_interrupted(job, *source, rendering.pictures());
  if (!job.quiet) print_summary(job, *source, rendering);
  return success;
}

std::string picture_support() {
  return std::string("pictures: yes\nfilms: ") +
         (render::has_ffmpeg() ? "yes" : "no (the program ffmpeg is missing: Debian package ffmpeg)") + "\n";
}

}  // namespace souple::app
