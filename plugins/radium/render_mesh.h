#pragma once

#include <Core/Utils/Index.hpp>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace Ra::Core::Geometry {
class AttribArrayGeometry;
}
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

/// What Radium shows of one of its meshes (triangles, quads, polygons or points), as plain numbers. It does
/// not keep the mesh alive; all functions but `alive` and `index` ask for one that is.
class RenderMesh {
 public:
  RenderMesh() = default;
  /// Not alive unless this render object is shown as a mesh.
  RenderMesh(Ra::Engine::RadiumEngine& engine, const Ra::Core::Utils::Index& render_object);

  /// Whether Radium still has it, with as many vertices as at first.
  bool alive() const;
  Ra::Core::Utils::Index index() const { return index_; }
  std::string name() const;
  Ra::Engine::Scene::Entity& entity() const;

  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t triangle_count() const;
  std::vector<float> positions() const;  ///< x, y, z of each vertex, in the mesh's own coordinates
  std::vector<float> normals() const;    ///< the same; empty when it has none
  /// Three vertices a triangle; quads and polygons cut as Radium cuts them, so that what is picked names
  /// the same triangle here.
  std::vector<std::uint32_t> triangles() const;
  /// From the mesh's own coordinates to the world: 4 x 4, column-major.
  std::array<float, 16> transform() const;

  /// x, y, z of each vertex, and of each normal unless that is empty. Its bounding box follows.
  void set_vertices(const std::vector<float>& positions, const std::vector<float>& normals);
  /// From its own coordinates to its entity's.
  void set_local_transform(const std::array<float, 16>& transform);

 private:
  Ra::Core::Geometry::AttribArrayGeometry& geometry() const;

  Ra::Engine::RadiumEngine* engine_ = nullptr;
  Ra::Core::Utils::Index index_;
  std::weak_ptr<Ra::Engine::Rendering::RenderObject> object_;
  std::size_t vertex_count_ = 0;
};

}  // namespace souple::radium
