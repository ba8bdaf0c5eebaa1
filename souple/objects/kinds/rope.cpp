#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/polyline.h"
#include "souple/objects/checks.h"
#include "souple/objects/constraint_builder.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/import_particles.h"
#include "souple/objects/kinds/kinds.h"
#include "souple/objects/kinds/of_material.h"
#include "souple/objects/object.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/core.h>

// Ropes: chains of particles.

namespace souple {
namespace {

// Each segment of a rope that collides with itself is near 4 r / l others. Without a limit, memory and time would grow
// with the square of the number of segments. Segments shorter than the limit add no detail to so thick a rope.
void require_long_segments(const RopeMaterial& m, const Object& object) {
  constexpr double shortest = 1.0 / 5;  // radii
  if (object.collision.itself == SelfCollision::off || object.rest.size() < 2) return;
  const auto radius = static_cast<double>(m.radius);
  const double l = length(object.rest[1] - object.rest[0]);
  if (l >= shortest * radius) return;
  const double count = static_cast<double>(object.rest.size() - 1);
  throw Error(fmt::format(
      "segments of {:.3g} m are too short for a rope of radius {:.3g} m that collides with itself, "
      "expected at least a fifth of the radius: use at most {:.0f} segments, a smaller radius, or "
      "no self_collision",
      l, radius, std::max(1.0, std::floor(count * l / (shortest * radius)))));
}

// Segments have the stretch stiffness k = E pi r^2 / l and the bending stiffness E I (see rope_bending.h).
void add_rope_elements(const RopeMaterial& m, const Object& object, ConstraintBuilder& to) {
  require_long_segments(m, object);
  const auto radius = static_cast<double>(m.radius);
  const auto E = static_cast<double>(m.young_modulus);
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) {
    const Edge edge{i, i + 1};
    const double l = length(object.rest[i] - object.rest[i + 1]);
    const double k =
        E * pi * radius * radius / l * static_cast<double>(object.mean(object.per_particle.stiffness, edge));
    const auto compliance = static_cast<float>(1 / k);
    if (usable(compliance) && to.wants(SetKind::distance))
      to.set<Distance>().add(edge, {static_cast<float>(l)}, {compliance}, m.damping_time, m.pbd_stretch);
    if (i + 2 >= object.particle_count() || !to.wants(SetKind::rope_bending)) continue;
    const std::array<std::uint32_t, 3> three{i, i + 1, i + 2};
    const auto bend = static_cast<float>(
        l * l * l /
        static_cast<double>(m.bending_stiffness * object.mean(object.per_particle.stiffness, three)));
    if (usable(bend))
      to.set<RopeBending>().add(three, {static_cast<float>(l)}, {bend}, m.damping_time, m.pbd_bending);
  }
}

SetKinds changed_rope_kinds(const RopeMaterial& a, const RopeMaterial& b) {
  const auto stretch = [](const RopeMaterial& m) {
    return std::tuple(m.radius, m.young_modulus, m.damping_time, m.pbd_stretch);
  };
  const auto bending = [](const RopeMaterial& m) {
    return std::tuple(m.bending_stiffness, m.damping_time, m.pbd_bending);
  };
  SetKinds changed;
  if (stretch(a) != stretch(b)) changed |= SetKind::distance;
  if (bending(a) != bending(b)) changed |= SetKind::rope_bending;
  return changed;
}

// Pieces no longer than the spacing, each at the midpoint of its part of a segment.
void append_pieces(const RopeMaterial& m, const Object& object, float spacing, std::span<const float> mass,
                   std::uint32_t number, std::vector<SubResolutionBody>& bodies) {
  const float radius = m.radius;
  constexpr double max_pieces = 64;  // per segment
  double all = 0, weight = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) weight += static_cast<double>(mass[i]);
  for (std::size_t i = 0; i + 1 < object.rest.size(); ++i) all += length(object.rest[i + 1] - object.rest[i]);
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) {
    const double segment = length(object.rest[i + 1] - object.rest[i]);
    const double pieces = min(std::ceil(max(segment / static_cast<double>(spacing), 1.0)), max_pieces);
    const auto piece = static_cast<float>(segment / pieces);
    for (double k = 0.5; k < pieces; ++k) {
      const auto t = static_cast<float>(k / pieces);
      bodies.push_back({.particles = {object.begin + i, object.begin + i + 1},
                        .weights = {1 - t, t},
                        .volume = static_cast<float>(pi) * radius * radius * piece,
                        .mass = static_cast<float>(weight / all) * piece,
                        .radius = radius,
                        .length = piece,
                        .object = number});
    }
  }
}

}  // namespace

NewObject import_rope(std::string name, std::span<const Vec3d> points, std::uint32_t segments,
                      const RopeMaterial& material, const ObjectOptions& options) {
  NewObject rope = start_object(std::move(name), material, options);
  Object& object = *rope.object;
  if (points.size() < 2)
    throw Error(fmt::format("{}: a rope needs at least two points, got {}", object.name, points.size()));
  if (segments < 1 || segments > 10000000)
    throw Error(fmt::format("{}: segments is {}, expected 1 to 10,000,000", object.name, segments));
  std::vector<Vec3d> path(points.begin(), points.end());
  transform_points(path, options.transform, object.name);
  const double length_of_all = polyline_length(path);
  if (!(length_of_all > 0)) throw Error(object.name + ": its points coincide, so the rope has no length");
  import_points(object, resample_polyline(path, segments));
  const auto radius = static_cast<double>(material.radius);
  const double mass = static_cast<double>(material.density) * pi * radius * radius * length_of_all / segments;
  rope.mass.assign(object.rest.size(), mass);
  rope.mass.front() = rope.mass.back() = mass / 2;
  finish_object(rope, options);
  return rope;
}

constinit const KindFunctions kinds::rope{
    .traits = {.name = "rope", .shape = ObjectShape::line},
    .default_material = default_material<RopeMaterial>,
    .find_preset = preset<material::find_rope>,
    .validate = of_material<check_fields<RopeMaterial>>,
    .density = of_material<volumetric_density<RopeMaterial>>,
    .add_elements = of_material<add_rope_elements>,
    .changed_kinds = of_two_materials<changed_rope_kinds>,
    .contact_radius = of_material<radius<RopeMaterial>>,
    .contact_material = of_material<contact_material<RopeMaterial>>,
    .append_sub_resolution_bodies = of_material<append_pieces>,
};

}  // namespace souple
