#include "souple/collision/collider_mesh.h"
#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <cmath>

namespace souple::host {

namespace {

std::vector<float> flat(const std::vector<Vec3f>& values) {
  std::vector<float> numbers;
  numbers.reserve(3 * values.size());
  for (const Vec3f& v : values) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  return numbers;
}

std::array<float, 16> matrix_of(const Transform& pose) {
  const Mat3f turn(rotation_matrix(pose.rotation));
  const Vec3f at(pose.translation);
  const Vec3f &a = turn.column[0], &b = turn.column[1], &c = turn.column[2];
  return {a.x, a.y, a.z, 0, b.x, b.y, b.z, 0, c.x, c.y, c.z, 0, at.x, at.y, at.z, 1};
}

}  // namespace

std::vector<ColliderShape> Session::colliders(double extent) const {
  if (!(extent > 0) || !std::isfinite(extent)) throw Error("colliders: the extent is not a length above 0");
  const World& world = impl_->contents->world();
  std::vector<ColliderShape> shapes;
  for (const ColliderId id : world.colliders()) {
    const Transform pose = world.collider_pose(id);
    const Vec3d origin = rotate(conjugate(pose.rotation), -pose.translation);
    const ColliderMesh mesh = collider_mesh(world.shape(id), origin, extent);
    ColliderShape shape;
    shape.name = world.collider_options(id).name;
    shape.positions = flat(mesh.positions);
    shape.normals = flat(mesh.normals);
    for (const Triangle& triangle : mesh.triangles)
      shape.indices.insert(shape.indices.end(), triangle.begin(), triangle.end());
    const std::optional<std::uint32_t> color = impl_->contents->collider_color(shape.name);
    shape.has_color = color.has_value();
    shape.color = channels_of(color);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

std::vector<std::array<float, 16>> Session::collider_transforms() const {
  const World& world = impl_->contents->world();
  std::vector<std::array<float, 16>> matrices;
  for (const ColliderId id : world.colliders()) matrices.push_back(matrix_of(world.collider_pose(id)));
  return matrices;
}

}  // namespace souple::host
