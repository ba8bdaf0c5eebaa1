#pragma once

#include "plugins/radium/physics_system.h"
#include "tests/paths.h"

#include <Core/Geometry/TriangleMesh.hpp>
#include <Core/Types.hpp>
#include <Engine/RadiumEngine.hpp>
#include <Engine/Scene/Component.hpp>
#include <Engine/Scene/Entity.hpp>
#include <Engine/Scene/EntityManager.hpp>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::radium {

inline const std::string scenes = source_path("scenes/");
/// The engine's constant step, as a float [s].
constexpr float frame_time = 1.0f / 60;

using Ra::Core::Transform;
using Ra::Core::Vector3;
using Ra::Core::Utils::Index;
using Ra::Engine::Scene::Entity;

/// Triangles as plain numbers.
struct Triangles {
  std::vector<Vector3> vertices;
  std::vector<Ra::Core::Vector3ui> indices;
};
/// A square sheet of 2 * cells * cells triangles, facing up, centered in the XZ plane; as importers deliver
/// meshes: a vertex for each corner of each triangle.
Triangles sheet(int cells, float size);
/// A closed box, each corner of each triangle a vertex of its own.
Triangles box(const Vector3& half);

/// Radium Engine without a window and without OpenGL, with Souple's system.
class Radium : public testing::Test {
 protected:
  Radium();
  ~Radium() override;

  Entity& entity(const std::string& name, const Transform& transform = Transform::Identity());
  /// Adds meshes to Radium in a new entity of that name; returns the indices of their render objects.
  Index show(const std::string& name, const Triangles& mesh,
             const Transform& transform = Transform::Identity());
  Index show_quads(const std::string& name, const std::vector<Vector3>& vertices,
                   const std::vector<Ra::Core::Vector4ui>& quads);
  Index show_polygons(const std::string& name, const std::vector<Vector3>& vertices,
                      const std::vector<std::vector<unsigned>>& polygons);
  Index show_points(const std::string& name, const std::vector<Vector3>& vertices);

  /// The mesh that shows an object or a collider of a scene.
  Index shown(const std::string& name) const;

  /// Runs frames of Radium: its tasks, then the end of the frame. Fails the test if a task fails.
  void frames(int count = 1);
  /// Runs the first frame, before any button press, in which Radium's time advances nevertheless.
  void first_frame() { frames(1); }
  /// Destroys Radium like an application at its end.
  void close();

  std::uint64_t steps() const { return system->session().steps(); }
  host::Session& session() const { return system->session(); }
  /// The system's messages on one line.
  std::string words() const;
  /// Positions of the mesh in Radium.
  RenderMesh mesh(const Index& index) const { return {*engine, index}; }
  /// Position of the vertex in world coordinates [m].
  Vector3 world_vertex(const Index& index, std::size_t vertex) const;
  Ra::Core::Aabb bounding_box(const Index& index) const;
  Ra::Engine::Scene::Component& component(const Index& index) const;

  Ra::Engine::RadiumEngine* engine = nullptr;
  PhysicsSystem* system = nullptr;
};

}  // namespace souple::radium
