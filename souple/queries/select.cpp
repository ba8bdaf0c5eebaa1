#include "souple/queries/select.h"

#include "souple/error.h"
#include "souple/objects/object.h"
#include "souple/queries/nearest_name.h"

#include <algorithm>
#include <limits>

#include <fmt/core.h>

namespace souple {
namespace {

struct SelectVertices {
  const Object& object;
  std::span<const Vec3f> positions;

  std::vector<std::uint32_t> operator()(const Selector::All&) const {
    std::vector<std::uint32_t> result(positions.size());
    for (std::uint32_t i = 0; i < result.size(); ++i) result[i] = i;
    return result;
  }
  std::vector<std::uint32_t> operator()(const Selector::Vertices& chosen) const {
    std::vector<std::uint32_t> result = chosen.indices;
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    if (!result.empty() && result.back() >= positions.size())
      throw Error(fmt::format("vertices: {} has {} vertices, but no vertex {}", object.name, positions.size(),
                              result.back()));
    return result;
  }
  std::vector<std::uint32_t> operator()(const Selector::InBox& box) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      const Vec3f& x = positions[i];
      if (x.x >= box.lo.x && x.x <= box.hi.x && x.y >= box.lo.y && x.y <= box.hi.y && x.z >= box.lo.z &&
          x.z <= box.hi.z)
        result.push_back(i);
    }
    return result;
  }
  std::vector<std::uint32_t> operator()(const Selector::Nearest& nearest) const {
    std::vector<std::uint32_t> result;
    float best = std::numeric_limits<float>::infinity();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      const float distance = length_squared(positions[i] - nearest.point);
      if (distance < best) best = distance, result = {i};
    }
    return result;
  }
  std::vector<std::uint32_t> operator()(const Selector::Group& group) const {
    const auto found = object.mesh.groups.find(group.name);
    if (found != object.mesh.groups.end()) return found->second;
    std::vector<std::string_view> names;
    for (const auto& [name, vertices] : object.mesh.groups) names.push_back(name);
    throw Error("group: the mesh of " + object.name + " has no group '" + group.name + "'" +
                nearest_name(group.name, names));
  }
};

}  // namespace

std::vector<std::uint32_t> select_vertices(const Object& object, std::span<const Vec3f> positions,
                                           const Selector& selector) {
  std::vector<std::uint32_t> result = std::visit(SelectVertices{object, positions}, selector.choice);
  if (result.empty())
    throw Error("the selector selects no vertex of " + object.name + "; check its current positions");
  return result;
}

}  // namespace souple
