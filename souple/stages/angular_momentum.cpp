#include "souple/stages/angular_momentum.h"

#include "souple/contacts/contacts.h"
#include "souple/math/disjoint_sets.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/user_constraint.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace souple {
namespace {

constexpr std::uint32_t particles_per_chunk = 1024;

/// Connects particles, and notes which are held.
struct Connections {
  DisjointSets sets;
  std::vector<std::uint32_t> held;

  void add(const ConstraintState& constraint) {
    for (const std::uint32_t i : constraint.particles) sets.join(constraint.particles.front(), i);
    if (constraint.particles.size() == 1) held.push_back(constraint.particles.front());
  }
};

bool gives_way(const StageView& stage, const RigidStage& bodies, std::uint32_t particle) {
  const Object& object = *stage.objects.objects[stage.objects.object_of[particle]];
  return object.traits().rigid ? bodies.is_free(object.id.value)
                               : stage.objects.particles.position[particle].w > 0;
}

}  // namespace

void AngularMomentum::find(const ObjectsView& objects, std::span<Projector* const> projectors,
                           std::span<const UserConstraint> users, Links links) {
  groups_.clear(), ranges_.clear(), chunks_.clear(), changing_.clear();
  links_ = std::move(links);
  known_ = true, any_free_ = false;
  Connections connections{DisjointSets(objects.particles.size()), {}};
  const ParticleView view = objects.view();
  const auto is_custom = [&](const Projector* projector) {
    return std::any_of(users.begin(), users.end(), [&](const UserConstraint& user) {
      return user.is_custom && user.projector.get() == projector;
    });
  };
  for (Projector* const projector : projectors) {
    if (!is_custom(projector)) {
      projector->visit(view, [&](const ConstraintState& constraint) { connections.add(constraint); });
      continue;
    }
    const std::size_t before = connections.held.size();
    projector->visit(view, [&](const ConstraintState& constraint) {
      connections.held.insert(connections.held.end(), constraint.particles.begin(),
                              constraint.particles.end());
    });
    if (connections.held.size() == before) changing_.push_back(projector);
  }
  for (const auto& object : objects.objects)
    for (std::uint32_t i = object->begin; object->traits().rigid && i < object->end; ++i)
      connections.sets.join(object->begin, i);
  for (const auto& [a, b] : links_) {
    if (b == fixed)
      connections.held.push_back(a);
    else
      connections.sets.join(a, b);
  }
  constexpr std::uint32_t unknown = fixed, none = fixed - 1;
  std::vector<std::uint32_t> group(objects.particles.size(), unknown);  // of a set, at its root
  for (const std::uint32_t i : connections.held) group[connections.sets.root(i)] = none;
  std::vector<std::uint32_t> size(objects.particles.size());
  for (const auto& object : objects.objects)
    for (std::uint32_t i = object->begin; !object->traits().rigid && i < object->end; ++i)
      ++size[connections.sets.root(i)];
  for (const auto& object : objects.objects)
    for (std::uint32_t i = object->begin; i < object->end; ++i) {
      const std::uint32_t root = connections.sets.root(i);
      const bool is_rigid = object->traits().rigid;
      if (group[root] == none || size[root] == 0 || (size[root] == 1 && root == i && !is_rigid)) continue;
      if (group[root] == unknown)
        group[root] = static_cast<std::uint32_t>(groups_.size()), groups_.emplace_back().first = i;
      const std::uint32_t g = group[root];
      if (is_rigid && i == object->begin) groups_[g].bodies.push_back(object->id.value);
      const auto append = [&](std::vector<Range>& list, std::uint32_t longest) {
        if (list.empty() || list.back().group != g || list.back().end != i ||
            i - list.back().begin >= longest)
          list.push_back({i, i + 1, g});
        else
          list.back().end = i + 1;
      };
      append(ranges_, fixed);
      if (!is_rigid) append(chunks_, particles_per_chunk);
    }
  of_chunk_.resize(chunks_.size()), of_group_.resize(groups_.size());
}

/// Fills of_group_ with the sums of the groups that are free and not held. motion(i, x, v): position and velocity of a particle.
template <class Motion>
void AngularMomentum::sum(const StageView& stage, const Motion& motion) {
  const std::vector<float>& mass = stage.objects.particles.mass;
  stage.threads.each(chunks_.size(), 1, [&](std::size_t c) {
    const Range& chunk = chunks_[c];
    const Group& group = groups_[chunk.group];
    of_chunk_[c] = {};
    for (std::uint32_t i = chunk.begin; group.turns() && i < chunk.end; ++i) {
      Vec3d x, v;
      motion(i, x, v);
      of_chunk_[c].add(static_cast<double>(mass[i]), x - group.origin, v);
    }
  });
  std::fill(of_group_.begin(), of_group_.end(), RigidSums{});
  for (std::size_t c = 0; c < chunks_.size(); ++c) of_group_[chunks_[c].group].add(of_chunk_[c]);
}

AngularMomentum::Group* AngularMomentum::group_of(std::uint32_t particle) {
  const auto after = std::upper_bound(ranges_.begin(), ranges_.end(), particle,
                                      [](std::uint32_t i, const Range& range) { return i < range.begin; });
  if (after == ranges_.begin() || particle >= (after - 1)->end) return nullptr;
  return &groups_[(after - 1)->group];
}

void AngularMomentum::leave_all() {
  for (Group& group : groups_) group.is_free = false;
}

void AngularMomentum::begin_step(const StageView& stage, const RigidStage& bodies) {
  if (groups_.empty()) return;
  const Particles& particles = stage.objects.particles;
  for (Group& group : groups_)
    group.is_free = std::all_of(group.bodies.begin(), group.bodies.end(),
                                [&](std::uint32_t body) { return bodies.is_free(body); });
  for (const Range& chunk : chunks_) {
    Group& group = groups_[chunk.group];
    // Objects that are tied together sleep together.
    if (stage.objects.objects[stage.objects.object_of[chunk.begin]]->sleep.island != 0) group.is_free = false;
    for (std::uint32_t i = chunk.begin; group.is_free && i < chunk.end; ++i)
      group.is_free = particles.position[i].w > 0;
  }
  for (const Projector* const projector : changing_) {
    bool any = false;
    projector->visit(stage.objects.view(), [&](const ConstraintState& constraint) {
      any = true;
      for (const std::uint32_t i : constraint.particles)
        if (Group* const group = group_of(i)) group->is_free = false;
    });
    for (Group& group : groups_) group.is_free = group.is_free && (any || projector->size() == 0);
  }
}

void AngularMomentum::begin_solve(const StageView& stage, const RigidStage& bodies, double h) {
  const ParticleView view = stage.objects.view();
  any_free_ = std::any_of(groups_.begin(), groups_.end(), [](const Group& group) { return group.is_free; });
  if (!any_free_) return;
  for (Group& group : groups_) group.origin = view.exact_position(group.first), group.held = false;
  sum(stage,
      [&](std::uint32_t i, Vec3d& x, Vec3d& v) { x = view.exact_position(i), v = Vec3d(view.moved(i)) / h; });
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].is_free) continue;
    for (const std::uint32_t body : groups_[g].bodies)
      bodies.add_to(of_group_[g], body, groups_[g].origin, h);
    groups_[g].momentum = of_group_[g].angular;
  }
}

// Impulses act on positions at the substep's start.
void AngularMomentum::end_solve(const StageView& stage, const RigidStage& bodies, const Contacts& contacts,
                                double h) {
  if (!any_free_) return;
  const ParticleView view = stage.objects.view();
  const auto is_body = [&](std::uint32_t i) {
    return stage.objects.objects[stage.objects.object_of[i]]->traits().rigid;
  };
  const auto take = [&](const ContactImpulse& contact) {
    const auto begin = contact.particle.begin(), end = begin + contact.count;
    Group* const first = group_of(*begin);
    const bool within = !contact.by_collider &&
                        std::all_of(begin, end, [&](std::uint32_t i) { return group_of(i) == first; });
    if (within) {
      if (first && first->is_free && std::any_of(begin, end, is_body))
        first->momentum += bodies.moment_of(stage.objects, contact) / h;
      return;
    }
    const bool gives = !contact.by_collider &&
                       std::all_of(begin, end, [&](std::uint32_t i) { return gives_way(stage, bodies, i); });
    for (std::size_t k = 0; k < contact.count; ++k) {
      Group* const group = group_of(contact.particle[k]);
      if (!group || !group->is_free) continue;
      group->held = group->held || !gives;
      const Vec3d x = bodies.start_of(stage.objects, contact.particle[k]) - group->origin;
      group->momentum += cross(x, Vec3d(contact.impulse[k])) / h;
    }
  };
  contacts.visit_impulses(view, std::ref(take));
  for (Group& group : groups_)
    group.held = group.held || std::any_of(group.bodies.begin(), group.bodies.end(),
                                           [&](std::uint32_t body) { return bodies.is_pushed(body); });
  sum(stage,
      [&](std::uint32_t i, Vec3d& x, Vec3d& v) { x = view.exact_position(i), v = Vec3d(view.moved(i)) / h; });
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    if (!group.turns()) continue;
    RigidSums& sums = of_group_[g];
    for (const std::uint32_t body : group.bodies) bodies.add_to(sums, body, group.origin, h);
    group.spin = spin_of(sums.inertia(), group.momentum - sums.angular);
    // More than a radian in a substep, or a number that is not finite, is no correction.
    group.held = !(length_squared(group.spin) * h * h < 1);
  }
}

void AngularMomentum::finish(const StageView& stage, RigidStage& bodies) {
  if (!any_free_) return;
  Particles& particles = stage.objects.particles;
  // The center after keep_apart moved particles: a rotation about another one would change momentum.
  sum(stage, [&](std::uint32_t i, Vec3d& x, Vec3d&) { x = particles.exact_position(i); });
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].turns()) continue;
    for (const std::uint32_t body : groups_[g].bodies)
      bodies.add_to(of_group_[g], body, groups_[g].origin, 0);
    groups_[g].center = groups_[g].origin + of_group_[g].position / of_group_[g].mass;
  }
  stage.threads.each(chunks_.size(), 1, [&](std::size_t c) {
    const Group& group = groups_[chunks_[c].group];
    for (std::uint32_t i = chunks_[c].begin; group.turns() && i < chunks_[c].end; ++i) {
      const Vec3d turn = cross(group.spin, particles.exact_position(i) - group.center);
      particles.velocity[i].set_xyz(Vec3f(Vec3d(particles.velocity[i].xyz()) + turn));
    }
  });
  for (const auto& object : stage.objects.objects) {
    if (!object->traits().rigid) continue;
    const Group* const group = group_of(object->begin);
    if (!group || !group->turns()) continue;
    const Vec3d r = bodies.pose(object->id.value)->position - group->center;
    bodies.change_velocity(particles, *object, {cross(group->spin, r), group->spin});
  }
  any_free_ = false;  // where everything sleeps, the next substep has no solve
}

std::size_t AngularMomentum::bytes() const {
  std::size_t result = bytes_of(links_, groups_, ranges_, chunks_, of_chunk_, of_group_);
  for (const Group& group : groups_) result += bytes_of(group.bodies);
  return result;
}

}  // namespace souple
