#include "souple/world/build.h"

#include "souple/objects/build_elements.h"
#include "souple/objects/constraint_groups.h"
#include "souple/objects/constraint_sets.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/world/add.h"
#include "souple/world/sleeping.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace souple {

void replace_material(WorldState& world, Object& object, const Material& material) {
  const Material before = std::exchange(object.material, material);
  const ConstraintChanges changes = changes_between(before, material);
  try {
    if (changes.kinds.any() || changes.groups) build_elements(object, changes.kinds);
  } catch (...) {
    object.material = before;
    throw;
  }
  wake_island(world, object);
  const float density_ratio = density(material) / density(before);
  if (density_ratio != 1) scale_mass(world, object, density_ratio);
  world.dirty.constraints = world.dirty.constraints || changes.kinds.any();
  world.dirty.groups = world.dirty.groups || changes.groups;
  world.dirty.radii = world.dirty.radii || contact_radius(material) != contact_radius(before);
  // Fluids read the materials and masses of all objects when tables are built.
  const bool with_fluids = std::any_of(world.objects.begin(), world.objects.end(),
                                       [](const auto& o) { return o->traits().flows; });
  world.dirty.tables = world.dirty.tables || with_fluids || !same_contacts(before, material);
}

namespace {

/// The objects' places in the sets: where they were when their constraints were last merged, and are now.
std::vector<ObjectPart> parts_of(const WorldState& world) {
  std::vector<ObjectPart> parts;
  for (const auto& object : world.objects)
    parts.push_back({object->built.begin, object->built.end, object->begin});
  return parts;
}

/// Merges what is new of one kind. Returns whether constraints came, went or were renumbered.
template <class Kind>
bool merge(WorldState& world, SetKind kind, std::span<const ObjectPart> parts, SetProjector<Kind>& of_all) {
  std::vector<SetProjector<Kind>*> fresh(world.objects.size());
  bool any_fresh = false;
  for (std::size_t o = 0; o < fresh.size(); ++o) {
    Object& object = *world.objects[o];
    if (!object.built.kinds.has(kind)) continue;
    fresh[o] = &std::get<SetProjector<Kind>>(object.built.fresh->sets);
    any_fresh = any_fresh || fresh[o]->size() > 0;
  }
  const bool any = any_fresh || of_all.size() > 0;
  if (!any || !(world.dirty.objects || std::any_of(fresh.begin(), fresh.end(), [](auto* f) { return f; })))
    return false;
  return !of_all.merge(parts, fresh);
}

void build_groups(WorldState& world) {
  ConstraintGroups& groups = *world.constraints.of_groups;
  groups = {};
  for (const auto& object : world.objects) add_groups(*object, groups);
  world.dirty.groups = false;
}

}  // namespace

bool build_constraints(WorldState& world) {
  ConstraintSets& all = *world.constraints.of_elements;
  ConstraintGroups& groups = *world.constraints.of_groups;
  const std::vector<ObjectPart> parts = parts_of(world);
  bool changed = world.dirty.objects;
  std::size_t kind = 0;
  const auto merge_one = [&](auto& set) {
    changed |= merge(world, static_cast<SetKind>(kind++), parts, set);
  };
  std::apply([&](auto&... sets) { (merge_one(sets), ...); }, all.sets);
  for (const auto& object : world.objects) {
    object->built.fresh.reset();
    object->built.kinds = {};
    object->built.begin = object->begin, object->built.end = object->reserved_end();
  }
  if (world.dirty.groups || world.dirty.objects) build_groups(world);
  world.constraints.object_projectors.clear();
  const auto list = [&](Projector& projector) {
    if (projector.size() > 0) world.constraints.object_projectors.push_back(&projector);
  };
  std::apply([&](auto&... sets) { (list(sets), ...); }, all.sets);
  list(groups.shape_matching), list(groups.enclosed_volume);
  return changed;
}

void build_contact_radii(WorldState& world) {
  for (const auto& object : world.objects)
    find_contact_radii(*object, world.particles.radius, world.particles.element_radius);
}

}  // namespace souple
