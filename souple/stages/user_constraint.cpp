#include "souple/stages/user_constraint.h"

#include "souple/constraints/attachment.h"
#include "souple/solver/set_projector.h"
#include "souple/stages/pins.h"
#include "souple/state/warnings.h"

#include <utility>

namespace souple {

void UserConstraint::update_targets(double t) {
  if (!attachment || !target) return;
  for (std::size_t k = 0; k < attached_vertices.size(); ++k)
    attachment->set().set_params(
        k, {Vec3f(target_at(target, attached_vertices[k].vertex, t) + attached_vertices[k].offset)});
}

void UserConstraint::erase_particles(std::uint32_t begin, std::uint32_t end) {
  if (attachment) {
    std::vector<AttachedVertex> kept;
    for (std::size_t k = 0; k < attached_vertices.size();
         ++k) {  // in this order: one color, one particle each
      const std::uint32_t particle = attachment->set().indices(k)[0];
      if (particle < begin || particle >= end) kept.push_back(attached_vertices[k]);
    }
    attached_vertices = std::move(kept);
  }
  projector->erase_particles(begin, end);
}

void drive_attachments(std::span<UserConstraint> constraints, double t, Warnings& warnings) {
  for (UserConstraint& constraint : constraints)
    warnings.guarded("an attachment's target", [&] { constraint.update_targets(t); });
}

}  // namespace souple
