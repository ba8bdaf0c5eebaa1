#include "souple/objects/kinds/kinds.h"

#include <cstddef>

namespace souple {

const KindFunctions& functions_of(ObjectKind kind) {
  return *kinds::all[static_cast<std::size_t>(kind)];
}

const KindTraits& traits_of(ObjectKind kind) {
  return functions_of(kind).traits;
}

std::string_view kind_name(ObjectKind kind) {
  return traits_of(kind).name;
}

std::optional<ObjectKind> find_kind(std::string_view name) {
  for (std::size_t k = 0; k < kinds::all.size(); ++k)
    if (kinds::all[k]->traits.name == name) return static_cast<ObjectKind>(k);
  return std::nullopt;
}

ObjectKind kind_of(const Material& material) {
  return static_cast<ObjectKind>(material.index());
}

void validate(const Material& material, std::string_view owner) {
  functions_of(material).validate(material, owner);
}

float density(const Material& material) {
  const auto density_of = functions_of(material).density;
  return density_of == nullptr ? 1 : density_of(material);
}

float contact_radius(const Material& material) {
  return functions_of(material).contact_radius(material);
}

float particle_radius(const Material& material) {
  const auto radius_of = functions_of(material).particle_radius;
  return radius_of == nullptr ? contact_radius(material) : radius_of(material);
}

}  // namespace souple
