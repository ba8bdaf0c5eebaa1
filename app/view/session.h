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

/// What stopped a simulation, and where.
struct Trouble {
  std::string message;  ///< one line: the object, the particle, what mends it
  std::string object;
  std::uint32_t vertex = 0;  ///< user order
  Vec3f place{};             ///< where the vertex last was well [m]
};

/// What is looked at: a simulation that runs, or a finished run that is played. Knows no screen.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  virtual const std::string& name() const = 0;
  virtual const std::string& description() const = 0;
  virtual double frame_rate() const = 0;    ///< frames a second
  virtual double time() const = 0;          ///< s
  virtual std::uint64_t frame() const = 0;  ///< shown now; 0 is the start
  virtual render::Subject subject() const = 0;
  /// Where the scene says to look from.
  virtual std::optional<render::Camera> camera() const = 0;

  /// Real time has passed [s]: goes on, if it plays.
  virtual void advance(double seconds) = 0;
  /// One frame, and pauses.
  virtual void step_frame() = 0;
  /// The smallest step there is, and pauses: one substep, or one frame back.
  virtual void step_fine() = 0;
  /// Back to the start. Throws Error and leaves all as it was when that cannot be.
  virtual void reset() = 0;
  virtual void set_playing(bool playing) = 0;
  virtual bool playing() const = 0;

  /// Achieved over wished speed; below 1 when the machine is too slow.
  virtual double speed() const = 0;
  virtual const std::optional<Trouble>& trouble() const = 0;
};

}  // namespace souple::viewer
