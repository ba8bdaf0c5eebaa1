#pragma once

#include "plugins/radium/physics_system.h"

#include <chrono>
#include <functional>
#include <memory>

namespace souple::radium {

/// Functions of the program around Radium, which draws only on request.
struct HostRequests {
  std::function<void(bool)> continuous_update;  ///< the program counts calls: each true needs a false
  std::function<void()> update;                 ///< requests a frame
  std::function<void()> prepare_new;            ///< Radium draws only prepared objects
  std::function<void()> look_at_world;          ///< moves the camera to the world, once
  /// Call before removing objects: Radium 1.5 can deadlock if a selected object is removed.
  std::function<void()> deselect;
};

/// Events of Radium's frames since the last query.
struct FrameWatch {
  float time = 0;  ///< time of the engine at the end of the last frame [s]
  int frames_in_motion =
      0;  ///< number of consecutive frames with advancing time, up to the last; 0: time stood still
  std::chrono::steady_clock::time_point last_motion{};
  bool scene_changed = true;  ///< a drawable object was added or removed
};

/// Plays, pauses, steps and resets a system, and requests its frames. Radium has such buttons too:
/// `check`, to be called several times per second, detects their use.
class Playback {
 public:
  Playback(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system, HostRequests requests);

  void play();
  void pause();
  void step();
  void reset();
  bool playing() const { return playing_ || radium_plays(); }
  /// Playing was started by a button of Radium.
  bool radium_plays() const;
  /// Pauses if a step failed or another component stopped the engine's clock.
  void check();
  /// Returns true once after a drawable object was added to or removed from Radium.
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
