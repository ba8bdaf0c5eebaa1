#include "plugins/radium/headless/sight.h"

#include <Engine/RadiumEngine.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

namespace souple::radium {

namespace {

using Ra::Core::Ray;
using Ra::Core::Vector3;

Vector3 vertex(const std::vector<float>& positions, std::size_t v) {
  return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
}

constexpr float none = std::numeric_limits<float>::infinity();

float distance_to_triangle(const std::array<Vector3, 3>& x, const Ray& ray) {
  const Vector3 ab = x[1] - x[0], ac = x[2] - x[0], across = ray.direction().cross(ac);
  const float volume = ab.dot(across);
  if (std::abs(volume) < 1e-12f) return none;
  const Vector3 from_a = ray.origin() - x[0], other = from_a.cross(ab);
  const float u = from_a.dot(across) / volume, v = ray.direction().dot(other) / volume;
  const float t = ac.dot(other) / volume;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : none;
}

/// The corner with the largest weight at the ray's intersection; -1 if another has almost the same weight.
int nearest_corner(const std::array<Vector3, 3>& x, const Ray& ray) {
  const Vector3 point = ray.pointAt(distance_to_triangle(x, ray));
  std::array<float, 3> weights{};
  for (std::size_t k = 0; k < 3; ++k)
    weights[k] = (x[(k + 1) % 3] - point).cross(x[(k + 2) % 3] - point).norm();
  const auto largest = std::max_element(weights.begin(), weights.end());
  for (auto other = weights.begin(); other != weights.end(); ++other)
    if (other != largest && *largest < 1.2f * *other) return -1;
  return static_cast<int>(largest - weights.begin());
}

float distance_to_ball(const Vector3& center, float radius, const Ray& ray) {
  // Radium picks the square around a splat.
  const float t = (center - ray.origin()).dot(ray.direction());
  return ray.distance(center) < 1.5f * radius && t > 0 ? t : none;
}

}  // namespace

Sight::Sight(Window& window, PhysicsSystem& system) : window_(window) {
  for (auto* entity : window.engine().getEntityManager()->getEntities()) {
    for (const auto& component : entity->getComponents()) {
      for (const auto& index : component->getRenderObjects()) {
        const RenderMesh mesh(window.engine(), index);
        if (!mesh.alive()) continue;
        const host::Handle object = system.object_of(index);
        const host::ObjectInfo info = object == 0 ? host::ObjectInfo() : system.session().object(object);
        add(mesh, object == 0 ? nullptr : &info);
      }
    }
  }
}

void Sight::add(const RenderMesh& mesh, const host::ObjectInfo* object) {
  const std::vector<float> positions = mesh.positions(), normals = mesh.normals();
  const std::vector<std::uint32_t> indices = mesh.triangles();
  const std::array<float, 16> matrix = mesh.transform();
  const Ra::Core::Transform to_world(Ra::Core::Matrix4(Eigen::Map<const Ra::Core::Matrix4>(matrix.data())));
  const float thickness = object == nullptr ? -1 : 1.01f * object->radius + 1e-5f;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    Target triangle{{mesh.index(), static_cast<int>(i / 3), 0}, {}, 0, thickness, true};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] = to_world * vertex(positions, indices[i + k]);
      const Vector3 normal = to_world.linear() * vertex(normals, indices[i + k]);
      const Ray from_eye = window_.ray_through(window_.pixel_of(triangle.corners[k]));
      triangle.faces_us = triangle.faces_us && normal.dot(from_eye.direction()) < 0;
    }
    targets_.push_back(triangle);
  }
  if (!indices.empty() || object == nullptr) return;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3 center = to_world * vertex(positions, v);
    targets_.push_back(
        {{mesh.index(), static_cast<int>(v), 0}, {center, center, center}, object->radius, thickness, true});
  }
}

float Sight::distance_along(const Ray& ray, const Target& target) {
  return target.ball_radius > 0 ? distance_to_ball(target.corners[0], target.ball_radius, ray)
                                : distance_to_triangle(target.corners, ray);
}

const Sight::Target* Sight::first_met(const Ray& ray) const {
  const Target* first = nullptr;
  float nearest = none;
  for (const Target& target : targets_) {
    const float distance = distance_along(ray, target);
    if (distance >= nearest) continue;
    nearest = distance;
    first = &target;
  }
  return first;
}

std::vector<VisibleVertex> Sight::visible_vertices(std::size_t count) const {
  std::vector<VisibleVertex> found;
  const std::size_t stride = std::max<std::size_t>(targets_.size() / (20 * count), 1);
  for (std::size_t t = 0; t < targets_.size() && found.size() < count; t += stride) {
    const Target& target = targets_[t];
    if (target.thickness < 0 || !target.faces_us) continue;
    const std::size_t some = target.ball_radius > 0 ? 0 : t % 3;
    const Vector3 beside =
        0.2f * (target.corners[0] + target.corners[1] + target.corners[2]) + 0.4f * target.corners[some];
    // The center of the pixel, where OpenGL samples.
    const Ra::Core::Vector2 at = window_.pixel_of(beside);
    const Ra::Core::Vector2 pixel(std::floor(at.x()) + 0.5f, std::floor(at.y()) + 0.5f);
    const Ray ray = window_.ray_through(pixel);
    if (!window_.shows(pixel) || first_met(ray) != &target) continue;
    const int corner = target.ball_radius > 0 ? 0 : nearest_corner(target.corners, ray);
    if (corner < 0) continue;
    PickedVertex vertex = target.vertex;
    vertex.corner = corner;
    found.push_back({pixel, vertex, target.corners[static_cast<std::size_t>(corner)], target.thickness});
    t += targets_.size() / (2 * count);
  }
  return found;
}

}  // namespace souple::radium
