#include "render/moving_subject.h"

namespace souple::render {

const Subject& MovingSubject::at(float time) {
  const double back = (static_cast<double>(time) - 1) * exposure_;  // s
  then_ = now_;
  // Numbers of frames that no other subject has: they tell the drawing that positions have changed.
  then_.frame = ~((now_.frame << 8) + calls_++ % 256);
  positions_.resize(now_.bodies.size());
  for (std::size_t b = 0; b < now_.bodies.size(); ++b) {
    const Body& body = now_.bodies[b];
    if (body.velocities.size() != body.positions.size()) continue;
    positions_[b].resize(body.positions.size());
    for (std::size_t i = 0; i < body.positions.size(); ++i)
      positions_[b][i] = body.positions[i] + body.velocities[i] * static_cast<float>(back);
    then_.bodies[b].positions = positions_[b];
  }
  for (ColliderBody& collider : then_.colliders)
    if (collider.motion != nullptr) collider.pose = collider.motion->at(collider.time + back);
  return then_;
}

}  // namespace souple::render
