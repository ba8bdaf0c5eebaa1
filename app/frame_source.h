#pragma once

#include "render/extreme_points.h"
#include "render/subject.h"
#include "souple/scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace souple::app {

enum class AdvanceResult {
  reached,
  stopped,    ///< at an earlier frame, because `should_continue` returned false
  non_finite  ///< at the last valid frame: the next one has values that are not finite
};

/// Frames to render in sequence: of a scene that is simulated meanwhile, or of a run's folder.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual std::string name() const = 0;                 ///< for files and messages, such as "flag"
  virtual std::uint64_t frames() const = 0;             ///< number of frames
  virtual double frame_rate() const = 0;                ///< 1/s
  virtual const CameraDescription* camera() const = 0;  ///< nullptr: there is no scene
  virtual bool has_world() const = 0;                   ///< false: no constraints, contacts and lattices

  using ShouldContinue = std::function<bool(std::uint64_t frame)>;
  /// Advances to a later frame. Calls `should_continue` before it leaves a frame. Throws Error when a file
  /// cannot be read, or a step is refused.
  virtual AdvanceResult advance_to(std::uint64_t frame, const ShouldContinue& should_continue) = 0;
  /// Extreme points of objects, and of colliders not much larger, over these frames, ascending. The current frame
  /// stays. A scene is simulated once more for it; ends early where `should_continue` returns false or values are not
  /// finite.
  virtual render::ExtremePoints covered(const std::vector<std::uint64_t>& frames,
                                        const ShouldContinue& should_continue) = 0;
  virtual std::uint64_t frame() const = 0;  ///< current frame; 0 before the first
  virtual double time() const = 0;          ///< time of the current frame [s]
  virtual const render::Subject& subject() = 0;
  virtual std::string failure() const { return {}; }  ///< message after `non_finite`
};

struct SourceRequest {
  std::string path;                   ///< a scene, a run's folder, or its run.json
  std::vector<std::string> settings;  ///< path=value, for a scene
  bool velocities = false;            ///< needed from a folder too
};
/// Throws Error when the path is neither a scene nor a run.
std::unique_ptr<FrameSource> open_source(const SourceRequest& request);

}  // namespace souple::app
