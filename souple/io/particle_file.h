#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// File formats for one frame of particles: positions [m] and velocities [m/s].
enum class ParticleFormat {
  ply,  ///< binary little-endian PLY: x, y, z, vx, vy, vz
  vtk,  ///< VTK's legacy format, binary: points, one vertex cell each, vectors `velocity`
  bgeo  ///< Houdini's classic format, version 5, uncompressed: points, vectors `v`
};

/// "ply", "vtk", "bgeo": name and file extension of the format.
std::string_view particle_format_name(ParticleFormat format);

/// The bytes of a file. `velocities` is empty or has one entry per point; throws Error otherwise.
std::string particle_bytes(ParticleFormat format, std::span<const Vec3f> points,
                           std::span<const Vec3f> velocities);

/// One frame of particles.
struct ParticleFrame {
  std::vector<Vec3f> positions;     ///< m
  std::vector<Vec3f> velocities;    ///< m/s; empty if the file has none
  std::vector<std::uint8_t> kinds;  ///< of foam: FoamKind; empty if the file has none
};
/// Reads a PLY as particle_bytes writes it, also without points. Returns nullopt for another kind of PLY
/// (with faces, for example) or another format. Throws Error if the file cannot be read or is truncated.
std::optional<ParticleFrame> read_particle_ply(const std::filesystem::path& path);

/// The velocities vx, vy, vz of the vertices of a PLY, with faces or without [m/s]. Empty if it has none, or is in a
/// form that Souple does not write: text, other types than float. Throws Error if the file cannot be read or is
/// truncated.
std::vector<Vec3f> read_ply_velocities(const std::filesystem::path& path);

}  // namespace souple
