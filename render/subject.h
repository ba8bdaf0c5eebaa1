#pragma once

#include "render/color.h"
#include "render/environment.h"
#include "render/image.h"
#include "souple/collision/collider_motion.h"
#include "souple/collision/shapes.h"
#include "souple/world/world.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace souple::render {

/// How the fabric of a cloth reflects light.
enum class Fabric { woven, velvet, satin };
/// Print of a cloth.
enum class Print { plain, checker, stripes, plaid, dots };

/// Data of an object for drawing, from a World or from a cache on disk. User order.
struct Body {
  std::uint32_t id = 0;  ///< ObjectId::value, or any number that is constant for an object
  std::string_view name;
  ObjectKind kind = ObjectKind::cloth;
  std::span<const Vec3f> positions;   ///< m
  std::span<const Vec3f> normals;     ///< empty for ropes and grains
  std::span<const Vec3f> velocities;  ///< m/s; may be empty
  std::span<const Triangle> triangles;
  std::span<const Vec3d> rest;         ///< of the mesh; empty for ropes and grains
  const TriangleMesh* mesh = nullptr;  ///< with the UVs of `picture`; nullptr: unknown
  /// Radius of ropes and grains; half the thickness of others; half the spacing of a fluid [m].
  float radius = 0.005f;
  float density = 0;              ///< of fluids; 0: unknown [kg/m^3]
  bool caustics = false;          ///< of fluids: they refract sunlight onto the floor
  std::span<const Vec3f> foam;    ///< set for the first fluid only: spray, foam and bubbles of all fluids [m]
  std::optional<Color> color{};   ///< empty: a color of the palette
  bool glass = false;             ///< of obstacles: transparent
  Fabric fabric = Fabric::woven;  ///< of cloths
  std::optional<Print> print{};   ///< of cloths; empty: of woven ones by their place, of others plain
  std::shared_ptr<const Image> picture;  ///< of cloths: printed instead of `print`, by the UVs of `mesh`
};

struct ColliderBody {
  std::uint32_t id = 0;
  std::string_view name;
  const Shape* shape = nullptr;
  Transform pose{};                        ///< current pose
  std::optional<Color> color{};            ///< empty: light gray, and concrete for a level floor
  bool glass = false;                      ///< transparent
  const ColliderMotion* motion = nullptr;  ///< nullptr: unknown, or it stands still
  double time = 0;                         ///< of `pose` in `motion` [s]
};

/// Content of a picture. Spans refer to the world or the cache, which must stay unchanged until the picture
/// is drawn.
struct Subject {
  std::vector<Body> bodies;
  std::vector<ColliderBody> colliders;
  std::uint64_t frame = 0;       ///< increases with every step: positions may have changed
  std::uint64_t topology = 0;    ///< changes when the world is replaced
  const World* world = nullptr;  ///< for constraints, contacts and lattices; nullptr for a cache
  std::shared_ptr<const Environment> environment;  ///< nullptr: the procedural sky
};

/// Assigns foam, which belongs to no particular fluid, to the first fluid.
void show_foam(Subject& subject, std::span<const Vec3f> foam);

/// `world_number` distinguishes a world from another that replaced it.
Subject subject_of(const World& world, std::uint64_t world_number = 0);

}  // namespace souple::render
