#pragma once

#include "souple/scene/scene.h"
#include "souple/world/world.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace souple::viewer {

/// Setup of a world: a scene, and the changes by the user.
struct Setup {
  SceneDescription scene;
  std::set<std::string> thrown;  ///< names of the objects that a reset removes
  /// Per object and pin of the scene: the vertices it selected at the start.
  std::vector<std::vector<std::vector<std::uint32_t>>> pinned_at_start;
  /// Number of changes of materials and pins: a snapshot fits a world of equally many.
  std::uint64_t edits = 0;
};

/// Approximate memory of a setup: objects and the lists of points in them. [bytes]
std::size_t bytes_of(const Setup& setup);

/// A state of the past: with its setup it makes the world that was.
struct PastState {
  double time = 0;  ///< s
  Snapshot snapshot;
  std::shared_ptr<const Setup> setup;
  std::size_t bytes = 0;  ///< of the snapshot, and of the setup unless an earlier state has it
};

/// The states from which the last steps were made, oldest first, within a limit of memory.
class Past {
 public:
  /// At least one state stays, however large.
  explicit Past(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  std::size_t size() const { return states_.size(); }
  const PastState& at(std::size_t i) const { return states_.at(i); }
  std::size_t bytes() const { return bytes_; }
  /// The state that the world is in; empty when it has moved on.
  std::optional<std::size_t> shown() const { return shown_; }
  void show(std::size_t i) { shown_ = i; }

  /// Whether a state is due: snapshots take at most a megabyte a step, so that they cost little time.
  bool is_due() const {
    return states_.empty() || steps_ * bytes_per_step >= states_.back().snapshot.bytes.size();
  }
  /// Adds the state that the world is in, as the newest.
  void add(PastState state);
  /// The world moves on by a step or a change: forgets the states that came later.
  void move_on();
  void count_step() { ++steps_; }
  void clear();

  static constexpr std::size_t bytes_per_step = std::size_t{1} << 20;

 private:
  std::size_t max_bytes_, bytes_ = 0;
  std::deque<PastState> states_;
  std::optional<std::size_t> shown_;
  std::size_t steps_ = 0;  // since the newest state
};

}  // namespace souple::viewer
