#pragma once

#include <cstdint>

namespace souple {

/// Handle of an object. It stays valid until the object is removed. The world never reuses it.
struct ObjectId {
  std::uint32_t value = 0;
  friend bool operator==(const ObjectId&, const ObjectId&) = default;
};
struct ColliderId {
  std::uint32_t value = 0;
  friend bool operator==(const ColliderId&, const ColliderId&) = default;
};
struct JointId {
  std::uint32_t value = 0;
  friend bool operator==(const JointId&, const JointId&) = default;
};
struct ProjectorId {
  std::uint32_t value = 0;
};
/// A function that runs before or after a stage.
struct CallbackId {
  std::uint32_t value = 0;
  friend bool operator==(const CallbackId&, const CallbackId&) = default;
};
struct ForceFieldId {
  std::uint32_t value = 0;
  friend bool operator==(const ForceFieldId&, const ForceFieldId&) = default;
};

}  // namespace souple
