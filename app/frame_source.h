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
  stopped,  ///< at an earlier frame, because it was told to
  went_bad  ///< at the last good frame: the simulation gave numbers that are not finite
};

/// Frames to be rendered one after the other: of a scene that is simulated meanwhile, or of a run's folder.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual std::string name() const = 0;                 ///< for files and messages: "flag"
  virtual std::uint64_t frames() const = 0;             ///< that there are
  virtual double frame_rate() const = 0;                ///< 1/s
  virtual const CameraDescription* camera() const = 0;  ///< nullptr: no scene says
  virtual bool has_world() const = 0;                   ///< for constraints, contacts and lattices

  using GoOn = std::function<bool(std::uint64_t frame)>;
  /// Moves on to a later frame. `go_on` is asked at every frame it leaves whether to. Throws Error when a
  /// file cannot be read any more.
  virtual Arrival go_to(std::uint64_t frame, const GoOn& go_on) = 0;
  virtual std::uint64_t frame() const = 0;  ///< the present one; 0 before the first
  virtual double time() const = 0;          ///< of it [s]
  virtual const render::Subject& subject() = 0;
  virtual std::string trouble() const { return {}; }  ///< in words, after went_bad
};

struct SourceWish {
  std::string what;                   ///< a scene, a run's folder, or its run.json
  std::vector<std::string> settings;  ///< of a scene: path=value
  bool velocities = false;            ///< wanted of a folder too
};
/// Throws Error for what is neither.
std::unique_ptr<FrameSource> open_source(const SourceWish& wish);

}  // namespace souple::app
