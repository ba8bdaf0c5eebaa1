#include "souple/error.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/fill.h"
#include "souple/objects/checks.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"

#include <utility>

#include <fmt/core.h>

// Fluids: particles that come and go. One solver moves those of all fluids (souple/fluid/).

namespace souple {
namespace {

void require_same_spacing(const FluidMaterial& from, const FluidMaterial& to, std::string_view owner) {
  if (to.spacing != from.spacing)
    throw Error(fmt::format("{}: spacing is {} m, was {} m: remove and add the fluid to change it", owner,
                            to.spacing, from.spacing));
}

// The density solver keeps particles half a spacing from walls; contacts only catch the rest.
float contact_radius_of(const FluidMaterial& m) {
  return m.spacing / 4;
}

float half_spacing(const FluidMaterial& m) {
  return m.spacing / 2;
}

// Fluids have viscous friction, not Coulomb friction.
ContactMaterial frictionless(const FluidMaterial& m) {
  return {.friction = 0, .restitution = m.restitution};
}

void require_fluid_options(const ObjectOptions& options, const std::string& name) {
  const auto refuse = [&](const char* option) {
    throw Error(name + ": the option " + option + " does not apply to a fluid");
  };
  if (!options.stiffness_map.empty()) refuse("stiffness_map");
  if (!options.thickness_map.empty()) refuse("thickness_map");
  if (options.self_collision != SelfCollision::off) refuse("self_collision");
}

}  // namespace

NewObject import_fluid(std::string name, std::span<const Vec3d> centers, const FluidMaterial& material,
                       const ObjectOptions& options) {
  NewObject fluid = start_object(std::move(name), material, options);
  Object& object = *fluid.object;
  require_fluid_options(options, object.name);
  import_points(object, {centers.begin(), centers.end()});
  transform_points(object.rest, options.transform, object.name);
  const auto d = static_cast<double>(material.spacing);
  require_apart(object.rest, d, object.name);
  fluid.mass.assign(object.rest.size(), static_cast<double>(material.density) * d * d * d);
  finish_object(fluid, options);
  return fluid;
}

NewObject import_fluid(std::string name, const TriangleMesh& surface, const FluidMaterial& material,
                       const ObjectOptions& options) {
  kinds::check_fields(material, name);
  TriangleMesh placed = surface;
  transform_points(placed.positions, options.transform, name);
  ObjectOptions transformed = options;
  transformed.transform = {};
  const ClosedSurface closed = closed_surface(placed, name);
  const std::vector<Vec3d> centers = fill(closed.mesh, static_cast<double>(material.spacing), name);
  NewObject fluid = import_fluid(std::move(name), centers, material, transformed);
  fluid.sentences = closed.sentences();
  return fluid;
}

constinit const KindFunctions kinds::fluid{
    .traits = {.name = "fluid", .shape = ObjectShape::balls, .flows = true},
    .default_material = default_material<FluidMaterial>,
    .find_preset = preset<material::find_fluid>,
    .validate = of_material<check_fields<FluidMaterial>>,
    .validate_change = of_two_materials<require_same_spacing>,
    .density = of_material<volumetric_density<FluidMaterial>>,
    .contact_radius = of_material<contact_radius_of>,
    .particle_radius = of_material<half_spacing>,
    .contact_material = of_material<frictionless>,
};

}  // namespace souple
