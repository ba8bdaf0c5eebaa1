#include "app/scene_colors.h"

#include "app/picture_files.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <vector>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

template <class Items>
void color(Items& items, std::string_view name, const std::optional<std::uint32_t>& color_value) {
  if (!color_value) return;
  for (auto& item : items) {
    if (item.name == name) item.color = render::srgb(*color_value);
  }
}

/// Makes the item of this name glass if the scene says so.
template <class Items>
void set_look(Items& items, std::string_view name, SurfaceLook look) {
  for (auto& item : items) {
    if (item.name == name) item.glass = look == SurfaceLook::glass;
  }
}

void set_fabric(std::vector<render::Body>& bodies, const ClothDescription& cloth, const fs::path& folder) {
  for (render::Body& body : bodies) {
    if (body.name != cloth.name) continue;
    body.fabric = static_cast<render::Fabric>(cloth.look);
    if (!cloth.pattern) continue;
    body.print = static_cast<render::Print>(cloth.pattern->pattern);
    if (!cloth.pattern->file.empty() && body.mesh != nullptr)
      body.picture = picture_of(folder / cloth.pattern->file);
  }
}

void set_caustics(std::vector<render::Body>& bodies, const FluidDescription& fluid) {
  for (render::Body& body : bodies)
    if (body.name == fluid.name) body.caustics = fluid.caustics;
}

void remove_collider(std::vector<render::ColliderBody>& colliders, std::string_view name) {
  const auto has_name = [&](const auto& collider) { return collider.name == name; };
  colliders.erase(std::remove_if(colliders.begin(), colliders.end(), has_name), colliders.end());
}

}  // namespace

void add_colors(const SceneDescription& scene, render::Subject& subject) {
  for (const AnyObjectDescription& object : scene.objects) {
    color(subject.bodies, common(object).name, common(object).color);
    if (const auto* cloth = std::get_if<ClothDescription>(&object))
      set_fabric(subject.bodies, *cloth, scene.folder);
    if (const auto* fluid = std::get_if<FluidDescription>(&object)) set_caustics(subject.bodies, *fluid);
    if (const auto* obstacle = std::get_if<ObstacleDescription>(&object))
      set_look(subject.bodies, obstacle->name, obstacle->look);
  }
  for (const ColliderDescription& collider : scene.colliders) {
    color(subject.colliders, collider.name, collider.color);
    set_look(subject.colliders, collider.name, collider.look);
    if (!collider.show) remove_collider(subject.colliders, collider.name);
  }
  // A run may be shown where the file is not; for a scene its existence was checked.
  if (scene.sky && fs::exists(scene.folder / scene.sky->file))
    subject.environment = sky_of(*scene.sky, scene.folder);
}

}  // namespace souple::app
