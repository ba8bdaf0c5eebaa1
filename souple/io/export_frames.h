#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/io/playback.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The frames of a run for formats that hold whole scenes: GLB and USD.

namespace souple {

enum class ExportShape { surface, line, grains, fluid, foam };

/// Appearance of an object, which its scene states.
struct ExportLook {
  Vec3f color{0.6f, 0.6f, 0.6f};  ///< linear RGB
  float opacity = 1;
  float roughness = 0.8f;
  float radius = 0;  ///< of its particles [m]; 0: unknown
};

/// An object in one frame.
struct ExportObject {
  std::string name, kind;
  ExportShape shape = ExportShape::surface;
  ExportLook look{};
  /// Per material of the mesh: `look` with the color and opacity that its .mtl file states, if there is one.
  std::vector<ExportLook> material_looks{};
  bool smooth = true;  ///< a surface with vertex normals
  /// Triangles, faces, UVs, groups and materials in this frame; its positions are those at rest. Empty unless a surface.
  const TriangleMesh* mesh = nullptr;
  /// Whether mesh and number of points are those of the first frame.
  bool first_topology = true;
  /// Whether that is so in all frames; known after ExportFrames::survey.
  bool constant = true;
  std::span<const Vec3f> positions{};          ///< m; empty: the object is absent
  std::span<const Vec3f> normals{};            ///< of surfaces; unit
  std::span<const Vec3f> velocities{};         ///< m/s; empty: unknown
  std::span<const std::uint8_t> foam_kinds{};  ///< FoamKind of each point; empty: unknown
};

/// Reads a run frame by frame, and adds data that its caches lack: velocities, and meshes with UVs, groups and
/// materials.
class ExportFrames {
 public:
  using FindLook = std::function<ExportLook(const Playback::Object& object)>;
  /// `path` is the folder of a run or its run.json. Throws Error like Playback, and for a run without frames.
  ExportFrames(const std::filesystem::path& path, const FindLook& find_look);
  ExportFrames(const ExportFrames&) = delete;
  ExportFrames& operator=(const ExportFrames&) = delete;

  const Playback& playback() const { return playback_; }
  /// Finds which objects have the same points and triangles in all frames. Reads each frame if the run has sequences.
  /// Returns whether all have.
  bool survey();
  /// Reads a frame. Velocities that the caches lack are displacements since the frame before, divided by its duration;
  /// in the first frame, until the next one. Objects whose topology changed meanwhile have none.
  void read(std::uint64_t frame);
  std::span<const ExportObject> objects() const { return objects_; }

 private:
  /// State of an object from frame to frame.
  struct Part {
    TriangleMesh home, other;
    std::size_t points = 0;       // in the first frame
    std::vector<Vec3f> previous;  // positions in the frame before
    std::vector<Vec3f> velocities, normals;
  };
  void describe(std::size_t i);
  void find_velocities(std::uint64_t from, std::uint64_t to);
  void remember();

  Playback playback_;
  std::vector<Part> parts_;
  std::vector<ExportObject> objects_;
  std::uint64_t remembered_ = 0;  // frame of Part::previous
};

/// The name of the run in a folder, for files: "flag" for out/flag and out/flag/run.json.
std::string run_name(const std::filesystem::path& path);

}  // namespace souple
