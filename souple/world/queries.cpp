#include "souple/contacts/collider_queries.h"
#include "souple/contacts/contact_law.h"
#include "souple/geometry/closest_point.h"
#include "souple/world/add.h"
#include "souple/world/impl.h"
#include "souple/world/prepare.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

/// Distance at which a ray enters a ball: 0 if it starts inside, infinity if it misses.
double ray_ball(const Vec3d& origin, const Vec3d& direction, const Vec3d& center, double radius) {
  const Vec3d s = center - origin;
  const double along = dot(s, direction), miss2 = dot(s, s) - along * along, r2 = radius * radius;
  if (miss2 > r2) return std::numeric_limits<double>::infinity();
  const double half = std::sqrt(r2 - miss2);
  if (along + half < 0) return std::numeric_limits<double>::infinity();
  return std::fmax(along - half, 0.0);
}

std::uint32_t nearest_corner(std::span<const Vec3f> x, const Triangle& triangle, const Vec3d& point) {
  std::uint32_t best = triangle[0];
  for (const std::uint32_t vertex : triangle)
    if (length_squared(Vec3d(x[vertex]) - point) < length_squared(Vec3d(x[best]) - point)) best = vertex;
  return best;
}

/// Keeps the nearest candidate; of equal ones the first. The order of candidates is fixed.
struct Nearest {
  Hit hit;
  double distance;

  bool offer(double candidate) const { return candidate < distance; }
  void take(const Hit& better, double at) {
    hit = better;
    hit.found = true;
    hit.distance = distance = at;
  }
};

}  // namespace

Hit World::ray_cast(const Vec3f& origin, const Vec3f& direction, double max_distance) const {
  const WorldState& world = impl_->state;
  const Vec3d o(origin), d = normalized(Vec3d(direction));
  if (!is_finite(o) || !(length_squared(d) > 0))
    throw Error("ray_cast: the origin is not finite or the direction is zero");
  const Segment<double> ray{o, d, std::numeric_limits<double>::infinity()};
  Nearest nearest{{}, max_distance};
  for (const auto& object : world.objects) {
    const auto x = positions(object->id);
    const auto faces = triangles(object->id);
    for (std::uint32_t t = 0; t < faces.size(); ++t) {
      const Triangle& f = faces[t];
      const Corners<double> corners{Vec3d(x[f[0]]), Vec3d(x[f[1]]), Vec3d(x[f[2]])};
      const double at = find_crossing(world.settings.segment_test, ray, corners).t;
      const Vec3d point = o + d * at;
      if (nearest.offer(at))
        nearest.take({.object = object->id,
                      .vertex = nearest_corner(x, f, point),
                      .triangle = t,
                      .point = Vec3f(point)},
                     at);
    }
    if (!faces.empty()) continue;
    const auto radius = static_cast<double>(particle_radius(object->id));
    for (std::uint32_t v = 0; v < x.size(); ++v) {
      const double at = ray_ball(o, d, Vec3d(x[v]), radius);
      if (nearest.offer(at))
        nearest.take({.object = object->id, .vertex = v, .point = Vec3f(o + d * at)}, at);
    }
  }
  for (const ColliderRecord& record : world.colliders) {
    const Collider collider{record.options.name, record.shape, record.options.motion, {}, true};
    const auto found = souple::ray_cast(collider, world.time, o, d, nearest.distance);
    if (found && nearest.offer(found->distance))
      nearest.take({.collider = record.id, .is_collider = true, .point = Vec3f(found->point)},
                   found->distance);
  }
  return nearest.hit;
}

Hit World::closest_point(const Vec3f& point) const {
  const WorldState& world = impl_->state;
  const Vec3d p(point);
  if (!is_finite(p)) throw Error("closest_point: the point is not finite");
  Nearest nearest{{}, std::numeric_limits<double>::infinity()};
  for (const auto& object : world.objects) {
    const auto x = positions(object->id);
    const auto faces = triangles(object->id);
    for (std::uint32_t t = 0; t < faces.size(); ++t) {
      const Triangle& f = faces[t];
      const Vec3d a(x[f[0]]), b(x[f[1]]), c(x[f[2]]);
      const TrianglePoint w = closest_on_triangle(p, a, b, c);
      const Vec3d on = a * w.a + b * w.b + c * w.c;
      if (nearest.offer(length(on - p)))
        nearest.take(
            {.object = object->id, .vertex = nearest_corner(x, f, on), .triangle = t, .point = Vec3f(on)},
            length(on - p));
    }
    if (!faces.empty()) continue;
    for (std::uint32_t v = 0; v < x.size(); ++v) {
      const Vec3d towards = normalized(p - Vec3d(x[v])) * static_cast<double>(particle_radius(object->id));
      const Vec3d on = Vec3d(x[v]) + towards;
      if (nearest.offer(length(on - p)))
        nearest.take({.object = object->id, .vertex = v, .point = Vec3f(on)}, length(on - p));
    }
  }
  for (const ColliderRecord& record : world.colliders) {
    const Collider collider{record.options.name, record.shape, record.options.motion, {}, true};
    const SurfaceDistance surface = souple::surface_distance(collider, world.time, p);
    if (nearest.offer(std::fabs(surface.distance)))
      nearest.take(
          {.collider = record.id, .is_collider = true, .point = Vec3f(p - surface.normal * surface.distance)},
          std::fabs(surface.distance));
  }
  return nearest.hit;
}

// --- sums over an object -------------------------------------------------------------------------

double World::kinetic_energy(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  double sum = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum += 0.5 * static_cast<double>(world.particles.mass[i]) *
           length_squared(Vec3d(world.particles.velocity[i].xyz()));
  if (object.kind != ObjectKind::grains) return sum;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const std::vector<float>& map = object.thickness_map;
    const auto r =
        static_cast<double>(contact_radius(object.material) * (map.empty() ? 1.0f : map[i - object.begin]));
    const double inertia =
        static_cast<double>(world.particles.mass[i]) * r * r / static_cast<double>(inverse_inertia_factor);
    sum += 0.5 * inertia * length_squared(Vec3d(world.particles.spin[i].xyz()));
  }
  return sum;
}

double World::potential_energy(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  double sum = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum -= static_cast<double>(world.particles.mass[i]) *
           dot(Vec3d(world.settings.gravity), world.exact_position(i));
  return sum;
}

Vec3d World::momentum(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  Vec3d sum;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    sum += Vec3d(world.particles.velocity[i].xyz()) * static_cast<double>(world.particles.mass[i]);
  return sum;
}

Vec3d World::center_of_mass(ObjectId id) const {
  const WorldState& world = impl_->state;
  const Object& object = world.object(id);
  Vec3d sum;
  double mass = 0;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const auto m = static_cast<double>(world.particles.mass[i]);
    sum += world.exact_position(i) * m;
    mass += m;
  }
  if (mass > 0) return sum / mass;
  for (std::uint32_t i = object.begin; i < object.end; ++i) sum += world.exact_position(i);
  return sum / std::max(1u, object.particle_count());
}

}  // namespace souple
