#pragma once

#include "render/color.h"
#include "souple/collision/shapes.h"
#include "souple/world/world.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace souple::render {

/// An object as a picture needs it, from a World or from a cache on disk. User order.
struct Body {
  std::uint32_t id = 0;  ///< ObjectId::value, or any number that stays the same for an object
  std::string_view name;
  ObjectKind kind = ObjectKind::cloth;
  std::span<const Vec3f> positions;   ///< m
  std::span<const Vec3f> normals;     ///< empty for ropes and grains
  std::span<const Vec3f> velocities;  ///< m/s; may be empty
  std::span<const Triangle> triangles;
  std::span<const Vec3d> rest;   ///< of the mesh; empty for ropes and grains
  float radius = 0.005f;         ///< of ropes and grains, half the thickness of others, half of a fluid's
                                 ///< spacing [m]
  float density = 0;             ///< of fluids; 0: not known [kg/m^3]
  std::span<const Vec3f> foam;   ///< of the first of all fluids: their spray, foam and bubbles [m]
  std::optional<Color> color{};  ///< if none: one of the palette
};

struct ColliderBody {
  std::uint32_t id = 0;
  std::string_view name;
  const Shape* shape = nullptr;
  Transform pose{};              ///< now
  std::optional<Color> color{};  ///< if none: light gray
};

/// What is looked at. Spans point into the world or the cache, which has to live and stay as it is until the
/// picture is drawn.
struct Subject {
  std::vector<Body> bodies;
  std::vector<ColliderBody> colliders;
  std::uint64_t frame = 0;       ///< grows with every step: positions may have changed
  std::uint64_t topology = 0;    ///< another number: it is another world
  const World* world = nullptr;  ///< for constraints, contacts and lattices; none in a cache
};

/// Foam is of no fluid in particular: the first one shows it.
void show_foam(Subject& subject, std::span<const Vec3f> foam);

/// `world_number` tells one world from another that took its place.
Subject subject_of(const World& world, std::uint64_t world_number = 0);

}  // namespace souple::render
