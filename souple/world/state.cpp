#include "souple/world/state.h"

#include "souple/objects/constraint_sets.h"
#include "souple/objects/object.h"
#include "souple/solver/solver.h"
#include "souple/world/balance.h"
#include "souple/world/caches.h"
#include "souple/world/collider_record.h"
#include "souple/world/contact_state.h"
#include "souple/world/flow.h"
#include "souple/world/fluids.h"
#include "souple/world/sleeping.h"
#include "souple/world/step_scratch.h"
#include "souple/world/user_constraint.h"

#include <algorithm>

#include <fmt/core.h>

namespace souple {

WorldState::WorldState()
    : contact(std::make_unique<ContactState>()),
      balance(std::make_unique<Balance>()),
      fluids(std::make_unique<Fluids>()),
      sleep(std::make_unique<SleepScratch>()),
      scratch(std::make_unique<StepScratch>()),
      caches(std::make_unique<Caches>()) {}
WorldState::~WorldState() = default;

void UserConstraint::update_targets(double t) {
  if (!attachment || !target) return;
  for (std::size_t k = 0; k < attached_vertices.size(); ++k)
    attachment->set().set_params(
        k, {Vec3f(target(attached_vertices[k].vertex, t) + attached_vertices[k].offset)});
}

void UserConstraint::erase_particles(std::uint32_t begin, std::uint32_t end) {
  if (attachment) {
    std::vector<AttachedVertex> kept;
    for (std::size_t k = 0; k < attached_vertices.size();
         ++k) {  // in this order: one color, one particle each
      const std::uint32_t particle = attachment->set().indices(k)[0];
      if (particle < begin || particle >= end) kept.push_back(attached_vertices[k]);
    }
    attached_vertices = std::move(kept);
  }
  projector->erase_particles(begin, end);
}

Object* WorldState::find_object(ObjectId id) const {
  const std::optional<std::size_t> at = object_index.find(id.value);
  return at ? objects[*at].get() : nullptr;
}

Object& WorldState::object(ObjectId id) {
  if (Object* const found = find_object(id)) return *found;
  throw Error(
      fmt::format("no object has the handle {}: it was removed, or belongs to another world", id.value));
}

ColliderRecord& WorldState::collider(ColliderId id) {
  if (const std::optional<std::size_t> at = collider_index.find(id.value)) return colliders[*at];
  throw Error(
      fmt::format("no collider has the handle {}: it was removed, or belongs to another world", id.value));
}

void WorldState::teleport_particle(std::size_t i, const Vec3d& x) {
  contact->check_intersections = true;
  set_position(i, x);
}

void WorldState::set_position(std::size_t i, const Vec3d& x) {
  const Vec3f rounded(x);
  particles.position[i].set_xyz(rounded);
  particles.offset[i] = {};
  if (settings.form == Form::displacement) particles.offset[i].set_xyz(Vec3f(x - Vec3d(rounded)));
}

void Callbacks::erase_removed() {
  for (auto* lists : {&before, &after})
    for (auto& callbacks : *lists) callbacks.erase_removed();
  force_fields.erase_removed();
}

std::string WorldState::unique_name(const std::string& wanted, std::string_view base) const {
  if (wanted.empty()) return names.first_free(base);
  names.require_free(wanted);
  return wanted;
}

void WorldState::require_between_steps(std::string_view what) const {
  if (current.running) throw Error(std::string(what) + ": not while a step runs; call it between steps");
}

const Object& WorldState::object(ObjectId id) const {
  return const_cast<WorldState*>(this)->object(id);
}

ParticleView WorldState::view() {
  return objects_view().view();
}

}  // namespace souple
