#pragma once

#include "souple/error.h"
#include "souple/io/manifest.h"
#include "souple/io/particle_file.h"
#include "souple/io/sequence.h"
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

// Meshes of fluids in a folder that other commands read: from a finished run (`souple surface`), or during
// the run (`souple run --surface`).

namespace souple::app {

/// Meshes, or volumes around them.
enum class SurfaceFormat { obj, ply, vdb };

/// Settings of surfaces and of the files they are written to.
struct SurfaceFileOptions {
  SurfaceOptions surface;
  SurfaceFormat format = SurfaceFormat::obj;
  std::optional<ParticleFormat> particles;
  std::filesystem::path out;
};

/// Parses "anisotropic" or "isotropic". Throws Error that names the option.
SurfaceMethod surface_method_of(const std::string& word, const char* option);

/// Maps out/dam, or out/dam/run.json, with the ending "_surface" to out/dam_surface.
std::filesystem::path folder_beside(const std::filesystem::path& cache, const char* ending);
/// out/dam_surface
std::filesystem::path surface_folder(const std::filesystem::path& cache);

/// Spacing of an object's particles [m]; 0 if the object does not consist of particles.
float particle_spacing(const AnyObjectDescription& description);

/// Writes the files of one object.
class SurfaceFiles {
 public:
  SurfaceFiles(const SurfaceFileOptions& file_options, float spacing, std::string object,
               const std::string& file_name, Threads& threads);
  SurfaceFiles(const SurfaceFiles&) = delete;
  SurfaceFiles& operator=(const SurfaceFiles&) = delete;

  /// Resumes after frame `done`, and keeps the existing meshes up to that frame. `before` is the run.json
  /// that was written with these meshes or after later ones. Throws Error where it does not match.
  void resume(const RunManifest& before, std::uint64_t done);
  /// `velocities` may be empty; `rate` is the frame rate [1/s]. Writes no file for an object without
  /// particles, or too thin for the grid.
  void write(std::uint64_t frame, std::span<const Vec3f> positions, std::span<const Vec3f> velocities,
             double rate);
  /// Undoes a failed frame: restores the state after frame `frame`.
  void drop_after(std::uint64_t frame);
  void finish();
  /// Size of the files of a frame; 0 without them.
  std::uint64_t bytes_of(std::uint64_t frame) const;
  const ManifestObject& manifest_object() const { return manifest_object_; }
  std::uint64_t triangles() const { return triangles_; }
  double milliseconds() const { return milliseconds_; }  ///< of meshing and writing

 private:
  std::string bytes();
  std::string volume_bytes();
  void add_first_to_manifest(std::uint64_t frame, const SurfaceMesh& mesh);
  std::span<const Vec3f> differences(std::span<const Vec3f> positions, float rate);

  std::filesystem::path folder_;
  std::string object_, file_name_;
  SurfaceFormat format_;
  std::string extension_, particles_extension_;
  Threads& threads_;
  FluidSurface surface_;
  SequenceWriter meshes_;
  std::optional<SequenceWriter> particles_;
  ManifestObject manifest_object_;
  std::vector<Vec3f> previous_, velocities_;
  std::span<const Vec3f> particles_now_, velocities_now_;  // of the frame that is written
  std::uint64_t triangles_ = 0;
  double milliseconds_ = 0;
};

using ObjectFiles = std::vector<std::unique_ptr<SurfaceFiles>>;

/// The run.json for the meshes of the first `frames` frames of a run, without reports.
RunManifest surface_manifest(const RunManifest& source, std::uint64_t frames, const ObjectFiles& objects);

/// "300 frames, 20000 triangles and 31.5 ms each".
std::string surface_summary(std::uint64_t frames, const ObjectFiles& objects);

}  // namespace souple::app
