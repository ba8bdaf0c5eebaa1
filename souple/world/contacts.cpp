#include "souple/world/contacts.h"

#include "souple/constraints/distance.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/kind_traits.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/queries/caches.h"
#include "souple/solver/set_projector.h"
#include "souple/stages/body_restitution.h"
#include "souple/stages/obstacles.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/stage_view.h"
#include "souple/stages/ties.h"
#include "souple/stages/user_constraint.h"
#include "souple/studies/segment_triangle/choice.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/sleeping.h"
#include "souple/world/stages.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace souple {
namespace {

/// Calls f(particle) for the particles of a tie's side; a rigid body is its first one.
template <class Function>
void for_each_tied(const WorldState& world, const TieEnd& end, const Function& f) {
  if (!end.object) return;
  const std::uint32_t begin = world.object(*end.object).begin;
  if (end.kind == TieEnd::Kind::body) f(begin);
  for (const TieEnd::Part& part : end.parts)
    if (end.kind == TieEnd::Kind::particles && part.weight != 0) f(begin + part.particle);
}

/// Two points that are tied together have no room for a contact, which would pull at the tie.
void append_tied(const WorldState& world, std::vector<Edge>& joined) {
  const Ties& ties = *world.constraints.ties;
  for (std::size_t k = 0; k < ties.count(); ++k) {
    const Tie& tie = ties.tie(k);
    if (ties.state(k).broken != 0 || tie.rest_length > 0 || !tie.chain.empty()) continue;
    for_each_tied(world, tie.a, [&](std::uint32_t i) {
      for_each_tied(world, tie.b, [&](std::uint32_t j) { joined.push_back({i, j}); });
    });
  }
}

ParticlePairs joined_particles(const WorldState& world) {
  std::vector<Edge> joined, bodies;
  append_tied(world, joined);
  for (const UserConstraint& user_constraint : world.constraints.users)
    for (std::size_t i = 0; user_constraint.distance_joint && user_constraint.is_active &&
                            i < user_constraint.distance_joint->size();
         ++i)
      joined.push_back(user_constraint.distance_joint->set().indices(i));
  for (const auto& object : world.objects)
    if (!joined.empty() && world.rigid->definition(object->id.value))
      bodies.push_back({object->begin, object->end});
  return ParticlePairs(std::move(joined), std::move(bodies));
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
    geometry.surfaces.push_back(contact_surface(*world.objects[a], a, tables.rope_edges[a],
                                                materials[a].radius, tables.against_objects));
    if (const RigidDefinition* const body = world.rigid->definition(world.objects[a]->id.value))
      geometry.surfaces.back().round = round_shape_of(*body, world.objects[a]->surface);
    if (any_solid) append_elements(*world.objects[a], a, tables.rope_edges[a], geometry.elements);
  }
  return geometry;
}

/// Objects that are asleep and obstacles without a motion stay where they are, unless something changed since the last step.
void find_still(WorldState& world) {
  const bool unchanged = world.version == world.current.version_after;
  for (const auto& object : world.objects)
    object->sleep.still =
        unchanged && (object->sleep.island != 0 || (object->traits().driven && is_static(object->motion)));
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

void build_contact_tables(WorldState& world) {
  world.contact->invalidate();
  ContactTables& tables = world.contact->tables;
  world.scratch->sleep->proximity.invalidate();
  tables.objects.clear();
  tables.colliders.clear();
  std::vector<NamedContactMaterial> object_materials, collider_materials;
  std::vector<ColliderId> ids;
  for (const auto& object : world.objects) {
    tables.objects.push_back(contact_object(*object));
    object_materials.push_back({object->name, contact_material_of(object->material), object->collision.filter,
                                radius_at_rest(*object, world.particles.radius)});
  }
  for (const ColliderRecord& record : world.colliders) {
    const ContactMaterial material = contact_material_of(record.options);
    ids.push_back(record.id);
    tables.colliders.push_back(
        {record.options.name, record.shape, record.options.motion, material, !record.options.sensor});
    collider_materials.push_back(
        {record.options.name, material, {record.options.collision_groups, record.options.collision_mask}});
  }
  world.rigid->set_colliders(std::move(ids));
  tables.against_colliders = ContactMaterialTable(object_materials, collider_materials, world.contact->pairs);
  tables.against_objects = ContactMaterialTable(object_materials, object_materials, world.contact->pairs);
  tables.rope_edges.clear();
  for (const auto& object : world.objects) tables.rope_edges.push_back(edges_of_line(*object));
  world.contact->contacts.build(contact_geometry(world, object_materials));
  world.contact->check_intersections = world.dirty.counts = true;
  build_fluids(world);
}

void update_fluid_counts(WorldState& world) {
  if (!world.dirty.counts) return;
  for (std::size_t a = 0; a < world.objects.size(); ++a) {
    const Object& object = *world.objects[a];
    if (!object.traits().flows) continue;
    world.contact->tables.objects[a].end = object.end;
    world.contact->contacts.set_end(a, object.end);
  }
  world.scratch->sleep->proximity.invalidate();
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
    driven = driven || object->motion.kinematic || (object->traits().driven && !is_static(object->motion));
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

/// The search of a step for contacts that may come.
void begin_contacts(WorldState& world, double dt) {
  const ContactStep step{.time = world.time,
                         .dt = static_cast<float>(dt),
                         .gravity = length(world.settings.gravity),
                         .h = static_cast<float>(dt / world.settings.substeps),
                         .detection = world.settings.detection,
                         .crossing_test = &crossing_test_of(world.settings.segment_test),
                         .placed = world.contact->check_intersections,
                         .turn = world.particles.turn};
  ContactTables& tables = world.contact->tables;
  Particles& particles = world.particles;
  particles.start = particles.offset;
  const ParticleView view = world.view();
  for (std::size_t a = 0; a < tables.objects.size(); ++a)
    tables.objects[a].moves = world.objects[a]->sleep.island == 0,
    tables.objects[a].still = world.objects[a]->sleep.still;
  const ContactInput input{
      view, particles.velocity, particles.radius, particles.element_radius, particles.contact_margin, tables,
      step};
  world.rigid->begin_step(world.stage_view(), tables, dt);
  world.warnings.guarded("a collider's motion", [&] {
    const bool search_intersections = may_intersect(world);
    world.contact->check_intersections = false;
    world.contact->contacts.begin_step(input, search_intersections, *world.threads);
  });
}

/// Whether all objects are asleep, but for obstacles without a motion.
bool all_rest(const WorldState& world) {
  return std::all_of(world.objects.begin(), world.objects.end(), [](const auto& object) {
    return object->sleep.island != 0 || (object->traits().driven && is_static(object->motion));
  });
}

}  // namespace

void find_candidates(WorldState& world, double dt) {
  SleepScratch& sleep = *world.scratch->sleep;
  const bool rested = sleep.rests() && world.version == world.current.version_after;
  find_still(world);
  if (!rested) {
    predict_obstacles(world.stage_view(), dt);
    world.rigid->aim(world.stage_view(), dt);
  }
  wake_disturbed(world, dt);
  sleep.idle = all_rest(world);
  if (!rested || !sleep.rests()) begin_contacts(world, dt);
  world.report.layer_violations = world.contact->contacts.layer_violations();
  report_intersections(world);
}

void generate_contacts(WorldState& world, const Substep& substep) {
  if (world.scratch->sleep->all) return;
  const StageView stage = world.stage_view();
  world.rigid->split_masses(stage);
  world.warnings.guarded("a collider's motion", [&] {
    world.contact->contacts.refresh(world.view(), substep, world.time, *world.threads);
  });
  if (!world.rigid->empty() && world.rigid->count_touched(stage, world.constraints.order))
    world.contact->contacts.update_masses(world.view());
}

void keep_apart(WorldState& world, const Substep& substep) {
  world.report.kept_apart += world.contact->contacts.after_solve(world.view(), substep, *world.threads);
}

void apply_restitution(WorldState& world, const Substep& substep) {
  const StageView stage = world.stage_view();
  world.rigid->split_masses(stage);
  restitute_bodies(world.objects_view(), world.contact->contacts, length(world.settings.gravity), substep,
                   world.scratch->impacts);
  world.contact->contacts.apply_restitution(world.view(), world.particles.velocity, substep, *world.threads);
  world.rigid->gather_velocities(stage);
}

void report_contacts(WorldState& world) {
  const ContactReport report = world.contact->contacts.report();
  world.report.contacts = report.count + world.rigid->push_count();
  world.report.deepest_contact = max(static_cast<double>(report.deepest), world.rigid->deepest());
  const ShortenedMotion shortened = world.contact->contacts.shortened();
  if (shortened.speed > 0 && shortened.limit == 0)
    world.warnings.warn(
        Flag::shortened_motion,
        fmt::format(
            "'{}' is driven at {:.3g} m/s into something that cannot give way, so it was held back: drive it "
            "slower, or to another place",
            world.objects[shortened.object]->name, shortened.speed));
  else if (shortened.speed > 0)
    world.warnings.warn(
        Flag::shortened_motion,
        fmt::format(
            "'{}' moves at {:.3g} m/s, too far in a substep for its contacts to be found, so its motion was "
            "shortened to {:.3g} m/s: lower its speed, or raise substeps",
            world.objects[shortened.object]->name, shortened.speed, shortened.limit));
}

std::span<const ContactEvent> World::contacts() const {
  WorldState& world = state();
  require_readable(*world.calls, "contacts");
  const std::lock_guard<std::mutex> lock(world.caches->lock);
  if (world.contact->events_valid) return world.contact->events;
  world.contact->events.clear();
  if (!world.contact->valid && !world.current.running) return world.contact->events;
  std::vector<ContactPush> pushes;
  world.contact->contacts.events(world.view(), pushes);
  world.rigid->append_pushes(world.stage_view(), true, pushes);
  for (const ContactPush& push : pushes) append_event(world, push, world.contact->events);
  world.contact->events_valid = !world.current.running;
  return world.contact->events;
}

}  // namespace souple
