#pragma once

#include "souple/objects/materials.h"
#include "souple/objects/set_kinds.h"

#include <cstddef>

namespace souple {

struct ConstraintGroups;
struct Object;

/// Builds the constraints of one object, of the kinds that its material changed or all that are new. They wait in the
/// object until a world merges them. Throws Error, beginning with the object's name, if they cannot be built. Returns
/// the number of cloth elements that are too thin for bending or a membrane and are skipped.
std::size_t build_elements(Object& object, const SetKinds& kinds);
/// Adds the constraints on an object as a whole.
void add_groups(const Object& object, ConstraintGroups& groups);

/// Constraints of an object that another material of its kind replaces.
struct ConstraintChanges {
  SetKinds kinds;
  bool groups = false;  ///< those on the object as a whole
};
ConstraintChanges changes_between(const Material& from, const Material& to);

}  // namespace souple
