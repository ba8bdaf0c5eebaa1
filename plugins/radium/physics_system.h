#pragma once

#include "plugins/radium/body.h"

#include <Core/Types.hpp>
#include <Core/Utils/Index.hpp>
#include <Engine/FrameInfo.hpp>
#include <Engine/Scene/System.hpp>
#include <cstdint>
#include <souple/host/session.h>
#include <string>
#include <vector>

namespace Ra::Engine {
class RadiumEngine;
}

namespace souple::radium {

/// A mesh that Radium shows and Souple can move.
struct LoadedMesh {
  Ra::Core::Utils::Index render_object;
  std::string name;
  std::size_t triangle_count = 0;
  host::Handle object = 0;  ///< 0: it is not in the world yet
};

/// A vertex as Radium's picking names it.
struct PickedVertex {
  Ra::Core::Utils::Index render_object;
  int triangle = -1;  ///< of splats: the vertex
  int corner = -1;    ///< of the triangle: 0, 1 or 2; of splats 0
};

/// One world in Radium, stepped by one task a frame: Souple's threads work inside it.
///
/// All functions but `generateTasks` are for the thread of the user interface, between frames. Those that can
/// fail throw souple::Error, one sentence, and leave all as it was.
class PhysicsSystem : public Ra::Engine::Scene::System {
 public:
  static constexpr const char* system_name = "Souple";
  /// Makes it the engine's; its time window becomes endless, since a window that loops would reset the world.
  /// nullptr when the engine has one already, as when the plugin is loaded twice.
  static PhysicsSystem* add_to(Ra::Engine::RadiumEngine& engine);
  explicit PhysicsSystem(Ra::Engine::RadiumEngine& engine);

  void generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& frame) override;

  host::Session& session() { return session_; }
  /// What went wrong or is worth knowing since the last call, one sentence each.
  std::vector<std::string> take_messages();

  // --- what is in the world
  /// Shows a scene file's objects and colliders in the place of all that was in the world. The renderer has
  /// yet to prepare what is new.
  void open_scene(const std::string& file);
  /// Empties the world: a scene's objects are gone, Radium's meshes lie again as they were loaded.
  void clear();
  /// Radium's meshes, without those that show a scene's objects.
  std::vector<LoadedMesh> loaded_meshes() const;
  host::Handle add(const Ra::Core::Utils::Index& render_object, host::Kind kind,
                   host::MeshOptions options = {});
  void remove(host::Handle object);
  /// 0 when what is shown is no object.
  host::Handle object_of(const Ra::Core::Utils::Index& render_object) const;

  // --- time: the engine's, so that its own buttons do the same
  void play();
  void pause();
  void step();
  void reset();
  /// Whether `play` was called last; false after a step that failed.
  bool playing() const;

  // --- the mouse
  bool grab(const PickedVertex& picked, const Ra::Core::Ray& ray, const Ra::Core::Vector3& facing);
  /// Whatever the ray meets first: Radium picks a surface from its front only.
  bool grab(const Ra::Core::Ray& ray, const Ra::Core::Vector3& facing);
  void drag(const Ra::Core::Ray& ray);
  void release();
  /// Holds a vertex where it is, or lets it go. False when what was picked is none of an object.
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
  /// Calls `action` with the object and its vertex; false when there is none.
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
