#pragma once

#include "souple/objects/handles.h"

#include <cstdint>
#include <string_view>

namespace souple {

/// What the particles of an object form.
enum class ObjectShape : std::uint8_t {
  surface,  ///< triangles
  solid,    ///< tets
  line,     ///< a chain: each particle is joined to the next
  balls     ///< loose particles
};

/// What all objects of a kind have in common.
struct KindTraits {
  std::string_view name;  ///< in files and messages; the default name of an object
  ObjectShape shape = ObjectShape::surface;
  bool driven = false;  ///< without mass: only its prescribed motion moves it
  bool rolls = false;   ///< each particle is a body of its own with an angular velocity
  bool flows = false;   ///< particles come and go; the solver of fluids keeps them apart and off colliders
};

const KindTraits& traits_of(ObjectKind kind);

}  // namespace souple
