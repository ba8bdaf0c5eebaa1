#pragma once

#include "souple/math/vec3.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace souple {

/// Selection of an animation in a mesh file.
struct MeshAnimationImport {
  std::string animation{};  ///< its name; empty: the file's only one
  std::string node{};       ///< as MeshImport::node
  double frame_rate = 60;   ///< frames per second, > 0 and at most 1e5
};

/// Positions of a mesh's vertices, frame by frame.
struct MeshAnimation {
  std::size_t points = 0;     ///< vertices, in the order of read_triangle_mesh
  std::vector<double> times;  ///< of the frames: from 0 to the animation's end, increasing [s]
  std::vector<Vec3f>
      positions;  ///< points x frames, those of a frame in succession [unit of read_triangle_mesh]
};

/// Reads an animation of a .gltf, .glb, .fbx or .dae file: nodes that move, bones (linear blend skinning) and shapes
/// (morph targets). The file's keys are joined by straight lines and rotations of constant speed, and evaluated at the
/// frames. Throws Error like read_triangle_mesh; where the file has no such animation, with the names of those it has;
/// and above 1 GiB of positions.
MeshAnimation read_mesh_animation(const std::filesystem::path& path, const MeshAnimationImport& options = {});

/// Whether files of this extension (".glb", in any letter case) hold animations that read_mesh_animation reads.
bool may_hold_mesh_animation(const std::filesystem::path& path);

}  // namespace souple
