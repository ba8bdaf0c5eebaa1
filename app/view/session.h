#pragma once

#include "app/view/clock.h"
#include "render/camera.h"
#include "render/subject.h"
#include "souple/math/vec3.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace souple::viewer {

inline render::Camera camera_of(const CameraDescription& scene) {
  return {Vec3f(scene.from), Vec3f(scene.to), static_cast<float>(scene.fov)};
}

/// The cause and position of a failed step.
struct Failure {
  std::string message;       ///< one line: the object, the particle, the remedy; or why the step was refused
  std::string object;        ///< empty: the step was refused
  std::uint32_t vertex = 0;  ///< user order
  Vec3f position{};          ///< last valid position of the vertex [m]
};

/// Content of the viewer: a running simulation, or the recording of a finished run. Independent of any
/// screen.
class Session {
 public:
  explicit Session(std::string name) : name_(std::move(name)) {}
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const std::string& name() const { return name_; }
  virtual const std::string& description() const = 0;
  virtual double frame_rate() const = 0;    ///< frames per second
  virtual double time() const = 0;          ///< s
  virtual std::uint64_t frame() const = 0;  ///< frame on screen; 0 is the start
  virtual render::Subject subject() const = 0;
  /// The scene's camera; empty where it has none.
  virtual std::optional<render::Camera> camera() const = 0;

  /// Adds real time [s]; advances if it is playing.
  virtual void advance(double seconds) = 0;
  /// Advances one frame, and pauses.
  virtual void step_frame() = 0;
  /// Makes the smallest possible step, and pauses: one substep forward, or one frame back in a recording.
  virtual void step_fine() = 0;
  /// Goes back one frame, and pauses. Throws Error when there is none before.
  virtual void step_back() = 0;
  /// Returns to the start. Throws Error, and then has changed nothing, when that fails.
  virtual void reset() = 0;
  virtual void set_playing(bool playing) = 0;
  bool playing() const { return playing_; }

  /// Achieved speed over requested speed; below 1 when the machine is too slow.
  double speed() const { return clock_.speed(); }
  /// A recording cannot fail.
  const std::optional<Failure>& failure() const { return failure_; }

 protected:
  std::string name_;
  Clock clock_;
  bool playing_ = true;
  std::optional<Failure> failure_;
};

}  // namespace souple::viewer
