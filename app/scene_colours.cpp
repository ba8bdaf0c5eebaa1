#include "app/scene_colours.h"

#include <string_view>

namespace souple::app {

namespace {

template <class Things>
void colour(Things& things, std::string_view name, const std::optional<std::uint32_t>& wish) {
  if (!wish) return;
  for (auto& thing : things) {
    if (thing.name == name) thing.colour = render::srgb(*wish);
  }
}

}  // namespace

void add_colours(const SceneDescription& scene, render::Subject& subject) {
  for (const AnyObjectDescription& object : scene.objects)
    colour(subject.bodies, common(object).name, common(object).colour);
  for (const ColliderDescription& collider : scene.colliders)
    colour(subject.colliders, collider.name, collider.colour);
}

}  // namespace souple::app
