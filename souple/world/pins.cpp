#include "souple/constraints/attachment.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/tether.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/close_holes.h"
#include "souple/math/limits.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/object.h"
#include "souple/queries/select.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"
#include "souple/stages/user_constraint.h"
#include "souple/world/add.h"
#include "souple/world/call_scope.h"
#include "souple/world/impl.h"
#include "souple/world/registry.h"
#include "souple/world/sleeping.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <fmt/core.h>

// Pins, and the constraints that users add between vertices.

namespace souple {
namespace {

/// The particles of the chosen vertices, each once, with one of these vertices.
std::vector<std::pair<std::uint32_t, std::uint32_t>> particles_with_vertices(
    const Object& object, const std::vector<std::uint32_t>& vertices) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (const std::uint32_t vertex : vertices)
    for (const std::uint32_t particle : particles_of(object, {vertex})) result.emplace_back(particle, vertex);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end(), [](auto a, auto b) { return a.first == b.first; }),
               result.end());
  return result;
}

void set_inverse_mass(WorldState& world, const Object& object, std::uint32_t particle, bool pinned) {
  const std::uint32_t i = object.begin + particle;
  world.particles.position[i].w = pinned ? 0 : 1 / world.particles.mass[i];
  world.dirty.masses = true;
  if (pinned) world.particles.velocity[i] = {};
  if (pinned && object.traits().rolls) world.particles.spin[i] = {};
}

void require_compliance(float compliance, const char* what) {
  if (!(compliance >= 0) || !std::isfinite(compliance))
    throw Error(fmt::format("{}: the compliance is {} m/N, expected a finite number >= 0", what, compliance));
}

}  // namespace

std::vector<std::uint32_t> particles_of(const Object& object, const std::vector<std::uint32_t>& vertices) {
  std::vector<std::uint32_t> result;
  for (const std::uint32_t vertex : vertices) {
    if (object.embedding) {
      const Tet& tet = object.embedding->vertices[vertex];
      result.insert(result.end(), tet.begin(), tet.end());
    } else {
      result.push_back(object.particle_of[vertex]);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<std::uint32_t> World::select(ObjectId id, const Selector& selector) const {
  return select_vertices(state().object(id), positions(id), selector);
}

void World::pin(ObjectId id, const Selector& selector, Target target) {
  WorldState& world = state();
  const CallScope call(*world.calls, "pin", From::stages);
  Object& object = world.object(id);
  require_movable(object, "pin");
  require_permanent_particles(object, "pin");
  if (object.traits().rigid)
    throw Error("pin: " + object.name + " is a rigid body, whose vertices do not move alone; use attach");
  const std::vector<std::uint32_t> chosen = select(id, selector);
  wake_island(world, object);
  const auto shared = target ? std::make_shared<const Target>(std::move(target)) : nullptr;
  for (const auto& [particle, vertex] : particles_with_vertices(object, chosen)) {
    PinnedParticle pin{particle, vertex, {}, shared, world.particles.exact_position(object.begin + particle),
                       {},       {}};
    if (object.embedding)
      pin.offset = world.particles.exact_position(object.begin + particle) - Vec3d(positions(id)[vertex]);
    const auto position =
        std::lower_bound(object.pins.begin(), object.pins.end(), particle,
                         [](const PinnedParticle& p, std::uint32_t i) { return p.particle < i; });
    if (position != object.pins.end() && position->particle == particle) {
      *position = pin;
    } else {
      object.pins.insert(position, pin);
    }
    set_inverse_mass(world, object, particle, true);
  }
}

void World::unpin(ObjectId id, const Selector& selector) {
  WorldState& world = state();
  const CallScope call(*world.calls, "unpin", From::stages);
  Object& object = world.object(id);
  require_movable(object, "unpin");
  const std::vector<std::uint32_t> freed = particles_of(object, select(id, selector));
  wake_island(world, object);
  const auto is_freed = [&](const PinnedParticle& pin) {
    return std::binary_search(freed.begin(), freed.end(), pin.particle);
  };
  for (const PinnedParticle& pin : object.pins)
    if (is_freed(pin)) set_inverse_mass(world, object, pin.particle, false);
  object.pins.erase(std::remove_if(object.pins.begin(), object.pins.end(), is_freed), object.pins.end());
}

std::vector<std::uint32_t> World::pinned(ObjectId id) const {
  std::vector<std::uint32_t> result;
  for (const PinnedParticle& pin : state().object(id).pins) result.push_back(pin.vertex);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

ProjectorId World::attach(ObjectId id, const Selector& selector, Target target, float compliance) {
  WorldState& world = state();
  const CallScope call(*world.calls, "attach");
  require_compliance(compliance, "attach");
  const Object& object = world.object(id);
  require_movable(object, "attach");
  require_permanent_particles(object, "attach");
  const std::vector<std::uint32_t> chosen = select(id, selector);
  auto projector = std::make_unique<SetProjector<Attachment>>();
  UserConstraint user_constraint;
  user_constraint.target = std::move(target);
  for (const auto& [particle, vertex] : particles_with_vertices(object, chosen)) {
    const Vec3d x = world.particles.exact_position(object.begin + particle);
    projector->add({object.begin + particle}, {Vec3f(x)}, {compliance});
    user_constraint.attached_vertices.push_back(
        {vertex, object.embedding ? x - Vec3d(positions(id)[vertex]) : Vec3d{}});
  }
  user_constraint.attachment = projector.get();
  wake_island(world, object);
  return world.add_user_constraint(std::move(user_constraint), std::move(projector));
}

ProjectorId World::connect(std::span<const std::pair<VertexRef, VertexRef>> pairs, float rest_length,
                           float compliance, std::optional<double> until) {
  WorldState& world = state();
  const CallScope call(*world.calls, "connect");
  require_compliance(compliance, "connect");
  if (until && !(std::isfinite(*until) && *until >= 0))
    throw Error(fmt::format("connect: until is {} s, expected a finite time >= 0", *until));
  if (!(std::abs(static_cast<double>(rest_length)) <= range::coordinate))
    throw Error(fmt::format("connect: rest_length is {} m, expected a finite number of at most {:g} m",
                            rest_length, range::coordinate));
  if (pairs.empty()) throw Error("connect: there are no pairs");
  auto projector = std::make_unique<SetProjector<Distance>>();
  for (const auto& [a, b] : pairs) {
    require_permanent_particles(world.object(a.object), "connect");
    require_permanent_particles(world.object(b.object), "connect");
    const std::uint32_t i = particle(a.object, a.vertex), j = particle(b.object, b.vertex);
    if (i == j) throw Error("connect: a vertex of " + name(a.object) + " is connected to itself");
    const double now = length(world.particles.exact_position(i) - world.particles.exact_position(j));
    projector->add({i, j}, {rest_length < 0 ? static_cast<float>(now) : rest_length}, {compliance});
  }
  for (const auto& [a, b] : pairs)
    wake_island(world, world.object(a.object)), wake_island(world, world.object(b.object));
  UserConstraint user_constraint;
  user_constraint.distance_joint = projector.get();
  user_constraint.until = until;
  return world.add_user_constraint(std::move(user_constraint), std::move(projector));
}

namespace {

/// Rest distance along edges from each particle of an object to the nearest of `sources`, and that source
/// (Dijkstra).
struct EdgeDistances {
  std::vector<double> distance;
  std::vector<std::uint32_t> source;
};

EdgeDistances edge_distances_from(const Object& object, const std::vector<PinnedParticle>& sources) {
  const std::size_t count = object.particle_count();
  std::vector<std::vector<std::uint32_t>> neighbors(count);
  const auto add_edge = [&](std::uint32_t a, std::uint32_t b) {
    neighbors[a].push_back(b);
    neighbors[b].push_back(a);
  };
  for (const Edge& edge : unique_edges(object.surface)) add_edge(edge[0], edge[1]);
  for (const Edge& edge : unique_edges(object.tets.tets)) add_edge(edge[0], edge[1]);
  for (const Edge& edge : edges_of_line(object)) add_edge(edge[0], edge[1]);

  EdgeDistances edge_distances{std::vector<double>(count, std::numeric_limits<double>::infinity()),
                               std::vector<std::uint32_t>(count)};
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const PinnedParticle& pin : sources) {
    edge_distances.distance[pin.particle] = 0;
    edge_distances.source[pin.particle] = pin.particle;
    queue.emplace(0.0, pin.particle);
  }
  while (!queue.empty()) {
    const auto [distance, i] = queue.top();
    queue.pop();
    if (distance > edge_distances.distance[i]) continue;
    for (const std::uint32_t j : neighbors[i]) {
      const double along = distance + length(object.rest[i] - object.rest[j]);
      if (!(along < edge_distances.distance[j])) continue;
      edge_distances.distance[j] = along;
      edge_distances.source[j] = edge_distances.source[i];
      queue.emplace(along, j);
    }
  }
  return edge_distances;
}

}  // namespace

ProjectorId World::add_tethers(ObjectId id, float slack) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_tethers");
  const Object& object = world.object(id);
  require_movable(object, "add_tethers");
  if (object.pins.empty())
    throw Error("add_tethers: " + object.name + " has no pinned vertex; pin some first");
  if (!(slack >= 0) || !std::isfinite(slack))
    throw Error(fmt::format("add_tethers: the slack is {}, expected a finite number >= 0", slack));
  const EdgeDistances edge_distances = edge_distances_from(object, object.pins);
  auto projector = std::make_unique<SetProjector<Tether>>();
  for (std::uint32_t i = 0; i < object.particle_count(); ++i) {
    if (!(edge_distances.distance[i] > 0) || !std::isfinite(edge_distances.distance[i])) continue;
    projector->add({object.begin + i, object.begin + edge_distances.source[i]},
                   {static_cast<float>(edge_distances.distance[i] * (1 + static_cast<double>(slack)))});
  }
  wake_island(world, object);
  return world.add_user_constraint({}, std::move(projector));
}

ProjectorId World::add_projector(std::unique_ptr<Projector> projector) {
  WorldState& world = state();
  const CallScope call(*world.calls, "add_projector");
  if (!projector) throw Error("add_projector: the projector is null");
  projector->prepare(world.particles.size());
  UserConstraint user_constraint;
  user_constraint.is_custom = true;
  wake_particles_of(world, *projector);
  return world.add_user_constraint(std::move(user_constraint), std::move(projector));
}

ProjectorId WorldState::add_user_constraint(UserConstraint user_constraint,
                                            std::unique_ptr<Projector> projector) {
  user_constraint.id = {registry->next_id++};
  user_constraint.projector = std::move(projector);
  dirty.tables = dirty.tables || user_constraint.distance_joint;  // contacts exclude joined particles
  dirty.solver = true;
  constraints.users.push_back(std::move(user_constraint));
  return constraints.users.back().id;
}

namespace {

std::size_t find_user_constraint(const WorldState& world, ProjectorId id) {
  for (std::size_t k = 0; k < world.constraints.users.size(); ++k)
    if (world.constraints.users[k].id.value == id.value) return k;
  throw_stale("projector", id.value);
}

}  // namespace

void World::remove(ProjectorId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "remove(ProjectorId)");
  const std::size_t found = find_user_constraint(world, id);
  world.dirty.tables = world.dirty.tables || world.constraints.users[found].distance_joint;
  world.dirty.solver = true;
  wake_particles_of(world, *world.constraints.users[found].projector);
  world.constraints.users.erase(world.constraints.users.begin() + static_cast<std::ptrdiff_t>(found));
}

Projector& World::projector(ProjectorId id) {
  WorldState& world = state();
  const CallScope call(*world.calls, "projector");
  Projector& found = *world.constraints.users[find_user_constraint(world, id)].projector;
  world.dirty.solver = true;  // the caller may change it
  wake_particles_of(world, found);
  return found;
}

namespace {

/// A cloth that encloses gas. Logs which holes are closed for it.
Object& closed_cloth(WorldState& world, ObjectId id, const char* what) {
  const CallScope call(*world.calls, what);
  Object& object = world.object(id);
  if (object.kind != ObjectKind::cloth)
    throw Error(std::string(what) + ": " + object.name + " is a " + std::string(kind_name(object.kind)) +
                ", expected a closed cloth");
  if (object.gas.pressure == 0 && !object.gas.volume)
    world.warnings.log_info(object.name,
                            closed_surface(object.mesh, std::string(what) + ": " + object.name).sentences());
  return object;
}

}  // namespace

void World::set_pressure(ObjectId id, float pascals) {
  if (!std::isfinite(pascals)) throw Error("set_pressure: the pressure is not finite");
  Object& object = closed_cloth(state(), id, "set_pressure");
  wake_island(state(), object);
  object.gas.pressure = pascals;
  state().dirty.groups = true;
}

void World::set_enclosed_volume(ObjectId id, float factor, float compliance) {
  if (!(factor > 0) || !std::isfinite(factor))
    throw Error(
        fmt::format("set_enclosed_volume: the factor is {}, expected a finite number above 0", factor));
  require_compliance(compliance, "set_enclosed_volume");
  Object& object = closed_cloth(state(), id, "set_enclosed_volume");
  wake_island(state(), object);
  object.gas.volume = {factor, compliance};
  state().dirty.groups = true;
}

}  // namespace souple
