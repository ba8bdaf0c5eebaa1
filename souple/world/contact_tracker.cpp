#include "souple/world/contact_tracker.h"

#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/queries/overlap.h"
#include "souple/queries/query_view.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/stage_view.h"
#include "souple/world/contact_state.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>

namespace souple {

void ContactTracker::end_substep(WorldState& world) {
  if (!tracks_) return;
  const ParticleView view = world.view();
  pushes_.clear();
  world.contact->contacts.events(view, pushes_);
  world.rigid->append_pushes(world.stage_view(), false, pushes_);
  add_pushes(world);
  merge();
}

void ContactTracker::add_pushes(const WorldState& world) {
  for (const ContactPush& push : pushes_) {
    if (!std::isfinite(push.impulse)) continue;  // pinned since
    const std::uint32_t object = world.objects[world.object_of[push.particle]]->id.value;
    Touch touch{.key = {object, push.against_collider, 0},
                .impulse = push.impulse,
                .largest = push.impulse,
                .point = push.point,
                .normal = push.normal};
    if (push.against_collider) {
      touch.key.other = world.colliders[push.other].id.value;
    } else {
      touch.key.other = world.objects[world.object_of[push.other]]->id.value;
      if (touch.key.other == object) continue;
      if (touch.key.other < object) std::swap(touch.key.object, touch.key.other), touch.normal = -push.normal;
    }
    add(touch);
  }
}

// Most contacts follow another of the same pair.
void ContactTracker::add(const Touch& touch) {
  if (!touching_.empty() && touching_.back().key == touch.key) return touching_.back().absorb(touch);
  touching_.push_back(touch);
  touching_.back().order = static_cast<std::uint32_t>(touching_.size());
}

void ContactTracker::merge() {
  std::sort(touching_.begin(), touching_.end(), [](const Touch& a, const Touch& b) {
    return a.key != b.key ? a.key < b.key : a.order < b.order;
  });
  std::size_t kept = 0;
  for (const Touch& touch : touching_) {
    Touch* const into = kept > 0 ? &touching_[kept - 1] : nullptr;
    if (into == nullptr || into->key != touch.key)
      touching_[kept++] = touch;
    else
      into->absorb(touch);
  }
  touching_.resize(kept);
  for (std::size_t k = 0; k < kept; ++k) touching_[k].order = static_cast<std::uint32_t>(k + 1);
}

void ContactTracker::add_sensors(const WorldState& world) {
  const QueryView view = world.query_view();
  view.caches.query_index.refresh(view);
  for (std::size_t c = 0; c < world.colliders.size(); ++c) {
    const ColliderRecord& record = world.colliders[c];
    if (!record.options.sensor) continue;
    const Transform pose = record.options.motion.at(world.time);
    for (std::size_t a = 0; a < world.objects.size(); ++a) {
      if (!world.contact->tables.against_colliders.collide(a, c)) continue;
      if (!overlaps(view, a, record.shape, pose)) continue;
      add({.key = {world.objects[a]->id.value, true, record.id.value}, .is_sensor = true});
    }
  }
}

// Contacts of sleepers are not computed.
void ContactTracker::keep_sleepers(const WorldState& world) {
  const auto pushing = static_cast<std::ptrdiff_t>(touching_.size());
  const auto rests = [&](std::uint32_t id) {
    const Object* const object = world.find_object({id});
    return object != nullptr && (object->sleep.island != 0 || object->is_driven());
  };
  for (const Touch& touch : last_) {
    if (touch.is_sensor || !rests(touch.key.object)) continue;
    const bool other_rests =
        touch.key.is_collider
            ? std::any_of(world.colliders.begin(), world.colliders.end(),
                          [&](const ColliderRecord& c) { return c.id.value == touch.key.other; })
            : rests(touch.key.other);
    const auto pushed = [&] {
      return std::binary_search(touching_.begin(), touching_.begin() + pushing, touch,
                                [](const Touch& a, const Touch& b) { return a.key < b.key; });
    };
    if (!other_rests || pushed()) continue;
    touching_.push_back(touch);
    touching_.back().impulse = touching_.back().largest = 0;
  }
}

void ContactTracker::end_step(WorldState& world, bool valid) {
  pairs_.clear();
  if (!valid) return touching_.clear();
  // Without any pair before and now, nothing is to be done.
  const bool senses = std::any_of(world.colliders.begin(), world.colliders.end(),
                                  [](const ColliderRecord& c) { return c.options.sensor; });
  if (!tracks_ && !senses && last_.empty()) return;
  if (senses) world.warnings.guarded("a sensor's motion", [&] { add_sensors(world); });
  merge();
  keep_sleepers(world);
  merge();
  compare_with_last();
}

// Both lists are sorted.
void ContactTracker::compare_with_last() {
  const auto append = [&](const Touch& touch, ContactPhase phase) {
    const bool ended = phase == ContactPhase::end;
    ContactPair pair{.object = {touch.key.object},
                     .is_collider = touch.key.is_collider,
                     .is_sensor = touch.is_sensor,
                     .phase = phase,
                     .impulse = ended ? 0 : touch.impulse,
                     .point = touch.point,
                     .normal = touch.normal};
    if (pair.is_collider) {
      pair.collider = {touch.key.other};
    } else {
      pair.other = {touch.key.other};
    }
    pairs_.push_back(pair);
  };
  auto before = last_.begin();
  for (const Touch& touch : touching_) {
    for (; before != last_.end() && before->key < touch.key; ++before) append(*before, ContactPhase::end);
    const bool persists = before != last_.end() && before->key == touch.key;
    if (persists) ++before;
    append(touch, persists ? ContactPhase::persist : ContactPhase::begin);
  }
  for (; before != last_.end(); ++before) append(*before, ContactPhase::end);
  std::swap(last_, touching_);
  touching_.clear();
}

}  // namespace souple
