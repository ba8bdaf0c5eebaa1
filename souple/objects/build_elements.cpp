#include "souple/objects/build_elements.h"

#include "souple/error.h"
#include "souple/objects/constraint_builder.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"

#include <memory>
#include <utility>

namespace souple {

std::size_t build_elements(Object& object, const SetKinds& kinds) {
  const SetKinds wanted = object.built.kinds | kinds;
  auto fresh = std::make_unique<ConstraintSets>();
  ConstraintBuilder builder(wanted, *fresh);
  try {
    if (const auto add = functions_of(object.kind).add_elements) add(object.material, object, builder);
    ConstraintGroups groups;  // whether they can be built
    add_groups(object, groups);
  } catch (const Error& error) {
    throw Error(object.name + ": " + error.what());
  }
  object.built.fresh = std::move(fresh);
  object.built.kinds = wanted;
  return object.built.fresh->skipped;
}

void add_groups(const Object& object, ConstraintGroups& groups) {
  if (const auto add = functions_of(object.kind).add_groups) add(object.material, object, groups);
}

ConstraintChanges changes_between(const Material& from, const Material& to) {
  const KindFunctions& kind = functions_of(to);
  ConstraintChanges changes;
  if (kind.changed_kinds) changes.kinds = kind.changed_kinds(from, to);
  if (kind.has_groups_of_material)
    changes.groups = kind.has_groups_of_material(from) || kind.has_groups_of_material(to);
  return changes;
}

}  // namespace souple
