#pragma once

#include "app/view/simulation.h"
#include "souple/host/drag_plane.h"
#include "souple/host/grab.h"
#include "souple/scene/scene.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace souple::web {

/// A scene, its world and the hand of a user, as JavaScript holds them.
class HeldWorld {
 public:
  /// Throws Error when the scene cannot be built.
  HeldWorld(SceneDescription scene, std::string name);

  viewer::Simulation& simulation() { return simulation_; }
  World& world() { return simulation_.world(); }
  /// From now on a user can step back.
  void keep_past();
  /// One frame if dt is 0. Throws Error if a state is no longer finite. [s]
  void step(double dt);
  /// Returns to the start, without a grab.
  void reset();

  /// Adds an object, given as in a scene file's `objects`. Returns its name.
  std::string add(const std::string& object_json);
  /// Sets a value of the scene while it runs: "substeps=20", "objects.flag.material.damping=0.1". Throws Error for
  /// what only a new world can take.
  void set(const std::string& setting);

  /// Grabs the first object on the ray, or within `reach` [m] of it. False if there is none, or it cannot be grabbed.
  bool grab(const host::Ray& ray, float reach, const Vec3f& facing);
  void drag(const host::Ray& ray);
  void release();
  bool grabbing() const { return grab_ != nullptr && grab_->holds(); }
  Vec3f grabbed_point() const { return grab_->point(); }
  Vec3f drag_target() const { return plane_->point(); }

  /// As JSON: the objects, the last step, and what sliders may change.
  std::string objects_text();
  std::string report_text();
  std::string tunables_text(std::size_t object);

 private:
  Hit hit_by(const host::Ray& ray, float reach);

  viewer::Simulation simulation_;
  std::unique_ptr<Grab> grab_;
  std::optional<host::DragPlane> plane_;
};

}  // namespace souple::web
