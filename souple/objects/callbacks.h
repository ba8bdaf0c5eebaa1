#pragma once

#include "souple/math/vec3.h"
#include "souple/objects/handles.h"

#include <cstdint>
#include <functional>

namespace souple {

/// Target position of a pinned or attached vertex: (vertex in user order, time in s) -> meters.
using Target = std::function<Vec3d(std::uint32_t vertex, double time)>;

/// Force field: (position [m], velocity [m/s], mass [kg], time [s]) -> force [N].
using ForceField = std::function<Vec3f(const Vec3f&, const Vec3f&, float, double)>;

/// A particle on which a force field acts.
struct ForcePoint {
  ObjectId object;
  std::uint32_t vertex = 0;  ///< user order; of a soft body made of a surface: a vertex near the particle
  Vec3f position{};          ///< m
  Vec3f velocity{};          ///< m/s
  float mass = 0;            ///< kg
  double time = 0;           ///< s
};
/// Force field that knows object and vertex: point -> force [N].
using VertexForceField = std::function<Vec3f(const ForcePoint&)>;

}  // namespace souple
