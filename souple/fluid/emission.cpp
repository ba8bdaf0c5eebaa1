#include "souple/fluid/emission.h"

#include "souple/contacts/collider_queries.h"
#include "souple/fluid/emitter_record.h"
#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"

#include <algorithm>
#include <cmath>

namespace souple {
namespace {

constexpr double min_distance_ratio = 0.7;   // in spacings: emission stops where other fluid is nearer
constexpr std::size_t emission_grain = 512;  // minimum number of particles per thread

/// Two unit vectors perpendicular to the unit vector n.
std::array<Vec3d, 2> across(const Vec3d& n) {
  const Vec3d axis = std::fabs(n.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(cross(n, axis));
  return {u, cross(n, u)};
}

/// Layer k, which left the nozzle at time t, at its undisturbed position at time `now`: straight through the
/// inflow zone, then a parabola,
///
///   x = x(t) + v s + g r^2 / 2,   v + g r,   s = now - t, r: time since it left the zone
///
/// Every second layer is shifted by half a spacing: particles in line would collide head on where the jet
/// slows down.
void append_layer(const Emitter& emitter, std::uint64_t k, double t, const Vec3d& g, double spacing,
                  double now, std::vector<Drop>& drops) {
  const Nozzle nozzle = nozzle_at(emitter, t);
  const auto speed = static_cast<double>(emitter.speed);
  const double s = now - t, r = std::max(0.0, s - inflow_depth * spacing / speed);
  const Vec3d v = nozzle.velocity + nozzle.direction * speed;
  const Vec3d middle = nozzle.position + v * s + g * (0.5 * r * r);
  const double radius = static_cast<double>(emitter.radius) / spacing;
  const double moved = k % 2 == 1 && radius >= 1 ? 0.5 : 0;
  const int max_index = static_cast<int>(radius) + 1;
  for (int i = -max_index; i <= max_index; ++i)
    for (int j = -max_index; j <= max_index; ++j) {
      const double u = i + moved, w = j + moved;
      if (u * u + w * w <= radius * radius)
        drops.push_back(
            {middle + nozzle.side[0] * (u * spacing) + nozzle.side[1] * (w * spacing), v + g * r});
    }
}

/// Positions of the particles of all fluids that may block drops.
std::vector<Vec3d> particles_near(const ObjectsView& objects, std::span<const Drop> drops, double distance) {
  Vec3d lo = drops[0].position, hi = lo;
  for (const Drop& drop : drops)
    for (int k = 0; k < 3; ++k)
      lo[k] = std::min(lo[k], drop.position[k]), hi[k] = std::max(hi[k], drop.position[k]);
  std::vector<Vec3d> result;
  for (const auto& object : objects.objects) {
    if (!object->traits().flows) continue;
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const Vec3d x = objects.particles.exact_position(i);
      bool within = true;
      for (int k = 0; k < 3; ++k) within = within && x[k] > lo[k] - distance && x[k] < hi[k] + distance;
      if (within) result.push_back(x);
    }
  }
  return result;
}

}  // namespace

// v = (x(t + e) - x(t)) / e
Nozzle nozzle_at(const Emitter& emitter, double t) {
  constexpr double e = 1.0 / 1024;
  const Vec3d x(emitter.position), n = normalized(Vec3d(emitter.direction));
  const std::array<Vec3d, 2> side = across(n);
  const Transform pose = emitter.motion.at(t);
  Nozzle result{pose.point(x), pose.direction(n), {}, {pose.direction(side[0]), pose.direction(side[1])}};
  if (!emitter.motion.is_static() && !emitter.motion.jumps(t, t + e))
    result.velocity = (emitter.motion.at(t + e).point(x) - result.position) / e;
  return result;
}

std::vector<Drop> next_drops(EmitterRecord& record, const Vec3d& gravity, double spacing, double now) {
  constexpr std::uint64_t max_layers = 10000;  // per step
  const Emitter& emitter = record.emitter;
  std::vector<Drop> drops;
  const double layer_interval = spacing / static_cast<double>(emitter.speed);
  const auto leaves = [&](std::uint64_t k) {
    return emitter.start + static_cast<double>(k) * layer_interval;
  };
  for (std::uint64_t n = 0; n < max_layers && leaves(record.layers) <= now; ++n, ++record.layers)
    if (is_open(emitter.start, emitter.end, leaves(record.layers)))
      append_layer(emitter, record.layers, leaves(record.layers), gravity, spacing, now, drops);
  return drops;
}

std::vector<std::uint8_t> blocked_drops(std::span<const Drop> drops, const ObjectsView& objects,
                                        double spacing) {
  std::vector<std::uint8_t> result(drops.size());
  if (drops.empty()) return result;
  const double distance = min_distance_ratio * spacing;
  const std::vector<Vec3d> others = particles_near(objects, drops, distance);
  std::transform(drops.begin(), drops.end(), result.begin(), [&](const Drop& drop) {
    const bool blocked = std::any_of(others.begin(), others.end(), [&](const Vec3d& x) {
      return length_squared(x - drop.position) < distance * distance;
    });
    return static_cast<std::uint8_t>(blocked ? 1 : 0);
  });
  return result;
}

double back_pressure(const Emitter& emitter, const ObjectsView& objects, const Vec3d& weight, double spacing,
                     double now) {
  const Vec3d nozzle = nozzle_at(emitter, now).position;
  const double reach = static_cast<double>(emitter.radius) + 2 * spacing;
  double sum = 0, at_depth = 0;
  std::size_t count = 0;
  for (const auto& object : objects.objects) {
    if (!object->traits().flows) continue;
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const Vec3d from = objects.particles.exact_position(i) - nozzle;
      at_depth = std::max(at_depth, -dot(weight, from));
      if (!(length_squared(from) < reach * reach)) continue;
      sum += static_cast<double>(objects.particles.velocity[i].w);
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) - at_depth : 0;
}

std::uint64_t layers_before(const Emitter& emitter, double spacing, double now) {
  const double past = now - emitter.start;
  constexpr double most = 1e18;  // of a long time at a high speed
  return past > 0 ? static_cast<std::uint64_t>(
                        std::min(std::ceil(past * static_cast<double>(emitter.speed) / spacing), most))
                  : 0;
}

std::vector<std::uint32_t> particles_in(const Drain& drain, const Object& fluid, const ObjectsView& objects,
                                        Threads& threads) {
  std::vector<std::uint8_t> is_in(fluid.particle_count());
  const Collider collider{"drain", drain.shape, ColliderMotion::fixed(drain.pose), {}, true};
  threads.for_each(is_in.size(), emission_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      is_in[i] = surface_distance(collider, 0, objects.particles.exact_position(fluid.begin + i)).distance < 0
                     ? 1
                     : 0;
  });
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < is_in.size(); ++i)
    if (is_in[i] != 0) result.push_back(i);
  return result;
}

}  // namespace souple
