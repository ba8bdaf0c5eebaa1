#pragma once

#include "plugins/radium/render_mesh.h"

#include <Core/Types.hpp>
#include <Core/Utils/Index.hpp>
#include <Engine/FrameInfo.hpp>
#include <Engine/Scene/System.hpp>
#include <array>
#include <cstdint>
#include <souple/host/drawable.h>
#include <souple/host/session.h>
#include <string>
#include <vector>

namespace Ra::Engine {
class RadiumEngine;
}

namespace souple::radium {

/// A mesh in Radium that Souple can move.
struct LoadedMesh {
  Ra::Core::Utils::Index render_object;
  std::string name;
  std::size_t triangle_count = 0;
  host::Handle object = 0;  ///< 0: not in the world
};

/// A vertex as returned by Radium's picking.
struct PickedVertex {
  Ra::Core::Utils::Index render_object;
  int triangle = -1;  ///< for splats: the vertex
  int corner = -1;    ///< corner of the triangle: 0, 1 or 2; for splats 0
};

/// An object of the world and its mesh in Radium.
struct Body {
  std::string name;
  host::Drawable drawable;
  RenderMesh mesh;
  bool from_scene = false;
  std::array<float, 16> transform{};     ///< the mesh's transform when the world last read it
  std::vector<float> first_positions{};  ///< positions of the mesh when it became an object
  std::vector<float> first_normals{};    ///< normals of the mesh when it became an object
  Ra::Engine::Scene::Component* mark =
      nullptr;  ///< component in Radium's tree; nullptr after its deletion there

  host::Handle object() const { return drawable.object(); }
};

/// A world in Radium, stepped by one task per frame; Souple's threads work inside that task.
///
/// All functions but `generateTasks` are for the thread of the user interface, between frames. Functions that
/// can fail throw souple::Error (one sentence) and leave everything unchanged.
class PhysicsSystem : public Ra::Engine::Scene::System {
 public:
  static constexpr const char* system_name = "Souple";
  /// Registers the system in the engine and makes its time window endless, because a looping window would
  /// reset the world. nullptr if the engine already has one, for example if the plugin is loaded twice.
  static PhysicsSystem* add_to(Ra::Engine::RadiumEngine& engine);
  explicit PhysicsSystem(Ra::Engine::RadiumEngine& engine);

  void generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& frame) override;

  host::Session& session() { return session_; }
  /// Errors and notes since the last call, one sentence each.
  std::vector<std::string> take_messages();

  // --- objects
  /// Replaces the world's contents by a scene file's objects and colliders. The renderer must
  /// then prepare the new ones.
  void open_scene(const std::string& file);
  /// Empties the world: removes a scene's objects and restores Radium's meshes as loaded.
  void clear();
  /// Radium's meshes, except those of a scene's objects.
  std::vector<LoadedMesh> loaded_meshes() const;
  host::Handle add(const Ra::Core::Utils::Index& render_object, host::Kind kind,
                   host::MeshOptions options = {});
  void remove(host::Handle object);
  /// 0 if the mesh is no object.
  host::Handle object_of(const Ra::Core::Utils::Index& render_object) const;

  // --- time of the engine, so that its own buttons have the same effect
  void play();
  void pause();
  void step();
  void reset();
  /// Whether the system plays; false after a failed step.
  bool playing() const;

  // --- the mouse
  bool grab(const PickedVertex& picked, const Ra::Core::Ray& ray, const Ra::Core::Vector3& facing);
  /// Grabs the first object on the ray: Radium picks a surface only from its front.
  bool grab(const Ra::Core::Ray& ray, const Ra::Core::Vector3& facing);
  void drag(const Ra::Core::Ray& ray);
  void release();
  /// Pins a vertex at its current position, or releases it. Returns false if no object was picked.
  bool set_pinned(const PickedVertex& picked, bool pinned);

 protected:
  void unregisterComponent(const Ra::Engine::Scene::Entity* entity,
                           Ra::Engine::Scene::Component* component) override;

 private:
  void show(Body body);
  void hide(Body& body);
  void hide_all();
  void forget_deleted();
  void follow_transforms();
  void draw();
  void run(double time, double dt);
  void begin_here();
  void mend_time_window();
  std::vector<Body>::iterator find(host::Handle object);
  /// Calls `action` with the object and its vertex; returns false if there is none.
  template <class Action>
  bool with_vertex(const PickedVertex& picked, Action action);

  Ra::Engine::RadiumEngine& engine_;
  host::Session session_;
  std::vector<Body> bodies_;
  std::vector<RenderMesh> colliders_;
  std::uint64_t drawn_version_ = 0;
  bool playing_ = false;
  bool first_frame_ = true;
  std::vector<std::string> messages_;
};

}  // namespace souple::radium
