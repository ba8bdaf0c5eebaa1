#include "souple/world/fluid_registry.h"

#include "souple/objects/collider_record.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/object.h"
#include "souple/world/contact_state.h"
#include "souple/world/state.h"

#include <optional>
#include <utility>

namespace souple {

void FluidRegistry::find_bodies(const WorldState& world, FluidBodies& bodies,
                                SubResolutionBodies& sub_resolution_bodies) {
  with_boundary.clear();
  sub_resolution.clear();
  std::vector<BoundaryMesh> boundaries;
  std::vector<SubResolutionBody> pieces;
  float spacing = 0;
  for (const auto& object : world.objects)
    if (const auto* material = std::get_if<FluidMaterial>(&object->material)) spacing = material->spacing;
  for (std::uint32_t o = 0; spacing > 0 && o < world.objects.size(); ++o) {
    if (std::optional<BoundaryMesh> boundary = boundary_mesh_of(*world.objects[o], spacing)) {
      boundaries.push_back(std::move(*boundary));
      with_boundary.push_back(o);
      continue;
    }
    const std::size_t before = pieces.size();
    append_sub_resolution_bodies(*world.objects[o], spacing, world.particles.mass,
                                 static_cast<std::uint32_t>(sub_resolution.size()), pieces);
    if (pieces.size() > before) sub_resolution.push_back(o);
  }
  bodies.set_meshes(std::move(boundaries));
  sub_resolution_bodies.set_bodies(std::move(pieces));
}

void FluidRegistry::find_particles(const WorldState& world) {
  particle.clear();
  fluid.clear();
  collides_with_collider.clear();
  collides_with_body.clear();
  collides_with_sub_resolution.clear();
  viscosities.clear();
  wind_exposures.clear();
  materials.clear();
  for (std::uint32_t o = 0; o < world.objects.size(); ++o) {
    const Object& object = *world.objects[o];
    const auto* material = std::get_if<FluidMaterial>(&object.material);
    if (!material) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      if (world.particles.position[i].w == 0) continue;
      particle.push_back(i);
      fluid.push_back(static_cast<std::uint16_t>(materials.size()));
    }
    for (const std::uint32_t body : with_boundary)
      collides_with_body.push_back(world.contact->tables.against_objects.collide(o, body) ? 1 : 0);
    for (const std::uint32_t body : sub_resolution)
      collides_with_sub_resolution.push_back(world.contact->tables.against_objects.collide(o, body) ? 1 : 0);
    viscosities.push_back(material->viscosity);
    wind_exposures.push_back(object.wind_exposure);
    materials.push_back(*material);
    for (std::uint32_t c = 0; c < world.contact->tables.colliders.size(); ++c)
      collides_with_collider.push_back(world.contact->tables.against_colliders.collide(o, c) ? 1 : 0);
  }
}

}  // namespace souple
