#pragma once

#include "souple/io/export_frames.h"
#include "souple/io/glb_model.h"
#include "souple/io/split_mesh.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Frames of a run as glTF: a node per object, named as it is, in meters with Y up. Surfaces are triangles, one vertex
// per UV of a vertex. If vertices are duplicated, the attribute _SOUPLE_VERTEX holds the index of each in the run.
// Ropes are line strips; grains, fluids and foam are points with the attribute _RADIUS. Application-specific attributes
// have no 32-bit integers in glTF, so indices are floats, exact up to 2^24.

namespace souple {

/// A .glb of one frame, with the attribute _VELOCITY where velocities are known. [m/s]
std::string glb_frame(const std::string& run, std::uint64_t frame, double time,
                      std::span<const ExportObject> objects);

/// A .glb of a clip: the first frame, and a morph target for each later one, which the animation shows at its time.
/// All frames have the topology of the first one.
class GlbClip {
 public:
  /// Ten seconds at 60 frames per second. Each target has a key in each frame. Renderers keep targets in the layers of
  /// a texture: WebGL 2 promises 256, graphics cards have 2048.
  static constexpr std::uint64_t most_frames = 600;
  static constexpr std::uint64_t most_bytes = 0xffffffff;  ///< the format states sizes in 32 bits

  explicit GlbClip(const std::string& run);
  /// `seconds`: time of the frame in the animation, later than that of the frame before.
  void add(double seconds, std::span<const ExportObject> objects);
  std::string bytes() &&;

 private:
  struct Track {
    SplitMesh split;
    bool smooth = false;
    std::vector<Vec3f> positions, normals;                 // of the first frame
    std::vector<std::optional<GlbModel::Target>> targets;  // empty: as in the first frame
  };
  void begin(std::span<const ExportObject> objects);
  void end_track(Track& track, std::size_t node);

  GlbModel model_;
  std::vector<std::optional<Track>> tracks_;  // per object; empty: without points
  std::vector<float> times_;
};

/// Bytes of a clip: exact but for the JSON, which is estimated, and for objects at rest, which take less.
std::uint64_t glb_clip_size(std::uint64_t frames, std::span<const ExportObject> objects);

}  // namespace souple
