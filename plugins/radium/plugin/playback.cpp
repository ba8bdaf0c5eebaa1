#include "plugins/radium/plugin/playback.h"

#include <Engine/RadiumEngine.hpp>
#include <Engine/Scene/ItemEntry.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Engine::Scene::ItemEntry;

// Inside a signal Radium holds a lock: signals only record events.
void watch_frames(Ra::Engine::RadiumEngine& engine, const std::shared_ptr<FrameWatch>& watch) {
  auto& signals = *engine.getSignalManager();
  const auto changed = [watch](const ItemEntry&) { watch->scene_changed = true; };
  signals.getRenderObjectCreatedNotifier().attach(changed);
  signals.getRenderObjectDestroyedNotifier().attach(changed);
  signals.getEndFrameNotifier().attach([watch, &engine] {
    const float time = engine.getTime();
    watch->frames_in_motion = time == watch->time ? 0 : watch->frames_in_motion + 1;
    if (watch->frames_in_motion > 0) watch->last_motion = std::chrono::steady_clock::now();
    watch->time = time;
  });
}

}  // namespace

Playback::Playback(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system, HostRequests requests)
    : system_(system), requests_(std::move(requests)), watch_(std::make_shared<FrameWatch>()) {
  watch_frames(engine, watch_);
}

void Playback::set_playing(bool playing) {
  if (std::exchange(playing_, playing) == playing) return;
  requests_.continuous_update(playing);
}

void Playback::play() {
  system_.play();
  watch_->frames_in_motion = 1;
  set_playing(true);
}

void Playback::pause() {
  system_.pause();
  set_playing(false);
  watch_->frames_in_motion = 0;
  requests_.update();
}

void Playback::step() {
  pause();
  system_.step();
  requests_.update();
}

void Playback::reset() {
  pause();
  system_.reset();
  requests_.update();
}

void Playback::check() {
  if (playing_ && (!system_.playing() || watch_->frames_in_motion == 0)) pause();
}

bool Playback::radium_plays() const {
  using namespace std::chrono_literals;
  // One frame in motion may be a step; and without requests for frames, no frame shows that time stands
  // still.
  return !playing_ && watch_->frames_in_motion > 1 &&
         std::chrono::steady_clock::now() - watch_->last_motion < 500ms;
}

bool Playback::take_scene_change() {
  return std::exchange(watch_->scene_changed, false);
}

}  // namespace souple::radium
