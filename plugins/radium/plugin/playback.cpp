#include "plugins/radium/plugin/playback.h"

#include <Engine/RadiumEngine.hpp>
#include <Engine/Scene/ItemEntry.hpp>
#include <Engine/Scene/SignalManager.hpp>
#include <utility>

namespace souple::radium {

namespace {

using Ra::Engine::Scene::ItemEntry;

// Inside a signal Radium holds a lock: what is to be done is only noted there.
void watch_frames(Ra::Engine::RadiumEngine& engine, const std::shared_ptr<FrameWatch>& watch) {
  auto& signals = *engine.getSignalManager();
  const auto changed = [watch](const ItemEntry&) { watch->scene_changed = true; };
  signals.getRenderObjectCreatedNotifier().attach(changed);
  signals.getRenderObjectDestroyedNotifier().attach(changed);
  signals.getEndFrameNotifier().attach([watch, &engine] {
    const float time = engine.getTime();
    watch->time_stands = time == watch->time;
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
  watch_->time_stands = false;
  set_playing(true);
}

void Playback::pause() {
  system_.pause();
  set_playing(false);
  requests_.update();
}

void Playback::step() {
  system_.pause();
  set_playing(false);
  system_.step();
  requests_.update();
}

void Playback::reset() {
  system_.pause();
  set_playing(false);
  system_.reset();
  requests_.update();
}

void Playback::check() {
  if (playing_ && (!system_.playing() || watch_->time_stands)) pause();
}

bool Playback::take_scene_change() {
  return std::exchange(watch_->scene_changed, false);
}

}  // namespace souple::radium
