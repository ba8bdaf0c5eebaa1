#include "souple/stages/sleeping.h"

#include "souple/assert.h"
#include "souple/constraints/attachment.h"
#include "souple/constraints/distance.h"
#include "souple/contacts/contact_projector.h"
#include "souple/objects/collider_record.h"
#include "souple/objects/object.h"
#include "souple/solver/set_projector.h"
#include "souple/stages/spin.h"
#include "souple/stages/user_constraint.h"

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
  return object.is_driven();
}

// --- state of objects

void set_inverse_masses(Particles& particles, const Object& object) {
  for (std::uint32_t i = object.begin; i < object.end; ++i)
    particles.position[i].w =
        object.sleep.island != 0 || !(particles.mass[i] > 0) ? 0 : 1 / particles.mass[i];
  for (const PinnedParticle& pin : object.pins) particles.position[object.begin + pin.particle].w = 0;
}

void set_awake(Particles& particles, Object& object, SleepScratch& sleep) {
  object.sleep.rest_time = 0;
  if (object.sleep.island == 0) return;
  object.sleep.island = 0;
  object.sleep.still = false;
  set_inverse_masses(particles, object);
  sleep.all = false;
  sleep.woken = sleep.changed = true;
}

void set_asleep(Particles& particles, Object& object, std::uint32_t island) {
  SOUPLE_ASSERT(island != 0, "an island has a name");
  object.sleep.island = island;
  set_inverse_masses(particles, object);
  const auto stop = [&](std::vector<Vec4f>& array) {
    std::fill(array.data() + object.begin, array.data() + object.end, Vec4f{});
  };
  stop(particles.velocity);
  if (object.traits().rolls) stop(particles.spin);
}

// --- proximity

void set_box(ProximityQuery& proximity, const Particles& particles, std::uint32_t i, const Vec3f& x,
             const Vec3f& move, float fall) {
  const float margin = (1 + margin_ratio) * max(particles.radius[i], 0.0f) + min_margin;
  proximity.margin[i] = margin;
  proximity.motion_bound[i] = length(move) + fall;
  const float grown = margin + fall;
  const Vec3f end = x + move, extent{grown, grown, grown};
  proximity.boxes[i] = united({x - extent, x + extent}, {end - extent, end + extent});
}

// Activates the fast particles of a moving object; all particles of an obstacle that has just jumped or
// moved.
bool mark_mover(const SleepView& step, const Object& object, float dt) {
  ProximityQuery& proximity = step.sleep.proximity;
  const Particles& particles = step.stage.objects.particles;
  const ParticleView view = step.stage.objects.view();
  const Settings& settings = step.stage.settings;
  const float threshold = settings.sleeping.speed * (is_obstacle(object) ? carrier_speed_ratio : 1.0f);
  const bool jumped = is_obstacle(object) && object.sleep.rest_time == 0;
  bool any = false;
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    const Vec3f v = particles.velocity[i].xyz();
    const bool fast = jumped || length(v) > threshold;
    any = any || fast;
    proximity.active_particles[i] = {0, 0, 0, fast ? 1.0f : 0.0f};
    const float fall = particles.position[i].w > 0 ? length(settings.gravity) * dt * dt : 0.0f;
    set_box(proximity, particles, i, view.relative(i, {}), v * dt, fall);
  }
  return any;
}

void mark_still(const SleepView& step, const Object& object, bool active) {
  ProximityQuery& proximity = step.sleep.proximity;
  const ParticleView view = step.stage.objects.view();
  for (std::uint32_t i = object.begin; i < object.end; ++i) {
    proximity.active_particles[i] = {0, 0, 0, active ? 1.0f : 0.0f};
    set_box(proximity, step.stage.objects.particles, i, view.relative(i, {}), {}, 0);
  }
}

// Wakes sleeping objects that moving objects and obstacles may touch. An object that has been at rest wakes none, even
// if its last substep left velocities. Otherwise two objects that settle together would keep each other awake.
void wake_near_movers(const SleepView& step, float dt) {
  const ObjectsView& view = step.stage.objects;
  const auto& objects = view.objects;
  ProximityQuery& proximity = step.sleep.proximity;
  const auto may_move = [](const Object& object) {
    return object.sleep.island == 0 && !object.sleep.still &&
           (object.sleep.rest_time == 0 || is_obstacle(object));
  };
  if (std::none_of(objects.begin(), objects.end(), [&](const auto& object) { return may_move(*object); }))
    return;
  proximity.reset(view);
  bool any = false;
  for (std::size_t a = 0; a < objects.size(); ++a) {
    const Object& object = *objects[a];
    if (!may_move(object)) continue;
    proximity.active[a] = mark_mover(step, object, dt) ? 1 : 0;
    any = any || proximity.active[a] != 0;
  }
  if (!any) return;
  for (std::size_t a = 0; a < objects.size(); ++a) {
    if (objects[a]->sleep.island == 0) continue;
    proximity.passive[a] = 1;
    mark_still(step, *objects[a], false);
  }
  find_close_objects(view, step.tables, proximity, step.stage.threads);
  for (const auto& [a, b] : proximity.found)
    for (const std::uint32_t k : {a, b})
      if (objects[k]->sleep.island != 0) wake_island(view, *objects[k], step.sleep);
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

void wake_near_collider(const SleepView& step, std::size_t collider, double dt) {
  const ObjectsView& view = step.stage.objects;
  const MovingCollider moving(step.colliders[collider], step.stage.time, dt);
  const auto threshold = static_cast<double>(carrier_speed_ratio * step.stage.settings.sleeping.speed) * dt;
  for (std::size_t a = 0; a < view.objects.size(); ++a) {
    const Object& object = *view.objects[a];
    if (object.sleep.island == 0 || !step.tables.against_colliders.collide(a, collider)) continue;
    for (std::uint32_t i = object.begin; i < object.end; ++i) {
      const auto radius = static_cast<double>(max(view.particles.radius[i], 0.0f));
      const double margin = (1 + double(margin_ratio)) * radius + double(min_margin) +
                            static_cast<double>(view.particles.element_radius[i]);
      if (!moving.touches(view.particles.exact_position(i), margin, threshold)) continue;
      wake_island(view, object, step.sleep);
      break;
    }
  }
}

// --- islands

float max_displacement(const SleepView& step, const StartOfStep& before, const Object& object) {
  const Particles& p = step.stage.objects.particles;
  const std::size_t count = object.particle_count(), chunks = (count + chunk - 1) / chunk;
  std::vector<float>& squared = step.sleep.chunk_displacement_squared;
  squared.assign(chunks, 0);
  step.stage.threads.each(chunks, 1, [&](std::size_t c) {
    for (std::size_t i = object.begin + c * chunk; i < object.begin + std::min(count, (c + 1) * chunk); ++i)
      squared[c] = max(squared[c], length_squared((p.position[i].xyz() - before.position[i].xyz()) +
                                                  (p.offset[i].xyz() - before.offset[i].xyz())));
  });
  return std::sqrt(*std::max_element(squared.begin(), squared.end()));
}

// Whether some object's rest time has just reached a multiple of the time to fall asleep.
bool measure_rest(const SleepView& step, const StartOfStep& before_step, double dt) {
  const Sleeping& sleeping = step.stage.settings.sleeping;
  const auto seconds = static_cast<double>(sleeping.seconds);
  bool ready = false;
  for (const auto& object : step.stage.objects.objects) {
    if (object->sleep.island != 0) continue;
    const double limit =
        static_cast<double>(sleeping.speed * (is_obstacle(*object) ? carrier_speed_ratio : 1.0f)) * dt;
    const double before = object->sleep.rest_time;
    const double motion = max(static_cast<double>(max_displacement(step, before_step, *object)),
                              static_cast<double>(fastest_spin(step.stage.objects.particles, *object)) * dt);
    object->sleep.rest_time = motion <= limit ? before + dt : 0;
    ready = ready || (!is_obstacle(*object) &&
                      std::floor(object->sleep.rest_time / seconds) > std::floor(before / seconds));
  }
  return ready;
}

void mark_object_of(const SleepView& step, std::uint32_t particle) {
  step.sleep.cannot_sleep[step.stage.objects.object_of[particle]] = 1;
}

// Marks objects on which a force may act at any time: they do not sleep.
void find_sleepless(const SleepView& step, bool has_force_fields) {
  const ObjectsView& view = step.stage.objects;
  std::vector<std::uint8_t>& cannot_sleep = step.sleep.cannot_sleep;
  const Wind& wind = step.stage.settings.wind;
  const bool gusts = wind.gust > 0 && !(wind.velocity == Vec3f{});
  cannot_sleep.assign(view.objects.size(), gusts || has_force_fields ? 1 : 0);
  for (std::size_t a = 0; a < view.objects.size(); ++a)
    for (const PinnedParticle& pin : view.objects[a]->pins)
      if (pin.target) cannot_sleep[a] = 1;
  for (const std::uint32_t a : step.sleep.joined.driven) cannot_sleep[a] = 1;
  const ParticleView particles = view.view();
  for (const UserConstraint& user_constraint : step.constraints) {
    if (user_constraint.attachment && user_constraint.target)
      for (std::size_t k = 0; k < user_constraint.attachment->set().size(); ++k)
        mark_object_of(step, user_constraint.attachment->set().indices(k)[0]);
    if (!user_constraint.is_custom) continue;
    bool any = user_constraint.projector->size() == 0;
    user_constraint.projector->visit(particles, [&](const ConstraintState& constraint) {
      any = true;
      for (const std::uint32_t i : constraint.particles) mark_object_of(step, i);
    });
    if (!any) cannot_sleep.assign(view.objects.size(), 1);
  }
}

// Islands of objects that are in contact, joined, or asleep together. Obstacles do not connect objects.
void find_islands(const SleepView& step) {
  const ObjectsView& view = step.stage.objects;
  DisjointSets& islands = step.sleep.islands;
  ProximityQuery& proximity = step.sleep.proximity;
  const auto n = static_cast<std::uint32_t>(view.objects.size());
  islands.reset(n);
  proximity.reset(view);
  for (std::uint32_t a = 0; a < n; ++a) {
    const Object& object = *view.objects[a];
    if (is_obstacle(object)) continue;
    mark_still(step, object, object.sleep.island == 0);
    proximity.active[a] = object.sleep.island == 0 ? 1 : 0;
    proximity.passive[a] = 1;
    for (std::uint32_t b = 0; object.sleep.island != 0 && b < a; ++b)
      if (view.objects[b]->sleep.island == object.sleep.island) islands.join(a, b);
  }
  find_close_objects(view, step.tables, proximity, step.stage.threads);
  for (const auto& [a, b] : proximity.found) islands.join(a, b);
  for (const auto& [a, b] : step.sleep.joined.pairs) islands.join(a, b);
  for (const UserConstraint& user_constraint : step.constraints)
    for (std::size_t k = 0; user_constraint.distance_joint && user_constraint.is_active &&
                            k < user_constraint.distance_joint->set().size();
         ++k) {
      const auto ends = user_constraint.distance_joint->set().indices(k);
      islands.join(view.object_of[ends[0]], view.object_of[ends[1]]);
    }
}

void put_islands_to_sleep(const SleepView& step) {
  const ObjectsView& view = step.stage.objects;
  DisjointSets& islands = step.sleep.islands;
  std::vector<std::uint8_t>& cannot_sleep = step.sleep.cannot_sleep;
  const auto n = static_cast<std::uint32_t>(view.objects.size());
  const auto seconds = static_cast<double>(step.stage.settings.sleeping.seconds);
  for (std::uint32_t a = n; a-- > 0;) {  // roots have the lowest index: they come last
    const Object& object = *view.objects[a];
    if (object.sleep.island == 0 && object.sleep.rest_time < seconds) cannot_sleep[a] = 1;
    if (cannot_sleep[a] != 0) cannot_sleep[islands.root(a)] = 1;
  }
  for (std::uint32_t a = 0; a < n; ++a) {
    const std::uint32_t first = islands.root(a);
    if (cannot_sleep[first] != 0 || is_obstacle(*view.objects[a])) continue;
    if (view.objects[a]->sleep.island == 0) step.sleep.changed = true;
    set_asleep(view.particles, *view.objects[a], view.objects[first]->id.value);
  }
}

/// Returns the number of objects asleep, and notes whether all are.
std::size_t count_sleepers(const SleepView& step) {
  std::size_t awake = 0, asleep = 0;
  for (const auto& object : step.stage.objects.objects) {
    asleep += object->sleep.island != 0 ? 1 : 0;
    awake += object->sleep.island == 0 && !is_obstacle(*object) ? 1 : 0;
  }
  step.sleep.all = awake == 0 && asleep > 0;
  return asleep;
}

}  // namespace

std::size_t wake_disturbed(const SleepView& step, double dt) {
  SleepScratch& sleep = step.sleep;
  sleep.woken = false;
  sleep.all = false;
  if (!step.stage.settings.sleeping.enabled || count_sleepers(step) == 0) return 0;
  wake_near_movers(step, static_cast<float>(dt));
  for (std::size_t c = 0; c < step.colliders.size(); ++c)
    if (!step.colliders[c].options.motion.is_static() && !step.colliders[c].options.sensor)
      step.stage.warnings.guarded("a collider's motion", [&] { wake_near_collider(step, c, dt); });
  for (const std::uint32_t a : sleep.joined.driven)
    wake_island(step.stage.objects, *step.stage.objects.objects[a], sleep);
  sleep.woken = false;  // the search for near pairs follows
  return count_sleepers(step);
}

std::size_t fall_asleep(const SleepView& step, const StartOfStep& start, bool has_force_fields, double dt) {
  if (!step.stage.settings.sleeping.enabled) return 0;
  if (measure_rest(step, start, dt)) {
    find_sleepless(step, has_force_fields);
    find_islands(step);
    put_islands_to_sleep(step);
  }
  return count_sleepers(step);
}

void leave_out_asleep(const ObjectsView& objects, std::span<Projector* const> projectors,
                      SleepScratch& sleep) {
  if (!sleep.changed) return;
  sleep.changed = false;
  sleep.constraints.clear();
  std::vector<IndexRange> particles;
  for (const auto& object : objects.objects) {
    if (object->sleep.island == 0) continue;
    if (!particles.empty() && particles.back().end == object->begin)
      particles.back().end = object->reserved_end();
    else
      particles.push_back({object->begin, object->reserved_end()});
  }
  if (particles.empty()) return;
  for (Projector* projector : projectors) {
    const LinearFacet* const linear = projector->facets().linear;
    std::vector<IndexRange> asleep;
    if (linear != nullptr) linear->append_constraints_of(particles, asleep);
    sleep.constraints.add_ranges(*projector, asleep, projector->size());
  }
}

void wake_island(const ObjectsView& objects, const Object& touched, SleepScratch& sleep) {
  const std::uint32_t island = touched.sleep.island;
  for (const auto& object : objects.objects)
    if (object->id == touched.id || (island != 0 && object->sleep.island == island))
      set_awake(objects.particles, *object, sleep);
}

void wake_all(const ObjectsView& objects, SleepScratch& sleep) {
  for (const auto& object : objects.objects) set_awake(objects.particles, *object, sleep);
}

void wake_particles_of(const ObjectsView& objects, const Projector& projector, SleepScratch& sleep) {
  bool any = false;
  projector.visit(objects.view(), [&](const ConstraintState& constraint) {
    any = true;
    for (const std::uint32_t i : constraint.particles)
      wake_island(objects, *objects.objects[objects.object_of[i]], sleep);
  });
  if (!any && projector.size() > 0) wake_all(objects, sleep);
}

float inverse_mass_awake(const Particles& particles, const Object& object, std::uint32_t particle) {
  if (object.sleep.island == 0) return particles.position[object.begin + particle].w;
  const bool pinned = std::any_of(object.pins.begin(), object.pins.end(),
                                  [&](const PinnedParticle& pin) { return pin.particle == particle; });
  return pinned ? 0 : 1 / particles.mass[object.begin + particle];
}

void update_sleeping_masses(const ObjectsView& objects, SleepScratch& sleep) {
  sleep.changed = true;
  for (const auto& object : objects.objects)
    if (!is_obstacle(*object)) set_inverse_masses(objects.particles, *object);
}

}  // namespace souple
