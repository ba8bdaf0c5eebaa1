#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/frame_source.h"
#include "app/interrupt.h"
#include "app/picture_sink.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "render/contact_sheet.h"
#include "render/film.h"
#include "souple/error.h"
#include "souple/scene/nearest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

/// The parsed command line.
struct Order {
  OutputKind kind = OutputKind::picture;
  fs::path out;
  PictureStyle style;
  CameraWish camera;
  SheetShape sheet;
  std::vector<std::uint64_t> frames;  ///< frames to render, ascending
  double film_rate = 60;              ///< pictures per second
  int colors = 0;                     ///< colors of a picture's palette; 0: full color
  bool quiet = false;
};

render::ConstraintDisplay constraint_display_of(const std::string& name) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < render::constraint_display_count; ++i) {
    const auto display = static_cast<render::ConstraintDisplay>(i);
    known.emplace_back(render::constraint_display_name(display));
    if (known.back() == name) return display;
  }
  std::string list;
  for (const std::string& word : known) list += (list.empty() ? "" : ", ") + word;
  throw Error("--constraints \"" + name + "\": expected one of " + list);
}

void choose_liquids(const RenderRequest& request, PictureStyle& style) {
  try {
    if (!request.liquid_splats.empty())
      style.display.liquid_splats = render::splat_shape_of(request.liquid_splats);
  } catch (const Error& error) {
    throw Error(std::string("--liquid-splats: ") + error.what());
  }
  try {
    if (!request.liquid_filter.empty()) style.liquid_filter = render::liquid_filter_of(request.liquid_filter);
  } catch (const Error& error) {
    throw Error(std::string("--liquid-filter: ") + error.what());
  }
  if (!request.liquid_steps) return;
  if (*request.liquid_steps < 1 || *request.liquid_steps > render::most_liquid_steps)
    throw Error(
        fmt::format("--liquid-steps {}: expected 1 to {}", *request.liquid_steps, render::most_liquid_steps));
  style.liquid_steps = static_cast<int>(*request.liquid_steps);
}

PictureStyle style_of(const RenderRequest& request) {
  PictureStyle style;
  try {
    style.display.display = render::display_of(request.display);
  } catch (const Error& error) {
    throw Error(std::string("--display: ") + error.what());
  }
  style.display.constraints = constraint_display_of(request.constraints);
  style.display.pins = false;
  choose_liquids(request, style);
  if (request.samples) {
    constexpr std::uint32_t most = 1024;
    if (*request.samples < 1 || *request.samples > most)
      throw Error(fmt::format("--samples {}: expected 1 to 1024", *request.samples));
    style.samples = static_cast<int>(*request.samples);
  }
  return style;
}

/// The default of --out: a film for several frames, a picture for one.
fs::path default_out(const RenderRequest& request, const FrameSource& source) {
  const bool several = request.sheet.empty() && !request.frames.empty() &&
                       parse_frames(request.frames, source.frames()).size() > 1;
  return fs::path("out") / (source.name() + (several ? ".mp4" : ".png"));
}

bool is_gif(const fs::path& out) {
  const std::string extension = out.extension().string();
  return extension == ".gif" || extension == ".GIF";
}

/// A .gif shows at most 50 pictures per second: omits the frames that it would drop.
std::uint64_t gif_step(double frame_rate) {
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(frame_rate / 50 - 1e-9)));
}

void choose_frames(const RenderRequest& request, const FrameSource& source, Order& order) {
  std::string words = request.frames;
  if (words.empty()) words = order.kind == OutputKind::picture ? "last" : "all";
  order.frames = parse_frames(words, source.frames());
  if (order.kind == OutputKind::picture && order.frames.size() > 1) {
    throw Error(fmt::format(
        "--out {}: {} frames do not fit into one picture: give --sheet, a film .mp4 or .gif, or a folder",
        order.out.string(), order.frames.size()));
  }
  std::uint64_t step = step_of_frames(words);
  if (order.kind == OutputKind::film && is_gif(order.out) && step == 1) {
    step = gif_step(source.frame_rate());
    std::vector<std::uint64_t> kept;
    for (std::size_t i = 0; i < order.frames.size(); i += step) kept.push_back(order.frames[i]);
    order.frames = std::move(kept);
  }
  order.film_rate = source.frame_rate() / static_cast<double>(step);
  if (order.kind == OutputKind::sheet) {
    const auto cells =
        static_cast<std::size_t>(order.sheet.columns) * static_cast<std::size_t>(order.sheet.rows);
    std::vector<std::uint64_t> shown;
    for (const std::uint64_t position : render::sheet_frames(order.frames.size(), cells))
      shown.push_back(order.frames[position - 1]);
    order.frames = std::move(shown);
  }
}

/// Defaults of size and samples: small and fast for sheets, GIFs and films.
void choose_size(const RenderRequest& request, Order& order) {
  const bool still = order.kind == OutputKind::picture || order.kind == OutputKind::sheet;
  if (!request.samples) order.style.samples = still ? 16 : 4;
  if (!request.size.empty()) {
    order.style.size = parse_size(request.size);
  } else if (order.kind == OutputKind::sheet) {
    order.style.size = {480, 270};
  } else if (is_gif(order.out)) {
    order.style.size = {640, 360};
  }
  if (order.kind != OutputKind::sheet) return;
  constexpr int longest = 16384;
  if (order.sheet.columns * order.style.size.width > longest ||
      order.sheet.rows * order.style.size.height > longest)
    throw Error("--sheet: the page would be more than 16384 pixels wide or high; give a smaller --size");
}

/// Throws for displays that need a world when the source is a cache.
void require_world(const Order& order, const RenderRequest& request, const FrameSource& source) {
  if (source.has_world()) return;
  const auto refuse = [&](const std::string& option) {
    throw Error(option + ": " + request.source +
                " holds positions only; render the scene instead of the folder to see this");
  };
  const render::Display display = order.style.display.display;
  if (display == render::Display::lattice || display == render::Display::contacts)
    refuse("--display " + request.display);
  if (order.style.display.constraints != render::ConstraintDisplay::none)
    refuse("--constraints " + request.constraints);
}

int colors_of(std::uint32_t colors, const Order& order) {
  const std::string option = fmt::format("--colors {}", colors);
  if (colors < 2 || colors > 256) throw Error(option + ": expected 2 to 256");
  if (order.kind == OutputKind::film)
    throw Error(option + ": is for pictures; " + order.out.string() + " is a film");
  return static_cast<int>(colors);
}

Order order_of(const RenderRequest& request, const FrameSource& source, PictureStyle style, CameraWish camera,
               SheetShape sheet) {
  Order order;
  order.style = style;
  order.camera = camera;
  order.sheet = sheet;
  order.quiet = request.quiet;
  order.out = request.out.empty() ? default_out(request, source) : request.out;
  order.kind = output_kind(order.out, !request.sheet.empty());
  if (request.colors) order.colors = colors_of(*request.colors, order);
  choose_frames(request, source, order);
  choose_size(request, order);
  require_world(order, request, source);
  return order;
}

std::string counted(std::uint64_t count, const std::string& one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string label_of(const FrameSource& source) {
  char text[64];
  std::snprintf(text, sizeof(text), "frame %llu, %.2f s", static_cast<unsigned long long>(source.frame()),
                source.time());
  return text;
}

/// Renders frame by frame.
class Rendering {
 public:
  Rendering(const Order& order, FrameSource& source, PictureMaker& maker, PictureSink& sink)
      : order_(order), source_(source), maker_(maker), sink_(sink) {}

  Arrival run() {
    const std::uint64_t first = source_.has_world() ? 0 : order_.frames.front() - 1;
    Progress progress(source_.name(), order_.frames.back(), first, order_.quiet);
    const FrameSource::GoOn go_on = [&](std::uint64_t frame) {
      progress.frame_done(frame);
      return !interrupt_came();
    };
    Arrival arrival = Arrival::there;
    for (const std::uint64_t frame : order_.frames) {
      arrival = source_.go_to(frame, go_on);
      // A scene that diverges before any picture: at least its last valid frame is shown.
      const bool worth = arrival == Arrival::non_finite && pictures_ == 0 && source_.frame() > 0;
      if (arrival == Arrival::there || worth) render_one();
      if (arrival != Arrival::there) break;
    }
    sink_.finish();
    seconds_ = progress.seconds();
    return arrival;
  }

  std::uint64_t pictures() const { return pictures_; }
  double seconds() const { return seconds_; }

 private:
  void render_one() {
    const render::Subject& subject = source_.subject();
    if (!camera_) camera_ = camera_for(order_.camera, source_.camera(), subject, order_.style.aspect());
    const std::string label = order_.kind == OutputKind::sheet ? label_of(source_) : "";
    sink_.add(maker_.picture(subject, *camera_, order_.style, label), source_.frame());
    ++pictures_;
  }

  const Order& order_;
  FrameSource& source_;
  PictureMaker& maker_;
  PictureSink& sink_;
  std::optional<render::Camera> camera_;
  std::uint64_t pictures_ = 0;
  double seconds_ = 0;
};

int report_non_finite(const Order& order, const FrameSource& source, std::uint64_t pictures) {
  const std::string left =
      pictures == 0 ? "there is nothing to show"
      : order.kind == OutputKind::picture
          ? fmt::format("{} shows the last valid frame, {}", order.out.string(), source.frame())
          : order.out.string() + " shows " + counted(pictures, "frame") + " before it";
  std::fprintf(stderr, "souple: %s; %s. %s\n", source.trouble().c_str(), left.c_str(),
               std::string(advice(Flag::non_finite)).c_str());
  return non_finite;
}

int say_interrupted(const Order& order, const FrameSource& source, std::uint64_t pictures) {
  const std::string left =
      pictures == 0 ? "nothing was written" : order.out.string() + " holds " + counted(pictures, "picture");
  std::fprintf(stderr, "souple: interrupted after frame %llu; %s\n",
               static_cast<unsigned long long>(source.frame()), left.c_str());
  return interrupted;
}

void print_summary(const Order& order, const FrameSource& source, const Rendering& rendering) {
  std::string what = counted(rendering.pictures(), "picture");
  if (order.kind == OutputKind::picture) what = fmt::format("frame {}", order.frames.front());
  std::printf("%s: %s of %dx%d in %.2f s, in %s\n", source.name().c_str(), what.c_str(),
              order.style.size.width, order.style.size.height, rendering.seconds(),
              order.out.string().c_str());
}

}  // namespace

int render_frames(const RenderRequest& request) {
  const PictureStyle style = style_of(request);
  const CameraWish camera = parse_camera(request.camera);
  const SheetShape sheet = request.sheet.empty() ? SheetShape{} : parse_sheet(request.sheet);
  if (!request.size.empty()) parse_size(request.size);
  SourceWish wish{request.source, request.settings, style.display.display == render::Display::speed};
  const std::unique_ptr<FrameSource> source = open_source(wish);
  const Order order = order_of(request, *source, style, camera, sheet);
  PictureMaker maker;
  const std::unique_ptr<PictureSink> sink =
      open_sink({order.kind, order.out, source->name(), order.film_rate, order.sheet, order.colors});
  // From here on files exist: an interrupt must leave them complete.
  watch_interrupts();
  try {
    Rendering rendering(order, *source, maker, *sink);
    const Arrival arrival = rendering.run();
    if (arrival == Arrival::non_finite) return report_non_finite(order, *source, rendering.pictures());
    if (arrival == Arrival::stopped) return say_interrupted(order, *source, rendering.pictures());
    if (!order.quiet) print_summary(order, *source, rendering);
    return fine;
  } catch (const Error& error) {
    std::fprintf(stderr, "souple: %s\n", error.what());
    return failed;
  }
}

std::string picture_support() {
  return std::string("pictures: yes\nfilms: ") +
         (render::has_ffmpeg() ? "yes" : "no (the program ffmpeg is missing: Debian package ffmpeg)") + "\n";
}

}  // namespace souple::app
