#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

// What a renderer may show of a world's inside, handed out without knowing any renderer.

namespace souple {

/// One constraint, at the positions of now.
struct DebugConstraint {
  std::string_view kind;          ///< "distance", "neo_hookean", ...
  std::span<const Vec3f> points;  ///< where its particles are [m]; valid during the call
  /// Of the solver: constraints of one kind and color share no particle. Contacts of one color may share
  /// a particle that cannot move; contacts between colliders and triangles or edges have one color and are
  /// solved one after the other.
  int color = 0;
  float strain = 0;    ///< (l - l0) / l0 of kinds that have one, else 0
  float residual = 0;  ///< largest |C| of its rows, in the unit of C; 0 where an inequality holds
};

/// A contact that pushed in the last substep.
struct DebugContact {
  Vec3f point{}, normal{};  ///< m; normal points to the particle that is pushed
  float impulse = 0;        ///< N s
};

struct DebugParticle {
  Vec3f position{};        ///< m
  float radius = 0;        ///< m
  float inverse_mass = 0;  ///< 1/kg
  bool pinned = false;
  std::uint32_t object = 0;  ///< ObjectId::value
};

/// What is asked for: those callbacks that are set are called, once for each thing, in a fixed order.
struct DebugDraw {
  std::function<void(const DebugConstraint&)> constraint;
  std::function<void(const DebugContact&)> contact;
  std::function<void(const DebugParticle&)> particle;
  std::function<void(const Vec3f& a, const Vec3f& b)> tet_edge;  ///< of soft bodies, each edge once
};

}  // namespace souple
