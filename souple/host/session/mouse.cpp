#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

// Picking, grabbing and dragging with the mouse.

namespace souple::host {

namespace {

/// Intersection of a ray with the plane of a triangle; the corner `otherwise` if there is none.
Vec3f on_triangle(const Ray& ray, const Vec3f (&x)[3], const Vec3f& otherwise) {
  const Vec3d a(x[0]), origin(ray.origin), direction(ray.direction);
  const Vec3d normal = cross(Vec3d(x[1]) - a, Vec3d(x[2]) - a);
  const Vec3d at = origin + direction * (dot(a - origin, normal) / dot(direction, normal));
  // A distant intersection means that the triangle is seen edge-on.
  const double size = std::max(length(Vec3d(x[1]) - a), length(Vec3d(x[2]) - a));
  return is_finite(at) && length(at - Vec3d(otherwise)) < 2 * size ? Vec3f(at) : otherwise;
}

}  // namespace

std::uint32_t Session::Impl::world_vertex(const Item& item, const World& world, std::uint32_t vertex) {
  const std::size_t count = item.mesh ? item.mesh->weld.vertex_count() : world.positions(item.id).size();
  if (vertex >= count)
    throw Error(fmt::format("{}: there is no vertex {}, it has {}", item.name, vertex, count));
  return item.mesh ? item.mesh->weld.particle_of()[vertex] : vertex;
}

bool Session::Impl::take_hold(const Item& item, std::uint32_t vertex, const Vec3f& point, const Ray& ray,
                              const Vec3f& facing) {
  const DragPlane across(point, ray, facing);
  hand.reset();
  plane.reset();
  if (item.kind == Kind::obstacle) return false;
  hand.emplace(contents->world(), item.id, vertex, point);
  if (!hand->holds()) {
    hand.reset();
    return false;
  }
  plane = across;
  return true;
}

bool Session::grab_vertex(Handle object, std::uint32_t vertex, const Ray& ray, const Vec3f& facing) {
  const Item& item = impl_->contents->item(object);
  const World& world = impl_->contents->world();
  const std::uint32_t held = Impl::world_vertex(item, world, vertex);
  return impl_->take_hold(item, held, world.positions(item.id)[held], ray, facing);
}

bool Session::grab_triangle(Handle object, std::uint32_t triangle, const Ray& ray, const Vec3f& facing) {
  const Item& item = impl_->contents->item(object);
  const World& world = impl_->contents->world();
  const std::size_t count = item.mesh ? item.mesh->weld.triangle_count() : world.triangles(item.id).size();
  if (triangle >= count)
    throw Error(fmt::format("{}: there is no triangle {}, it has {}", item.name, triangle, count));
  const Triangle& corners =
      item.mesh ? item.mesh->weld.render_triangles()[triangle] : world.triangles(item.id)[triangle];
  Vec3f x[3];
  std::uint32_t vertices[3];
  for (std::size_t k = 0; k < 3; ++k) {
    vertices[k] = Impl::world_vertex(item, world, corners[k]);
    x[k] = world.positions(item.id)[vertices[k]];
  }
  const Vec3f point = on_triangle(ray, x, x[0]);
  const auto nearer = [&](std::size_t a, std::size_t b) {
    return length(x[a] - point) <= length(x[b] - point);
  };
  const std::size_t first = nearer(0, 1) ? 0 : 1, nearest = nearer(first, 2) ? first : 2;
  return impl_->take_hold(item, vertices[nearest], point, ray, facing);
}

bool Session::grab(const Ray& ray, const Vec3f& facing) {
  const Hit hit = impl_->contents->world().ray_cast(ray.origin, ray.direction);
  const Item* item = hit.found && !hit.is_collider ? impl_->contents->find(hit.object) : nullptr;
  if (item != nullptr) return impl_->take_hold(*item, hit.vertex, hit.point, ray, facing);
  release();
  return false;
}

void Session::drag(const Ray& ray) {
  if (grabbing()) impl_->hand->move_to(impl_->plane->drag(ray));
}

void Session::release() {
  impl_->hand.reset();
  impl_->plane.reset();
}

bool Session::grabbing() const {
  return impl_->hand && impl_->hand->holds();
}
Vec3f Session::grabbed_point() const {
  return grabbing() ? impl_->hand->point() : drag_target();
}
Vec3f Session::drag_target() const {
  return impl_->plane ? impl_->plane->point() : Vec3f{};
}

}  // namespace souple::host
