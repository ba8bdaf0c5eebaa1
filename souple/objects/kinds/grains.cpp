#include "souple/objects/checks.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"

#include <cmath>
#include <utility>

// Grains: balls that roll. Contacts are all that acts between them.

namespace souple {
namespace {

ContactMaterial rolling_contact_material(const GrainsMaterial& m) {
  ContactMaterial result = kinds::contact_material(m);
  result.rolling_friction = m.rolling_friction;
  return result;
}

/// Points in a ball, about a spacing apart; its center if it is smaller.
std::vector<Vec3f> points_in_ball(float radius, float spacing) {
  constexpr float max_points_across = 10;
  if (radius < spacing) return {Vec3f{}};
  std::vector<Vec3f> result;
  const float across = std::ceil(min(2 * radius / spacing, max_points_across)), pitch = 2 * radius / across;
  for (float z = 0.5f; z < across; ++z)
    for (float y = 0.5f; y < across; ++y)
      for (float x = 0.5f; x < across; ++x) {
        const Vec3f at = Vec3f{x, y, z} * pitch - Vec3f{radius, radius, radius};
        if (dot(at, at) < radius * radius) result.push_back(at);
      }
  return result;
}

// The points of a large grain have in total its cross section, which determines the drag.
void append_balls(const GrainsMaterial& m, const Object& object, float spacing, std::span<const float> mass,
                  std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  const float radius = m.radius;
  const std::vector<Vec3f> points = points_in_ball(radius, spacing);
  const float part = 1 / static_cast<float>(points.size());
  const float volume = 4 * static_cast<float>(pi) / 3 * radius * radius * radius;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    for (const Vec3f& point : points)
      bodies.push_back({.particles = {i, i},
                        .weights = {1, 0},
                        .offset = point,
                        .volume = volume * part,
                        .mass = mass[i] * part,
                        .radius = radius * std::sqrt(part),
                        .object = number});
}

}  // namespace

NewObject import_grains(std::string name, std::span<const Vec3d> centers, const GrainsMaterial& material,
                        const ObjectOptions& options) {
  NewObject grains = start_object(std::move(name), material, options);
  Object& object = *grains.object;
  import_points(object, {centers.begin(), centers.end()});
  transform_points(object.rest, options.transform, object.name);
  const auto radius = static_cast<double>(material.radius);
  grains.mass.assign(object.rest.size(),
                     static_cast<double>(material.density) * 4 / 3 * pi * radius * radius * radius);
  finish_object(grains, options);
  return grains;
}

constinit const KindFunctions kinds::grains{
    .traits = {.name = "grains", .shape = ObjectShape::balls, .rolls = true},
    .default_material = default_material<GrainsMaterial>,
    .find_preset = preset<material::find_grains>,
    .validate = of_material<check_fields<GrainsMaterial>>,
    .density = of_material<volumetric_density<GrainsMaterial>>,
    .contact_radius = of_material<radius<GrainsMaterial>>,
    .contact_material = of_material<rolling_contact_material>,
    .append_sub_resolution_bodies = of_material<append_balls>,
};

}  // namespace souple
