#pragma once

#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace souple {

/// Positions of points, frame by frame: the input of AnimatedPoints.
struct PointFrames {
  std::uint64_t points = 0;
  std::vector<double> times{};  ///< per frame: time since the first frame [s]
  std::function<void(std::uint64_t frame, std::span<Vec3f> positions)> read{};
};

/// The positions of an animated mesh at any time: linear between frames, constant before the first and after
/// the last. Drives pinned vertices. Keeps two frames in memory.
class AnimatedPoints {
 public:
  /// Reads the vertices of a mesh file in the file's order, e.g. by read_triangle_mesh.
  using ReadMesh = std::function<std::vector<Vec3f>(const std::filesystem::path&)>;

  struct Options {
    /// Frames per second of a .pc2 or a sequence of meshes; a .mdd stores its own times.
    double frame_rate = 60;
    double start_time = 0;    ///< time of the first frame [s]
    std::string animation{};  ///< of a .gltf, .glb, .fbx or .dae: its name; empty: the only one
    std::string node{};       ///< of such a file: moves only this object's vertices, as MeshImport::node
    bool loop = false;        ///< repeats the frames after the last, which should equal the first
  };

  /// `path` is a .pc2, a .mdd, a file with an animation, or a sequence of meshes for `read_mesh`. An animation is read
  /// by read_mesh_animation, evaluated at `frame_rate`. A sequence is given by one of its files (NAME_0001.obj) or by
  /// its folder. A NAME_0001.glb beside a NAME_0002.glb is one of a sequence unless Options::animation is given. Throws
  /// Error for an invalid file, no frames, decreasing times, or a changing number of vertices.
  AnimatedPoints(const std::filesystem::path& path, const Options& options, const ReadMesh& read_mesh = {});
  AnimatedPoints(AnimatedPoints&&) noexcept = default;
  AnimatedPoints& operator=(AnimatedPoints&&) noexcept = default;

  std::uint64_t points() const { return frames_.points; }
  double start_time() const { return start_time_; }                       ///< time of the first frame [s]
  double end_time() const { return start_time_ + frames_.times.back(); }  ///< time of the last frame [s]
  /// Per frame: time since the first frame. [s]
  std::span<const double> times() const { return frames_.times; }
  /// Writes the positions at `time` [s]; `positions` has points() entries. Throws Error if a number of the
  /// file is not finite or the file can no longer be read.
  void evaluate(double time, std::span<Vec3f> positions);

 private:
  struct Loaded {
    std::uint64_t frame = ~std::uint64_t(0);  ///< none
    std::vector<Vec3f> positions{};
  };
  const std::vector<Vec3f>& load(std::uint64_t frame);

  PointFrames frames_;
  std::string name_;
  double start_time_;
  bool loop_;
  std::array<Loaded, 2> loaded_;  ///< frame f is in loaded_[f % 2], so successive frames coexist
};

}  // namespace souple
