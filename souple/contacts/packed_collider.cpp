#include "souple/contacts/packed_collider.h"

#include "souple/collision/signed_distance_grid.h"

#include <span>
#include <variant>

namespace souple {
namespace {

void sample_field(const void* field, int count, const float* const (&point)[3], float* distance,
                  float* const (&normal)[3]) {
  for (int i = 0; i < count; ++i) {
    const SurfaceDistance at = static_cast<const SignedDistanceField*>(field)->at(
        {double(point[0][i]), double(point[1][i]), double(point[2][i])});
    distance[i] = float(at.distance);
    for (int axis = 0; axis < 3; ++axis) normal[axis][i] = float(at.normal[axis]);
  }
}

struct PackedShape {
  using Form = kernels::ColliderForm;
  kernels::ColliderShape operator()(const Plane&) const { return {.form = Form::plane}; }
  kernels::ColliderShape operator()(const Sphere& s) const {
    return {.form = Form::sphere, .radius = s.radius};
  }
  kernels::ColliderShape operator()(const Box& b) const {
    return {.form = Form::box, .half_extents = {b.half_extents.x, b.half_extents.y, b.half_extents.z}};
  }
  kernels::ColliderShape operator()(const Capsule& c) const {
    return {.form = Form::capsule, .radius = c.radius, .half_extents = {0, c.half_height, 0}};
  }
  kernels::ColliderShape operator()(const Cylinder& c) const {
    return {.form = Form::cylinder, .radius = c.radius, .half_extents = {0, c.half_height, 0}};
  }
  kernels::ColliderShape operator()(const SignedDistanceField& field) const {
    const SignedDistanceField::Grid& grid = field.grid();
    kernels::ColliderShape shape{.form = Form::field, .sample = sample_field, .field = &field};
    for (int axis = 0; axis < 3; ++axis) {
      shape.grid.origin[axis] = static_cast<float>(grid.origin[axis]);
      shape.grid.blocks[axis] = grid.blocks[static_cast<std::size_t>(axis)];
    }
    shape.grid.spacing = static_cast<float>(grid.spacing);
    shape.grid.corners = grid.corners.data(), shape.grid.slot = grid.slot.data();
    shape.grid.points = grid.points.data();
    return shape;
  }
};

struct Center {
  Vec3d operator()(const Plane&) const { return {}; }
  Vec3d operator()(const SignedDistanceField&) const { return {}; }
  template <class Solid>
  Vec3d operator()(const Solid& solid) const {
    return Vec3d(solid.center);
  }
};

void store(const Vec3d& v, float (&out)[3]) {
  for (int k = 0; k < 3; ++k) out[k] = float(v[k]);
}

kernels::ColliderFrame packed_frame(const Mat3d& axes, const Vec3d& origin) {
  kernels::ColliderFrame frame;
  for (int k = 0; k < 3; ++k) store(axes.column[k], frame.axis[k]);
  store(origin, frame.origin);
  store(origin - Vec3d(Vec3f(origin)), frame.origin_rest);
  return frame;
}

}  // namespace

kernels::ColliderShape packed_shape(const Shape& shape) {
  return std::visit(PackedShape{}, shape);
}

Vec3d center_of(const Shape& shape) {
  return std::visit(Center{}, shape);
}

PackedCollider::PackedCollider(std::uint32_t index, const Collider& of) : collider(index) {
  packed.shape = packed_shape(of.shape);
  packed.moves = !of.motion.is_static();
}

void PackedCollider::follow(const ColliderMotion& motion, double time, float h) {
  if (!packed.moves) return;
  const auto [start, end] = poses_between(motion, time, time + double(h));
  set_pose(start, end);
}

void PackedCollider::set_pose(const RigidPose& at_start, const RigidPose& at_end) {
  before = at_start, after = at_end;
  const Mat3d axes_before = before.rotation * axes, axes_after = after.rotation * axes;
  const Vec3d origin_before = before.to_world(origin), origin_after = after.to_world(origin);
  packed.before = packed_frame(axes_before, origin_before);
  packed.after = packed_frame(axes_after, origin_after);
  for (int k = 0; k < 3; ++k) store(axes_after.column[k] - axes_before.column[k], packed.turn[k]);
  store(origin_after - origin_before, packed.shift);
  // sum_k a_k x (phi x a_k) = 2 phi for three perpendicular unit vectors.
  Vec3d rotation;
  for (int k = 0; k < 3; ++k) rotation += cross(axes_before.column[k], axes_after.column[k]) / 2.0;
  store(rotation, packed.rotation);
}

kernels::ColliderParticles packed_particles(const ParticleView& particles) {
  if (particles.position.empty()) return {};
  const std::span<Vec4f> corrected = particles.corrected.empty() ? particles.moving : particles.corrected;
  return {.position = &particles.position.data()->x,
          .moving = &particles.moving.data()->x,
          .start = &particles.start.data()->x,
          .corrected = &corrected.data()->x};
}

}  // namespace souple
