#include "app/surface_files.h"

#include "app/option_names.h"
#include "app/surface_velocities.h"
#include "app/vdb.h"
#include "souple/mesh_files/mesh_write.h"
#include "souple/version.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <system_error>

#include <fmt/core.h>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

SurfaceOptions with_spacing(SurfaceOptions options, float spacing) {
  options.spacing = spacing;
  return options;
}

const char* extension_of(SurfaceFormat format) {
  return format == SurfaceFormat::vdb ? "vdb" : format == SurfaceFormat::ply ? "ply" : "obj";
}

/// Width of the narrow band of a volume on each side of the surface. [cells]
constexpr int band_cells = 3;

struct Spacing {
  float operator()(const FluidDescription& fluid) const { return fluid.material.spacing; }
  float operator()(const GrainsDescription& grains) const { return 2 * grains.material.radius; }
  float operator()(const ObjectDescription&) const { return 0; }
};

}  // namespace

SurfaceMethod surface_method_of(const std::string& word, const char* option) {
  return value_of<SurfaceMethod>(
      {{"anisotropic", SurfaceMethod::anisotropic}, {"isotropic", SurfaceMethod::isotropic}}, word, option);
}

fs::path folder_beside(const fs::path& cache, const char* ending) {
  fs::path folder = (cache.filename() == "run.json" ? cache.parent_path() : cache).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (folder.empty() || folder == "." || folder == "..") folder = fs::absolute(folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  folder += ending;
  return folder;
}

fs::path surface_folder(const fs::path& cache) {
  return folder_beside(cache, "_surface");
}

float particle_spacing(const AnyObjectDescription& description) {
  return std::visit(Spacing{}, description);
}

SurfaceFiles::SurfaceFiles(const SurfaceFileOptions& file_options, float spacing, std::string object,
                           const std::string& file_name, Threads& threads)
    : folder_(file_options.out),
      object_(std::move(object)),
      file_name_(file_name),
      format_(file_options.format),
      extension_(extension_of(file_options.format)),
      threads_(threads),
      surface_(with_spacing(file_options.surface, spacing)),
      meshes_(file_options.out, file_name, extension_, [this](auto, auto) { return bytes(); }) {
  if (file_options.particles) {
    const ParticleFormat format = *file_options.particles;
    particles_extension_ = std::string(particle_format_name(format));
    particles_.emplace(
        file_options.out, file_name + "_particles", std::string(particle_format_name(format)),
        [format](auto positions, auto velocities) { return particle_bytes(format, positions, velocities); });
  }
}

void SurfaceFiles::resume(const RunManifest& before, std::uint64_t done) {
  const auto known = std::find_if(before.objects.begin(), before.objects.end(),
                                  [&](const ManifestObject& object) { return object.name == object_; });
  std::uint64_t mesh_count = 0;
  for (std::uint64_t frame = 1; frame <= done; ++frame) {
    std::error_code ignored;
    if (fs::exists(folder_ / frame_file_name(file_name_, frame, extension_), ignored)) ++mesh_count;
  }
  const bool has_any = known != before.objects.end() && !known->files.empty();
  const std::uint64_t written = has_any ? known->files.front().frames : 0;
  // That run.json may list later frames too.
  if (before.frames < done || mesh_count > written || written - mesh_count > before.frames - done)
    throw Error(
        fmt::format("{}: lacks meshes of \"{}\": {} of the first {} frames exist; start the run again, "
                    "or make them from its folder with `souple surface`",
                    folder_.string(), object_, mesh_count, done));
  meshes_.go_on_after(done);
  if (mesh_count == 0) return;
  manifest_object_ = *known;
  manifest_object_.files.front().frames = mesh_count;
}

void SurfaceFiles::write(std::uint64_t frame, std::span<const Vec3f> positions,
                         std::span<const Vec3f> velocities, double rate) {
  const auto start = std::chrono::steady_clock::now();
  const SurfaceMesh& mesh = surface_.build(positions, threads_);
  const bool needs_velocities = particles_ || format_ != SurfaceFormat::obj;
  if (velocities.empty() && needs_velocities) velocities = differences(positions, static_cast<float>(rate));
  particles_now_ = positions;
  velocities_now_ = velocities;
  triangles_ += mesh.triangles.size();
  if (!mesh.triangles.empty()) {
    meshes_.skip_to(frame);
    meshes_.append(mesh.positions, {});
    if (manifest_object_.files.empty()) add_first_to_manifest(frame, mesh);
    ++manifest_object_.files.front().frames;
  }
  if (particles_ && !positions.empty()) {
    particles_->skip_to(frame);
    particles_->append(positions, velocities);
  }
  previous_.assign(positions.begin(), positions.end());
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
  milliseconds_ += spent.count();
}

std::uint64_t SurfaceFiles::bytes_of(std::uint64_t frame) const {
  std::uint64_t sum = 0;
  std::vector<std::string> names{frame_file_name(file_name_, frame, extension_)};
  if (particles_) names.push_back(frame_file_name(file_name_ + "_particles", frame, particles_extension_));
  for (const std::string& name : names) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(folder_ / name, error);
    if (!error) sum += size;
  }
  return sum;
}

void SurfaceFiles::drop_after(std::uint64_t frame) {
  std::vector<ManifestFile>& files = manifest_object_.files;
  const bool has_mesh = meshes_.frames() > frame && !files.empty();
  meshes_.drop_after(frame);
  if (particles_) particles_->drop_after(frame);
  if (has_mesh && --files.front().frames == 0) files.clear();
}

void SurfaceFiles::finish() {
  meshes_.finish();
  if (particles_) particles_->finish();
}

std::string SurfaceFiles::bytes() {
  const SurfaceMesh& mesh = surface_.mesh();
  if (format_ == SurfaceFormat::obj) return obj_text(mesh.positions, mesh.normals, mesh.triangles);
  if (format_ == SurfaceFormat::vdb) return volume_bytes();
  constexpr float radius = 2;  // vertices are half a spacing above the outermost particles
  return ply_bytes(mesh.positions, mesh.normals, mesh.triangles,
                   surface_velocities(mesh.positions, particles_now_, velocities_now_,
                                      radius * surface_.options().spacing, threads_));
}

std::string SurfaceFiles::volume_bytes() {
  const SurfaceMesh& mesh = surface_.mesh();
  const SurfaceOptions& options = surface_.options();
  const NarrowBand band = narrow_band(mesh.positions, mesh.triangles, options.cell, band_cells, threads_);
  // As far as the outermost point of the band is from a particle below the surface.
  const float radius = options.spacing + (band_cells + 1) * options.cell;
  return vdb_bytes(band, object_,
                   surface_velocities(band_points(band), particles_now_, velocities_now_, radius, threads_));
}

void SurfaceFiles::add_first_to_manifest(std::uint64_t frame, const SurfaceMesh& mesh) {
  manifest_object_ = {
      object_, "fluid", {{extension_, frame_file_name(file_name_, frame, extension_), 0}}, 0, 0};
  if (format_ == SurfaceFormat::vdb) return;  // a volume has neither
  manifest_object_.points = mesh.positions.size();
  manifest_object_.triangles = mesh.triangles.size();
}

/// Velocities where the cache holds positions only: displacement since the frame before, divided by its
/// duration. Zero where there was no such frame, or where its number of particles differs.
std::span<const Vec3f> SurfaceFiles::differences(std::span<const Vec3f> positions, float rate) {
  velocities_.assign(positions.size(), {});
  if (previous_.size() == positions.size())
    for (std::size_t i = 0; i < positions.size(); ++i) velocities_[i] = (positions[i] - previous_[i]) * rate;
  return velocities_;
}

RunManifest surface_manifest(const RunManifest& source, std::uint64_t frames, const ObjectFiles& objects) {
  RunManifest result;
  result.version = version;
  result.scene = source.scene;
  result.frame_rate = source.frame_rate;
  result.frames = frames;
  for (const auto& object : objects)
    if (!object->manifest_object().files.empty()) result.objects.push_back(object->manifest_object());
  result.notes = {"surfaces of particles, by souple surface"};
  return result;
}

std::string surface_summary(std::uint64_t frames, const ObjectFiles& objects) {
  std::uint64_t triangles = 0;
  double milliseconds = 0;
  for (const auto& object : objects) triangles += object->triangles(), milliseconds += object->milliseconds();
  const double count = static_cast<double>(std::max<std::uint64_t>(1, frames));
  return fmt::format("{} frames, {:.0f} triangles and {:.1f} ms each", frames,
                     static_cast<double>(triangles) / count, milliseconds / count);
}

}  // namespace souple::app
