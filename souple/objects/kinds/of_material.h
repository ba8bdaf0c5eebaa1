#pragma once

#include "souple/objects/checks.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/material_fields.h"

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

/// Checks the range of each field. Throws Error.
template <class M>
struct FieldChecks {
  const M& m;
  std::string_view owner;

  template <auto member>
  void operator()(Field<member>, const char* name, const FieldRange& range, const char*,
                  const Slider&) const {
    if constexpr (std::is_same_v<decltype(member), float M::*>) {
      double highest = range.exact ? range.highest : range::finite;
      if constexpr (std::is_same_v<M, ClothMaterial>)
        if (range.rigid && may_be_rigid(m, member)) highest = range::infinite;
      const double lowest = range.open_low && !range.zero ? range::positive : range.lowest;
      check_all(owner, {{name, double(m.*member), lowest, highest, range.open_high}});
    } else {
      check_all(owner, {{name, double((m.*member).value_or(m.friction)), 0, double(m.friction)}});
    }
  }
  template <auto member, class E>
  void operator()(Field<member>, const char* name, FieldWords<E> words, const char*) const {
    check_all(owner, {{name, double(m.*member), 0, double(words.size() - 1)}});
  }
};
template <class M>
void check_fields(const M& m, std::string_view owner) {
  visit_fields<M>(FieldChecks<M>{m, owner});
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
