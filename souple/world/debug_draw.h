#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

// Internal data of a world for renderers, independent of any renderer.

namespace souple {

/// One constraint, at the current positions.
struct DebugConstraint {
  std::string_view kind;          ///< "distance", "neo_hookean", ...
  std::span<const Vec3f> points;  ///< positions of its particles [m]; valid during the call
  /// Color of the solver: constraints of one kind and color share no particle. Contacts of one color may
  /// share an immovable particle. Contacts between colliders and triangles or edges have a single color and
  /// are solved sequentially.
  int color = 0;
  float strain = 0;    ///< (l - l0) / l0 for kinds that define a strain, else 0
  float residual = 0;  ///< max |C| of its rows, in the unit of C; 0 for a satisfied inequality
};

/// A contact that applied a correction in the last substep.
struct DebugContact {
  Vec3f point{}, normal{};  ///< m; the normal points toward the particle that is pushed
  float impulse = 0;        ///< N s
};

struct DebugParticle {
  Vec3f position{};        ///< m
  float radius = 0;        ///< m
  float inverse_mass = 0;  ///< 1/kg
  bool pinned = false;
  std::uint32_t object = 0;  ///< ObjectId::value
};

/// A joint of rigid bodies, or a tie (kind "tie", without an axis).
struct DebugJoint {
  std::string_view name, kind;    ///< kind: "hinge", "pulley", ...; valid during the call
  Vec3f point_a{}, point_b{};     ///< m
  Vec3f axis{};                   ///< the first axis
  std::span<const Vec3f> rope{};  ///< of a distance joint or pulley: its line; valid during the call [m]
  bool taut = false;              ///< a rope that pulls
  bool broken = false;
};

/// Callbacks for World::debug_draw. Each callback that is set is called once per item, in a fixed order.
struct DebugDraw {
  std::function<void(const DebugConstraint&)> constraint;
  std::function<void(const DebugContact&)> contact;
  std::function<void(const DebugParticle&)> particle;
  std::function<void(const DebugJoint&)> joint;
  std::function<void(const Vec3f& a, const Vec3f& b)> tet_edge;  ///< each edge of soft bodies once
};

}  // namespace souple
