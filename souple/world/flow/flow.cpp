#include "souple/world/flow/flow.h"

#include "souple/fluid/covered_points.h"
#include "souple/fluid/emission.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/add.h"
#include "souple/world/contact_state.h"
#include "souple/world/sleeping.h"
#include "souple/world/state.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace souple {
namespace {

void append(WorldState& world, Object& fluid, const Drop& drop) {
  const std::uint32_t i = fluid.end;
  set_count(world, fluid, fluid.particle_count() + 1);
  world.particles.velocity[i].set_xyz(Vec3f(drop.velocity));
  world.set_position(i, drop.position);
}

/// The pressure at an emitter's nozzle beyond that of the depth, over rho v^2, v the emitter's speed: what its jet could
/// resist. But v is at most a half of what substeps resolve, h sqrt(p / rho) = d / 3 (Flag::coarse_substeps), and at least a
/// quarter, as pressures are noisy.
double load_of(WorldState& world, const Emitter& emitter, const FluidMaterial& material, double h) {
  const double density = material.density, spacing = material.spacing, resolved = spacing / (3 * h);
  const Vec3d weight = Vec3d(world.settings.gravity) * density;
  const double speed = std::clamp(static_cast<double>(emitter.speed), resolved / 4, resolved / 2);
  return back_pressure(emitter, world.objects_view(), weight, spacing, world.time) /
         (density * speed * speed);
}

/// A closed vessel is full where the load reaches 1. A vessel that is nearly full has no room for a whole layer, and half a
/// percent more particles than fit never come to rest. So they come one by one from a quarter of that load.
void emit(WorldState& world, EmitterRecord& record, double h) {
  Object& fluid = world.object(ObjectId{record.fluid});
  const auto& material = std::get<FluidMaterial>(fluid.material);
  const auto spacing = static_cast<double>(material.spacing);
  std::vector<Drop> drops;
  constexpr double nearly_full = 0.25;
  double load = 0;
  world.warnings.guarded("an emitter's motion", [&] {
    drops = next_drops(record, Vec3d(world.settings.gravity), spacing, world.time);
    load = load_of(world, record.emitter, material, h);
  });
  record.stalled = !(load < 1);
  std::size_t room = load < nearly_full ? drops.size() : 1;
  if (record.stalled) world.report.fluid.held_back += drops.size();
  if (drops.empty() || record.stalled) return;
  const std::vector<std::uint8_t> blocked = blocked_drops(drops, world.objects_view(), spacing);
  wake_island(world, fluid);
  for (std::size_t k = 0; k < drops.size(); ++k) {
    if (blocked[k] != 0 || room == 0 || fluid.particle_count() == fluid.capacity) {
      ++world.report.fluid.held_back;
    } else {
      --room;
      append(world, fluid, drops[k]);
      ++world.report.fluid.emitted;
    }
  }
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

/// The surface of an object that no fluid belongs inside. Empty for cloth and what has none.
TriangleMesh solid_surface(WorldState& world, const Object& object, float spacing) {
  TriangleMesh surface;
  const KindTraits& kind = object.traits();
  if (kind.shape != ObjectShape::solid && !kind.rigid && !kind.driven) return surface;
  const std::optional<BoundaryMesh> boundary = boundary_mesh_of(object, spacing);
  if (!boundary) return surface;
  surface.triangles = boundary->triangles;
  for (std::size_t v = 0; v < boundary->particles.size(); ++v) {
    Vec3d& x = surface.positions.emplace_back();
    for (std::size_t k = 0; k < 4; ++k)
      x += world.particles.exact_position(boundary->particles[v][k]) *
           static_cast<double>(boundary->weights[v][k]);
  }
  return surface;
}

/// Whether a pin, a tie or a constraint of the user refers to a particle of an object.
bool is_held(WorldState& world, const Object& object) {
  if (!object.pins.empty()) return true;
  const Ties& ties = *world.constraints.ties;
  for (std::size_t k = 0; k < ties.count(); ++k)
    for (const TieEnd* const end : {&ties.tie(k).a, &ties.tie(k).b})
      if (end->object && *end->object == object.id) return true;
  const ParticleView view = world.objects_view().view();
  return std::any_of(world.constraints.users.begin(), world.constraints.users.end(),
                     [&](const UserConstraint& user) {
                       bool any = false, held = false;
                       user.projector->visit(view, [&](const ConstraintState& constraint) {
                         any = true;
                         for (const std::uint32_t i : constraint.particles)
                           held = held || (i >= object.begin && i < object.end);
                       });
                       return held || (!any && user.projector->size() > 0);
                     });
}

/// Removes the grains that are `inside`; the others keep their order.
void remove_grains(WorldState& world, Object& grains, const std::vector<std::uint8_t>& inside) {
  const auto keep = [&](auto& list) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (inside[i] == 0) list[kept++] = list[i];
    list.resize(kept);
  };
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < grains.particle_count(); ++i)
    if (inside[i] == 0) world.particles.copy(grains.begin + i, grains.begin + kept++);
  keep(grains.rest), keep(grains.per_particle.stiffness), keep(grains.per_particle.thickness);
  grains.particle_of.resize(kept), grains.vertex_of.resize(kept);
  const std::uint32_t begin = grains.begin + kept, end = grains.reserved_end();
  grains.end = begin, grains.capacity = kept;
  world.caches->mirrors.erase(grains.id.value);
  erase_particles(world, std::array{IndexRange{begin, end}});
}

/// The points of a fluid or of grains, without those that another object or a collider covers.
class Covered {
 public:
  Covered(WorldState& world, Object& fluid) : world_(world), fluid_(fluid) {
    for (std::uint32_t i = fluid.begin; i < fluid.end; ++i)
      points_.push_back(world.particles.exact_position(i));
  }
  void leave_out(const CoveredPoints& covered, const std::string& by) {
    const std::vector<std::uint8_t>& inside = covered.inside;
    const bool flows = fluid_.traits().flows;
    world_.flow.settles = world_.flow.settles || (flows && covered.crowded);
    std::vector<std::uint32_t> gone;
    std::vector<Vec3d> left;
    for (std::uint32_t i = 0; i < inside.size(); ++i)
      if (inside[i] != 0)
        gone.push_back(i);
      else
        left.push_back(points_[i]);
    if (gone.empty() || (!flows && left.empty())) return;
    wake_island(world_, fluid_);
    if (flows)
      remove_particles(world_, fluid_, gone);
    else
      remove_grains(world_, fluid_, inside);
    world_.contact->invalidate();
    ++world_.version;
    world_.warnings.log_info(fluid_.name, {fmt::format("{} of {} points lie inside {} and were left out",
                                                       gone.size(), points_.size(), by)});
    points_ = std::move(left);
  }
  CoverablePoints points() const { return {points_, width()}; }
  double width() const {
    const auto* const water = std::get_if<FluidMaterial>(&fluid_.material);
    return static_cast<double>(water ? water->spacing : 2 * contact_radius(fluid_.material));
  }
  bool is_new() const { return fluid_.collision.since == world_.steps; }
  bool collides(const std::string& name, const CollisionFilter& filter) const {
    return may_collide(fluid_.collision.filter, filter) && world_.contact->pairs.collide(fluid_.name, name);
  }

 private:
  WorldState& world_;
  Object& fluid_;
  std::vector<Vec3d> points_;
};

void leave_out_covered(WorldState& world, Object& fluid) {
  Covered covered(world, fluid);
  const auto applies = [&](std::uint64_t since, const std::string& name, const CollisionFilter& filter) {
    return (covered.is_new() || since == world.steps) && covered.collides(name, filter);
  };
  for (const ColliderRecord& collider : world.colliders) {
    const ColliderOptions& options = collider.options;
    if (options.sensor ||
        !applies(collider.since, options.name, {options.collision_groups, options.collision_mask}))
      continue;
    world.warnings.guarded("a collider's motion", [&] {
      const Transform pose = options.motion.at(world.time);
      covered.leave_out(covered_points(collider.shape, pose, covered.points()), options.name);
    });
  }
  for (const auto& object : world.objects) {
    if (!applies(object->collision.since, object->name, object->collision.filter)) continue;
    const TriangleMesh surface = solid_surface(world, *object, static_cast<float>(covered.width()));
    if (surface.triangles.empty()) continue;
    // A body is solid whatever its holes. An obstacle is a shell that fluid enters through a hole of some spacings.
    const double widest_hole =
        object->traits().driven ? 3 * covered.width() : std::numeric_limits<double>::infinity();
    covered.leave_out(covered_points(surface, widest_hole, covered.points()), object->name);
  }
}

void drain(WorldState& world, DrainRecord& record, double dt) {
  if (!is_open(record.drain.start, record.drain.end, world.time)) return;
  const bool limited = std::isfinite(record.drain.rate);
  for (const auto& object : world.objects) {
    const auto* material = std::get_if<FluidMaterial>(&object->material);
    if (!material || object->particle_count() == 0) continue;
    const auto d = static_cast<double>(material->spacing);
    if (limited) record.credit += static_cast<double>(record.drain.rate) * dt / (d * d * d);
    std::vector<std::uint32_t> gone =
        particles_in(record.drain, *object, world.objects_view(), *world.threads);
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

void leave_out_covered(WorldState& world) {
  const auto is_new = [&](std::uint64_t since) { return since == world.steps; };
  const bool any_new = std::any_of(world.colliders.begin(), world.colliders.end(),
                                   [&](const ColliderRecord& collider) { return is_new(collider.since); }) ||
                       std::any_of(world.objects.begin(), world.objects.end(),
                                   [&](const auto& object) { return is_new(object->collision.since); });
  if (!any_new) return;
  for (const auto& object : world.objects)
    if (object->traits().flows && object->particle_count() > 0) leave_out_covered(world, *object);
}

void leave_out_covered_now(WorldState& world) {
  leave_out_covered(world);
  for (const auto& object : world.objects)
    if (object->traits().rolls && !is_held(world, *object)) leave_out_covered(world, *object);
  constexpr std::uint64_t long_ago = ~std::uint64_t{0};
  for (ColliderRecord& collider : world.colliders) collider.since = long_ago;
  for (const auto& object : world.objects) object->collision.since = long_ago;
}

void update_flow(WorldState& world, double dt) {
  leave_out_covered(world);
  for (DrainRecord& record : world.flow.drains) drain(world, record, dt);
  for (EmitterRecord& record : world.flow.emitters) emit(world, record, dt / world.settings.substeps);
  world.current.settles = world.flow.settles;
}

void end_flow(WorldState& world) {
  world.flow.settles = world.current.settles;
  if (!world.flow.emitters.empty()) world.fluids->store_pressures(world.particles.velocity);
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
