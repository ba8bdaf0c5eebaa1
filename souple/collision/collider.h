#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/contact_material.h"
#include "souple/collision/shapes.h"

#include <string>

namespace souple {

/// A rigid obstacle that particles cannot enter and that they do not move.
struct Collider {
  std::string name;
  Shape shape;
  ColliderMotion motion;  ///< the pose of the shape's frame
  ContactMaterial material;
  bool enabled = true;
};

}  // namespace souple
