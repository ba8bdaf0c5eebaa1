#include "souple/fluid/stage/fluid_registry.h"

#include "souple/assert.h"
#include "souple/contacts/contact_projector.h"
#include "souple/fluid/fluid_bodies.h"
#include "souple/fluid/sub_resolution_bodies.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace souple {

// All fluids have the same spacing. Without fluids there are no bodies.
void FluidRegistry::find_bodies(const ObjectsView& objects, FluidBodies& bodies,
                                SubResolutionBodies& sub_resolution_bodies) {
  with_boundary.clear();
  sub_resolution.clear();
  std::vector<BoundaryMesh> boundaries;
  std::vector<SubResolutionBody> pieces;
  float spacing = 0;
  for (const auto& object : objects.objects)
    if (const auto* material = std::get_if<FluidMaterial>(&object->material)) spacing = material->spacing;
  for (std::uint32_t o = 0; spacing > 0 && o < objects.objects.size(); ++o) {
    if (std::optional<BoundaryMesh> boundary = boundary_mesh_of(*objects.objects[o], spacing)) {
      boundaries.push_back(std::move(*boundary));
      with_boundary.push_back(o);
      continue;
    }
    const std::size_t before = pieces.size();
    append_sub_resolution_bodies(*objects.objects[o], spacing, objects.particles.mass,
                                 static_cast<std::uint32_t>(sub_resolution.size()), pieces);
    if (pieces.size() > before) sub_resolution.push_back(o);
  }
  bodies.set_meshes(std::move(boundaries));
  sub_resolution_bodies.set_bodies(std::move(pieces));
}

void FluidRegistry::find_particles(const ObjectsView& objects, const ContactTables& contacts) {
  particle.clear();
  fluid.clear();
  collides_with_collider.clear();
  collides_with_body.clear();
  collides_with_sub_resolution.clear();
  viscosities.clear();
  wind_exposures.clear();
  materials.clear();
  sources.clear();
  for (std::uint32_t o = 0; o < objects.objects.size(); ++o) {
    const Object& object = *objects.objects[o];
    const auto* material = std::get_if<FluidMaterial>(&object.material);
    if (!material) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      if (objects.particles.position[i].w == 0) continue;
      particle.push_back(i);
      fluid.push_back(static_cast<std::uint16_t>(materials.size()));
    }
    for (const std::uint32_t body : with_boundary)
      collides_with_body.push_back(contacts.against_objects.collide(o, body) ? 1 : 0);
    for (const std::uint32_t body : sub_resolution)
      collides_with_sub_resolution.push_back(contacts.against_objects.collide(o, body) ? 1 : 0);
    viscosities.push_back(material->viscosity);
    wind_exposures.push_back(object.wind_exposure);
    materials.push_back(*material);
    sources.push_back({object.id.value, object.begin, object.end});
    for (std::uint32_t c = 0; c < contacts.colliders.size(); ++c)
      collides_with_collider.push_back(contacts.against_colliders.collide(o, c) ? 1 : 0);
  }
}

std::size_t FluidRegistry::find(std::uint32_t id) const {
  const auto at =
      std::find_if(sources.begin(), sources.end(), [id](const Source& source) { return source.id == id; });
  SOUPLE_ASSERT(at != sources.end(), "an emitter has a fluid");
  return static_cast<std::size_t>(at - sources.begin());
}

}  // namespace souple
