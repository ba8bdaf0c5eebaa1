#include "app/scene_colors.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace souple::app {

namespace {

template <class Things>
void color(Things& things, std::string_view name, const std::optional<std::uint32_t>& wish) {
  if (!wish) return;
  for (auto& thing : things) {
    if (thing.name == name) thing.color = render::srgb(*wish);
  }
}

void leave_out(std::vector<render::ColliderBody>& colliders, std::string_view name) {
  const auto is_it = [&](const auto& collider) { return collider.name == name; };
  colliders.erase(std::remove_if(colliders.begin(), colliders.end(), is_it), colliders.end());
}

}  // namespace

void add_colors(const SceneDescription& scene, render::Subject& subject) {
  for (const AnyObjectDescription& object : scene.objects)
    color(subject.bodies, common(object).name, common(object).color);
  for (const ColliderDescription& collider : scene.colliders) {
    color(subject.colliders, collider.name, collider.color);
    if (!collider.show) leave_out(subject.colliders, collider.name);
  }
}

}  // namespace souple::app
