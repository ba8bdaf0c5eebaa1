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

// Meshes of fluids in a folder that other commands read: of a finished run (`souple surface`), or while it
// runs (`souple run --surface`).

namespace souple::app {

/// The words that an option knows, and what they mean.
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

/// Meshes, or volumes around them.
enum class SurfaceFormat { obj, ply, vdb };

/// How surfaces are made and written.
struct SurfaceOrder {
  SurfaceOptions surface;
  SurfaceFormat format = SurfaceFormat::obj;
  std::optional<ParticleFormat> particles;
  std::filesystem::path out;
};

/// Of "anisotropic" or "isotropic". Throws Error, naming the option.
SurfaceMethod surface_method_of(const std::string& word, const char* option);

/// out/dam, or out/dam/run.json, to out/dam_surface.
std::filesystem::path surface_folder(const std::filesystem::path& cache);

/// How far particles lie apart [m]; 0 of what is not made of particles.
float particle_spacing(const AnyObjectDescription& description);

/// The files of one object.
class SurfaceFiles {
 public:
  SurfaceFiles(const SurfaceOrder& order, float spacing, std::string object, const std::string& file_name,
               Threads& threads);
  SurfaceFiles(const SurfaceFiles&) = delete;
  SurfaceFiles& operator=(const SurfaceFiles&) = delete;

  /// Goes on after frame `done`, with the meshes of the frames before it that are there. `before` is the
  /// run.json that was written with them, or after later ones. Throws Error where it does not fit.
  void resume(const RunManifest& before, std::uint64_t done);
  /// `velocities` may be empty; `rate` of frames [1/s]. An object that is not there, or too thin for the
  /// grid, has no file.
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
