#include "souple/objects/object.h"

#include "souple/objects/constraint_sets.h"

namespace souple {

Object::Object() = default;
Object::~Object() = default;

}  // namespace souple
