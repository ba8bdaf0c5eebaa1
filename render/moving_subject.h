#pragma once

#include "render/subject.h"

#include <vector>

namespace souple::render {

/// A subject while the shutter of a camera is open: it closes at the subject's time. Vertices move along their
/// velocities, colliders along their motion; objects without velocities, and foam, stand still.
class MovingSubject {
 public:
  /// `subject` must stay valid and unchanged. `exposure`: how long the shutter is open [s].
  MovingSubject(const Subject& subject, double exposure) : now_(subject), exposure_(exposure) {}

  /// At a time in [0, 1], where 1 is the subject itself. Valid until the next call.
  const Subject& at(float time);

 private:
  const Subject& now_;
  double exposure_;
  Subject then_;
  std::vector<std::vector<Vec3f>> positions_;  ///< per body [m]
  std::uint64_t calls_ = 0;
};

}  // namespace souple::render
