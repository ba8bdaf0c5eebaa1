#include "app/scene_colors.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace souple::app {

namespace {

template <class Items>
void color(Items& items, std::string_view name, const std::optional<std::uint32_t>& color_value) {
  if (!color_value) return;
  for (auto& item : items) {
    if (item.name == name) item.color = render::srgb(*color_value);
  }
}

void remove_collider(std::vector<render::ColliderBody>& colliders, std::string_view name) {
  const auto has_name = [&](const auto& collider) { return collider.name == name; };
  colliders.erase(std::remove_if(colliders.begin(), colliders.end(), has_name), colliders.end());
}

}  // namespace

void add_colors(const SceneDescription& scene, render::Subject& subject) {
  for (const AnyObjectDescription& object : scene.objects)
    color(subject.bodies, common(object).name, common(object).color);
  for (const ColliderDescription& collider : scene.colliders) {
    color(subject.colliders, collider.name, collider.color);
    if (!collider.show) remove_collider(subject.colliders, collider.name);
  }
}

}  // namespace souple::app
