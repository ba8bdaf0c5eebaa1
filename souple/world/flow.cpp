#include "souple/world/flow.h"

#include "souple/contacts/collider_queries.h"
#include "souple/objects/checks.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/world/inflow_particles.h"
#include "souple/world/sleeping.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace souple {
namespace {

constexpr double min_distance_ratio = 0.7;   // in spacings: emission stops where other fluid is nearer
constexpr double max_layer_particles = 1e5;  // particles
constexpr std::size_t grain = 512;           // minimum number of particles per thread

void require_times(double start, double end, std::string_view owner) {
  if (!std::isfinite(start) || !(end >= start))
    throw Error(
        fmt::format("{}: it is active from {:g} to {:g} s, expected a finite start and an end not before it",
                    owner, start, end));
}

/// Two unit vectors perpendicular to the unit vector n.
std::array<Vec3d, 2> across(const Vec3d& n) {
  const Vec3d axis = std::fabs(n.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(cross(n, axis));
  return {u, cross(n, u)};
}

struct Drop {
  Vec3d position, velocity;
};

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

bool open(double start, double end, double t) {
  return t >= start && t < end;
}

/// All layers k that left by now, at the time start + k d / speed, and have not been added yet.
std::vector<Drop> drops_of(EmitterRecord& record, const Vec3d& gravity, double spacing, double now) {
  constexpr std::uint64_t max_layers = 10000;  // per step
  const Emitter& emitter = record.emitter;
  std::vector<Drop> drops;
  const double layer_interval = spacing / static_cast<double>(emitter.speed);
  const auto leaves = [&](std::uint64_t k) {
    return emitter.start + static_cast<double>(k) * layer_interval;
  };
  for (std::uint64_t n = 0; n < max_layers && leaves(record.layers) <= now; ++n, ++record.layers)
    if (open(emitter.start, emitter.end, leaves(record.layers)))
      append_layer(emitter, record.layers, leaves(record.layers), gravity, spacing, now, drops);
  return drops;
}

/// Positions of the particles of all fluids that may block drops.
std::vector<Vec3d> particles_near(const WorldState& world, const std::vector<Drop>& drops, double distance) {
  Vec3d lo = drops[0].position, hi = lo;
  for (const Drop& drop : drops)
    for (int k = 0; k < 3; ++k)
      lo[k] = std::min(lo[k], drop.position[k]), hi[k] = std::max(hi[k], drop.position[k]);
  std::vector<Vec3d> result;
  for (const auto& object : world.objects) {
    if (object->kind != ObjectKind::fluid) continue;
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const Vec3d x = world.exact_position(i);
      bool within = true;
      for (int k = 0; k < 3; ++k) within = within && x[k] > lo[k] - distance && x[k] < hi[k] + distance;
      if (within) result.push_back(x);
    }
  }
  return result;
}

void append(WorldState& world, Object& fluid, const Drop& drop) {
  const std::uint32_t i = fluid.end;
  set_count(world, fluid, fluid.particle_count() + 1);
  world.particles.velocity[i].set_xyz(Vec3f(drop.velocity));
  world.set_position(i, drop.position);
}

void emit(WorldState& world, EmitterRecord& record) {
  Object& fluid = world.object(ObjectId{record.fluid});
  const auto spacing = static_cast<double>(std::get<FluidMaterial>(fluid.material).spacing);
  std::vector<Drop> drops;
  world.warnings.guarded("an emitter's motion", [&] {
    drops = drops_of(record, Vec3d(world.settings.gravity), spacing, world.time);
  });
  if (drops.empty()) return;
  const double distance = min_distance_ratio * spacing;
  const std::vector<Vec3d> others = particles_near(world, drops, distance);
  wake_island(world, fluid);
  for (const Drop& drop : drops) {
    const bool blocked = std::any_of(others.begin(), others.end(), [&](const Vec3d& x) {
      return length_squared(x - drop.position) < distance * distance;
    });
    if (blocked || fluid.particle_count() == fluid.capacity) {
      ++world.report.fluid.held_back;
    } else {
      append(world, fluid, drop);
      ++world.report.fluid.emitted;
    }
  }
}

/// The particles of a fluid that are in a drain, ascending.
std::vector<std::uint32_t> found_in(const WorldState& world, const Object& fluid, const Drain& drain) {
  std::vector<std::uint8_t> is_in(fluid.particle_count());
  const Collider collider{"drain", drain.shape, ColliderMotion::fixed(drain.pose), {}, true};
  world.threads->for_each(is_in.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      is_in[i] = surface_distance(collider, 0, world.exact_position(fluid.begin + i)).distance < 0 ? 1 : 0;
  });
  std::vector<std::uint32_t> result;
  for (std::uint32_t i = 0; i < is_in.size(); ++i)
    if (is_in[i] != 0) result.push_back(i);
  return result;
}

/// Removes the particles `gone`; the others keep their order.
void remove_particles(WorldState& world, Object& fluid, const std::vector<std::uint32_t>& gone) {
  std::uint32_t to = gone[0];
  for (std::uint32_t from = gone[0], k = 0; from < fluid.particle_count(); ++from) {
    if (k < gone.size() && gone[k] == from) {
      ++k;
      continue;
    }
    world.particles.copy(fluid.begin + from, fluid.begin + to);
    ++to;
  }
  set_count(world, fluid, to);
}

void drain(WorldState& world, DrainRecord& record, double dt) {
  if (!open(record.drain.start, record.drain.end, world.time)) return;
  const bool limited = std::isfinite(record.drain.rate);
  for (const auto& object : world.objects) {
    const auto* material = std::get_if<FluidMaterial>(&object->material);
    if (!material || object->particle_count() == 0) continue;
    const auto d = static_cast<double>(material->spacing);
    if (limited) record.credit += static_cast<double>(record.drain.rate) * dt / (d * d * d);
    std::vector<std::uint32_t> gone = found_in(world, *object, record.drain);
    // Volume that the drain could not remove for lack of fluid does not accumulate.
    if (limited && static_cast<double>(gone.size()) > record.credit)
      gone.resize(static_cast<std::size_t>(record.credit));
    if (limited) record.credit = std::min(record.credit - static_cast<double>(gone.size()), 1.0);
    if (gone.empty()) continue;
    wake_island(world, *object);
    remove_particles(world, *object, gone);
    world.report.fluid.drained += gone.size();
  }
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

void validate(const Emitter& emitter, std::string_view owner) {
  if (!is_finite(emitter.position) || !is_finite(emitter.direction) ||
      !(length_squared(Vec3d(emitter.direction)) > 1e-12))
    throw Error(fmt::format("{}: its position or direction is not finite, or the direction is zero", owner));
  if (!(emitter.radius >= 0) || !std::isfinite(emitter.radius))
    throw Error(fmt::format("{}: radius is {:g} m, expected a finite number >= 0", owner, emitter.radius));
  if (!(emitter.speed > 0) || !std::isfinite(emitter.speed))
    throw Error(fmt::format("{}: speed is {:g} m/s, expected a finite number > 0", owner, emitter.speed));
  require_times(emitter.start, emitter.end, owner);
}

void validate(const Drain& drain, std::string_view owner) {
  validate(drain.shape, owner);
  validate(drain.pose, owner);
  if (!(drain.rate > 0))
    throw Error(fmt::format("{}: rate is {:g} m^3/s, expected a number > 0", owner, drain.rate));
  require_times(drain.start, drain.end, owner);
}

void require_layer_size(const Emitter& emitter, float spacing, std::string_view owner) {
  const double ratio = static_cast<double>(emitter.radius / spacing);
  if (pi * ratio * ratio > max_layer_particles)
    throw Error(
        fmt::format("{}: radius is {:g} m, {:g} spacings: a layer would have more than {:g} particles", owner,
                    emitter.radius, ratio, max_layer_particles));
}

std::uint64_t layers_before(const WorldState& world, const Object& fluid, const Emitter& emitter) {
  const auto spacing = static_cast<double>(std::get<FluidMaterial>(fluid.material).spacing);
  const double past = world.time - emitter.start;
  return past > 0 ? static_cast<std::uint64_t>(std::ceil(past * static_cast<double>(emitter.speed) / spacing))
                  : 0;
}

void update_flow(WorldState& world, double dt) {
  for (DrainRecord& record : world.flow.drains) drain(world, record, dt);
  for (EmitterRecord& record : world.flow.emitters) emit(world, record);
}

// In a fluid vertex n is particle n.
void set_count(WorldState& world, Object& fluid, std::uint32_t count) {
  const auto& material = std::get<FluidMaterial>(fluid.material);
  const float mass = material.density * material.spacing * material.spacing * material.spacing;
  const std::uint32_t before = fluid.particle_count();
  if (count == before) return;
  Particles& particles = world.particles;
  for (std::uint32_t k = std::min(before, count); k < std::max(before, count); ++k) {
    const std::uint32_t i = fluid.begin + k;
    const bool is_there = k < count;
    particles.position[i] = {0, 0, 0, is_there ? 1 / mass : 0};
    particles.offset[i] = particles.velocity[i] = {};
    particles.mass[i] = is_there ? mass : 0;
    particles.radius[i] = contact_radius(fluid.material);
    particles.contact_margin[i] = 0;
  }
  fluid.rest.resize(count);
  fluid.particle_of.resize(count), fluid.vertex_of.resize(count);
  for (std::uint32_t k = before; k < count; ++k) fluid.particle_of[k] = fluid.vertex_of[k] = k;
  fluid.end = fluid.begin + count;
  world.dirty.counts = true;
}

}  // namespace souple
