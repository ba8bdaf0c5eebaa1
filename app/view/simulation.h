#pragma once

#include "app/view/clock.h"
#include "app/view/session.h"
#include "souple/scene/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace souple::viewer {

/// Time of each stage in a frame. [ms]
using StageTimes = std::array<double, stage_count>;

/// A running scene that may be changed meanwhile. Every change acts immediately and appears in
/// `scene_text()`, so that a user can save the result of experiments.
class Simulation : public Session {
 public:
  /// Throws Error if the scene cannot be read or built.
  explicit Simulation(const std::filesystem::path& scene);
  Simulation(SceneDescription scene, std::string name);

  const std::string& name() const override { return name_; }
  const std::string& description() const override { return scene_.description; }
  double frame_rate() const override { return scene_.frame_rate; }
  double time() const override { return world_.time(); }
  std::uint64_t frame() const override;
  render::Subject subject() const override;
  std::optional<render::Camera> camera() const override;

  void advance(double seconds) override;
  void step_frame() override;
  void step_fine() override;
  void reset() override;
  void set_playing(bool playing) override;
  bool playing() const override { return playing_; }
  double speed() const override { return clock_.speed(); }
  const std::optional<Trouble>& trouble() const override { return trouble_; }

  const SceneDescription& scene() const { return scene_; }
  const World& world() const { return world_; }
  /// Access for objects that refer to the world, such as a grab. `reset` replaces the world: see
  /// `generation`.
  World& world() { return world_; }
  /// A new number means: the world was replaced.
  std::uint64_t generation() const { return generation_; }
  /// Report of the last step; empty before the first.
  const StepReport& report() const { return world_.report(); }
  /// Stage times of the last frames, newest last; at most `history_length`.
  const std::deque<StageTimes>& history() const { return history_; }
  static constexpr std::size_t history_length = 240;

  // --- changes. Each throws Error on bad values and then changes nothing.
  void set_settings(const Settings& settings);
  void set_material(std::size_t object, const MaterialDescription<ClothMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<SoftBodyMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<RopeMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<GrainsMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<FluidMaterial>& material);
  void set_material(std::size_t object, const ObstacleMaterial& material);
  /// Index in scene().objects.
  std::size_t index_of(ObjectId object) const;
  bool is_pinned(ObjectId object, std::uint32_t vertex) const;
  /// Pins the vertex at its current position, or releases it. Returns whether it is now pinned.
  /// `scene_text()` pins it at its initial position.
  bool toggle_pin(ObjectId object, std::uint32_t vertex);
  /// Sets the camera for `scene_text()`.
  void set_camera(const render::Camera& camera);

  /// The current scene as the text of a scene file.
  std::string scene_text() const;

 private:
  template <class Description, class Material>
  void change_material(std::size_t object, const Material& material);
  void step(double dt, int substeps);
  void take_trouble();
  void forget_pin(std::size_t object, std::uint32_t vertex);
  void start();

  std::string name_;
  SceneDescription scene_;
  World world_;
  Clock clock_;
  std::uint64_t generation_ = 1;
  std::uint64_t steps_ = 0;  // steps of any length: a change means that objects may have moved
  bool playing_ = true;
  std::optional<Trouble> trouble_;
  std::deque<StageTimes> history_;
  // Per object and pin of the scene: its vertices at the start.
  std::vector<std::vector<std::vector<std::uint32_t>>> pinned_at_start_;
};

}  // namespace souple::viewer
