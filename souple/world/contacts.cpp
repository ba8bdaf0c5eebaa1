#include "souple/world/contacts.h"

#include "souple/constraints/distance.h"
#include "souple/geometry/measures.h"
#include "souple/objects/object.h"
#include "souple/solver/set_projector.h"
#include "souple/world/body_restitution.h"
#include "souple/world/caches.h"
#include "souple/world/collider_record.h"
#include "souple/world/contact_state.h"
#include "souple/world/fluid_stage.h"
#include "souple/world/impl.h"
#include "souple/world/obstacles.h"
#include "souple/world/sleeping.h"
#include "souple/world/stages.h"
#include "souple/world/user_constraint.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

// Balls collide with balls as particles; all other pairs collide as surfaces.
ContactObject contact_object(const Object& object) {
  constexpr std::uint32_t balls = 1;
  ContactObject result{.begin = object.begin, .end = object.end, .groups = 0};
  result.self_collision = result.rolls = object.kind == ObjectKind::grains;
  result.collides_with_colliders = object.kind != ObjectKind::fluid;  // see fluid/stage/fluids.h
  if (is_particle_only(object) && object.kind != ObjectKind::fluid) result.groups = result.mask = balls;
  return result;
}

// R of ContactStep::depenetration_speed [m]: of grains, which are bodies of their own, the radius of a grain; of others
// two thirds of that of the ball around the center that holds all rest positions (3 m/s for a sheet of 1 m).
float radius_at_rest(const WorldState& world, const Object& object) {
  float radius = 0;
  if (object.kind == ObjectKind::grains) {
    for (std::uint32_t i = object.begin; i < object.end; ++i) radius = max(radius, world.particles.radius[i]);
    return radius;
  }
  Vec3d center;
  for (const Vec3d& x : object.rest) center += x * (1 / static_cast<double>(object.rest.size()));
  double square = 0;
  for (const Vec3d& x : object.rest) square = max(square, length_squared(x - center));
  return static_cast<float>(2 * std::sqrt(square) / 3);
}

std::vector<Edge> edges_of_rope(const Object& object) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; object.kind == ObjectKind::rope && i + 1 < object.particle_count(); ++i)
    edges.push_back({i, i + 1});
  return edges;
}

ContactSurface contact_surface(const WorldState& world, std::uint32_t index, float radius) {
  const Object& object = *world.objects[index];
  const ContactMaterialTable& matrix = world.contact->tables.against_objects;
  ContactSurface result{
      .begin = object.begin,
      .end = object.end,
      .reserved_end = object.reserved_end(),
      .triangles = object.surface,
      .edges = world.contact->tables.rope_edges[index],
      .particles_only = is_particle_only(object),
      .self_collision = object.self_collision && !is_particle_only(object) && matrix.collide(index, index),
      .groups = object.filter.groups,
      .mask = object.filter.mask,
      .immovable = object.kind == ObjectKind::obstacle,
      .layer = object.layer,
      .rest = object.rest,
      .rolls = object.kind == ObjectKind::grains,
      .radius = radius};
  matrix.for_each_ignored(index, [&](std::uint32_t other) {
    if (other != index) result.ignored_surfaces.push_back(other);
  });
  return result;
}

// Bodies with an embedded surface have no elements: their particles collide instead.
void append_elements(const Object& object, std::uint32_t index, std::span<const Edge> rope_edges,
                     std::vector<ContactElement>& elements) {
  if (object.kind == ObjectKind::obstacle || is_particle_only(object)) return;
  const std::uint32_t b = object.begin;
  const auto append = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    const double radius = enclosing_radius(object.rest[p], object.rest[q], object.rest[r]);
    elements.push_back({{b + p, b + q, b + r}, index, static_cast<float>(radius)});
  };
  for (const Triangle& t : object.surface) append(t[0], t[1], t[2]);
  for (const Edge& edge : rope_edges) append(edge[0], edge[1], edge[1]);
}

std::vector<std::array<std::uint32_t, 2>> joined_particles(const WorldState& world) {
  std::vector<std::array<std::uint32_t, 2>> joined;
  for (const UserConstraint& user_constraint : world.constraints.users)
    for (std::size_t i = 0; user_constraint.distance_joint && user_constraint.is_active &&
                            i < user_constraint.distance_joint->size();
         ++i)
      joined.push_back(user_constraint.distance_joint->set().indices(i));
  return joined;
}

// Reads world.contact->tables. Elements concern solid colliders only.
ContactGeometry contact_geometry(const WorldState& world, std::span<const NamedContactMaterial> materials) {
  const ContactTables& tables = world.contact->tables;
  ContactGeometry geometry;
  geometry.joined = joined_particles(world);
  const bool any_solid = std::any_of(tables.colliders.begin(), tables.colliders.end(), [](const Collider& c) {
    return !std::holds_alternative<Plane>(c.shape);
  });
  for (std::uint32_t a = 0; a < world.objects.size(); ++a) {
    geometry.surfaces.push_back(contact_surface(world, a, materials[a].radius));
    if (any_solid) append_elements(*world.objects[a], a, tables.rope_edges[a], geometry.elements);
  }
  return geometry;
}

ContactMaterial contact_material_of(const Material& material) {
  // Fluids have viscous friction, not Coulomb friction.
  if (const auto* fluid = std::get_if<FluidMaterial>(&material))
    return {.friction = 0, .restitution = fluid->restitution};
  // Particles of soft bodies do not bounce alone, see body_restitution.h.
  if (const auto* soft = std::get_if<SoftBodyMaterial>(&material))
    return {.friction = soft->friction,
            .kinetic_friction = soft->kinetic_friction,
            .restitution = soft->restitution > elastic_restitution ? soft->restitution : 0};
  return std::visit(
      [](const auto& m) {
        ContactMaterial result{.friction = m.friction, .restitution = m.restitution};
        if constexpr (requires { m.kinetic_friction; }) result.kinetic_friction = m.kinetic_friction;
        if constexpr (requires { m.rolling_friction; }) result.rolling_friction = m.rolling_friction;
        return result;
      },
      material);
}

void append_event(const WorldState& world, const ContactPush& push, std::vector<ContactEvent>& events) {
  if (!std::isfinite(push.impulse)) return;  // pinned since
  const Object& object = *world.objects[world.object_of[push.particle]];
  ContactEvent event;
  event.object = object.name, event.object_id = object.id;
  event.vertex = object.vertex_of[push.particle - object.begin];
  event.other_is_collider = push.against_collider;
  if (push.against_collider) {
    event.other = world.colliders[push.other].options.name;
    event.collider_id = world.colliders[push.other].id;
  } else {
    const Object& other = *world.objects[world.object_of[push.other]];
    event.other = other.name, event.other_id = other.id;
    event.other_vertex = other.vertex_of[push.other - other.begin];
  }
  event.point = push.point;
  event.normal = push.normal;
  event.impulse = push.impulse;
  events.push_back(event);
}

}  // namespace

ContactMaterial contact_material_of(const ColliderOptions& options) {
  return {.friction = options.friction,
          .kinetic_friction = options.kinetic_friction,
          .restitution = options.restitution};
}

bool is_particle_only(const Object& object) {
  return object.surface.empty() && object.kind != ObjectKind::rope;
}

void build_contact_tables(WorldState& world) {
  world.contact->invalidate();
  ContactTables& tables = world.contact->tables;
  world.sleep->proximity.invalidate();
  tables.objects.clear();
  tables.colliders.clear();
  std::vector<NamedContactMaterial> object_materials, collider_materials;
  for (const auto& object : world.objects) {
    tables.objects.push_back(contact_object(*object));
    object_materials.push_back({object->name, contact_material_of(object->material), object->filter,
                                radius_at_rest(world, *object)});
  }
  for (const ColliderRecord& record : world.colliders) {
    const ContactMaterial material = contact_material_of(record.options);
    tables.colliders.push_back(
        {record.options.name, record.shape, record.options.motion, material, !record.options.sensor});
    collider_materials.push_back(
        {record.options.name, material, {record.options.collision_groups, record.options.collision_mask}});
  }
  tables.against_colliders = ContactMaterialTable(object_materials, collider_materials, world.contact->pairs);
  tables.against_objects = ContactMaterialTable(object_materials, object_materials, world.contact->pairs);
  tables.rope_edges.clear();
  for (const auto& object : world.objects) tables.rope_edges.push_back(edges_of_rope(*object));
  world.contact->contacts.build(contact_geometry(world, object_materials));
  world.contact->check_intersections = world.dirty.counts = true;
  build_fluids(world);
}

void update_fluid_counts(WorldState& world) {
  if (!world.dirty.counts) return;
  for (std::size_t a = 0; a < world.objects.size(); ++a) {
    const Object& object = *world.objects[a];
    if (object.kind != ObjectKind::fluid) continue;
    world.contact->tables.objects[a].end = object.end;
    world.contact->contacts.set_end(a, object.end);
  }
  world.sleep->proximity.invalidate();
  world.dirty.counts = false;
}

namespace {

// Contacts preserve a state without intersections. So intersections arise only when objects are placed, or
// from motion that contacts cannot stop: pinned vertices and driven obstacles that pass through each other.
// For the latter a check every few steps is early enough.
bool may_intersect(const WorldState& world) {
  constexpr std::uint64_t interval = 8;  // steps
  if (world.contact->check_intersections) return true;
  if (world.steps % interval != 0) return false;
  bool driven = false, pinned = false;
  for (const auto& object : world.objects) {
    driven = driven || (object->kind == ObjectKind::obstacle && !is_static(object->motion));
    for (const PinnedParticle& pin : object->pins)
      driven = driven || pin.target || pin.arrival, pinned = true;
  }
  return driven && pinned;
}

void report_intersections(WorldState& world) {
  std::string words;
  std::size_t described = 0;
  for (const IntersectingPair& pair : world.contact->contacts.intersecting_pairs()) {
    world.report.intersections += pair.edges;
    if (++described > 3) continue;
    const std::string& one = world.objects[pair.edge_surface]->name;
    const std::string& other = world.objects[pair.surface]->name;
    const bool itself = pair.edge_surface == pair.surface;
    words += fmt::format("{} {} of '{}' {} through {}{}; ", pair.edges, pair.edges == 1 ? "edge" : "edges",
                         one, pair.edges == 1 ? "passes" : "pass",
                         itself ? "its own triangles" : fmt::format("triangles of '{}'", other),
                         pair.immovable ? ", where nothing can move" : "");
  }
  if (world.report.intersections > 0)
    world.warnings.warn(Flag::intersecting, words + std::string(advice(Flag::intersecting)));
}

}  // namespace

void find_candidates(WorldState& world, double dt) {
  const ContactStep step{.time = world.time,
                         .dt = static_cast<float>(dt),
                         .gravity = length(world.settings.gravity),
                         .h = static_cast<float>(dt / world.settings.substeps),
                         .detection = world.settings.detection,
                         .segment_test = world.settings.segment_test,
                         .turn = world.particles.turn};
  ContactTables& tables = world.contact->tables;
  Particles& particles = world.particles;
  predict_obstacles(world, dt);
  wake_disturbed(world, dt);
  particles.start = world.settings.form == Form::plain ? particles.position : particles.offset;
  const ParticleView view = world.view();
  for (std::size_t a = 0; a < tables.objects.size(); ++a)
    tables.objects[a].moves = world.objects[a]->island == 0;
  const ContactInput input{
      view, particles.velocity, particles.radius, particles.element_radius, particles.contact_margin, tables,
      step};
  world.warnings.guarded("a collider's motion", [&] {
    const bool search_intersections = may_intersect(world);
    world.contact->check_intersections = false;
    world.contact->contacts.begin_step(input, search_intersections, *world.threads);
  });
  world.report.layer_violations = world.contact->contacts.layer_violations();
  report_intersections(world);
}

void generate_contacts(WorldState& world, const Substep& substep) {
  if (world.sleep->all) return;
  world.warnings.guarded("a collider's motion", [&] {
    world.contact->contacts.refresh(world.view(), substep, world.time, *world.threads);
  });
}

void keep_apart(WorldState& world, const Substep& substep) {
  world.report.kept_apart += world.contact->contacts.after_solve(world.view(), substep, *world.threads);
}

void apply_restitution(WorldState& world, const Substep& substep) {
  restitute_bodies(world, substep);
  world.contact->contacts.apply_restitution(world.view(), world.particles.velocity, substep, *world.threads);
}

void report_contacts(WorldState& world) {
  const ContactReport report = world.contact->contacts.report();
  world.report.contacts = report.count;
  world.report.deepest_contact = static_cast<double>(report.deepest);
}

std::span<const ContactEvent> World::contacts() const {
  WorldState& world = impl_->state;
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  if (world.contact->events_valid) return world.contact->events;
  world.contact->events.clear();
  if (!world.contact->valid && !world.current.running) return world.contact->events;
  world.contact->events_valid = !world.current.running;
  std::vector<ContactPush> pushes;
  world.contact->contacts.events(world.view(), pushes);
  for (const ContactPush& push : pushes) append_event(world, push, world.contact->events);
  return world.contact->events;
}

}  // namespace souple
