#pragma once

#include "souple/math/vec3.h"
#include "souple/objects/handles.h"
#include "souple/objects/materials.h"

#include <cstdint>
#include <string_view>
#include <vector>

// Inputs and results of queries, and contacts by pair of bodies.

namespace souple {

/// Bit of a kind for QueryFilter::kinds.
constexpr std::uint32_t kind_bit(ObjectKind kind) {
  return 1u << static_cast<std::uint32_t>(kind);
}

/// The objects and colliders that a query considers. By default: all but sensors.
struct QueryFilter {
  /// Bits of collision groups (ObjectOptions::collision_groups). A query considers objects and colliders that belong to
  /// at least one of them; without a group they pass only ~0.
  std::uint32_t groups = ~0u;
  std::uint32_t kinds = ~0u;       ///< kind_bit(...) | ...: of objects
  std::vector<ObjectId> only{};    ///< only these objects; empty: all
  std::vector<ObjectId> except{};  ///< not these objects
  std::vector<ColliderId> except_colliders{};
  bool objects = true, colliders = true, sensors = false;
};

/// Result of a ray cast, a swept ball or a closest-point query.
struct Hit {
  bool found = false;
  ObjectId object{};  ///< valid if `is_collider` is false
  ColliderId collider{};
  bool is_collider = false;
  std::uint32_t vertex = 0;    ///< vertex of the object that is nearest to `point`, user order
  std::uint32_t triangle = 0;  ///< triangle of the object's surface, if it has one
  Vec3f point{};               ///< on the surface [m]
  double distance = 0;  ///< from the ray's origin or the query point, or that the ball's center moved [m]
  /// Unit: of the triangle, toward the side of the origin; from the ball's center; outward from a collider. 0 for a
  /// triangle without area.
  Vec3f normal{};
};

/// An object or collider that a shape overlaps.
struct Overlap {
  ObjectId object{};  ///< valid if `is_collider` is false
  ColliderId collider{};
  bool is_collider = false;
  /// Vertices of the object in the shape, ascending; of ropes, grains and fluids those whose balls touch it. Empty where a
  /// triangle passes through the shape between its corners.
  std::vector<std::uint32_t> vertices{};
};

/// A contact that applied a correction in the last substep of a step.
struct ContactEvent {
  std::string_view object, other;  ///< names; `other` is an object or a collider
  std::uint32_t vertex = 0, other_vertex = 0;
  bool other_is_collider = true;
  Vec3f point{}, normal{};   ///< m; the normal points toward `object`
  float impulse = 0;         ///< N s
  ObjectId object_id{};      ///< of `object`
  ObjectId other_id{};       ///< of `other`, if it is an object
  ColliderId collider_id{};  ///< of `other`, if it is a collider
};

enum class ContactPhase { begin, persist, end };

/// Contact of two bodies during the last step, see World::track_contacts.
struct ContactPair {
  ObjectId object{};      ///< of two objects the one with the lower handle
  ObjectId other{};       ///< valid if `is_collider` is false
  ColliderId collider{};  ///< valid if `is_collider` is true
  bool is_collider = false;
  bool is_sensor = false;  ///< the collider is a sensor: the object overlaps it
  ContactPhase phase = ContactPhase::begin;
  float impulse =
      0;  ///< sum of the normal impulses over the step [N s]; 0 at the end, asleep and for sensors
  Vec3f point{}, normal{};  ///< of the largest impulse, the last known [m]; the normal points toward `object`
};

}  // namespace souple
