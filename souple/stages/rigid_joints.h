#pragma once

#include "souple/objects/joint_options.h"
#include "souple/rigid/joints/joint_solver.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace souple {

class SavedBytes;
class SavedBytesWriter;

/// Record of a joint besides its description.
struct JointRecord {
  JointId id;
  JointSide a, b;
  bool collide = false;
};

/// The joints of a world's rigid bodies in its step. They keep the handles of the joined bodies, and from `list` on
/// their indices, until bodies change.
class RigidJoints {
 public:
  bool empty() const { return records_.empty(); }
  std::span<const JointRecord> records() const { return records_; }  ///< ascending by id
  const joint::Joints& joints() const { return joints_; }            ///< as `records`

  /// `joint` is valid but for its bodies.
  void add(JointRecord record, joint::Joint joint);
  void remove(std::span<const IndexRange> joints);
  /// The kind keeps its alternative.
  void set_kind(std::size_t index, const joint::Kind& kind);

  /// `body_of`: index of the body at a side that is not the world.
  void list(const std::function<std::uint32_t(const JointSide&)>& body_of);
  /// Whether a joint keeps two bodies from colliding with each other.
  bool joined(std::uint32_t a, std::uint32_t b) const;

  void begin_step() { broken_.clear(); }
  void begin_substep(const RigidBodies& bodies, double h) { solver_.begin_substep(joints_, bodies, h); }
  void project(RigidBodies& bodies) { solver_.project(joints_, bodies); }
  /// Reports forces. Returns whether a joint has broken.
  bool end_substep();
  /// Indices of the joints that broke since begin_step.
  std::span<const std::uint32_t> broken() const { return broken_; }

  /// Keeps the state of the joints, or returns to what was kept.
  void keep() { kept_ = joints_.state; }
  void undo() { joints_.state = kept_; }
  /// State that one step passes to the next.
  void save(SavedBytesWriter& out) const;
  /// Reads a saved state. Throws Error if it is none of these joints.
  std::vector<joint::JointState> read(SavedBytes& in) const;
  void set(std::vector<joint::JointState> state) { joints_.state = std::move(state); }
  std::size_t bytes() const;

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  std::vector<JointRecord> records_;
  joint::Joints joints_;
  std::vector<joint::JointState> kept_;
  joint::JointSolver solver_;
  std::vector<Pair> apart_;  ///< bodies that do not collide, the lower one first, sorted
  std::vector<std::uint32_t> whole_, broken_;
};

}  // namespace souple
