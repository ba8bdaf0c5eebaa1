#include "souple/stages/rigid_joints.h"

#include "souple/assert.h"
#include "souple/state/bytes.h"
#include "souple/state/saved_bytes.h"

#include <algorithm>

namespace souple {
namespace {

/// Calls f(value) for each value of a joint's state, none with padding.
template <class State, class F>
void for_each_value(State& state, const F& f) {
  f(state.lambda), f(state.value), f(state.at), f(state.angle), f(state.h);
  f(state.force), f(state.torque), f(state.broken);
}

}  // namespace

void RigidJoints::add(JointRecord record, joint::Joint joint) {
  SOUPLE_ASSERT(records_.empty() || records_.back().id.value < record.id.value, "ids ascend");
  const std::size_t count = records_.size();
  try {
    joints_.joint.push_back(std::move(joint));
    joints_.state.emplace_back();
    kept_.emplace_back();
    records_.push_back(record);
  } catch (...) {
    joints_.joint.resize(count), joints_.state.resize(count), kept_.resize(count);
    throw;
  }
}

void RigidJoints::remove(std::span<const IndexRange> joints) {
  erase_ranges(records_, joints);
  erase_ranges(joints_.joint, joints), erase_ranges(joints_.state, joints), erase_ranges(kept_, joints);
}

void RigidJoints::set_kind(std::size_t index, const joint::Kind& kind) {
  joint::Joint& joint = joints_.joint[index];
  SOUPLE_ASSERT(joint.kind.index() == kind.index(), "a joint keeps its kind");
  const int before = joint::rows_of(joint, {}).count;
  joint.kind = kind;
  if (joint::rows_of(joint, {}).count == before) return;
  // Impulses belong to rows that are others now.
  joint::JointState& state = joints_.state[index];
  state.lambda = {}, state.value = {}, state.at = {}, state.h = 0;
}

void RigidJoints::list(const std::function<std::uint32_t(const JointSide&)>& body_of) {
  apart_.clear();
  for (std::size_t j = 0; j < records_.size(); ++j) {
    const JointRecord& record = records_[j];
    joint::Joint& joint = joints_.joint[j];
    joint.a = record.a.is_world() ? no_body : body_of(record.a);
    joint.b = record.b.is_world() ? no_body : body_of(record.b);
    if (!record.collide && !joints_.state[j].broken && joint.a != no_body && joint.b != no_body)
      apart_.emplace_back(std::min(joint.a, joint.b), std::max(joint.a, joint.b));
  }
  std::sort(apart_.begin(), apart_.end());
}

bool RigidJoints::joined(std::uint32_t a, std::uint32_t b) const {
  return std::binary_search(apart_.begin(), apart_.end(), Pair{std::min(a, b), std::max(a, b)});
}

bool RigidJoints::end_substep() {
  whole_.clear();
  for (std::uint32_t j = 0; j < records_.size(); ++j)
    if (!joints_.state[j].broken) whole_.push_back(j);
  solver_.end_substep(joints_);
  const std::size_t before = broken_.size();
  for (const std::uint32_t j : whole_)
    if (joints_.state[j].broken) broken_.push_back(j);
  return broken_.size() != before;
}

void RigidJoints::save(SavedBytesWriter& out) const {
  for (const joint::JointState& state : joints_.state)
    for_each_value(state, [&out](const auto& value) { out.put(value); });
}

std::vector<joint::JointState> RigidJoints::read(SavedBytes& in) const {
  std::vector<joint::JointState> states(joints_.state.size());
  for (joint::JointState& state : states) {
    for_each_value(state, [&in](auto& value) { in.get(value); });
    bool finite = true;
    for_each_value(state, [&finite](const auto& value) { finite = finite && all_finite(value); });
    const bool sides =
        std::all_of(state.at.begin(), state.at.end(), [](std::int8_t at) { return at >= -1 && at <= 1; });
    in.require(finite && sides && state.h >= 0);
  }
  return states;
}

std::size_t RigidJoints::bytes() const {
  return bytes_of(records_, joints_.joint, joints_.state, kept_, apart_, whole_, broken_);
}

}  // namespace souple
