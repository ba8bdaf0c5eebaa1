#pragma once

#include "plugins/radium/physics_system.h"

#include <vector>

namespace souple::radium {

/// Radium lights and picks a surface from its front only. A cloth that was one of Radium's meshes is given a
/// second mesh, which is the first turned over and a hair's breadth behind it. (The cloth of scenes has two
/// sides already.)
class BackSides : public Ra::Engine::Scene::System {
 public:
  /// Makes it the engine's.
  static BackSides* add_to(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system);
  BackSides(Ra::Engine::RadiumEngine& engine, PhysicsSystem& system) : engine_(engine), system_(system) {}

  /// Has the cloths as they are now, between frames. True when there is a new back side, for the renderer to
  /// prepare.
  bool match_cloths();
  bool contains(Ra::Core::Utils::Index render_object) const;
  /// What lies on the front where this was picked; what is no back side is returned as it is.
  PickedVertex front_of(const PickedVertex& picked) const;

  void generateTasks(Ra::Core::TaskQueue* tasks, const Ra::Engine::FrameInfo& frame) override;

 private:
  struct Pair {
    host::Handle object;
    RenderMesh front, back;
    float gap;  ///< between them, in the mesh's own coordinates
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
