#include "souple/fluid/stage/fluid_foam.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/math/fnv1a.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/world/arrivals.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/flow.h"
#include "souple/world/impl.h"
#include "souple/world/recover.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cstring>

// Layout of a snapshot:
// - magic number, shape (a hash of the objects), time, steps, size of the contacts' state, foam count, size of the
//   rigid bodies' state, origin;
// - per particle: position (with inverse mass), offset, velocity, contact margin (how far contacts recently pushed it);
// - the angular velocities of grains, object by object;
// - the contacts' state (the friction of pairs of particles);
// - per object: rest time, island, particle count, imbalance;
// - the state of emitters and drains, and foam;
// - rigid bodies with their joints and contacts, and ties;
// - the poses of the colliders that move_collider moved;
// - a checksum of all preceding bytes.

namespace souple {
namespace {

constexpr std::uint64_t magic = 0x38304e53504c5553u;  // "SULPSN08"

template <class T>
void put(std::vector<std::byte>& out, const T* values, std::size_t count) {
  const std::size_t begin = out.size();
  out.resize(begin + count * sizeof(T));
  if (count > 0) std::memcpy(out.data() + begin, values, count * sizeof(T));
}

template <class T>
void get(std::span<const std::byte>& in, T* values, std::size_t count) {
  if (count > 0) std::memcpy(values, in.data(), count * sizeof(T));
  in = in.subspan(count * sizeof(T));
}

/// Properties that must match for a restore: names, kinds and sizes of the objects, in order, and the numbers
/// of emitters, drains, joints and ties.
std::uint64_t shape_of(const WorldState& world) {
  std::uint64_t hash = fnv1a64_start;
  for (const auto& object : world.objects) {
    hash = fnv1a64(object->name, hash);
    const std::uint32_t numbers[] = {static_cast<std::uint32_t>(object->kind), object->begin,
                                     object->reserved_end()};
    hash = fnv1a64(std::as_bytes(std::span(numbers)), hash);
  }
  const std::size_t counts[] = {world.flow.emitters.size(), world.flow.drains.size(),
                                world.rigid->joints().records().size(), world.constraints.ties->count()};
  const std::size_t used =
      counts[3] > 0 ? 4 : 3;  // worlds without ties have the shape that they had before ties
  return counts[0] + counts[1] + counts[2] + counts[3] > 0
             ? fnv1a64(std::as_bytes(std::span(counts).first(used)), hash)
             : hash;
}

struct Header {
  std::uint64_t magic, shape;
  double time;
  std::uint64_t steps, contacts;
  std::uint64_t foam;   // particles
  std::uint64_t rigid;  // bytes
  double foam_origin[3];
};

constexpr std::size_t contact_unit = 32;  // bytes: unit of Header::contacts, the size of one pair's friction
constexpr std::size_t foam_bytes = 2 * sizeof(Vec3f) + 2 * sizeof(float) + sizeof(FoamKind);  // per particle

/// Sleep state, particle count and last measured imbalance of an object.
struct Rest {
  double rest_time;
  std::uint32_t island, particles;
  Imbalance imbalance;
};

/// Where move_collider left a collider.
struct ReachedPose {
  std::uint64_t collider;
  double translation[3], rotation[4];
};

void put_poses(std::vector<std::byte>& out, const WorldState& world) {
  for (const ColliderRecord& record : world.colliders) {
    if (!record.arrival) continue;
    const Vec3d& x = record.arrival->from.translation;
    const Quatd& q = record.arrival->from.rotation;
    const ReachedPose pose{record.id.value, {x.x, x.y, x.z}, {q.x, q.y, q.z, q.w}};
    put(out, &pose, 1);
  }
}

/// A collider without a pose in the snapshot had its own motion then.
void get_poses(WorldState& world, std::span<const std::byte> in) {
  for (ColliderRecord& record : world.colliders)
    if (record.arrival) place_collider(world, record, record.given.at(world.time));
  while (in.size() >= sizeof(ReachedPose)) {
    ReachedPose pose{};
    get(in, &pose, 1);
    for (ColliderRecord& record : world.colliders) {
      if (record.id.value != pose.collider) continue;
      const auto& [x, y, z] = pose.translation;
      const auto& q = pose.rotation;
      place_collider(world, record, {{x, y, z}, {q[0], q[1], q[2], q[3]}, 1});
    }
  }
}

void put(std::vector<std::byte>& out, const FoamState& foam) {
  put(out, foam.position.data(), foam.size());
  put(out, foam.velocity.data(), foam.size());
  put(out, foam.life.data(), foam.size());
  put(out, foam.age.data(), foam.size());
  put(out, foam.kind.data(), foam.size());
}

FoamState get_foam(std::span<const std::byte>& in, std::size_t count) {
  FoamState foam;
  foam.resize(count);
  get(in, foam.position.data(), count);
  get(in, foam.velocity.data(), count);
  get(in, foam.life.data(), count);
  get(in, foam.age.data(), count);
  get(in, foam.kind.data(), count);
  return foam;
}

std::size_t bytes_of_particles(const WorldState& world) {
  return world.particles.size() * (3 * sizeof(Vec4f) + sizeof(float));
}

/// Calls f(array, count) for the angular velocities of each object that has them.
template <class Array, class Function>
void for_each_spin(const WorldState& world, Array& spin, const Function& f) {
  for (const auto& object : world.objects)
    if (object->traits().rolls) f(spin.data() + object->begin, object->particle_count());
}

std::size_t bytes_of_spins(const WorldState& world) {
  std::size_t count = 0;
  for_each_spin(world, world.particles.spin, [&count](const Vec4f*, std::size_t n) { count += n; });
  return count * sizeof(Vec4f);
}

std::uint64_t size_for(const WorldState& world, std::uint64_t contacts, std::uint64_t foam,
                       std::uint64_t rigid) {
  return sizeof(Header) + bytes_of_particles(world) + bytes_of_spins(world) + contacts * contact_unit +
         world.objects.size() * sizeof(Rest) + world.flow.emitters.size() * sizeof(EmitterRecord::layers) +
         world.flow.drains.size() * sizeof(DrainRecord::credit) + foam * foam_bytes + rigid +
         sizeof(std::uint64_t);
}

/// Checks everything that can be checked before the world is modified.
Header checked_header(const WorldState& world, std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(Header) + sizeof(std::uint64_t))
    throw Error("restore: the snapshot is cut short");
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + bytes.size() - sizeof checksum, sizeof checksum);
  if (checksum != fnv1a64(bytes.first(bytes.size() - sizeof checksum)))
    throw Error("restore: the snapshot is damaged: its checksum does not match");
  Header header{};
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != magic || header.shape != shape_of(world) || header.contacts > bytes.size() ||
      header.foam > bytes.size() || header.rigid > bytes.size() ||
      bytes.size() < size_for(world, header.contacts, header.foam, header.rigid) ||
      (bytes.size() - size_for(world, header.contacts, header.foam, header.rigid)) % sizeof(ReachedPose) != 0)
    throw Error(
        "restore: the snapshot belongs to a world with other objects; build the world in the same way first");
  return header;
}

/// Ties come last.
void load_bodies(WorldState& world, std::span<const std::byte> in) {
  Ties& ties = *world.constraints.ties;
  const std::size_t of_ties = ties.count() * sizeof(TieState);
  if (in.size() < of_ties) throw Error("restore: the snapshot has no ties of this world");
  world.rigid->load(in.first(in.size() - of_ties));
  in = in.last(of_ties);
  ties.load(in);
}

void resume_objects(WorldState& world, std::span<const std::byte>& in) {
  world.scratch->sleep->changed = true;
  for (const auto& object : world.objects) {
    Rest rest{};
    get(in, &rest, 1);
    object->sleep.rest_time = rest.rest_time;
    object->sleep.island = rest.island;
    object->imbalance = rest.imbalance;
    if (object->traits().flows) set_count(world, *object, std::min(rest.particles, object->capacity));
  }
  for (EmitterRecord& record : world.flow.emitters) get(in, &record.layers, 1);
  for (DrainRecord& record : world.flow.drains) get(in, &record.credit, 1);
}

}  // namespace

Snapshot World::snapshot() const {
  const WorldState& world = state();
  require_readable(*world.calls, "snapshot");
  require_whole(*world.calls, "snapshot");
  const Particles& particles = world.particles;
  const std::vector<std::byte> contacts = world.contact->contacts.save();
  std::vector<std::byte> bodies = world.rigid->save();
  world.constraints.ties->save(bodies);
  const FluidFoam& foam = world.fluids->foam();
  const Vec3d& origin = foam.origin();
  const Header header{magic,
                      shape_of(world),
                      world.time,
                      world.steps,
                      contacts.size() / contact_unit,
                      foam.size(),
                      bodies.size(),
                      {origin.x, origin.y, origin.z}};
  Snapshot result;
  std::vector<std::byte>& out = result.bytes;
  out.reserve(static_cast<std::size_t>(size_for(world, header.contacts, foam.size(), bodies.size())));
  put(out, &header, 1);
  put(out, particles.position.data(), particles.size());
  put(out, particles.offset.data(), particles.size());
  put(out, particles.velocity.data(), particles.size());
  put(out, particles.contact_margin.data(), particles.size());
  for_each_spin(world, particles.spin, [&out](const Vec4f* spin, std::size_t n) { put(out, spin, n); });
  put(out, contacts.data(), contacts.size());
  for (const auto& object : world.objects) {
    const Rest rest{object->sleep.rest_time, object->sleep.island, object->particle_count(),
                    object->imbalance};
    put(out, &rest, 1);
  }
  for (const EmitterRecord& record : world.flow.emitters) put(out, &record.layers, 1);
  for (const DrainRecord& record : world.flow.drains) put(out, &record.credit, 1);
  put(out, foam.state());
  put(out, bodies.data(), bodies.size());
  put_poses(out, world);
  const std::uint64_t checksum = fnv1a64(out);
  put(out, &checksum, 1);
  return result;
}

void World::restore(const Snapshot& snapshot) {
  WorldState& world = state();
  require_callable(*world.calls, "restore", From::nowhere);
  const CallScope call(*world.calls, Calls::Doing::computing);
  const Header header = checked_header(world, snapshot.bytes);
  // Not above the snapshot's size.
  const auto contacts = static_cast<std::size_t>(header.contacts),
             foam = static_cast<std::size_t>(header.foam), bodies = static_cast<std::size_t>(header.rigid);
  if (world.calls->broken) start_afresh(world);
  Edit edit(world);
  std::span<const std::byte> in = std::span(snapshot.bytes).subspan(sizeof header);
  Particles& particles = world.particles;
  world.time = header.time;
  world.steps = header.steps;
  std::span<const std::byte> later =
      in.subspan(bytes_of_particles(world) + bytes_of_spins(world) + contacts * contact_unit);
  resume_objects(world, later);
  const auto& origin = header.foam_origin;
  world.fluids->foam().set_state(get_foam(later, foam), {origin[0], origin[1], origin[2]});
  load_bodies(world, later.first(bodies));
  later = later.subspan(bodies);
  get_poses(world, later.first(later.size() - sizeof(std::uint64_t)));
  get(in, particles.position.data(), particles.size());
  get(in, particles.offset.data(), particles.size());
  get(in, particles.velocity.data(), particles.size());
  get(in, particles.contact_margin.data(), particles.size());
  for_each_spin(world, particles.spin, [&in](Vec4f* spin, std::size_t n) { get(in, spin, n); });
  world.contact->contacts.load(in.first(contacts * contact_unit));
  world.contact->invalidate();
  world.contact->check_intersections = true;
  ++world.version;
  edit.done();
}

}  // namespace souple
