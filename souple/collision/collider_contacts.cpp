#include "souple/collision/collider_contacts.h"

#include "souple/collision/friction.h"
#include "souple/error.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <optional>

namespace souple {
namespace {

Vec3d place(const ParticleView& particles, std::size_t i) {
  const Vec3d x(particles.position[i].xyz());
  return particles.form == Form::displacement ? x + Vec3d(particles.moving[i].xyz()) : x;
}

Vec3d start_place(const ParticleView& particles, std::size_t i) {
  const Vec3d start(particles.start[i].xyz());
  return particles.form == Form::displacement ? Vec3d(particles.position[i].xyz()) + start : start;
}

struct Touch {
  SurfaceDistance surface;
  Vec3d point;
};

// Where a ball of radius r whose centre goes from `from` to `to` first touches a convex shape: sphere tracing
// (Hart 1996), each stride as long as the free distance. Grazing paths may need many strides; one that has
// not passed after 64 is within a hair of the surface and counts as touching.
std::optional<Touch> first_touch(const Shape& shape, const SurfaceDistance& start, const Vec3d& from,
                                 const Vec3d& to, double r) {
  const Vec3d motion = to - from;
  const double path = length(motion);
  if (start.distance <= r) {
    if (dot(start.normal, motion) >= 0) return std::nullopt;
    return Touch{start, from};
  }
  const double near_enough = 1e-4 * (start.distance - r);
  Touch touch{start, from};
  double gone = 0;
  for (int stride = 0; stride < 64; ++stride) {
    const double free = touch.surface.distance - r;
    if (free <= near_enough) break;
    gone += free;
    if (gone >= path) return std::nullopt;
    touch.point = from + motion * (gone / path);
    touch.surface = surface_distance(shape, touch.point);
  }
  return touch;
}

// Whether the straight way between two points at these distances from a surface may lead through it: each
// distance is the radius of a ball free of the shape. A particle that moves more than its radius takes the
// ball it is itself into account as well.
bool may_pass(double start, double end, double path, double r) {
  if (end <= 0 || path >= start + end) return true;
  return path > r && path >= start + end - 2 * r;
}

}  // namespace

ColliderContacts::Pose ColliderContacts::pose_at(const Collider& collider, double time) {
  const Transform pose = collider.motion.at(time);
  return {rotation_matrix(pose.rotation), pose.translation};
}

void ColliderContacts::begin_step(const ParticleView& particles, std::span<const Vec4f> velocity,
                                  std::span<const float> radius, std::span<const ContactObject> objects,
                                  std::span<const Collider> colliders, const SurfaceMatrix& surfaces,
                                  const ContactStep& step) {
  if (!colliders.empty() && (surfaces.rows() < objects.size() || surfaces.columns() < colliders.size()))
    throw Error("ColliderContacts: the surface matrix is smaller than objects x colliders; build it anew");
  colliders_ = colliders, objects_ = objects, radius_ = radius;
  surfaces_ = &surfaces;
  step_ = step;
  report_ = {};
  contacts_.clear();
  candidates_.clear();
  find_bodies();
  find_members();
  find_candidates(particles, velocity, 0);
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
    if (!body.moves) body.before = body.after = pose_at(collider, step_.time);
    bodies_.push_back(body);
  }
}

void ColliderContacts::find_members() {
  members_.clear();
  if (bodies_.empty()) return;
  for (std::uint32_t object = 0; object < objects_.size(); ++object) {
    if (!objects_[object].hits_colliders) continue;
    for (std::uint32_t i = objects_[object].begin; i < objects_[object].end; ++i)
      members_.push_back({i, object});
  }
}

// The margin is twice what a particle goes in a step at its present speed plus what gravity adds: forces and
// neighbours change speeds, and a particle that leaves its margin costs a new broad phase. In the middle of a
// step (h > 0) the speed is that of the predicted motion.
void ColliderContacts::find_candidates(const ParticleView& particles, std::span<const Vec4f> velocity,
                                       float h) {
  candidates_.clear();
  placed_.clear();
  const double t = double(step_.dt);
  for (const Member& member : members_) {
    const std::uint32_t i = member.particle;
    const double speed = h > 0 ? double(length(particles.moved(i)) / h) : double(length(velocity[i].xyz()));
    placed_.push_back(
        {place(particles, i), 2 * t * (speed + double(step_.gravity) * t) + double(radius_[i])});
  }
  for (Body& body : bodies_) {
    body.candidate_begin = candidates_.size();
    if (!body.moves) {
      const Vec3d centre = body.after.to_world(body.ball.center);
      for (std::size_t m = 0; m < members_.size(); ++m) {
        const std::uint32_t i = members_[m].particle;
        const double reach = 3 * placed_[m].margin + 2 * double(radius_[i]);
        const double clear = body.ball.radius + reach;
        if (!(length_squared(placed_[m].at - centre) <= clear * clear)) continue;
        if (surface_distance(shape_of(body), body.after.to_local(placed_[m].at)).distance > reach) continue;
        if (particles.inverse_mass(i) > 0) candidates_.push_back(members_[m]);
      }
    }
    body.candidate_end = candidates_.size();
  }
}

bool ColliderContacts::left_margins(const ParticleView& particles) const {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const double margin = placed_[m].margin;
    if (length_squared(place(particles, members_[m].particle) - placed_[m].at) > margin * margin) return true;
  }
  return false;
}

void ColliderContacts::refresh(const ParticleView& particles, const Substep& substep, double time) {
  last_h_ = substep.h;
  contacts_.clear();
  for (Body& body : bodies_) body.contact_begin = body.contact_end = 0;
  for (Body& body : bodies_) {
    if (!body.moves) continue;
    const Collider& collider = colliders_[body.collider];
    const double end = time + double(substep.h);
    body.after = pose_at(collider, end);
    body.before = collider.motion.jumps(time, end) ? body.after : pose_at(collider, time);
  }
  if (left_margins(particles)) find_candidates(particles, {}, substep.h);
  for (Body& body : bodies_) {
    body.contact_begin = contacts_.size();
    if (body.moves) {
      meet_moving(body, particles, substep.h);
    } else {
      for (std::size_t c = body.candidate_begin; c < body.candidate_end; ++c)
        meet(body, candidates_[c], particles, substep.h);
    }
    body.contact_end = contacts_.size();
  }
}

// A moving collider may go anywhere, so every particle is looked at in every substep: first against a ball.
// The motion of a point at distance D from the ball's centre, relative to the collider, is at most |p - x| +
// |centre's motion| + |R1 - R0| D.
void ColliderContacts::meet_moving(const Body& body, const ParticleView& particles, float h) {
  const Vec3d centre = body.after.to_world(body.ball.center);
  const double shift = length(centre - body.before.to_world(body.ball.center));
  const double turn = sqrt(frobenius_squared(body.after.rotation - body.before.rotation));
  for (const Member& member : members_) {
    const std::uint32_t i = member.particle;
    if (!(particles.inverse_mass(i) > 0)) continue;
    const double D = length(place(particles, i) - centre);
    const double motion = double(length(particles.moved(i))) + shift + turn * D;
    if (!(D <= body.ball.radius + 2 * (motion + double(radius_[i])))) continue;
    meet(body, member, particles, h);
  }
}

// One particle, one collider, both in the collider's frame, where the collider stands still.
void ColliderContacts::meet(const Body& body, const Member& member, const ParticleView& particles, float h) {
  const std::uint32_t i = member.particle;
  const Shape& shape = shape_of(body);
  const double r = double(radius_[i]);
  const Vec3d from = body.before.to_local(start_place(particles, i));
  const Vec3d to = body.after.to_local(place(particles, i));
  const double path = length(to - from);
  const SurfaceDistance end = surface_distance(shape, to);
  // Neither touched on the way nor likely to be pushed in by other constraints.
  if (!(end.distance - r <= max(r, path))) return;

  Contact contact;
  contact.particle = i;
  contact.radius = radius_[i];
  contact.surface = surfaces_->at(member.object, body.collider);
  contact.start = surface_distance(shape, from);
  contact.plane_offset = dot(contact.start.normal, from) - contact.start.distance;
  contact.predicted = Vec3f(body.after.rotation * (to - from));
  const double overlap = contact.start.distance - r;
  contact.allowed = overlap < 0 ? float(min(0.0, overlap + double(step_.depenetration_speed * h))) : 0.0f;
  contact.held = contact.start.distance <= 0;
  if (!contact.held && may_pass(contact.start.distance, end.distance, path, r)) {
    if (const auto touch = first_touch(shape, contact.start, from, to, r)) {
      contact.held = true;
      contact.start = touch->surface;
      contact.plane_offset = dot(touch->surface.normal, touch->point) - touch->surface.distance;
    }
  }
  contacts_.push_back(contact);
}

ColliderContacts::Gap ColliderContacts::gap(const Shape& shape, const Contact& contact, const Vec3d& local) {
  SurfaceDistance surface = contact.held ? contact.start : surface_distance(shape, local);
  if (contact.held || surface.distance <= 0) {
    surface.normal = contact.start.normal;
    surface.distance = dot(surface.normal, local) - contact.plane_offset;
  }
  return {surface.distance - double(contact.radius), surface.normal,
          local - surface.normal * surface.distance};
}

void ColliderContacts::project(int colour, std::size_t begin, std::size_t end, const ParticleView& particles,
                               const Substep&) {
  const Body& body = bodies_[static_cast<std::size_t>(colour)];
  for (std::size_t c = body.contact_begin + begin; c < body.contact_begin + end; ++c)
    project_one(body, contacts_[c], particles);
}

// dn = max(allowed - C, -pushed)          a contact pushes; later iterations may take back what it pushed
// t  = (I - n n^T) (p - x - carried)      tangential displacement relative to the surface
// rubbed' = rubbed - t                    cancels it all; beyond mu_s pushed it is cut to mu_k pushed
void ColliderContacts::project_one(const Body& body, Contact& contact, const ParticleView& particles) const {
  const std::uint32_t i = contact.particle;
  const Gap g = gap(shape_of(body), contact, body.after.to_local(place(particles, i)));
  const float dn = max(float(double(contact.allowed) - g.C), -contact.pushed);
  if (!(dn > 0) && !(contact.pushed > 0)) return;
  contact.pushed += dn;
  if (!(contact.pushed > 0)) {
    particles.correct(i, contact.normal * dn - contact.rubbed);
    contact.pushed = 0;
    contact.rubbed = {};
    return;
  }
  const Vec3f n(body.after.rotation * g.normal);
  if (body.moves) contact.carried = Vec3f(body.after.to_world(g.surface) - body.before.to_world(g.surface));
  const Vec3f relative = particles.moved(i) - contact.carried;
  const Vec3f tangential = relative - n * dot(n, relative);
  const Vec3f wanted = contact.rubbed - n * dot(n, contact.rubbed) - tangential;
  const Vec3f rubbed = within_friction(wanted, contact.surface, contact.pushed);
  particles.correct(i, n * dn + (rubbed - contact.rubbed));
  contact.rubbed = rubbed;
  contact.normal = n;
}

void ColliderContacts::apply_restitution(const ParticleView& particles, std::span<Vec4f> velocity,
                                         const Substep& substep) {
  report_ = {};
  const float h = substep.h;
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      Contact& contact = contacts_[c];
      if (!(contact.pushed > 0)) continue;
      const Vec3f n = contact.normal;
      const Vec3f v = velocity[contact.particle].xyz();
      const Vec3f u = v - contact.carried * (1 / h);
      const float u_n = dot(n, u);
      const float approach = -dot(n, contact.predicted) / h;
      const float target = approach > 2 * step_.gravity * h ? contact.surface.restitution * approach : 0.0f;
      contact.bounced = max(target - u_n, -contact.pushed / h);
      const Vec3f held_back = contact.rubbed * (1 / h);
      const Vec3f wanted = held_back - (u - n * u_n);
      const float pressed = contact.pushed / h + max(contact.bounced, 0.0f);
      const Vec3f change =
          n * contact.bounced + (within_friction(wanted, contact.surface, pressed) - held_back);
      velocity[contact.particle].set_xyz(v + change);

      ++report_.count;
      const Gap g = gap(shape_of(body), contact, body.after.to_local(place(particles, contact.particle)));
      report_.deepest = max(report_.deepest, float(-g.C));
    }
  }
}

void ColliderContacts::events(const ParticleView& particles, std::vector<ContactPush>& out) const {
  const float inverse_h = last_h_ > 0 ? 1 / last_h_ : 0.0f;
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Contact& contact = contacts_[c];
      if (!(contact.pushed > 0)) continue;
      const std::uint32_t i = contact.particle;
      const Gap g = gap(shape_of(body), contact, body.after.to_local(place(particles, i)));
      const float impulse = (contact.pushed * inverse_h + contact.bounced) / particles.inverse_mass(i);
      out.push_back({i, body.collider, Vec3f(body.after.to_world(g.surface)), contact.normal, impulse});
    }
  }
}

Residual ColliderContacts::residual(const ParticleView& particles) const {
  Residual result;
  result.count = contacts_.size();
  for (const Body& body : bodies_) {
    for (std::size_t c = body.contact_begin; c < body.contact_end; ++c) {
      const Vec3d local = body.after.to_local(place(particles, contacts_[c].particle));
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
      const double C = gap(shape_of(body), contacts_[c], body.after.to_local(place(particles, i))).C;
      visitor({{&i, 1}, static_cast<int>(b), 0, static_cast<float>(max(0.0, -C))});
    }
  }
}

void ColliderContacts::erase_particles(std::uint32_t, std::uint32_t) {
  bodies_.clear();
  members_.clear();
  placed_.clear();
  candidates_.clear();
  contacts_.clear();
  report_ = {};
}

std::size_t ColliderContacts::bytes() const {
  return bytes_of(bodies_, members_, placed_, candidates_, contacts_);
}

}  // namespace souple
