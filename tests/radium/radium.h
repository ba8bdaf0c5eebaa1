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
/// The engine's own constant step, as the float that it is [s].
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
/// A square sheet of 2 * cells * cells triangles, seen from above, centered in the XZ plane; as importers hand
/// meshes out: each corner a vertex of its own.
Triangles sheet(int cells, float size);
/// A closed box, each corner of each triangle a vertex of its own.
Triangles box(const Vector3& half);

/// A Radium without a window and without OpenGL, with Souple's system in it.
class Radium : public testing::Test {
 protected:
  Radium();
  ~Radium() override;

  Entity& entity(const std::string& name, const Transform& transform = Transform::Identity());
  /// Radium's meshes in a new entity of that name; each is the index of its render object.
  Index show(const std::string& name, const Triangles& mesh,
             const Transform& transform = Transform::Identity());
  Index show_quads(const std::string& name, const std::vector<Vector3>& vertices,
                   const std::vector<Ra::Core::Vector4ui>& quads);
  Index show_polygons(const std::string& name, const std::vector<Vector3>& vertices,
                      const std::vector<std::vector<unsigned>>& polygons);
  Index show_points(const std::string& name, const std::vector<Vector3>& vertices);

  /// Frames of Radium: its tasks, then the end of the frame. Not one task fails in silence.
  void frames(int count = 1);
  /// The frame before anybody pressed a button, in which Radium's time goes on nevertheless.
  void first_frame() { frames(1); }
  /// As an application does when it ends.
  void close();

  std::uint64_t steps() const { return system->session().steps(); }
  host::Session& session() const { return system->session(); }
  /// What the system has to say, in one line.
  std::string words() const;
  /// The mesh as Radium has it.
  RenderMesh mesh(const Index& index) const { return {*engine, index}; }
  /// The vertex in the world's coordinates [m].
  Vector3 world_vertex(const Index& index, std::size_t vertex) const;
  Ra::Core::Aabb bounding_box(const Index& index) const;
  Ra::Engine::Scene::Component& component(const Index& index) const;

  Ra::Engine::RadiumEngine* engine = nullptr;
  PhysicsSystem* system = nullptr;
};

}  // namespace souple::radium
