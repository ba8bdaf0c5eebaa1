#pragma once

#include "souple/io/export_frames.h"
#include "souple/io/usda_text.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace souple {

/// A run as text of USD: a stage in meters, Y up, whose time code N is frame N. An Xform of the run's name holds the
/// objects. Surfaces are a Mesh (polygons, UVs as primvars:st, a GeomSubset per material and per group), ropes
/// BasisCurves, fluids Points. Grains and foam are a PointInstancer of spheres. Per frame: points or positions,
/// velocities, extent, normals of smooth surfaces; topology of objects that are not constant. (Pixar, Universal Scene
/// Description, UsdGeom and value clips.)
class UsdaRun {
 public:
  struct Options {
    std::string run;         ///< name
    double frame_rate = 60;  ///< frames per second
    std::uint64_t frames = 0;
    bool clips = false;  ///< samples are in a file per frame, which the stage names
  };
  /// `first`: the objects in the first frame, after ExportFrames::survey.
  UsdaRun(const Options& options, std::span<const ExportObject> first);

  /// Adds a frame to the stage of a run without clips.
  void add(std::uint64_t frame, std::span<const ExportObject> objects);
  /// The text of a frame's file of a run with clips.
  std::string clip(std::uint64_t frame, std::span<const ExportObject> objects);
  /// The text of the stage, after all frames. `clips`: paths of the clips' files relative to the stage's.
  std::string stage(std::span<const std::string> clips = {}) const;
  /// Declares what clips hold; the stage refers to the file.
  std::string clip_manifest() const;
  static std::string manifest_name(const std::string& run) { return run + "_manifest.usda"; }

  /// The samples' size per frame, of these objects. [bytes]
  std::uint64_t frame_size(std::span<const ExportObject> objects) const;

 private:
  /// An attribute with a value per frame.
  struct Attribute {
    std::string declaration;  ///< "point3f[] points"
    std::string samples{};    ///< lines "1: [...],"
    std::string last{};       ///< the value of `last_frame`
    std::uint64_t last_frame = 0;
    bool changes = false, written = false;  ///< whether the last value is in samples
  };
  struct Value {
    const char* declaration;
    std::string text;
  };
  struct Prim {
    std::string name, type;
    std::string constant;  ///< lines of attributes without samples, and of child prims
    std::string metadata;  ///< in parentheses
    std::vector<Attribute> attributes;
  };
  struct MaterialPrim {
    std::string name, text;
  };

  Prim prim_of(const ExportObject& object);
  std::string topology_of(const ExportObject& object);
  std::string subsets_of(const ExportObject& object);
  std::string spheres_of(const ExportObject& object, const std::string& prim) const;
  std::string bind(const ExportObject& object, const std::string& name, const ExportLook& look);
  std::vector<Value> values_of(const ExportObject& object) const;
  std::string head() const;
  std::string clips_text(std::span<const std::string> clips) const;

  Options options_;
  std::string root_;  ///< prim name
  std::vector<Prim> prims_;
  std::vector<MaterialPrim> materials_;
  std::map<std::pair<std::string, std::string>, std::string>
      material_prims_;  // by the names of object and material
  usda::PrimNames material_names_;
};

}  // namespace souple
