#include "souple/objects/object.h"

#include "souple/objects/constraint_sets.h"

namespace souple {

Object::Object() = default;
Object::~Object() = default;

std::string_view kind_name(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::cloth:
      return "cloth";
    case ObjectKind::soft_body:
      return "soft_body";
    case ObjectKind::rope:
      return "rope";
    case ObjectKind::grains:
      return "grains";
    case ObjectKind::obstacle:
      return "obstacle";
    case ObjectKind::fluid:
      return "fluid";
  }
  return "?";
}

}  // namespace souple
