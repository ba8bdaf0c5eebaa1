#include "souple/geometry/vertex_maps.h"

#include "souple/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

void fill_group(std::vector<float>& map, const TriangleMesh& mesh, const std::string& group, float value) {
  const auto found = mesh.groups.find(group);
  if (found == mesh.groups.end()) {
    std::string known;
    for (const auto& [name, vertices] : mesh.groups) known += (known.empty() ? "" : ", ") + name;
    throw Error("the mesh has no group '" + group + "'" +
                (known.empty() ? "; it has no groups at all" : "; its groups are: " + known));
  }
  for (const std::uint32_t v : found->second) {
    if (v >= map.size())
      throw Error(fmt::format("group '{}' names vertex {}, but there are {} vertices (numbered from 0)",
                              group, v, map.size()));
    map[v] = value;
  }
}

}  // namespace

std::vector<float> map_from_group(const TriangleMesh& mesh, const std::string& group, float inside,
                                  float outside) {
  return map_from_groups(mesh, {{group, inside}}, outside);
}

std::vector<float> map_from_groups(const TriangleMesh& mesh, const std::map<std::string, float>& values,
                                   float otherwise) {
  std::vector<float> map(mesh.positions.size(), otherwise);
  for (const auto& [group, value] : values) fill_group(map, mesh, group, value);
  return map;
}

std::vector<float> map_from_colors(const TriangleMesh& mesh, ColorChannel channel, float low, float high) {
  if (mesh.colors.empty() || mesh.colors.size() != mesh.positions.size())
    throw Error(
        fmt::format("the mesh has {} vertex colors for {} vertices; a map from colors needs one each: "
                    "paint them, or save the mesh in a format that keeps them (PLY)",
                    mesh.colors.size(), mesh.positions.size()));
  std::vector<float> map;
  map.reserve(mesh.colors.size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
    const float value = mesh.colors[v][static_cast<int>(channel)];
    if (!std::isfinite(value)) throw Error(fmt::format("the color of vertex {} is not a finite number", v));
    map.push_back(low + (high - low) * std::clamp(value, 0.0f, 1.0f));
  }
  return map;
}

}  // namespace souple
