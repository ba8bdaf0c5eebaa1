#pragma once

#include "souple/error.h"
#include "souple/io/manifest.h"
#include "souple/io/particle_file.h"
#include "souple/io/sequence.h"
#include "souple/scene/nearest.h"
#include "souple/scene/scene.h"
#include "souple/surface/fluid_surface.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Meshes of fluids in a folder for other commands: of a finished run (`souple surface`), or during a run
// (`souple run --surface`).

namespace souple::app {

/// The words of an option and their values.
template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// Throws Error that lists the words.
template <class Value>
Value value_of(const Words<Value>& words, const std::string& word, const char* option) {
  std::vector<std::string> known;
  for (const auto& [name, value] : words) {
    if (name == word) return value;
    known.push_back(name);
  }
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  throw Error(std::string(option) + " \"" + word + "\": expected one of " + list +
              scene_format::suggestion(word, known));
}

/// Formats of meshes (OBJ, PLY) and of volumes around them (VDB).
enum class SurfaceFormat { obj, ply, vdb };

/// Options of meshing and writing surfaces.
struct SurfaceOrder {
  SurfaceOptions surface;
  SurfaceFormat format = SurfaceFormat::obj;
  std::optional<ParticleFormat> particles;
  std::filesystem::path out;
};

/// Parses "anisotropic" or "isotropic". Throws Error that names the option.
SurfaceMethod surface_method_of(const std::string& word, const char* option);

/// out/dam_surface for out/dam or out/dam/run.json.
std::filesystem::path surface_folder(const std::filesystem::path& cache);

/// Distance of particles [m]; 0 for objects without particles of their own.
float particle_spacing(const AnyObjectDescription& description);

/// The files of one object.
class SurfaceFiles {
 public:
  SurfaceFiles(const SurfaceOrder& order, float spacing, std::string object, const std::string& file_name,
               Threads& threads);
  SurfaceFiles(const SurfaceFiles&) = delete;
  SurfaceFiles& operator=(const SurfaceFiles&) = delete;

  /// Continues after frame `done` with the existing meshes of earlier frames. `before`: the run.json written
  /// with them or later. Throws Error if it does not match.
  void resume(const RunManifest& before, std::uint64_t done);
  /// `velocities` may be empty; `rate`: frames per second. An absent object, or one too thin for the grid,
  /// gets no file.
  void write(std::uint64_t frame, std::span<const Vec3f> positions, std::span<const Vec3f> velocities,
             double rate);
  void finish();
  const ManifestObject& listed() const { return listed_; }
  std::uint64_t triangles() const { return triangles_; }
  double milliseconds() const { return milliseconds_; }

 private:
  std::string bytes();
  void list_first(std::uint64_t frame, const SurfaceMesh& mesh);
  std::span<const Vec3f> differences(std::span<const Vec3f> positions, float rate);

  std::filesystem::path folder_;
  std::string object_, file_name_;
  SurfaceFormat format_;
  std::string extension_;
  Threads& threads_;
  FluidSurface surface_;
  SequenceWriter meshes_;
  std::optional<SequenceWriter> particles_;
  ManifestObject listed_;
  std::vector<Vec3f> before_, velocities_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  double milliseconds_ = 0;
};

using ObjectFiles = std::vector<std::unique_ptr<SurfaceFiles>>;

/// The run.json of the meshes of the first `frames` frames of a run.
RunManifest surface_manifest(const RunManifest& source, std::uint64_t frames, const ObjectFiles& objects);

/// "300 frames, 20000 triangles and 31.5 ms each".
std::string surface_summary(std::uint64_t frames, const ObjectFiles& objects);

}  // namespace souple::app
