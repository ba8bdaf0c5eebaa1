#pragma once

#include "plugins/radium/physics_system.h"

#include <vector>

namespace souple::radium {

/// Radium lights and picks a surface only from its front. A cloth that was one of Radium's meshes therefore
/// gets a second mesh, a reversed copy slightly behind it. (Cloths of scenes have two sides already.)
class BackSides : public Ra::Engine::Scene::System {
 public:
  /// Registers the system in the engine.
  static BackSides* add_to(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system);
  BackSides(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system) : engine_(engine), system_(system) {}

  /// Updates the back sides of the current cloths, between frames. Returns true if there is a new back side
  /// for the renderer to prepare.
  bool match_cloths();
  bool contains(Ra::Core::Utils::Index render_object) const;
  /// The front's element for an element picked on a back side; other elements are returned unchanged.
  PickedVertex front_of(const PickedVertex& picked) const;

  void generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& frame) override;

 private:
  struct Pair {
    host::Handle object;
    RenderMesh front, back;
    float gap;  ///< distance of the sides, in mesh coordinates
  };
  void remove_stale();
  void add(const LoadedMesh& cloth);
  static void follow(Pair& pair);

  Ra::Engine::RadiumEngine& engine_;
  PhysicsSystem& system_;
  std::vector<Pair> pairs_;
  std::uint64_t drawn_version_ = 0;
};

}  // namespace souple::radium
