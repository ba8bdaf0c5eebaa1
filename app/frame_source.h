#pragma once

#include "render/subject.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace souple::app {

enum class Arrival {
  there,
  stopped,    ///< at an earlier frame, on request
  non_finite  ///< at the last valid frame: the simulation gave numbers that are not finite
};

/// Successive frames to render: of a scene that is simulated on demand, or of a run's folder.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual std::string name() const = 0;                 ///< for files and messages: "flag"
  virtual std::uint64_t frames() const = 0;             ///< number of frames
  virtual double frame_rate() const = 0;                ///< 1/s
  virtual const CameraDescription* camera() const = 0;  ///< nullptr: not defined by a scene
  virtual bool has_world() const = 0;                   ///< for constraints, contacts and lattices

  using GoOn = std::function<bool(std::uint64_t frame)>;
  /// Advances to a later frame. Calls `go_on` before each frame and stops if it returns false. Throws Error
  /// if a file can no longer be read.
  virtual Arrival go_to(std::uint64_t frame, const GoOn& go_on) = 0;
  virtual std::uint64_t frame() const = 0;  ///< current frame; 0 before the first
  virtual double time() const = 0;          ///< time of the current frame [s]
  virtual const render::Subject& subject() = 0;
  virtual std::string trouble() const { return {}; }  ///< in words, after non_finite
};

struct SourceWish {
  std::string what;                   ///< a scene, a run's folder, or its run.json
  std::vector<std::string> settings;  ///< for a scene: path=value
  bool velocities = false;            ///< compute velocities for folders too
};
/// Throws Error if the source is neither a scene nor a run's folder.
std::unique_ptr<FrameSource> open_source(const SourceWish& wish);

}  // namespace souple::app
