#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

// Boundary of an object for fluids.

namespace souple {

struct Object;

/// How a body responds to pressure during the pressure solve.
enum class BodyCompliance {
  per_vertex,  ///< each vertex by itself; for cloth
  per_body     ///< as a rigid body; pressure deforms it only afterwards
};

/// A body's surface as a fluid's boundary: triangles over vertices, each interpolated from up to four
/// particles of the world.
struct BoundaryMesh {
  std::uint32_t begin = 0, end = 0;  ///< range of the body's particles
  std::vector<std::array<std::uint32_t, 4>> particles{};
  std::vector<std::array<float, 4>> weights{};  ///< per vertex; they sum to 1
  std::vector<Triangle> triangles{};            ///< over vertices, counterclockwise seen from outside
  float half_thickness = 0;                     ///< offset of the surface along its normal [m]
  bool closed = false;                          ///< the body has an inside, where no fluid belongs
  BodyCompliance compliance = BodyCompliance::per_vertex;
};

/// A grain, or a piece of a grain or a rope, whose size is at most about the particle spacing of the fluid.
struct SubResolutionBody {
  std::array<std::uint32_t, 2> particles{};  ///< particles of the world that carry it
  std::array<float, 2> weights{};            ///< they sum to 1
  Vec3f offset{};            ///< from there, without rotation [m]; the solver does not use it yet
  float volume = 0;          ///< m^3
  float mass = 0;            ///< kg
  float radius = 0;          ///< m
  float length = 0;          ///< of a piece of rope; 0: a ball [m]
  std::uint32_t object = 0;  ///< index among the objects that fluids may collide with
};

/// The boundary mesh of an object for fluids of a spacing [m]; none for objects that are no walls: fluids,
/// ropes, grains.
std::optional<BoundaryMesh> boundary_mesh_of(const Object& object, float spacing);
/// Appends the sub-resolution bodies of an object that is no wall. `mass`: of the world's particles [kg]; `number`:
/// their `object`.
void append_sub_resolution_bodies(const Object& object, float spacing, std::span<const float> mass,
                                  std::uint32_t number, std::vector<SubResolutionBody>& bodies);

}  // namespace souple
