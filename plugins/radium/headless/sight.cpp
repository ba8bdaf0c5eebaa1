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

/// How far along the ray it meets the triangle; infinite when it does not.
float distance_to(const std::array<Vector3, 3>& x, const Ray& ray) {
  constexpr float none = std::numeric_limits<float>::infinity();
  const Vector3 ab = x[1] - x[0], ac = x[2] - x[0], across = ray.direction().cross(ac);
  const float volume = ab.dot(across);
  if (std::abs(volume) < 1e-12f) return none;
  const Vector3 from_a = ray.origin() - x[0], other = from_a.cross(ab);
  const float u = from_a.dot(across) / volume, v = ray.direction().dot(other) / volume;
  const float t = ac.dot(other) / volume;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : none;
}

}  // namespace

Sight::Sight(Window& window, PhysicsSystem& system) : window_(window) {
  for (auto* entity : window.engine().getEntityManager()->getEntities()) {
    for (const auto& component : entity->getComponents()) {
      for (const auto& index : component->getRenderObjects()) {
        const RenderMesh mesh(window.engine(), index);
        const host::Handle object = system.object_of(index);
        if (mesh.alive())
          add(mesh, object == 0 ? -1 : 1.01f * system.session().object(object).radius + 1e-5f);
      }
    }
  }
}

void Sight::add(const RenderMesh& mesh, float thickness) {
  const std::vector<float> positions = mesh.positions();
  const std::vector<std::uint32_t> indices = mesh.triangles();
  const std::array<float, 16> matrix = mesh.transform();
  const Ra::Core::Transform to_world(Ra::Core::Matrix4(Eigen::Map<const Ra::Core::Matrix4>(matrix.data())));
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    Triangle triangle{{mesh.index(), static_cast<int>(i / 3), 0}, {}, thickness};
    for (std::size_t k = 0; k < 3; ++k) triangle.corners[k] = to_world * vertex(positions, indices[i + k]);
    triangles_.push_back(triangle);
  }
}

const Sight::Triangle* Sight::first_met(const Ray& ray) const {
  const Triangle* first = nullptr;
  float nearest = std::numeric_limits<float>::infinity();
  for (const Triangle& triangle : triangles_) {
    const float distance = distance_to(triangle.corners, ray);
    if (distance >= nearest) continue;
    nearest = distance;
    first = &triangle;
  }
  return first;
}

std::vector<VisibleVertex> Sight::visible_vertices(std::size_t count) const {
  std::vector<VisibleVertex> found;
  const std::size_t stride = std::max<std::size_t>(triangles_.size() / (20 * count), 1);
  for (std::size_t t = 0; t < triangles_.size() && found.size() < count; t += stride) {
    const Triangle& triangle = triangles_[t];
    if (triangle.thickness < 0) continue;
    const std::size_t corner = t % 3;
    const Vector3 &own = triangle.corners[corner], &next = triangle.corners[(corner + 1) % 3],
                  &last = triangle.corners[(corner + 2) % 3];
    // The middle of the pixel: OpenGL looks there.
    const Ra::Core::Vector2 at = window_.pixel_of(0.6f * own + 0.2f * next + 0.2f * last);
    const Ra::Core::Vector2 pixel(std::floor(at.x()) + 0.5f, std::floor(at.y()) + 0.5f);
    if (first_met(window_.ray_through(pixel)) != &triangle) continue;
    PickedVertex vertex = triangle.first_corner;
    vertex.corner = static_cast<int>(corner);
    found.push_back({pixel, vertex, own, triangle.thickness});
    t += triangles_.size() / (2 * count);
  }
  return found;
}

}  // namespace souple::radium
