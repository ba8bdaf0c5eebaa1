#pragma once

#include "app/view/past.h"
#include "app/view/session.h"
#include "souple/scene/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <variant>
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

  const std::string& description() const override { return scene_.description; }
  double frame_rate() const override { return scene_.frame_rate; }
  double time() const override { return world_.time(); }
  std::uint64_t frame() const override;
  render::Subject subject() const override;
  std::optional<render::Camera> camera() const override;

  void advance(double seconds) override;
  void step_frame() override;
  void step_fine() override;
  /// Returns to the state before the last step, or one of the steps before it where states are large. Throws
  /// Error when no earlier state is kept.
  void step_back() override;
  void reset() override;
  void set_playing(bool playing) override;

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

  // --- the past. A state comes back whole: motion, objects, settings, materials and pins. Steps from it give equal
  // bits.
  /// States to which `rewind` returns, oldest first; the last one is the present.
  std::size_t state_count() const { return past_.size() + (past_.shown() ? 0 : 1); }
  std::size_t state() const { return past_.shown().value_or(past_.size()); }
  double state_time(std::size_t i) const {
    return i < past_.size() ? past_.at(i).time : world_.time();
  }  ///< s
  /// Shows a state and pauses; a step or a change from there forgets the states that came later.
  void rewind(std::size_t i);
  /// Limit of the memory of states. [bytes] Forgets the states.
  void limit_past(std::size_t max_bytes);
  static constexpr std::size_t default_past_bytes = std::size_t{512} << 20;

  // --- changes. Each throws Error on invalid values, and then has changed nothing.
  void set_settings(const Settings& settings);
  /// `M`: what the object's description has.
  template <class M>
  void set_material(std::size_t object, const M& material) {
    AnyObjectDescription& description = scene_.objects.at(object);
    world_.set_material(world_.find_object(common(description).name), material);
    changed(true);
    const auto take = [&](auto& kind) {
      if constexpr (std::is_same_v<std::decay_t<decltype(kind.material)>, M>) kind.material = material;
    };
    std::visit(take, description);
  }
  /// Adds an object at the current time, with a unique name that begins like its own. After a reset it is there
  /// from the start, unless it was thrown: then the reset removes it, and `scene_text()` lacks it.
  ObjectId add(AnyObjectDescription object, bool thrown = false);
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
  void step(double dt, int substeps);
  void record_failure();
  void remove_from_pins(std::size_t object, std::uint32_t vertex);
  void start();
  void forget_thrown(SceneDescription& scene) const;
  // The past.
  void keep_state();
  void set_setup(std::shared_ptr<const Setup> setup);
  bool remove_later_objects(const Setup& setup);
  void changed(bool edited);

  SceneDescription scene_;
  World world_;
  std::uint64_t generation_ = 1;
  std::uint64_t steps_ = 0;  // of any length; shows that positions may have changed
  std::deque<StageTimes> history_;
  // Per object and pin of the scene: the vertices it selected at the start.
  std::vector<std::vector<std::vector<std::uint32_t>>> pinned_at_start_;
  std::set<std::string> thrown_;  // names
  Past past_{default_past_bytes};
  std::uint64_t edits_ = 0;             // see Setup
  std::shared_ptr<const Setup> setup_;  // the current one; null: changed since the last state
};

}  // namespace souple::viewer
