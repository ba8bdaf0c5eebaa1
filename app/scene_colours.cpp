#include "app/scene_colours.h"

#include <algorithm>
#include <string_view>
#include <vector>

namespace souple::app {

namespace {

template <class Things>
void colour(Things& things, std::string_view name, const std::optional<std::uint32_t>& wish) {
  if (!wish) return;
  for (auto& thing : things) {
    if (thing.name == name) thing.colour = render::srgb(*wish);
  }
}

void leave_out(std::vector<render::ColliderBody>& colliders, std::string_view name) {
  const auto is_it = [&](const auto& collider) { return collider.name == name; };
  colliders.erase(std::remove_if(colliders.begin(), colliders.end(), is_it), colliders.end());
}

}  // namespace

void add_colours(const SceneDescription& scene, render::Subject& subject) {
  for (const AnyObjectDescription& object : scene.objects)
    colour(subject.bodies, common(object).name, common(object).colour);
  for (const ColliderDescription& collider : scene.colliders) {
    colour(subject.colliders, collider.name, collider.colour);
    if (!collider.show) leave_out(subject.colliders, collider.name);
  }
}

}  // namespace souple::app
