#pragma once

#include "souple/objects/callbacks.h"
#include "souple/objects/handles.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace souple {

template <class Kind>
class SetProjector;
class Warnings;
struct Attachment;
struct Distance;

/// A constraint set that is not built from one object: attachments, distance joints, tethers, user
/// projectors.
struct UserConstraint {
  /// Target of the k-th constraint of an attachment: target(vertex, t) + offset.
  struct AttachedVertex {
    std::uint32_t vertex = 0;
    Vec3d offset{};
  };

  ProjectorId id;
  std::unique_ptr<Projector> projector;
  SetProjector<Attachment>* attachment = nullptr;    ///< `projector`, if it is an attachment
  SetProjector<Distance>* distance_joint = nullptr;  ///< `projector`, if it consists of distance joints
  bool is_custom = false;                            ///< user projector; its forces may change at any time
  std::optional<double> until;                       ///< release time of distance joints [s]
  bool is_active = true;                             ///< had not been released when the last step started
  Target target;
  std::vector<AttachedVertex> attached_vertices;

  void update_targets(double t);
  /// Removes the particles [begin, end).
  void erase_particles(std::uint32_t begin, std::uint32_t end);
};

/// Moves attachments to their targets at time t [s].
void drive_attachments(std::span<UserConstraint> constraints, double t, Warnings& warnings);

}  // namespace souple
