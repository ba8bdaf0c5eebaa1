#pragma once

#include "souple/contacts/contact_material.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/materials.h"
#include "souple/objects/set_kinds.h"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace souple {

class ConstraintBuilder;
struct ConstraintGroups;
struct Object;
struct SubResolutionBody;

/// Functions of one kind of objects, filled in by a file of objects/kinds/. Materials are of the kind. Null: objects of
/// the kind have no such data.
struct KindFunctions {
  KindTraits traits;

  // --- material
  Material (*default_material)() = nullptr;
  std::optional<Material> (*find_preset)(std::string_view name) = nullptr;
  /// Throws Error if a value is out of its range. `owner` begins the message.
  void (*validate)(const Material&, std::string_view owner) = nullptr;
  /// Throws Error if an object cannot change from the first material to the second.
  void (*validate_change)(const Material& from, const Material& to, std::string_view owner) = nullptr;
  /// kg/m^2 of sheets, kg/m^3 of others; null: no mass to scale.
  float (*density)(const Material&) = nullptr;

  // --- constraints, null without
  void (*add_elements)(const Material&, const Object&, ConstraintBuilder&) = nullptr;
  void (*add_groups)(const Material&, const Object&, ConstraintGroups&) = nullptr;
  /// Kinds of constraints to build again for another material.
  SetKinds (*changed_kinds)(const Material& from, const Material& to) = nullptr;
  bool (*has_groups_of_material)(const Material&) = nullptr;

  // --- contacts
  /// Distance of contact from a particle [m].
  float (*contact_radius)(const Material&) = nullptr;
  /// Radius of a particle as queries and pictures see it [m]; null: the contact radius.
  float (*particle_radius)(const Material&) = nullptr;
  ContactMaterial (*contact_material)(const Material&) = nullptr;
  /// Appends the bodies, too fine for a fluid of this spacing [m] to resolve, of an object without a surface.
  /// `mass`: per particle of the world [kg]; `number`: their `object`.
  void (*append_sub_resolution_bodies)(const Material&, const Object&, float spacing,
                                       std::span<const float> mass, std::uint32_t number,
                                       std::vector<SubResolutionBody>&) = nullptr;
};

const KindFunctions& functions_of(ObjectKind kind);

inline const KindFunctions& functions_of(const Material& material) {
  return functions_of(kind_of(material));
}

/// Throws Error if a value is out of its range. `owner` begins the message.
void validate(const Material& material, std::string_view owner);
/// kg/m^2 of a cloth, kg/m^3 of the other kinds; 1 for obstacles.
float density(const Material& material);
/// Half the thickness; the radius of grains and ropes; a quarter of the spacing of fluids [m].
float contact_radius(const Material& material);

}  // namespace souple
