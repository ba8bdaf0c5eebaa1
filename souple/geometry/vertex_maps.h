#pragma once

#include "souple/geometry/triangle_mesh.h"

#include <map>
#include <string>
#include <vector>

namespace souple {

// One number per vertex, painted by the user: a pin weight, a stiffness factor, a thickness [m]. Values are
// in the user's vertex order.

enum class ColorChannel { red, green, blue };

/// `inside` for vertices of the named group, `outside` for all others. Throws Error, with the list of groups,
/// if the mesh has no group of this name.
std::vector<float> map_from_group(const TriangleMesh& mesh, const std::string& group, float inside = 1,
                                  float outside = 0);

/// A value for each of several groups, `otherwise` for all other vertices. Where groups overlap, the
/// alphabetically last group wins.
std::vector<float> map_from_groups(const TriangleMesh& mesh, const std::map<std::string, float>& values,
                                   float otherwise);

/// low + (high - low) * channel, for a channel from 0 (black) to 1; values outside [0, 1] are clamped. Throws
/// Error if the mesh has no vertex colors or a color is not finite.
std::vector<float> map_from_colors(const TriangleMesh& mesh, ColorChannel channel, float low = 0,
                                   float high = 1);

}  // namespace souple
