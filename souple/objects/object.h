#pragma once

#include "souple/contacts/contact_material.h"
#include "souple/geometry/embedding.h"
#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/transform.h"
#include "souple/objects/callbacks.h"
#include "souple/objects/handles.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/materials.h"
#include "souple/objects/obstacle_motion.h"
#include "souple/objects/self_collision.h"
#include "souple/objects/set_kinds.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

// An object in a world.

namespace souple {

/// A pinned particle. Its position is target(vertex, t) + offset, or constant without a target.
struct PinnedParticle {
  std::uint32_t particle = 0;  ///< index within the object
  std::uint32_t vertex = 0;    ///< user order
  Vec3d offset{};              ///< from the vertex to the particle at the time of pinning [m]
  std::shared_ptr<const Target> target;
  // See World::move_pins.
  Vec3d pinned_at{};             ///< position of the particle when it was pinned [m]
  Vec3d from{};                  ///< start of the step [m]
  std::optional<Vec3d> arrival;  ///< end of the next step [m]
};

/// Values of an object's particles; each list may be empty.
struct ParticleValues {
  std::vector<float> stiffness, thickness;  ///< factors; empty: 1
  std::vector<float> outside;               ///< distance outside the embedded surface [m]
  std::vector<std::uint32_t> pin_guess;     ///< its last known index in the pins
};

/// Collision settings of an object.
struct ObjectCollision {
  SelfCollision itself = SelfCollision::off;
  int layer = 0;            ///< of cloth; 0: none
  CollisionFilter filter;   ///< with which other objects
  std::uint64_t since = 0;  ///< number of steps before the object was added
};

/// The gas that an object encloses.
struct ObjectGas {
  float pressure = 0;                             ///< Pa
  std::optional<std::pair<float, float>> volume;  ///< factor and compliance
};

struct ObjectSleep {
  double rest_time = 0;      ///< time at rest so far [s]
  std::uint32_t island = 0;  ///< id of the sleeping island: that of one of its objects; 0: awake
  /// It did not move in the last step, and does not in this one: it is asleep, or an obstacle without a motion.
  bool still = false;
};

/// Motion of an obstacle or of a kinematic rigid body.
struct PlacedMotion : ObstacleMotion {
  Transform placement{};   ///< of the mesh sequence
  bool kinematic = false;  ///< a rigid body that nothing pushes
};

struct ConstraintSets;

/// An object's constraints since the last build_constraints.
struct BuiltConstraints {
  std::unique_ptr<ConstraintSets> fresh;  ///< built since, of `kinds`
  SetKinds kinds;
  std::uint32_t begin = 0, end = 0;  ///< its particles at that time; equal: none
};

/// The last measurement of how far the forces of an object are out of balance, see stages/balance.h.
struct Imbalance {
  double unbalanced = 0, stretch = 0;     ///< ratios, 0 in equilibrium
  std::uint64_t times_not_converged = 0;  ///< successive measurements
};

/// The definition of an object. Its constraints are a pure function of this struct (see build.h).
struct Object {
  ObjectId id;
  std::string name;
  ObjectKind kind = ObjectKind::cloth;
  Material material;
  std::uint32_t begin = 0, end = 0;  ///< range of its particles
  /// Fluids: largest number of particles; other kinds: their number of particles.
  std::uint32_t capacity = 0;
  TriangleMesh mesh;        ///< as added, transformed; its positions are the rest state; may be empty
  TetMesh tets;             ///< soft bodies: vertices are the particles, in order
  std::vector<Vec3d> rest;  ///< rest position of each particle [m]
  std::vector<std::uint32_t> particle_of;  ///< user vertex -> particle within the object; empty if embedded
  std::vector<std::uint32_t> vertex_of;    ///< particle -> a user vertex at it, or near it if embedded
  std::optional<Embedding> embedding;      ///< user vertices in `tets`, if they are not particles
  /// Triangles over particles, for wind and pressure; may be empty.
  std::vector<std::array<std::uint32_t, 3>> surface;
  /// Cloth and obstacles: index in the mesh of each triangle of `surface`; empty: identity.
  std::vector<std::uint32_t> triangle_source;
  ParticleValues per_particle;
  std::vector<PinnedParticle> pins;  ///< ascending by particle
  ObjectCollision collision;
  ObjectGas gas;
  ObjectSleep sleep;
  Imbalance imbalance;      ///< of cloths, soft bodies and ropes
  PlacedMotion motion;      ///< of obstacles and kinematic rigid bodies
  float wind_exposure = 1;  ///< share of the wind's velocity
  std::uint64_t user_data = 0;

  BuiltConstraints built;

  Object();
  ~Object();

  const KindTraits& traits() const { return traits_of(kind); }
  /// Whether only its prescribed motion moves it.
  bool is_driven() const { return traits().driven || motion.kinematic; }
  std::uint32_t reserved_end() const { return begin + capacity; }
  std::uint32_t particle_count() const { return static_cast<std::uint32_t>(rest.size()); }
  std::size_t vertex_count() const { return embedding ? mesh.positions.size() : particle_of.size(); }
  /// Mean of a per-particle map over a constraint's particles; 1 without a map.
  template <class Indices>
  float mean(const std::vector<float>& map, const Indices& particles_of_constraint) const {
    if (map.empty()) return 1;
    float sum = 0;
    for (const std::uint32_t i : particles_of_constraint) sum += map[i];
    return sum / static_cast<float>(std::size(particles_of_constraint));
  }
};

}  // namespace souple
