#include "souple/world/sleeping.h"

#include "souple/assert.h"
#include "souple/constraints/attachment.h"
#include "souple/constraints/distance.h"
#include "souple/objects/object.h"
#include "souple/objects/obstacle_pose.h"
#include "souple/solver/set_projector.h"
#include "souple/world/collider_record.h"
#include "souple/world/contact_state.h"
#include "souple/world/impl.h"
#include "souple/world/spin.h"
#include "souple/world/user_constraint.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>

// Speed is the displacement over a step, not that of the last substep: objects in contact vibrate within a
// substep without net motion.

namespace souple {
namespace {

// Additional distance that counts as contact, relative to the contact radius.
constexpr float margin_ratio = 0.25f;
constexpr float min_margin = 1e-5f;  // m
// Obstacles and colliders move objects that lie on them: they wake these if they are faster than this
// fraction of the sleeping speed.
constexpr float carrier_speed_ratio = 0.01f;
constexpr std::size_t chunk = 2048;  // particles

bool is_obstacle(const Object& object) {
  return object.traits().driven;
}

// --- state of objects

void set_inverse_masses(WorldState& world, const Object& object) {
  Particles& particles = world.particles;
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    particles.position[i].w = object.island != 0 || !(particles.mass[i] > 0) ? 0 : 1 / particles.mass[i];
  for (const PinnedParticle& pin : object.pins) particles.position[object.begin + pin.particle].w = 0;
}

void set_awake(WorldState& world, Object& object) {
  object.rest_time = 0;
  if (object.island == 0) return;
  object.island = 0;
  set_inverse_masses(world, object);
  world.sleep->all = false;
  world.sleep->woken = world.sleep->woken || world.current.running;
}

void set_asleep(WorldState& world, Object& object, std::uint32_t island) {
  SOUPLE_ASSERT(island != 0, "an island has a name");
  object.island = island;
  set_inverse_masses(world, object);
  std::fill(world.particles.velocity.begin() + object.begin, world.particles.velocity.begin() + object.end,
            Vec4f{});
  if (object.traits().rolls)
    std::fill(world.particles.spin.begin() + object.begin, world.particles.spin.begin() + object.end,
              Vec4f{});
}

// --- proximity

void set_box(ProximityQuery& proximity, const WorldState& world, std::uint32_t i, const Vec3f& x,
             const Vec3f& move, float fall) {
  const float margin = (1 + margin_ratio) * max(world.particles.radius[i], 0.0f) + min_margin;
  proximity.margin[i] = margin;
  proximity.motion_bound[i] = length(move) + fall;
  const float grown = margin + fall;
  const Vec3f end = x + move, extent{grown, grown, grown};
  proximity.boxes[i] = united({x - extent, x + extent}, {end - extent, end + extent});
}

// Activates the fast particles of a moving object; all particles of an obstacle that has just jumped or
// moved.
bool mark_mover(WorldState& world, const Object& object, float dt) {
  ProximityQuery& proximity = world.sleep->proximity;
  const ParticleView view = world.view();
  const Settings& settings = world.settings;
  const float threshold = settings.sleeping.speed * (is_obstacle(object) ? carrier_speed_ratio : 1.0f);
  const bool jumped = is_obstacle(object) && object.rest_time == 0;
  bool any = false;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const Vec3f v = world.particles.velocity[i].xyz();
    const bool fast = jumped || length(v) > threshold;
    any = any || fast;
    proximity.active_particles[i] = {0, 0, 0, fast ? 1.0f : 0.0f};
    const float fall = world.particles.position[i].w > 0 ? length(settings.gravity) * dt * dt : 0.0f;
    set_box(proximity, world, i, view.relative(i, {}), v * dt, fall);
  }
  return any;
}

void mark_still(WorldState& world, const Object& object, bool active) {
  ProximityQuery& proximity = world.sleep->proximity;
  const ParticleView view = world.view();
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    proximity.active_particles[i] = {0, 0, 0, active ? 1.0f : 0.0f};
    set_box(proximity, world, i, view.relative(i, {}), {}, 0);
  }
}

// Wakes sleeping objects that moving objects and obstacles may touch. An object that has been at rest wakes
// none, even if its last substep left velocities: of two objects that settle together one may fall asleep
// first.
void wake_near_movers(WorldState& world, float dt) {
  ProximityQuery& proximity = world.sleep->proximity;
  proximity.reset(world);
  bool any = false;
  for (std::size_t a = 0; a < world.objects.size(); ++a) {
    const Object& object = *world.objects[a];
    if (object.island != 0 || (object.rest_time > 0 && !is_obstacle(object))) continue;
    proximity.active[a] = mark_mover(world, object, dt) ? 1 : 0;
    any = any || proximity.active[a] != 0;
  }
  if (!any) return;
  for (std::size_t a = 0; a < world.objects.size(); ++a) {
    if (world.objects[a]->island == 0) continue;
    proximity.passive[a] = 1;
    mark_still(world, *world.objects[a], false);
  }
  find_close_objects(world);
  for (const auto& [a, b] : proximity.found)
    for (const std::uint32_t k : {a, b})
      if (world.objects[k]->island != 0) wake_island(world, *world.objects[k]);
}

/// A collider at the start and at the end of a step.
struct MovingCollider {
  const Shape& shape;
  Transform before, after;
  Vec3d center;
  double shift = 0, turn = 0;

  MovingCollider(const ColliderRecord& record, double time, double dt)
      : shape(record.shape),
        before(record.options.motion.at(time)),
        after(record.options.motion.at(time + dt)),
        center(after.point(bounding_ball(shape).center)) {
    shift = length(center - before.point(bounding_ball(shape).center));
    turn = std::sqrt(frobenius_squared(rotation_matrix(after.rotation) - rotation_matrix(before.rotation)));
  }

  static double distance(const Shape& shape, const Transform& pose, const Vec3d& x) {
    return surface_distance(shape, rotate(conjugate(pose.rotation), x - pose.translation)).distance;
  }
  /// Uses the motion of its surface near x, at most `shift + turn D` at a distance D from its center.
  bool touches(const Vec3d& x, double margin, double threshold) const {
    const double motion = shift + turn * length(x - center);
    if (motion <= threshold) return false;
    return std::min(distance(shape, before, x), distance(shape, after, x)) <= margin + motion;
  }
};

void wake_near_collider(WorldState& world, std::size_t collider, double dt) {
  const ColliderRecord& record = world.colliders[collider];
  const MovingCollider moving(record, world.time, dt);
  const auto threshold = static_cast<double>(carrier_speed_ratio * world.settings.sleeping.speed) * dt;
  for (std::size_t a = 0; a < world.objects.size(); ++a) {
    const Object& object = *world.objects[a];
    if (object.island == 0 || !world.contact->tables.against_colliders.collide(a, collider)) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      const auto radius = static_cast<double>(max(world.particles.radius[i], 0.0f));
      const double margin = (1 + double(margin_ratio)) * radius + double(min_margin);
      if (!moving.touches(world.exact_position(i), margin, threshold)) continue;
      wake_island(world, object);
      break;
    }
  }
}

// --- islands

float max_displacement(WorldState& world, const Object& object) {
  const Particles& p = world.particles;
  const std::size_t count = object.particle_count(), chunks = (count + chunk - 1) / chunk;
  std::vector<float>& squared = world.sleep->chunk_displacement_squared;
  squared.assign(chunks, 0);
  world.threads->for_each(chunks, 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c)
      for (std::size_t i = object.begin + c * chunk; i < object.begin + std::min(count, (c + 1) * chunk); ++i)
        squared[c] =
            max(squared[c], length_squared((p.position[i].xyz() - world.last_valid.position[i].xyz()) +
                                           (p.offset[i].xyz() - world.last_valid.offset[i].xyz())));
  });
  return std::sqrt(*std::max_element(squared.begin(), squared.end()));
}

// Whether some object's rest time has just reached a multiple of the time to fall asleep.
bool measure_rest(WorldState& world, double dt) {
  const Sleeping& sleeping = world.settings.sleeping;
  const auto seconds = static_cast<double>(sleeping.seconds);
  bool ready = false;
  for (const auto& object : world.objects) {
    if (object->island != 0) continue;
    const double limit =
        static_cast<double>(sleeping.speed * (is_obstacle(*object) ? carrier_speed_ratio : 1.0f)) * dt;
    const double before = object->rest_time;
    const double motion = max(static_cast<double>(max_displacement(world, *object)),
                              static_cast<double>(fastest_spin(world, *object)) * dt);
    object->rest_time = motion <= limit ? before + dt : 0;
    ready = ready ||
            (!is_obstacle(*object) && std::floor(object->rest_time / seconds) > std::floor(before / seconds));
  }
  return ready;
}

void mark_object_of(const WorldState& world, std::vector<std::uint8_t>& cannot_sleep,
                    std::uint32_t particle) {
  cannot_sleep[world.object_of[particle]] = 1;
}

// Marks objects on which a force may act at any time: they do not sleep.
void find_sleepless(WorldState& world) {
  std::vector<std::uint8_t>& cannot_sleep = world.sleep->cannot_sleep;
  const Wind& wind = world.settings.wind;
  const bool gusts = wind.gust > 0 && !(wind.velocity == Vec3f{});
  cannot_sleep.assign(world.objects.size(), gusts || !world.callbacks.force_fields.empty() ? 1 : 0);
  for (std::size_t a = 0; a < world.objects.size(); ++a)
    for (const PinnedParticle& pin : world.objects[a]->pins)
      if (pin.target) cannot_sleep[a] = 1;
  const ParticleView view = world.view();
  for (const UserConstraint& user_constraint : world.constraints.users) {
    if (user_constraint.attachment && user_constraint.target)
      for (std::size_t k = 0; k < user_constraint.attachment->set().size(); ++k)
        mark_object_of(world, cannot_sleep, user_constraint.attachment->set().indices(k)[0]);
    if (!user_constraint.is_custom) continue;
    bool any = user_constraint.projector->size() == 0;
    user_constraint.projector->visit(view, [&](const ConstraintState& constraint) {
      any = true;
      for (const std::uint32_t i : constraint.particles) mark_object_of(world, cannot_sleep, i);
    });
    if (!any) cannot_sleep.assign(world.objects.size(), 1);
  }
}

std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t a) {
  while (parent[a] != a) a = parent[a] = parent[parent[a]];
  return a;
}

// The lower index is the root: islands do not depend on the order of pairs.
void unite(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = root(parent, a), b = root(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

// Islands of objects that are in contact, joined, or asleep together. Obstacles do not connect objects.
void find_islands(WorldState& world) {
  std::vector<std::uint32_t>& parent = world.sleep->parent;
  ProximityQuery& proximity = world.sleep->proximity;
  const auto n = static_cast<std::uint32_t>(world.objects.size());
  parent.resize(n);
  for (std::uint32_t a = 0; a < n; ++a) parent[a] = a;
  proximity.reset(world);
  for (std::uint32_t a = 0; a < n; ++a) {
    const Object& object = *world.objects[a];
    if (is_obstacle(object)) continue;
    mark_still(world, object, object.island == 0);
    proximity.active[a] = object.island == 0 ? 1 : 0;
    proximity.passive[a] = 1;
    for (std::uint32_t b = 0; object.island != 0 && b < a; ++b)
      if (world.objects[b]->island == object.island) unite(parent, a, b);
  }
  find_close_objects(world);
  for (const auto& [a, b] : proximity.found) unite(parent, a, b);
  for (const UserConstraint& user_constraint : world.constraints.users)
    for (std::size_t k = 0; user_constraint.distance_joint && user_constraint.is_active &&
                            k < user_constraint.distance_joint->set().size();
         ++k) {
      const auto ends = user_constraint.distance_joint->set().indices(k);
      unite(parent, world.object_of[ends[0]], world.object_of[ends[1]]);
    }
}

void put_islands_to_sleep(WorldState& world) {
  std::vector<std::uint32_t>& parent = world.sleep->parent;
  std::vector<std::uint8_t>& cannot_sleep = world.sleep->cannot_sleep;
  const auto n = static_cast<std::uint32_t>(world.objects.size());
  const auto seconds = static_cast<double>(world.settings.sleeping.seconds);
  for (std::uint32_t a = n; a-- > 0;) {  // roots have the lowest index: they come last
    const Object& object = *world.objects[a];
    if (object.island == 0 && object.rest_time < seconds) cannot_sleep[a] = 1;
    if (cannot_sleep[a] != 0) cannot_sleep[root(parent, a)] = 1;
  }
  for (std::uint32_t a = 0; a < n; ++a) {
    const std::uint32_t first = root(parent, a);
    if (cannot_sleep[first] != 0 || is_obstacle(*world.objects[a])) continue;
    set_asleep(world, *world.objects[a], world.objects[first]->id.value);
  }
}

void count_sleepers(WorldState& world) {
  std::size_t awake = 0;
  world.report.asleep = 0;
  for (const auto& object : world.objects) {
    world.report.asleep += object->island != 0 ? 1 : 0;
    awake += object->island == 0 && !is_obstacle(*object) ? 1 : 0;
  }
  world.sleep->all = awake == 0 && world.report.asleep > 0;
}

}  // namespace

void wake_disturbed(WorldState& world, double dt) {
  SleepScratch& sleep = *world.sleep;
  sleep.woken = false;
  sleep.all = false;
  if (!world.settings.sleeping.enabled) return;
  count_sleepers(world);
  if (world.report.asleep == 0) return;
  wake_near_movers(world, static_cast<float>(dt));
  for (std::size_t c = 0; c < world.colliders.size(); ++c)
    if (!world.colliders[c].options.motion.is_static() && !world.colliders[c].options.sensor)
      world.warnings.guarded("a collider's motion", [&] { wake_near_collider(world, c, dt); });
  count_sleepers(world);
  sleep.woken = false;  // the search for near pairs follows
}

void fall_asleep(WorldState& world, double dt) {
  if (!world.settings.sleeping.enabled) return;
  if (measure_rest(world, dt)) {
    find_sleepless(world);
    find_islands(world);
    put_islands_to_sleep(world);
  }
  count_sleepers(world);
}

void wake_island(WorldState& world, const Object& touched) {
  const std::uint32_t island = touched.island;
  for (const auto& object : world.objects)
    if (object->id == touched.id || (island != 0 && object->island == island)) set_awake(world, *object);
}

void wake_all(WorldState& world) {
  for (const auto& object : world.objects) set_awake(world, *object);
}

void wake_particles_of(WorldState& world, const Projector& projector) {
  bool any = false;
  projector.visit(world.view(), [&](const ConstraintState& constraint) {
    any = true;
    for (const std::uint32_t i : constraint.particles) wake_island(world, *world.objects[world.object_of[i]]);
  });
  if (!any && projector.size() > 0) wake_all(world);
}

float inverse_mass_awake(const WorldState& world, const Object& object, std::uint32_t particle) {
  if (object.island == 0) return world.particles.position[object.begin + particle].w;
  const bool pinned = std::any_of(object.pins.begin(), object.pins.end(),
                                  [&](const PinnedParticle& pin) { return pin.particle == particle; });
  return pinned ? 0 : 1 / world.particles.mass[object.begin + particle];
}

void update_sleeping_masses(WorldState& world) {
  if (!world.settings.sleeping.enabled) return;
  for (const auto& object : world.objects)
    if (!is_obstacle(*object)) set_inverse_masses(world, *object);
}

bool World::is_asleep(ObjectId id) const {
  return impl_->state.object(id).island != 0;
}

void World::wake(ObjectId id) {
  wake_island(impl_->state, impl_->state.object(id));
}

}  // namespace souple
