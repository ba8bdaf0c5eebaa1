#include "souple/rigid/contact_block.h"

namespace souple {
namespace {

Vec3d world_point(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& local) {
  return body == no_body ? local : poses[body].point(local);
}
Vec3d world_direction(std::span<const BodyPose> poses, std::uint32_t body, const Vec3d& local) {
  return body == no_body ? local : poses[body].direction(local);
}

}  // namespace

PlacedContact place(const RigidContact& contact, const RigidContactPoint& point,
                    std::span<const BodyPose> poses) {
  const Vec3d core_a = world_point(poses, contact.a, point.core_a);
  const Vec3d core_b = world_point(poses, contact.b, point.core_b);
  Vec3d n =
      world_direction(poses, contact.owner == NormalOwner::face_of_b ? contact.b : contact.a, contact.normal);
  if (contact.normal_between_points) {
    const Vec3d between = normalized(core_a - core_b);
    if (length_squared(between) > 0) n = between;
  }
  const Vec3d x_a = core_a - n * contact.radius_a, x_b = core_b + n * contact.radius_b;
  const double C = dot(n, x_a - x_b);
  // Sides that slide leave the point of a face behind: a corner of the other side says where they touch.
  const Vec3d from_a = x_a - n * (C / 2), from_b = x_b + n * (C / 2);
  switch (contact.owner) {
    case NormalOwner::face_of_a:
      return {n, from_b, C};
    case NormalOwner::face_of_b:
      return {n, from_a, C};
    case NormalOwner::edges:
      break;
  }
  return {n, (from_a + from_b) * 0.5, C};
}

}  // namespace souple
