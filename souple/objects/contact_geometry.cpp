#include "souple/objects/contact_geometry.h"

#include "souple/geometry/measures.h"
#include "souple/math/mat3.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/objects/rigid_definition.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace souple {
namespace {

void find_element_radii(const Object& object, std::span<float> radius) {
  const auto include = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto R = static_cast<float>(enclosing_radius(object.rest[a], object.rest[b], object.rest[c]));
    for (const std::uint32_t i : {a, b, c}) radius[object.begin + i] = std::max(radius[object.begin + i], R);
  };
  for (const Triangle& t : object.surface) include(t[0], t[1], t[2]);
  for (const Edge& edge : edges_of_line(object)) include(edge[0], edge[1], edge[1]);
}

}  // namespace

bool is_particle_only(const Object& object) {
  return object.surface.empty() && object.traits().shape != ObjectShape::line;
}

// Balls collide with balls as particles; all other pairs collide as surfaces.
ContactObject contact_object(const Object& object) {
  ContactObject result{.begin = object.begin, .end = object.end};
  const KindTraits& kind = object.traits();
  result.self_collision = result.rolls = kind.rolls;
  result.collides_with_colliders = !kind.flows && !kind.rigid;
  result.are_balls = is_particle_only(object) && !kind.flows;
  return result;
}

// R of ContactStep::depenetration_speed [m]. Grains are bodies of their own: R is the radius of a grain. For other
// objects R is two thirds of the radius of the ball that holds all rest positions. A sheet of 1 m gets 3 m/s.
float radius_at_rest(const Object& object, std::span<const float> radii) {
  float radius = 0;
  if (object.traits().rolls) {
    for (std::uint32_t i = object.begin; i < object.end; ++i) radius = max(radius, radii[i]);
    return radius;
  }
  Vec3d center;
  for (const Vec3d& x : object.rest) center += x * (1 / static_cast<double>(object.rest.size()));
  double square = 0;
  for (const Vec3d& x : object.rest) square = max(square, length_squared(x - center));
  return static_cast<float>(2 * std::sqrt(square) / 3);
}

std::vector<Edge> edges_of_line(const Object& object) {
  std::vector<Edge> edges;
  if (object.traits().shape != ObjectShape::line) return edges;
  edges.reserve(object.particle_count());
  for (std::uint32_t i = 0; i + 1 < object.particle_count(); ++i) edges.push_back({i, i + 1});
  return edges;
}

ContactSurface contact_surface(const Object& object, std::uint32_t index, std::span<const Edge> edges,
                               float radius, const ContactMaterialTable& matrix) {
  const KindTraits& kind = object.traits();
  ContactSurface result{
      .begin = object.begin,
      .end = object.end,
      .reserved_end = object.reserved_end(),
      .triangles = object.surface,
      .edges = edges,
      .particles_only = is_particle_only(object),
      .self_collision = object.collision.itself == SelfCollision::surfaces && !is_particle_only(object) &&
                        matrix.collide(index, index),
      .vertex_balls = object.collision.itself == SelfCollision::particles && matrix.collide(index, index),
      .filter = object.collision.filter,
      .immovable = object.is_driven(),
      .layer = object.collision.layer,
      .rest = object.rest,
      .rigid = kind.rigid,
      .keeps_shape = kind.rigid || (kind.driven && !deforms(object.motion)),
      .rolls = kind.rolls,
      .radius = radius};
  matrix.for_each_ignored(index, [&](std::uint32_t other) {
    if (other != index) result.ignored_surfaces.push_back(other);
  });
  return result;
}

RoundShape round_shape_of(const RigidDefinition& body, std::span<const Triangle> triangles) {
  constexpr double most_inclined = 0.5;  // of a cylinder's faces to its axis
  RoundShape result;
  if (body.shape.parts.size() != 1) return result;
  const ConvexShape& shape = body.shape.parts[0];
  result.is_cylinder = shape.side.radius > 0;
  if (!result.is_cylinder && (!shape.faces.empty() || !(shape.radius > 0))) return result;
  const double radius = result.is_cylinder ? shape.side.radius : shape.radius;
  const std::array<Vec3d, 2> ends{result.is_cylinder ? shape.side.from : shape.vertices.front(),
                                  result.is_cylinder ? shape.side.to : shape.vertices.back()};
  // Each of the four particles is the farthest from those before.
  const std::vector<Vec3d>& x = body.particles;
  const auto farthest = [&](const auto& distance) {
    std::uint32_t best = 0;
    for (std::uint32_t i = 0; i < x.size(); ++i)
      if (distance(x[i] - x[0]) > distance(x[best] - x[0])) best = i;
    return best;
  };
  auto& i = result.particle;
  i[1] = farthest([](const Vec3d& r) { return length_squared(r); });
  i[2] = farthest([&](const Vec3d& r) { return length_squared(cross(r, x[i[1]] - x[0])); });
  const Vec3d normal = cross(x[i[1]] - x[0], x[i[2]] - x[0]);
  i[3] = farthest([&](const Vec3d& r) { return std::abs(dot(r, normal)); });
  const Mat3d sides{x[i[1]] - x[0], x[i[2]] - x[0], x[i[3]] - x[0]};
  if (!(std::abs(determinant(sides)) > 0)) return result;
  for (std::size_t end = 0; end < 2; ++end) {
    const Vec3f w(inverse(sides) * (ends[end] - x[0]));
    result.axis[end] = {1 - w.x - w.y - w.z, w.x, w.y, w.z};
  }
  result.radius = static_cast<float>(radius);
  const Vec3d axis = normalized(ends[1] - ends[0]);
  for (const Triangle& t : triangles) {
    const Vec3d n = normalized(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]));
    if (result.is_cylinder && std::abs(dot(n, axis)) > most_inclined) continue;
    const double below = min(std::abs(dot(n, x[t[0]] - ends[0])), std::abs(dot(n, x[t[0]] - ends[1])));
    result.sagitta = max(result.sagitta, static_cast<float>(radius - below));
  }
  return result;
}

// Bodies with an embedded surface have no elements: their particles collide instead.
void append_elements(const Object& object, std::uint32_t index, std::span<const Edge> edges,
                     std::vector<ContactElement>& elements) {
  if (object.traits().driven || object.traits().rigid || is_particle_only(object)) return;
  const std::uint32_t b = object.begin;
  const auto append = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    const double radius = enclosing_radius(object.rest[p], object.rest[q], object.rest[r]);
    elements.push_back({{b + p, b + q, b + r}, index, static_cast<float>(radius)});
  };
  for (const Triangle& t : object.surface) append(t[0], t[1], t[2]);
  for (const Edge& edge : edges) append(edge[0], edge[1], edge[1]);
}

ContactMaterial contact_material_of(const Material& material) {
  return functions_of(material).contact_material(material);
}

bool same_contacts(const Material& a, const Material& b) {
  const auto law = [](const Material& material) {
    const ContactMaterial m = contact_material_of(material);
    return std::tuple(m.friction, m.kinetic_friction, m.restitution, m.rolling_friction,
                      contact_radius(material));
  };
  return law(a) == law(b);
}

void find_contact_radii(const Object& object, std::span<float> radius, std::span<float> element_radius) {
  const float of_material = contact_radius(object.material);
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const std::uint32_t local = i - object.begin;
    const float scale = object.per_particle.thickness.empty() ? 1 : object.per_particle.thickness[local];
    const float offset = object.per_particle.outside.empty() ? 0 : object.per_particle.outside[local];
    radius[i] = of_material * scale - offset;
    element_radius[i] = 0;
  }
  find_element_radii(object, element_radius);
}

}  // namespace souple
