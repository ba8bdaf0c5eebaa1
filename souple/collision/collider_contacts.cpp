#include "souple/collision/collider_contacts.h"

#include "souple/collision/contact_law.h"
#include "souple/collision/particle_position.h"
#include "souple/collision/sphere_cast.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <atomic>
#include <limits>

namespace souple {
namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();
constexpr std::size_t particle_grain = 256;  // least number of particles that pays for a thread

}  // namespace

void ColliderContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                  std::span<const float> radius, std::span<const ContactObject> objects,
                                  std::span<const Collider> colliders, const ContactMaterialTable& materials,
                                  const ContactStep& step, Threads& threads) {
  if (!colliders.empty() && (materials.rows() < objects.size() || materials.columns() < colliders.size()))
    throw Error("ColliderContacts: the material table is smaller than objects x colliders; rebuild it");
  colliders_ = colliders, objects_ = objects, radius_ = radius;
  materials_ = &materials;
  step_ = step;
  contacts_.clear();
  candidates_.clear();
  find_bodies();
  find_members();
  find_candidates(particles, velocity, 0, threads);
}

void ColliderContacts::find_bodies() {
  bodies_.clear();
  for (std::uint32_t c = 0; c < colliders_.size(); ++c) {
    const Collider& collider = colliders_[c];
    if (!collider.enabled) continue;
    Body body;
    body.collider = c;
    body.moves = !collider.motion.is_static();
    body.ball = bounding_ball(collider.shape);
    if (!body.moves) body.before = body.after = pose_at(collider.motion, step_.time);
    body.center = body.after.to_world(body.ball.center);
    bodies_.push_back(body);
  }
}

void ColliderContacts::find_members() {
  members_.clear();
  if (bodies_.empty()) return;
  for (std::uint32_t object = 0; object < objects_.size(); ++object) {
    if (!objects_[object].collides_with_colliders) continue;
    for (std::uint32_t i = objects_[object].begin; i < objects_[object].end; ++i)
      members_.push_back({i, object});
  }
}

// The margin is the particle's radius plus twice its path in a step at its present speed and under gravity:
// forces and neighbors change speeds, and a particle that leaves its margin costs a new broad phase. In the
// middle of a step (h > 0) the speed is that of the predicted motion.
void ColliderContacts::find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity,
                                       float h, Threads& threads) {
  candidates_.clear();
  broad_phase_.resize(members_.size());
  distance_.resize(members_.size());
  const double t = double(step_.dt);
  threads.for_each(members_.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const std::uint32_t i = members_[m].particle;
      const double speed = h > 0 ? double(length(particles.moved(i)) / h) : double(length(velocity[i].xyz()));
      broad_phase_[m] = {particle_position(particles, i),
                         2 * t * (speed + double(step_.gravity) * t) + double(radius_[i])};
    }
  });
  for (Body& body : bodies_) {
    body.candidate_begin = candidates_.size();
    if (!body.moves) {
      threads.for_each(members_.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m)
          distance_[m] = is_candidate(body, m, particles) ? 0 : far_away;
      });
      for (std::size_t m = 0; m < members_.size(); ++m)
        if (distance_[m] < far_away) candidates_.push_back(members_[m]);
    }
    body.candidate_end = candidates_.size();
  }
}

bool ColliderContacts::is_candidate(const Body& body, std::size_t member,
                                    const ParticleView& particles) const {
  const std::uint32_t i = members_[member].particle;
  if (!materials_->collide(members_[member].object, body.collider)) return false;
  const BroadPhasePosition& last = broad_phase_[member];
  const double max_distance = 3 * last.margin + 2 * double(radius_[i]);
  const double clear = body.ball.radius + max_distance;
  if (!(length_squared(last.at - body.center) <= clear * clear)) return false;
  if (surface_distance(shape_of(body), body.after.to_local(last.at)).distance > max_distance) return false;
  return particles.inverse_mass(i) > 0;
}

bool ColliderContacts::left_margins(const ParticleView& particles, Threads& threads) const {
  std::atomic<bool> left{false};
  threads.for_each(members_.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const double margin = broad_phase_[m].margin;
      if (!(length_squared(particle_position(particles, members_[m].particle) - broad_phase_[m].at) >
            margin * margin))
        continue;
      left.store(true, std::memory_order_relaxed);
      return;
    }
  });
  return left.load(std::memory_order_relaxed);
}

void ColliderContacts::refresh(const ParticleView& particles, const Substep& substep, double time,
                               Threads& threads) {
  last_h_ = substep.h;
  contacts_.clear();
  for (Body& body : bodies_) body.contact_begin = body.contact_end = 0;
  for (Body& body : bodies_) {
    if (!body.moves) continue;
    const auto [before, after] =
        poses_between(colliders_[body.collider].motion, time, time + double(substep.h));
    body.before = before, body.after = after;
    body.center = body.after.to_world(body.ball.center);
    body.shift = length(body.center - body.before.to_world(body.ball.center));
    body.turn = sqrt(frobenius_squared(body.after.rotation - body.before.rotation));
  }
  if (left_margins(particles, threads)) find_candidates(particles, {}, substep.h, threads);
  for (Body& body : bodies_) find_contacts(body, particles, substep.h, threads);
}

// All threads find the near particles; one thread then counts them in order. So contacts and their order do
// not depend on the number of threads.
void ColliderContacts::find_contacts(Body& body, const ParticleView& particles, float h, Threads& threads) {
  const std::span<const Member> all = candidates_;
  const std::span<const Member> tested =
      body.moves ? std::span<const Member>(members_)
                 : all.subspan(body.candidate_begin, body.candidate_end - body.candidate_begin);
  distance_.resize(std::max(distance_.size(), tested.size()));
  threads.for_each(tested.size(), particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      const bool candidate = !body.moves || may_touch(body, tested[m], particles);
      distance_[m] = candidate ? distance_if_near(body, tested[m], particles) : far_away;
    }
  });
  near_.clear();
  for (std::uint32_t m = 0; m < tested.size(); ++m)
    if (distance_[m] < far_away) near_.push_back(m);
  body.contact_begin = contacts_.size();
  body.contact_end = contacts_.size() + near_.size();
  if (contacts_.capacity() < body.contact_end) contacts_.reserve(2 * body.contact_end);
  contacts_.resize(body.contact_end);
  threads.for_each(near_.size(), grain(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      contacts_[body.contact_begin + k] =
          contact_of(body, tested[near_[k]], distance_[near_[k]], particles, h);
  });
}

// The path of a moving collider is not known in advance, so every substep tests every particle, first against
// the bounding ball. The motion of a point at distance D from the ball's center, relative to the collider, is
// at most |p - x| + |center's motion| + |R1 - R0| D.
bool ColliderContacts::may_touch(const Body& body, const Member& member,
                                 const ParticleView& particles) const {
  const std::uint32_t i = member.particle;
  if (!(particles.inverse_mass(i) > 0) || !materials_->collide(member.object, body.collider)) return false;
  const double D = length(particle_position(particles, i) - body.center);
  const double motion = double(length(particles.moved(i))) + body.shift + body.turn * D;
  return D <= body.ball.radius + 2 * (motion + double(radius_[i]));
}

// Distance of the particle's center from the surface at the substep's end. far_away when the particle did not
// touch the surface during the substep and other constraints are unlikely to push it in. Start and end of the
// motion are in the collider's frame, where the collider is at rest.
double ColliderContacts::distance_if_near(const Body& body, const Member& member,
                                          const ParticleView& particles) const {
  const std::uint32_t i = member.particle;
  const double r = double(radius_[i]);
  const Vec3d to = body.after.to_local(particle_position(particles, i));
  const double path = length(to - body.before.to_local(particle_start_position(particles, i)));
  const double distance = surface_distance(shape_of(body), to).distance;
  return distance - r <= max(r, path) ? distance : far_away;
}

ColliderContacts::Contact ColliderContacts::contact_of(const Body& body, const Member& member,
                                                       double end_distance, const ParticleView& particles,
                                                       float h) const {
  const std::uint32_t i = member.particle;
  const Shape& shape = shape_of(body);
  const double r = double(radius_[i]);
  const Vec3d from = body.before.to_local(particle_start_position(particles, i));
  const Vec3d to = body.after.to_local(particle_position(particles, i));
  Contact contact;
  contact.particle = i;
  contact.radius = radius_[i];
  contact.material = materials_->at(member.object, body.collider);
  contact.start = surface_distance(shape, from);
  contact.plane_offset = dot(contact.start.normal, from) - contact.start.distance;
  contact.predicted = Vec3f(body.after.rotation * (to - from));
  const double overlap = contact.start.distance - r;
  contact.slop = overlap < 0 ? float(min(0.0, overlap + double(step_.depenetration_speed * h))) : 0.0f;
  contact.fixed_plane = contact.start.distance <= 0;
  if (!contact.fixed_plane && may_tunnel(contact.start.distance, end_distance, length(to - from), r)) {
    if (const auto hit = sphere_cast(shape, contact.start, from, to, r)) {
      contact.fixed_plane = true;
      contact.start = hit->surface;
      contact.plane_offset = dot(hit->surface.normal, hit->point) - hit->surface.distance;
    }
  }
  return contact;
}

ColliderContacts::Gap ColliderContacts::gap(const Shape& shape, const Contact& contact, const Vec3d& local) {
  SurfaceDistance surface = contact.fixed_plane ? contact.start : surface_distance(shape, local);
  if (contact.fixed_plane || surface.distance <= 0) {
    surface.normal = contact.start.normal;
    surface.distance = dot(surface.normal, local) - contact.plane_offset;
  }
  return {surface.distance - double(contact.radius), surface.normal,
          local - surface.normal * surface.distance};
}

void ColliderContacts::project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const Substep&) {
  const Body& body = bodies_[static_cast<std::size_t>(color)];
  for (std::size_t c = body.contact_begin + begin; c < body.contact_begin + end; ++c)
    project_one(body, contacts_[c], particles);
}

// dn = max(slop - C, -N)                     N, the normal sum: never negative, later iterations may reduce
// it t  = (I - n n^T) (p - x - surface motion)  tangential displacement relative to the surface T' = T - t
// T, the tangent sum, cancels t; beyond mu_s N it is cut to mu_k N
void ColliderContacts::project_one(const Body& body, Contact& contact, const ParticleView& particles) const {
  const std::uint32_t i = contact.particle;
  const Gap g = gap(shape_of(body), contact, body.after.to_local(particle_position(particles, i)));
  const auto C = float(g.C);
  const Vec3f moved = particles.moved(i), n(body.after.rotation * g.normal);
  contact.offset = C - dot(n, moved);
  contact.normal = n;
  if (!(contact.slop > C) && !(contact.normal_sum > 0)) return;
  if (body.moves)
    contact.surface_motion = Vec3f(body.after.to_world(g.surface) - body.before.to_world(g.surface));
  solve(contact, C, moved, particles);
}

void ColliderContacts::solve(Contact& contact, float C, const Vec3f& moved, const ParticleView& particles) {
  ContactSums<float> sums{contact.normal_sum, contact.tangent_sum};
  particles.correct(contact.particle, solve_contact(sums, C, contact.slop, contact.normal,
                                                    moved - contact.surface_motion, contact.material));
  contact.normal_sum = sums.normal_sum;
  contact.tangent_sum = sums.tangent_sum;
}

void ColliderContacts::find_touching(std::span<const std::uint32_t> chosen,
                                     std::vector<std::uint32_t>& found) const {
  for (std::uint32_t c = 0; c < contacts_.size(); ++c)
    if (chosen[contacts_[c].particle] != unchosen) found.push_back(c);
}

bool ColliderContacts::removes_overlaps() const {
  return std::any_of(contacts_.begin(), contacts_.end(),
                     [](const Contact& contact) { return contact.slop < 0; });
}

// A contact that touches for the first time while its plane is used again takes the surface motion of a plane that
// has not been projected, 0: on a moving collider the exact projections that follow correct its friction.
void ColliderContacts::project_some(std::span<const std::uint32_t> contacts, const ParticleView& particles,
                                    bool again) {
  auto body = bodies_.begin();
  for (const std::uint32_t c : contacts) {
    Contact& contact = contacts_[c];
    if (!again) {
      while (c >= body->contact_end) ++body;
      project_one(*body, contact, particles);
      continue;
    }
    const Vec3f moved = particles.moved(contact.particle);
    const float C = contact.offset + dot(contact.normal, moved);
    if (contact.slop > C || contact.normal_sum > 0) solve(contact, C, moved, particles);
  }
}

void ColliderContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                         const Substep& substep, Threads& threads) {
  for (const Body& body : bodies_)
    threads.for_each(body.contact_end - body.contact_begin, grain(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = body.contact_begin + begin; c < body.contact_begin + end; ++c)
        apply_restitution_to(body, contacts_[c], particles, velocity, substep.h);
    });
}

void ColliderContacts::apply_restitution_to(const Body& body, Contact& contact, const ParticleView& particles,
                                            std::span<Vec4f> velocity, float h) const {
  if (!(contact.normal_sum > 0)) return;
  const Vec3f n = contact.normal;
  const Vec3f v = velocity[contact.particle].xyz();
  const Vec3f u = v - contact.surface_motion * (1 / h);
  const float inverse_h = 1 / h;
  const auto [change, restitution_velocity] = solve_restitution(
      {contact.normal_sum, contact.tangent_sum}, n, u, -dot(n, contact.predicted) * inverse_h,
      2 * step_.gravity * h, contact.material, inverse_h);
  contact.restitution_velocity = restitution_velocity;
  velocity[contact.particle].set_xyz(v + change);
  const Gap g =
      gap(shape_of(body), contact, body.after.to_local(particle_position(particles, contact.particle)));
  contact.depth = max(0.0f, float(-g.C));
}

void ColliderContacts::append_impacts(const Substep& substep, std::vector<Impact>& out) const {
  const float inverse_h = 1 / substep.h;
  for (const Contact& contact : contacts_) {
    const float approach = -dot(contact.normal, contact.predicted) * inverse_h;
    if (!(contact.normal_sum > 0) || !(contact.material.restitution > 0) ||
        !(approach > 2 * step_.gravity * substep.h))
      continue;
    out.push_back({contact.particle, Impact::collider, contact.normal, approach, contact.material.restitution,
                   contact.surface_motion * inverse_h});
  }
}

ContactReport ColliderContacts::report() const {
  return report_of(contacts_);
}

void ColliderContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Contact& contact = contacts_[c];
      if (!(contact.normal_sum > 0)) continue;
      const std::uint32_t i = contact.particle;
      const Gap g = gap(shape_of(body), contact, body.after.to_local(particle_position(particles, i)));
      const float impulse =
          (contact.normal_sum * inverse_h + contact.restitution_velocity) / particles.inverse_mass(i);
      out.push_back({i, body.collider, Vec3f(body.after.to_world(g.surface)), contact.normal, impulse});
    }
  }
}

Residual ColliderContacts::residual(const ParticleView& particles) const {
  Residual result;
  result.count = contacts_.size();
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Vec3d local = body.after.to_local(particle_position(particles, contacts_[c].particle));
      const double violation = max(0.0, -gap(shape_of(body), contacts_[c], local).C);
      result.largest = max(result.largest, violation);
      result.sum += violation;
    }
  }
  return result;
}

void ColliderContacts::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const std::uint32_t i = contacts_[c].particle;
      const double C =
          gap(shape_of(body), contacts_[c], body.after.to_local(particle_position(particles, i))).C;
      visitor({{&i, 1}, static_cast<int>(b), 0, static_cast<float>(max(0.0, -C))});
    }
  }
}

void ColliderContacts::erase_particles(std::uint32_t, std::uint32_t) {
  bodies_.clear();
  members_.clear();
  broad_phase_.clear();
  candidates_.clear();
  contacts_.clear();
}

std::size_t ColliderContacts::bytes() const {
  return bytes_of(bodies_, members_, broad_phase_, candidates_, contacts_);
}

}  // namespace souple
