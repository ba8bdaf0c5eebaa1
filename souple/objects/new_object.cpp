#include "souple/objects/new_object.h"

#include "souple/error.h"
#include "souple/objects/build_elements.h"
#include "souple/objects/checks.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/objects/rigid_definition.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr std::uint32_t max_fluid_particles = 50'000'000;  // particles

std::vector<float> gather_map(const std::vector<float>& map, const Object& object, std::size_t vertices,
                              const char* what) {
  if (map.empty()) return {};
  if (map.size() != vertices)
    throw Error(
        fmt::format("{}: the {} map has {} values for {} vertices", object.name, what, map.size(), vertices));
  std::vector<float> per_particle;
  for (const std::uint32_t vertex : object.vertex_of) {
    if (!(map[vertex] >= 0) || !std::isfinite(map[vertex]))
      throw Error(fmt::format("{}: the {} map is {} at vertex {}, expected a finite number >= 0", object.name,
                              what, map[vertex], vertex));
    per_particle.push_back(map[vertex]);
  }
  return per_particle;
}

/// Frees the spare capacity of arrays that grew item by item, except the capacity for emitters: an object's
/// shape is final.
void shrink(Object& object) {
  const auto shrink_all = [](auto&... vectors) { (vectors.shrink_to_fit(), ...); };
  shrink_all(object.mesh.positions, object.mesh.triangles, object.mesh.uvs, object.mesh.colors,
             object.mesh.faces, object.mesh.face_uvs, object.tets.positions, object.tets.tets, object.rest,
             object.particle_of, object.vertex_of, object.surface, object.triangle_source,
             object.per_particle.stiffness, object.per_particle.thickness, object.per_particle.outside);
  for (auto* map : {&object.particle_of, &object.vertex_of}) map->reserve(object.capacity);
  object.rest.reserve(object.capacity);
}

}  // namespace

NewObject::NewObject() : object(std::make_unique<Object>()) {}
NewObject::NewObject(NewObject&&) noexcept = default;
NewObject::~NewObject() = default;

NewObject start_object(std::string name, const Material& material, const ObjectOptions& options) {
  NewObject made;
  Object& object = *made.object;
  object.kind = kind_of(material);
  object.name = std::move(name);
  if (!object.traits().flows && options.max_particles > 0)
    throw Error(fmt::format("{}: max_particles is {}: only fluids gain particles; leave it 0", object.name,
                            options.max_particles));
  const GivenMass& given = options.given_mass;
  if (!object.traits().rigid && (given.mass || given.center || given.inertia))
    throw Error(fmt::format("{}: given_mass does not apply to a {}: its density says its mass", object.name,
                            object.traits().name));
  if (options.max_particles > max_fluid_particles)
    throw Error(fmt::format("{}: max_particles is {}, expected at most {}", object.name,
                            options.max_particles, max_fluid_particles));
  object.material = material;
  validate(material, object.name);
  validate(options.transform, object.name);
  require_within(object.name, "the velocity", Vec3d(options.velocity), range::speed);
  require_within(object.name, "the angular velocity", Vec3d(options.angular_velocity), range::speed);
  return made;
}

void finish_object(NewObject& made, const ObjectOptions& options) {
  Object& object = *made.object;
  object.capacity = std::max(static_cast<std::uint32_t>(object.rest.size()), options.max_particles);
  if (object.capacity == 0) throw Error(object.name + ": there are no vertices");
  object.per_particle.stiffness =
      gather_map(options.stiffness_map, object, object.vertex_count(), "stiffness");
  object.per_particle.thickness =
      gather_map(options.thickness_map, object, object.vertex_count(), "thickness");
  object.collision.itself = options.self_collision;
  const std::size_t skipped = build_elements(object, SetKinds::all());
  if (skipped > 0)
    made.sentences.push_back(
        fmt::format("{} elements are too thin for a bending or membrane constraint", skipped));
  if (options.self_collision == SelfCollision::particles && object.surface.empty())
    throw Error(
        object.name +
        ": self_collision: particles is for cloth and for soft bodies made of tets; use surfaces or off");
  check_all(object.name,
            {{"self_collision", double(options.self_collision), 0, double(SelfCollision::surfaces)}});
  require_layer(object, options.layer);
  object.collision.layer = options.layer;
  object.collision.filter = {options.collision_groups, options.collision_mask};
  shrink(object);
}

void require_layer(const Object& object, int layer) {
  constexpr int max_layer = 1000;
  if (layer < 0 || layer > max_layer)
    throw Error(
        fmt::format("{}: layer is {}, expected a whole number from 0 to {}", object.name, layer, max_layer));
  if (layer != 0 && object.surface.empty())
    throw Error(object.name +
                ": layer: only an object with its own surface can have a layer (cloth, a soft body "
                "made of tets, an obstacle); leave it 0");
}

}  // namespace souple
