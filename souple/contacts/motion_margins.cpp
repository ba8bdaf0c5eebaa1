#include "souple/contacts/motion_margins.h"

#include "souple/contacts/packed_collider.h"
#include "souple/math/elementary.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t grain = 1024;  // least number of particles that pays for a thread

}  // namespace

void MotionMargins::begin(std::span<const std::uint32_t> particle, std::span<const float> radius,
                          const Speeds& speeds, const ParticleView& particles, Threads& threads) {
  for (auto& axis : at_) axis.resize(particle.size());
  margin_.resize(particle.size());
  const float t = speeds.dt;
  threads.each(particle.size(), grain, [&](std::size_t k) {
    const std::uint32_t i = particle[k];
    const Vec3f x(particles.exact_position(i));
    for (int axis = 0; axis < 3; ++axis) at_[static_cast<std::size_t>(axis)][k] = x[axis];
    const float speed =
        speeds.h > 0 ? length(particles.moved(i)) / speeds.h : length(speeds.velocity[i].xyz());
    margin_[k] = 2 * t * (speed + speeds.gravity * t) + radius[i];
  });
}

bool MotionMargins::any_left(std::span<const std::uint32_t> particle,
                             const kernels::ColliderContactKernels& kernels, const ParticleView& particles,
                             Threads& threads) const {
  std::atomic<bool> left{false};
  const kernels::ColliderParticles packed = packed_particles(particles);
  threads.for_each(particle.size(), grain, [&](std::size_t begin, std::size_t end) {
    if (kernels.left(packed, particle.data(), {at_[0].data(), at_[1].data(), at_[2].data()}, margin_.data(),
                     begin, end))
      left.store(true, std::memory_order_relaxed);
  });
  return left.load(std::memory_order_relaxed);
}

float MotionMargins::largest() const {
  float result = 0;
  for (const float margin : margin_) result = max(result, margin);
  return result;
}

std::size_t MotionMargins::bytes() const {
  return bytes_of(at_[0], at_[1], at_[2], margin_);
}

// The angle a between two poses: |R' - R|^2 = 8 sin^2(a / 2), the sum of the squares of all elements.
double ColliderMargin::motion(const RigidPose& from, const RigidPose& to) const {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += length_squared(to.rotation.column[k] - from.rotation.column[k]);
  const double angle = 2 * elementary::asin(std::min(1.0, std::sqrt(square / 8)));
  const double turned = angle > 0 ? angle * radius_ : 0;  // radius_ may be infinite
  return length(to.to_world(center_) - from.to_world(center_)) + turned;
}

// Twice the motion that would follow at the present speed: a faster motion costs a new search. Where the body turns so
// fast that its margin would have to grow with itself, there is none.
void ColliderMargin::begin(const BoundingBall& ball, double near, const RigidPose& before,
                           const RigidPose& after, double substeps) {
  center_ = ball.center, radius_ = ball.radius + near, searched_ = before;
  margin_ = 2 * substeps * motion(before, after);
  radius_ += 3 * margin_;
  if (!(margin_ < 1e30) || left(before, after)) margin_ = std::numeric_limits<double>::infinity();
}

bool ColliderMargin::left(const RigidPose& before, const RigidPose& after) const {
  return !(motion(searched_, before) + motion(before, after) <= margin_);
}

}  // namespace souple
