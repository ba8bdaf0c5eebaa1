#pragma once

#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/math/mat3.h"
#include "souple/math/transform.h"
#include "souple/objects/self_collision.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace souple {

/// Mass properties of a rigid body that replace those of its solid.
struct GivenMass {
  std::optional<double> mass{};   ///< kg; none: from the density
  std::optional<Vec3d> center{};  ///< of mass, in the frame of the mesh or shape, before its transform [m]
  /// Inertia tensor about the center of mass, in the axes of that frame [kg m^2]; none: that of the solid, for its mass.
  /// The scale of the transform does not change it.
  std::optional<Mat3d> inertia{};
};

/// A shape of a rigid body of several.
struct RigidPart {
  Shape shape;
  Transform pose{};                 ///< in the body's frame, with scale 1
  std::optional<double> density{};  ///< kg/m^3; none: the material's
};

/// Options common to all kinds of objects.
struct ObjectOptions {
  std::string name{};        ///< unique; empty: the kind's name, then kind2, kind3, ...
  Transform transform{};     ///< applied to the mesh
  Vec3f velocity{};          ///< m/s
  Vec3f angular_velocity{};  ///< rad/s about the center of mass; each grain also rotates with it
  /// Per vertex: factor of the stiffness; a constraint uses the mean of its vertices. Empty: 1.
  std::vector<float> stiffness_map{};
  std::vector<float> thickness_map{};  ///< per vertex: factor of the thickness; empty: 1
  /// How the surface collides with itself. `surfaces`: cloth lies on its own folds, a rope does not pass through itself.
  SelfCollision self_collision = SelfCollision::off;
  /// Layer of the surface, 0 to 1000. Where two objects collide, the object of the higher layer belongs on the outer
  /// side of the lower one. The outer side is the one from which the lower one's triangles are counter-clockwise. Parts
  /// on the wrong side are moved out. 0: no order. Only objects with a surface of their own have layers: cloth, soft
  /// bodies made of tets, obstacles.
  int layer = 0;
  /// Fluids only: upper limit of the particle count for emitters. Memory for them is reserved at once, and
  /// the fluid may start with no particle. 0: emitters add none.
  std::uint32_t max_particles = 0;
  GivenMass given_mass{};  ///< rigid bodies only
  /// Bit masks: the groups (of 32) to which the object belongs, and the groups with which it collides.
  /// Objects or colliders a and b collide if a.collision_groups & b.collision_mask and b.collision_groups &
  /// a.collision_mask are both non-zero.
  std::uint32_t collision_groups = 1;
  std::uint32_t collision_mask = ~0u;
};

struct ColliderOptions {
  float friction = 0.5f;
  float restitution = 0;
  std::optional<float> kinetic_friction{};  ///< at most `friction`; none: `friction`
  std::string name{};                       ///< unique; empty: collider, collider2, ...
  ColliderMotion motion{};                  ///< static by default; its poses are applied to the shape
  std::uint32_t collision_groups = 1;       ///< as in ObjectOptions
  std::uint32_t collision_mask = ~0u;
  /// Pushes nothing and stops no fluid; World::contact_pairs says which objects overlap it after each step.
  bool sensor = false;
};

}  // namespace souple
