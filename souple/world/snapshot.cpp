#include "souple/fluid/stage/fluid_foam.h"
#include "souple/fluid/stage/fluids.h"
#include "souple/math/fnv1a.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_joints.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/saved_rigid_bodies.h"
#include "souple/stages/sleeping.h"
#include "souple/stages/ties.h"
#include "souple/state/saved_bytes.h"
#include "souple/world/arrivals.h"
#include "souple/world/call_scope.h"
#include "souple/world/contact_state.h"
#include "souple/world/flow/flow.h"
#include "souple/world/impl.h"
#include "souple/world/recover.h"
#include "souple/world/step_scratch.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

// Layout of a snapshot: magic number, shape of the world, sections, and a checksum of all preceding bytes. A section is
// a tag, a number of bytes, and these:
// - clock: time, steps;
// - objects: of each, rest time, island, particle count, imbalance;
// - particles: of each, position with inverse mass, offset, velocity, contact margin: how far contacts recently pushed
//   it. Then the angular velocities of grains, object by object;
// - contacts: a section for each kind (the friction of pairs of particles);
// - flow: the state of emitters and drains, and whether fluid has yet to settle;
// - foam;
// - bodies: rigid bodies with their joints and contacts;
// - ties;
// - colliders: the poses of those that move_collider moved.
//
// A checksum does not make bytes trustworthy. A restore reads all sections into a copy, and checks each number that the
// world relies on: indices, enumerators, finite values. Only then does the world change.

namespace souple {
namespace {

constexpr std::uint64_t magic = section_tag("SULPSN09");
constexpr std::uint64_t clock_tag = section_tag("clock   "), particles_tag = section_tag("particle"),
                        contacts_tag = section_tag("contacts"), objects_tag = section_tag("objects "),
                        flow_tag = section_tag("flow    "), foam_tag = section_tag("foam    "),
                        bodies_tag = section_tag("bodies  "), ties_tag = section_tag("ties    "),
                        colliders_tag = section_tag("collider");

// --- the shape of a world

/// Properties that must match for a restore: names, kinds, sizes and topology of the objects; emitters and drains; the
/// kinds and sides of joints. Then the sides and chains of ties. Handles do not count: a world that is built again may
/// have others.
class WorldShape {
 public:
  explicit WorldShape(const WorldState& world) : world_(world) {
    for (const auto& object : world.objects) add(*object);
    for (const EmitterRecord& record : world.flow.emitters) add_object(ObjectId{record.fluid});
    add_number(world.flow.drains.size());
    const RigidJoints& joints = world.rigid->joints();
    for (std::size_t j = 0; j < joints.records().size(); ++j) {
      add_number(joints.joints().joint[j].kind.index());
      add(joints.records()[j].a), add(joints.records()[j].b);
    }
    const Ties& ties = *world.constraints.ties;
    for (std::size_t t = 0; t < ties.count(); ++t) {
      add(ties.tie(t).a), add(ties.tie(t).b);
      add_all(ties.tie(t).chain);
    }
  }
  std::uint64_t hash() const { return hash_; }

 private:
  void add_number(std::uint64_t number) { add_bytes(std::as_bytes(std::span(&number, 1))); }
  void add_bytes(std::span<const std::byte> bytes) { hash_ = fnv1a64(bytes, hash_); }
  template <class T>
  void add_all(const std::vector<T>& list) {
    add_number(list.size());
    add_bytes(std::as_bytes(std::span(list)));
  }
  void add(const Object& object) {
    add_number(object.name.size());
    hash_ = fnv1a64(object.name, hash_);
    add_number(static_cast<std::uint64_t>(object.kind));
    add_number(object.begin), add_number(object.reserved_end());
    add_all(object.mesh.triangles), add_all(object.tets.tets);
  }
  void add_object(ObjectId id) {
    const auto found =
        std::lower_bound(world_.objects.begin(), world_.objects.end(), id.value,
                         [](const auto& object, std::uint32_t value) { return object->id.value < value; });
    add_number(static_cast<std::uint64_t>(found - world_.objects.begin()));
  }
  void add_collider(ColliderId id) {
    const auto found = std::lower_bound(
        world_.colliders.begin(), world_.colliders.end(), id.value,
        [](const ColliderRecord& record, std::uint32_t value) { return record.id.value < value; });
    add_number(static_cast<std::uint64_t>(found - world_.colliders.begin()));
  }
  void add(const JointSide& side) {
    add_number(side.is_world() ? 0 : side.object() != nullptr ? 1 : 2);
    if (side.object() != nullptr) add_object(*side.object());
    if (side.collider() != nullptr) add_collider(*side.collider());
  }
  void add(const TieEnd& end) {
    add_number(static_cast<std::uint64_t>(end.kind));
    add_number(end.object ? 1 : end.collider ? 2 : 0);
    if (end.object) add_object(*end.object);
    if (end.collider) add_collider(*end.collider);
    add_number(end.parts.size());
    for (const TieEnd::Part& part : end.parts) add_number(part.particle);
  }

  const WorldState& world_;
  std::uint64_t hash_ = fnv1a64_start;
};

// --- records

struct SavedTime {
  double time = 0;
  std::uint64_t steps = 0;
};

/// Sleep state, particle count and last measured imbalance of an object.
struct Rest {
  double rest_time;
  std::uint32_t island, particles;
  Imbalance imbalance;
};
static_assert(sizeof(Rest) == 40, "without padding");

/// Where move_collider left a collider.
struct ReachedPose {
  std::uint64_t collider;
  Vec3d translation;
  Quatd rotation;
};
static_assert(sizeof(ReachedPose) == 64, "without padding");

/// Calls f(span) for the angular velocities of each object that has them.
template <class Array, class Function>
void for_each_spin(const WorldState& world, Array& spin, const Function& f) {
  for (const auto& object : world.objects)
    if (object->traits().rolls) f(std::span(spin).subspan(object->begin, object->particle_count()));
}

/// A snapshot's content, checked for a world.
struct Loaded {
  SavedTime time;
  std::vector<Vec4f> position, offset, velocity, spin;
  std::vector<float> contact_margin;
  SavedBytes contacts{{}, {}};
  std::vector<Rest> rests;
  std::vector<std::uint64_t> layers;
  std::uint8_t settles = 0;
  std::vector<double> credits;
  FoamState foam;
  Vec3d foam_origin{};
  SavedRigidBodies bodies;
  std::vector<TieState> ties;
  std::vector<ReachedPose> poses;
};

// --- saving

void save_particles(const WorldState& world, SavedBytesWriter& out) {
  const Particles& particles = world.particles;
  const auto put = [&out](const auto& list) { out.put_all(std::span(list.data(), list.size())); };
  put(particles.position), put(particles.offset), put(particles.velocity), put(particles.contact_margin);
  for_each_spin(world, particles.spin, [&](std::span<const Vec4f> spins) { out.put_all(spins); });
}

void save_foam(const FluidFoam& foam, SavedBytesWriter& out) {
  const FoamState& state = foam.state();
  const auto put = [&out](const auto& list) { out.put_all(std::span(list.data(), list.size())); };
  out.put(foam.origin()), out.put(std::uint64_t{state.size()});
  put(state.position), put(state.velocity), put(state.life), put(state.age), put(state.kind);
}

void save_objects(const WorldState& world, SavedBytesWriter& out) {
  for (const auto& object : world.objects)
    out.put(Rest{object->sleep.rest_time, object->sleep.island, object->particle_count(), object->imbalance});
}

void save_flow(const WorldState& world, SavedBytesWriter& out) {
  for (const EmitterRecord& record : world.flow.emitters) out.put(record.layers);
  for (const DrainRecord& record : world.flow.drains) out.put(record.credit);
  out.put(std::uint8_t{world.flow.settles});
}

void save_poses(const WorldState& world, SavedBytesWriter& out) {
  for (const ColliderRecord& record : world.colliders)
    if (record.arrival)
      out.put(ReachedPose{record.id.value, record.arrival->from.translation, record.arrival->from.rotation});
}

std::size_t bytes_of_particles(const WorldState& world) {
  return world.particles.size() * (4 * sizeof(Vec4f) + sizeof(float));
}

// --- loading

void load_clock(SavedBytes in, Loaded& loaded) {
  in.get(loaded.time), in.require_end();
  in.require(std::isfinite(loaded.time.time));
}

void load_objects(const WorldState& world, SavedBytes in, Loaded& loaded) {
  loaded.rests = in.get_list<Rest>(world.objects.size());
  in.require_end();
  for (std::size_t k = 0; k < loaded.rests.size(); ++k) {
    const Rest& rest = loaded.rests[k];
    const Object& object = *world.objects[k];
    in.require(rest.rest_time >= 0 && std::isfinite(rest.rest_time) &&
               !std::isnan(rest.imbalance.unbalanced) && !std::isnan(rest.imbalance.stretch));
    in.require(object.traits().flows ? rest.particles <= object.capacity
                                     : rest.particles == object.particle_count());
  }
}

void load_particles(const WorldState& world, SavedBytes in, Loaded& loaded) {
  const std::size_t count = world.particles.size();
  loaded.position = in.get_list<Vec4f>(count);
  loaded.offset = in.get_list<Vec4f>(count);
  loaded.velocity = in.get_list<Vec4f>(count);
  loaded.contact_margin = in.get_list<float>(count);
  loaded.spin.resize(count);
  for_each_spin(world, loaded.spin, [&in](std::span<Vec4f> spins) { in.get_all(spins); });
  in.require_end();
  in.require(all_finite(loaded.position) && all_finite(loaded.offset) && all_finite(loaded.velocity) &&
             all_finite(loaded.contact_margin) && all_finite(loaded.spin));
  in.require(
      std::all_of(loaded.position.begin(), loaded.position.end(), [](const Vec4f& x) { return x.w >= 0; }));
  in.require(
      std::all_of(loaded.offset.begin(), loaded.offset.end(), [](const Vec4f& d) { return d.w == 0; }));
  in.require(std::all_of(loaded.contact_margin.begin(), loaded.contact_margin.end(),
                         [](float margin) { return margin >= 0; }));
}

void load_flow(const WorldState& world, SavedBytes in, Loaded& loaded) {
  constexpr double most = 1e15;
  loaded.layers = in.get_list<std::uint64_t>(world.flow.emitters.size());
  loaded.credits = in.get_list<double>(world.flow.drains.size());
  in.get(loaded.settles);
  in.require_end();
  in.require(loaded.settles <= 1);
  for (const double credit : loaded.credits) in.require(credit >= 0 && credit <= most);
}

void load_foam(SavedBytes in, Loaded& loaded) {
  FoamState& foam = loaded.foam;
  std::uint64_t count = 0;
  in.get(loaded.foam_origin), in.get(count);
  foam.position = in.get_list<Vec3f>(count);
  foam.velocity = in.get_list<Vec3f>(count);
  foam.life = in.get_list<float>(count);
  foam.age = in.get_list<float>(count);
  foam.kind = in.get_list<FoamKind>(count);
  in.require_end();
  in.require(all_finite(loaded.foam_origin) && all_finite(foam.position) && all_finite(foam.velocity) &&
             all_finite(foam.life) && all_finite(foam.age));
  in.require(std::all_of(foam.kind.begin(), foam.kind.end(),
                         [](FoamKind kind) { return kind <= FoamKind::bubble; }));
}

void load_poses(SavedBytes in, Loaded& loaded) {
  loaded.poses = in.get_list<ReachedPose>(in.size() / sizeof(ReachedPose));
  in.require_end();
  for (const ReachedPose& pose : loaded.poses)
    in.require(all_finite(pose.translation) && is_rotation(pose.rotation));
}

/// The sections, if the bytes are a snapshot of a world with this shape.
SavedBytes sections_of(const WorldState& world, std::span<const std::byte> bytes) {
  constexpr std::size_t least = 3 * sizeof(std::uint64_t);
  if (bytes.size() < least) throw Error("restore: the snapshot is cut short");
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + bytes.size() - sizeof checksum, sizeof checksum);
  bytes = bytes.first(bytes.size() - sizeof checksum);
  if (checksum != fnv1a64(bytes))
    throw Error("restore: the snapshot is damaged: its checksum does not match");
  SavedBytes in(bytes, "sections");
  std::uint64_t found = 0, shape = 0;
  in.get(found), in.get(shape);
  if (found != magic) throw Error("restore: the snapshot is one of another version of Souple");
  if (shape != WorldShape(world).hash())
    throw Error(
        "restore: the snapshot belongs to a world with other objects; build the world in the same way first");
  return in;
}

Loaded load(const WorldState& world, std::span<const std::byte> bytes) {
  SavedBytes in = sections_of(world, bytes);
  Loaded loaded;
  load_clock(in.section(clock_tag, "times"), loaded);
  load_objects(world, in.section(objects_tag, "objects"), loaded);
  load_particles(world, in.section(particles_tag, "particles"), loaded);
  loaded.contacts = in.section(contacts_tag, "contacts");
  world.contact->contacts.check_saved(loaded.contacts, world.particles.size());
  load_flow(world, in.section(flow_tag, "emitters and drains"), loaded);
  load_foam(in.section(foam_tag, "foam"), loaded);
  SavedBytes bodies = in.section(bodies_tag, "rigid bodies"), ties = in.section(ties_tag, "ties");
  loaded.bodies = world.rigid->read(bodies);
  loaded.ties = world.constraints.ties->read(ties);
  load_poses(in.section(colliders_tag, "colliders"), loaded);
  in.require_end();
  return loaded;
}

void resume_objects(WorldState& world, const Loaded& loaded) {
  world.scratch->sleep->changed = true;
  for (std::size_t k = 0; k < world.objects.size(); ++k) {
    Object& object = *world.objects[k];
    const Rest& rest = loaded.rests[k];
    object.sleep.rest_time = rest.rest_time;
    object.sleep.island = rest.island;
    object.imbalance = rest.imbalance;
    if (object.traits().flows) set_count(world, object, rest.particles);
  }
  world.flow.settles = loaded.settles == 1;
  for (std::size_t k = 0; k < loaded.layers.size(); ++k) world.flow.emitters[k].layers = loaded.layers[k];
  for (std::size_t k = 0; k < loaded.credits.size(); ++k) world.flow.drains[k].credit = loaded.credits[k];
}

void resume_particles(WorldState& world, const Loaded& loaded) {
  Particles& particles = world.particles;
  std::copy(loaded.position.begin(), loaded.position.end(), particles.position.begin());
  std::copy(loaded.offset.begin(), loaded.offset.end(), particles.offset.begin());
  std::copy(loaded.velocity.begin(), loaded.velocity.end(), particles.velocity.begin());
  std::copy(loaded.contact_margin.begin(), loaded.contact_margin.end(), particles.contact_margin.begin());
  for (const auto& object : world.objects)
    if (object->traits().rolls)
      std::copy_n(loaded.spin.data() + object->begin, object->particle_count(),
                  particles.spin.data() + object->begin);
}

/// A collider without a pose in the snapshot had its own motion then.
void resume_colliders(WorldState& world, const Loaded& loaded) {
  for (ColliderRecord& record : world.colliders)
    if (record.arrival) place_collider(world, record, record.given.at(world.time));
  for (const ReachedPose& pose : loaded.poses)
    for (ColliderRecord& record : world.colliders)
      if (record.id.value == pose.collider)
        place_collider(world, record, {pose.translation, pose.rotation, 1});
}

}  // namespace

Snapshot World::snapshot() const {
  const WorldState& world = state();
  require_readable(*world.calls, "snapshot");
  require_whole(*world.calls, "snapshot");
  Snapshot result;
  result.bytes.reserve(bytes_of_particles(world) + 4096);
  SavedBytesWriter out(result.bytes);
  out.put(magic), out.put(WorldShape(world).hash());
  out.section(clock_tag, [&] { out.put(SavedTime{world.time, world.steps}); });
  out.section(objects_tag, [&] { save_objects(world, out); });
  out.section(particles_tag, [&] { save_particles(world, out); });
  out.section(contacts_tag, [&] { world.contact->contacts.save(out); });
  out.section(flow_tag, [&] { save_flow(world, out); });
  out.section(foam_tag, [&] { save_foam(world.fluids->foam(), out); });
  out.section(bodies_tag, [&] { world.rigid->save(out); });
  out.section(ties_tag, [&] { world.constraints.ties->save(out); });
  out.section(colliders_tag, [&] { save_poses(world, out); });
  out.put(fnv1a64(result.bytes));
  return result;
}

void World::restore(const Snapshot& snapshot) {
  WorldState& world = state();
  require_callable(*world.calls, "restore", From::nowhere);
  const CallScope call(*world.calls, Calls::Doing::computing);
  Loaded loaded = load(world, snapshot.bytes);
  if (world.calls->broken) start_afresh(world);
  Edit edit(world);
  world.time = loaded.time.time;
  world.steps = loaded.time.steps;
  resume_objects(world, loaded);
  resume_particles(world, loaded);
  world.fluids->foam().set_state(std::move(loaded.foam), loaded.foam_origin);
  world.rigid->set(std::move(loaded.bodies));
  world.constraints.ties->set(loaded.ties);
  world.dirty.tables = world.dirty.tables || !world.constraints.ties->empty();  // which may be broken now
  resume_colliders(world, loaded);
  world.contact->contacts.load(loaded.contacts);
  world.contact->invalidate();
  world.contact->check_intersections = true;
  ++world.version;
  edit.done();
}

}  // namespace souple
