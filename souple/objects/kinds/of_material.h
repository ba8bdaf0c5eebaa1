#pragma once

#include "souple/objects/kind_functions.h"

#include <optional>
#include <string_view>
#include <variant>

// Functions of one kind's material as those of any material, and functions that materials of several kinds share.

namespace souple::kinds {

template <auto function>
struct OfMaterial;
template <class R, class M, class... Arguments, R (*function)(const M&, Arguments...)>
struct OfMaterial<function> {
  static R call(const Material& material, Arguments... arguments) {
    return function(std::get<M>(material), arguments...);
  }
};
template <auto function>
struct OfTwoMaterials;
template <class R, class M, class... Arguments, R (*function)(const M&, const M&, Arguments...)>
struct OfTwoMaterials<function> {
  static R call(const Material& from, const Material& to, Arguments... arguments) {
    return function(std::get<M>(from), std::get<M>(to), arguments...);
  }
};
/// A function whose first argument is one kind's material, or the first two are, as a function of any material.
template <auto function>
inline constexpr auto of_material = &OfMaterial<function>::call;
template <auto function>
inline constexpr auto of_two_materials = &OfTwoMaterials<function>::call;

template <class M>
Material default_material() {
  return M{};
}

/// A search for presets of one kind as one for those of any kind.
template <auto find>
std::optional<Material> preset(std::string_view name) {
  const auto* const found = find(name);
  return found == nullptr ? std::nullopt : std::optional<Material>(*found);
}

/// Friction and restitution, as most materials have them.
template <class M>
ContactMaterial contact_material(const M& m) {
  return {.friction = m.friction, .kinetic_friction = m.kinetic_friction, .restitution = m.restitution};
}

/// The coefficient while sliding, for a check of its range.
template <class M>
double kinetic_friction(const M& m) {
  return double(m.kinetic_friction.value_or(m.friction));
}

template <class M>
float half_thickness(const M& m) {
  return m.thickness / 2;
}

template <class M>
float radius(const M& m) {
  return m.radius;
}

template <class M>
float volumetric_density(const M& m) {
  return m.density;
}

}  // namespace souple::kinds
