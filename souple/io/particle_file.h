#pragma once

#include "souple/math/vec3.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// Files that hold one frame of particles: positions [m] and velocities [m/s].
enum class ParticleFormat {
  ply,  ///< binary little-endian PLY: x, y, z, vx, vy, vz
  vtk,  ///< VTK's legacy format, binary: points, a vertex each, vectors `velocity`
  bgeo  ///< Houdini's classic format, version 5, uncompressed: points, vectors `v`
};

/// "ply", "vtk", "bgeo": the name of the format, and the extension of its files.
std::string_view particle_format_name(ParticleFormat format);

/// The bytes of a file. `velocities` is empty, or has one for each point; else Error.
std::string particle_bytes(ParticleFormat format, std::span<const Vec3f> points,
                           std::span<const Vec3f> velocities);

/// One frame of particles.
struct ParticleFrame {
  std::vector<Vec3f> positions;   ///< m
  std::vector<Vec3f> velocities;  ///< m/s; empty where the file has none
};
/// A PLY as particle_bytes writes it, also of no points. Nothing where the file is another kind of PLY, with
/// faces for example, or none. Throws Error where it cannot be read, or ends too soon.
std::optional<ParticleFrame> read_particle_ply(const std::filesystem::path& path);

}  // namespace souple
