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

/// Duration of each stage of one frame. [ms]
using StageTimes = std::array<double, stage_count>;

/// A running scene that may be changed meanwhile: every change takes effect immediately and enters
/// `scene_text()`, so the result of experiments can be saved.
class Simulation : public Session {
 public:
  /// Throws Error when the scene cannot be read or built.
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
  const std::optional<Failure>& failure() const override { return failure_; }

  const SceneDescription& scene() const { return scene_; }
  const World& world() const { return world_; }
  /// For objects that refer to the world from outside, such as a grab. `reset` replaces the world: see
  /// `generation`.
  World& world() { return world_; }
  /// Changes when the world is replaced.
  std::uint64_t generation() const { return generation_; }
  /// Report of the last step; empty before the first.
  const StepReport& report() const { return world_.report(); }
  /// Stage times of the last frames, newest last; at most `history_length`.
  const std::deque<StageTimes>& history() const { return history_; }
  static constexpr std::size_t history_length = 240;

  // --- changes. Each throws Error on invalid values, and then has changed nothing.
  void set_settings(const Settings& settings);
  void set_material(std::size_t object, const MaterialDescription<ClothMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<SoftBodyMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<RopeMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<GrainsMaterial>& material);
  void set_material(std::size_t object, const MaterialDescription<FluidMaterial>& material);
  void set_material(std::size_t object, const ObstacleMaterial& material);
  /// Position in scene().objects.
  std::size_t index_of(ObjectId object) const;
  bool is_pinned(ObjectId object, std::uint32_t vertex) const;
  /// Pins the vertex at its current position, or releases it. Returns whether it is pinned now. In
  /// `scene_text()` it is pinned at its initial position.
  bool toggle_pin(ObjectId object, std::uint32_t vertex);
  /// Sets the camera of `scene_text()`.
  void set_camera(const render::Camera& camera);

  /// The current scene as a scene file.
  std::string scene_text() const;

 private:
  template <class Description, class Material>
  void change_material(std::size_t object, const Material& material);
  void step(double dt, int substeps);
  void record_failure();
  void remove_from_pins(std::size_t object, std::uint32_t vertex);
  void start();

  std::string name_;
  SceneDescription scene_;
  World world_;
  Clock clock_;
  std::uint64_t generation_ = 1;
  std::uint64_t steps_ = 0;  // of any length; shows that positions may have changed
  bool playing_ = true;
  std::optional<Failure> failure_;
  std::deque<StageTimes> history_;
  // Per object and pin of the scene: the vertices it selected at the start.
  std::vector<std::vector<std::vector<std::uint32_t>>> pinned_at_start_;
};

}  // namespace souple::viewer
