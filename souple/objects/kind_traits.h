#pragma once

#include "souple/objects/materials.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace souple {

/// Arrangement of an object's particles.
enum class ObjectShape : std::uint8_t {
  surface,  ///< triangles
  solid,    ///< tets
  line,     ///< a chain: each particle is joined to the next
  balls     ///< loose particles
};

/// Properties that all objects of a kind have in common.
struct KindTraits {
  std::string_view name;  ///< in files and messages; the default name of an object
  ObjectShape shape = ObjectShape::surface;
  bool driven = false;  ///< without mass: only its prescribed motion moves it
  bool rolls = false;   ///< each particle is a body of its own with an angular velocity
  bool rigid = false;   ///< its particles are points of one rigid body, which moves them
  bool flows = false;   ///< particles come and go; the solver of fluids keeps them apart and off colliders
};

const KindTraits& traits_of(ObjectKind kind);
std::optional<ObjectKind> find_kind(std::string_view name);
/// The kind of objects that a material belongs to.
ObjectKind kind_of(const Material& material);

/// Radius of grains and ropes, half the thickness of others, half the spacing of fluids [m].
float particle_radius(const Material& material);

}  // namespace souple
