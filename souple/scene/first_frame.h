#pragma once

#include "souple/math/vec3.h"
#include "souple/mesh_files/mesh_file.h"

#include <span>
#include <string>

namespace souple {

/// Compares the first frame of an animation with the mesh that it moves. The frame is in the units and axes of its
/// file, the mesh in meters with Y up. Recognizes a frame that is the mesh rotated by multiples of 90 degrees or
/// scaled, and names the keys that mend it. Returns a sentence without subject ("is the mesh rotated ..."), or nothing
/// if both fit: a pose of its own is no mistake.
std::string first_frame_remark(std::span<const Vec3d> mesh, std::span<const Vec3f> frame,
                               const MeshImport& import);

}  // namespace souple
