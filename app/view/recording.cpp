#include "app/view/recording.h"

#include "app/view/simulation.h"
#include "souple/error.h"
#include "souple/io/export_frames.h"

#include <algorithm>

#include <fmt/core.h>

namespace souple::viewer {

namespace {

// A delayed frame of the viewer catches up by at most this many frames of the recording.
constexpr int max_frames = 8;

}  // namespace

Recording::Recording(const std::filesystem::path& path) : Session(run_name(path)), cache_(path) {
  if (cache_.frames() == 0) {
    throw Error(path.string() +
                ": holds no frame to play; expected PC2, MDD, OBJ or PLY files from `souple run`");
  }
  rate_ = cache_.playback().manifest().frame_rate;
  description_ = cache_.scene() ? cache_.scene()->description : fmt::format("A run of {} frames.", frames());
  seek(1);
}

std::optional<render::Camera> Recording::camera() const {
  if (!cache_.scene()) return std::nullopt;
  return camera_of(cache_.scene()->camera);
}

void Recording::advance(double seconds) {
  if (!playing_) return;
  clock_.tick(seconds);
  std::uint64_t wanted = frame();
  for (int steps = 0; clock_.consume(1 / rate_); ++steps) {
    ++wanted;
    if (steps + 1 >= max_frames) clock_.drop();
  }
  if (wanted != frame()) seek(wanted);
  if (frame() == frames()) playing_ = false;
}

void Recording::step_frame() {
  playing_ = false;
  seek(frame() + 1);
}

void Recording::step_fine() {
  playing_ = false;
  seek(frame() - 1);
}

void Recording::step_back() {
  playing_ = false;
  if (frame() == 1) throw Error("this is the first frame of the recording");
  seek(frame() - 1);
}

void Recording::reset() {
  clock_.restart();
  seek(1);
}

void Recording::set_playing(bool playing) {
  if (playing && !playing_) {
    clock_.restart();
    if (frame() == frames()) seek(1);
  }
  playing_ = playing;
}

void Recording::seek(std::uint64_t frame) {
  subject_ = cache_.read(std::clamp<std::uint64_t>(frame, 1, frames()), true);
}

}  // namespace souple::viewer
