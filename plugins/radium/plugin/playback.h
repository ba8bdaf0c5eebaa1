#pragma once

#include "plugins/radium/physics_system.h"

#include <chrono>
#include <functional>
#include <memory>

namespace souple::radium {

/// What the plugin may ask of the program around Radium, which draws only when it is asked to.
struct HostRequests {
  std::function<void(bool)> continuous_update;  ///< the program counts: each true wants one false
  std::function<void()> update;                 ///< one frame, soon
  std::function<void()> prepare_new;            ///< Radium draws nothing that was not prepared
  std::function<void()> look_at_world;          ///< the camera, once
  /// Before something is removed: Radium 1.5 can wait for itself when what is selected goes away.
  std::function<void()> deselect;
};

/// What the frames of a Radium told since they were last asked.
struct FrameWatch {
  float time = 0;            ///< of the engine at the last frame's end [s]
  int frames_in_motion = 0;  ///< in a row, the last one included; 0: no time went by in it
  std::chrono::steady_clock::time_point last_motion{};
  bool scene_changed = true;  ///< something to draw came or went
};

/// Plays, pauses, steps and resets a system, and has frames drawn for it. Radium has such buttons too: what
/// they did is noticed in `check`, to be called some times a second.
class Playback {
 public:
  Playback(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system, HostRequests requests);

  void play();
  void pause();
  void step();
  void reset();
  bool playing() const { return playing_ || radium_plays(); }
  /// By a button of Radium's.
  bool radium_plays() const;
  /// Pauses when a step failed, or when somebody else stopped the engine's clock.
  void check();
  /// True once after something to draw came or went in Radium.
  bool take_scene_change();

  const HostRequests& host() const { return requests_; }

 private:
  void set_playing(bool playing);

  PhysicsSystem& system_;
  HostRequests requests_;
  std::shared_ptr<FrameWatch> watch_;  // shared with Radium's signals, which may outlive this
  bool playing_ = false;
};

}  // namespace souple::radium
