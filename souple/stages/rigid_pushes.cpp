#include "souple/contacts/contact.h"
#include "souple/objects/object.h"
#include "souple/stages/rigid_stage.h"
#include "souple/stages/stage_view.h"

#include <limits>

// The contacts of rigid bodies with each other and with colliders, as World::contacts tells them.

namespace souple {
namespace {

struct Place {
  Vec3d point{}, normal{};
};

/// Where a contact is: halfway between its sides, at the corner if one side is a face.
Place place_of(const RigidContact& contact, const RigidContactPoint& point, const RigidBodies& bodies) {
  const BodyPose &a = bodies.pose[contact.a], &b = bodies.pose[contact.b];
  const Vec3d core_a = a.point(point.core_a), core_b = b.point(point.core_b);
  Vec3d n = (contact.owner == NormalOwner::face_of_b ? b : a).direction(contact.normal);
  if (contact.normal_between_points && length_squared(core_a - core_b) > 0) n = normalized(core_a - core_b);
  const Vec3d x_a = core_a - n * contact.radius_a, x_b = core_b + n * contact.radius_b;
  if (contact.owner == NormalOwner::face_of_a) return {x_b, n};
  if (contact.owner == NormalOwner::face_of_b) return {x_a, n};
  return {(x_a + x_b) * 0.5, n};
}

std::uint32_t nearest_particle(const Object& object, const RigidDefinition& body, const Vec3d& local) {
  std::uint32_t result = object.begin;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < body.particles.size(); ++k) {
    const double d = length_squared(body.particles[k] - local);
    if (d < least) least = d, result = object.begin + k;
  }
  return result;
}

}  // namespace

bool RigidStage::pushes(const RigidContact& contact) const {
  return contact.a != no_body && contact.b != no_body &&
         (moves(bodies_, contact.a) || moves(bodies_, contact.b));
}

std::size_t RigidStage::push_count() const {
  std::size_t result = 0;
  for (const RigidContact& contact : finder_.contacts())
    for (std::uint32_t k = 0; pushes(contact) && k < contact.count; ++k)
      if (contact.points[k].normal_impulse > 0) ++result;
  return result;
}

void RigidStage::append_pushes(const StageView& stage, bool nearest, std::vector<ContactPush>& out) const {
  if (!listed_ || !(h_ > 0)) return;
  const auto particle = [&](std::uint32_t body, const Vec3d& x) {
    const Object& object = *stage.objects.objects[rows_[body]];
    if (!nearest) return object.begin;
    const Vec3d local = bodies_.pose[body].local_point(x);
    if (body < records_.size()) return nearest_particle(object, records_[body].definition, local);
    return object.begin + shapes_[body].mesh->nearest_vertex(local);
  };
  for (const RigidContact& contact : finder_.contacts()) {
    if (!pushes(contact)) continue;
    const bool turned_around = contact.a >= records_.size();  // a collider or an obstacle
    const std::uint32_t one = turned_around ? contact.b : contact.a;
    const std::uint32_t other = turned_around ? contact.a : contact.b;
    for (std::uint32_t k = 0; k < contact.count; ++k) {
      const RigidContactPoint& point = contact.points[k];
      if (!(point.normal_impulse > 0)) continue;
      const Place at = place_of(contact, point, bodies_);
      const bool against_collider = is_collider(other);
      out.push_back({particle(one, at.point), against_collider ? rows_[other] : particle(other, at.point),
                     Vec3f(at.point), Vec3f(turned_around ? -at.normal : at.normal),
                     static_cast<float>(point.normal_impulse / h_), against_collider});
    }
  }
}

}  // namespace souple
