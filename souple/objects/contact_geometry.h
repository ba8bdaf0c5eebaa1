#pragma once

#include "souple/broad_phase/contact_surface.h"
#include "souple/contacts/contact.h"
#include "souple/contacts/contact_material.h"
#include "souple/contacts/contact_projector.h"
#include "souple/objects/materials.h"

#include <cstdint>
#include <span>
#include <vector>

// Geometry of an object for contacts.

namespace souple {

struct Object;
struct RigidDefinition;

/// A soft body rebounds by its own elasticity, at up to this part of its speed (measured: 0.2 to 0.65). A larger
/// coefficient of restitution concerns the body as a whole, see stages/body_restitution.h.
inline constexpr float elastic_restitution = 0.7f;

/// Whether an object collides as a cloud of balls: it has no triangles and is no line. True for grains,
/// fluids and bodies whose surface is embedded in a lattice.
bool is_particle_only(const Object& object);
/// The edges of a line, from particle to particle; other objects have none. Others have none.
std::vector<Edge> edges_of_line(const Object& object);

ContactObject contact_object(const Object& object);
/// `index`: of the object in the world; `edges`: edges_of_line, must outlive the surface; `radius`: radius_at_rest [m].
ContactSurface contact_surface(const Object& object, std::uint32_t index, std::span<const Edge> edges,
                               float radius, const ContactMaterialTable& matrix);
/// The round shape of a rigid body of one part, if it is round. `triangles`: of its particles.
RoundShape round_shape_of(const RigidDefinition& body, std::span<const Triangle> triangles);
/// Appends the triangles and edges that may touch colliders.
void append_elements(const Object& object, std::uint32_t index, std::span<const Edge> edges,
                     std::vector<ContactElement>& elements);

ContactMaterial contact_material_of(const Material& material);
/// Whether contacts are the same with both materials of a kind.
bool same_contacts(const Material& a, const Material& b);

/// Sets the contact radius and the element radius of each particle of the object (see Particles) [m]. The contact
/// radius is half the thickness, the radius of a grain or rope, or a quarter of a fluid's spacing. It is multiplied by
/// the thickness map and reduced by the embedding offset. The spans are of all particles of the world.
void find_contact_radii(const Object& object, std::span<float> radius, std::span<float> element_radius);
/// R of ContactStep::depenetration_speed [m]. `radii`: contact radii of all particles of the world.
float radius_at_rest(const Object& object, std::span<const float> radii);

}  // namespace souple
