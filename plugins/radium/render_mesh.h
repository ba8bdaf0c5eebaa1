#pragma once

#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Utils/Index.hpp>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace Ra::Engine {
class RadiumEngine;
namespace Rendering {
class RenderObject;
}
namespace Scene {
class Entity;
}
}  // namespace Ra::Engine

namespace souple::radium {

/// x, y, z of each vector.
Ra::Core::Vector3Array vectors(const std::vector<float>& values);

/// A mesh of Radium (triangles, quads, polygons or points) as plain numbers. It does
/// not keep the mesh alive; all functions but `alive` and `index` require a mesh that is.
class RenderMesh {
 public:
  RenderMesh() = default;
  /// Alive only if this render object is a mesh.
  RenderMesh(Ra::Engine::RadiumEngine& engine, const Ra::Core::Utils::Index& render_object);

  /// Whether the mesh still exists in Radium, with its initial number of vertices.
  bool alive() const;
  Ra::Core::Utils::Index index() const { return index_; }
  std::string name() const;
  Ra::Engine::Scene::Entity& entity() const;

  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t triangle_count() const;
  std::vector<float> positions() const;  ///< x, y, z of each vertex, in mesh coordinates
  std::vector<float> normals()
      const;  ///< x, y, z of each normal, in mesh coordinates; empty if there are none
  /// Three vertices per triangle; quads and polygons are triangulated as in Radium, so that a picked index
  /// names the same triangle here.
  std::vector<std::uint32_t> triangles() const;
  /// From mesh coordinates to the world: 4 x 4, column-major.
  std::array<float, 16> transform() const;

  /// Sets x, y, z of each vertex, and of each normal unless that is empty. Updates the bounding box.
  void set_vertices(const std::vector<float>& positions, const std::vector<float>& normals);
  /// Transform from mesh coordinates to the entity's.
  void set_local_transform(const std::array<float, 16>& transform);

 private:
  Ra::Core::Geometry::AttribArrayGeometry& geometry() const;

  Ra::Engine::RadiumEngine* engine_ = nullptr;
  Ra::Core::Utils::Index index_;
  std::weak_ptr<Ra::Engine::Rendering::RenderObject> object_;
  std::size_t vertex_count_ = 0;
};

}  // namespace souple::radium
