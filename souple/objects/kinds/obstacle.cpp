#include "souple/error.h"
#include "souple/objects/checks.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"

#include <utility>

// Obstacles: triangles with prescribed motion. No force or contact moves them, so they have no mass.

namespace souple {
namespace {

void require_obstacle_options(const ObjectOptions& options, const std::string& name) {
  const auto refuse = [&](const char* option) {
    throw Error(name + ": the option " + option +
                " does not apply to an obstacle, which only its motion moves");
  };
  if (length_squared(options.velocity) > 0) refuse("velocity");
  if (length_squared(options.angular_velocity) > 0) refuse("angular_velocity");
  if (!options.stiffness_map.empty()) refuse("stiffness_map");
  if (options.self_collision != SelfCollision::off) refuse("self_collision");
}

}  // namespace

NewObject import_obstacle(std::string name, const TriangleMesh& mesh, const ObstacleMaterial& material,
                          ObstacleMotion motion, const ObjectOptions& options) {
  NewObject obstacle = start_object(std::move(name), material, options);
  Object& object = *obstacle.object;
  require_obstacle_options(options, object.name);
  import_surface(obstacle, mesh, options.transform);
  if (object.surface.empty()) throw Error(object.name + ": the mesh has no triangles to collide with");
  validate(motion, object.vertex_count(), object.name);
  static_cast<ObstacleMotion&>(object.motion) = std::move(motion);
  object.motion.placement = options.transform;
  obstacle.mass.assign(object.rest.size(), 0.0);
  finish_object(obstacle, options);
  return obstacle;
}

constinit const KindFunctions kinds::obstacle{
    .traits = {.name = "obstacle", .shape = ObjectShape::surface, .driven = true},
    .default_material = default_material<ObstacleMaterial>,
    .validate = of_material<check_fields<ObstacleMaterial>>,
    .contact_radius = of_material<half_thickness<ObstacleMaterial>>,
    .contact_material = of_material<contact_material<ObstacleMaterial>>,
};

}  // namespace souple
