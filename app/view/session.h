#pragma once

#include "render/camera.h"
#include "render/subject.h"
#include "souple/math/vec3.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <optional>
#include <string>

namespace souple::viewer {

inline render::Camera camera_of(const CameraDescription& scene) {
  return {Vec3f(scene.from), Vec3f(scene.to), static_cast<float>(scene.fov)};
}

/// Cause and position of a simulation's failure.
struct Trouble {
  std::string message;  ///< one line: the object, the particle, the remedy
  std::string object;
  std::uint32_t vertex = 0;  ///< user order
  Vec3f position{};          ///< last finite position of the vertex [m]
};

/// Content of the viewer: a running simulation or the playback of a finished run. Independent of the screen.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  virtual const std::string& name() const = 0;
  virtual const std::string& description() const = 0;
  virtual double frame_rate() const = 0;    ///< frames per second
  virtual double time() const = 0;          ///< s
  virtual std::uint64_t frame() const = 0;  ///< current frame; 0 is the start
  virtual render::Subject subject() const = 0;
  /// The scene's camera, if it defines one.
  virtual std::optional<render::Camera> camera() const = 0;

  /// Adds elapsed real time [s]; advances while playing.
  virtual void advance(double seconds) = 0;
  /// Advances one frame and pauses.
  virtual void step_frame() = 0;
  /// Makes the smallest possible step and pauses: one substep, or, in a recording, one frame back.
  virtual void step_fine() = 0;
  /// Returns to the start. Throws Error and changes nothing if that fails.
  virtual void reset() = 0;
  virtual void set_playing(bool playing) = 0;
  virtual bool playing() const = 0;

  /// Ratio of actual to requested speed; below 1 on a machine that is too slow.
  virtual double speed() const = 0;
  virtual const std::optional<Trouble>& trouble() const = 0;
};

}  // namespace souple::viewer
