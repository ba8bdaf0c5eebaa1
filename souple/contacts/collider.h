#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/contacts/contact_material.h"

#include <string>

namespace souple {

/// A rigid obstacle. Particles cannot enter it and do not move it.
struct Collider {
  std::string name;
  Shape shape;
  ColliderMotion motion;  ///< pose of the shape's frame over time
  ContactMaterial material;
  bool enabled = true;
};

}  // namespace souple
