#include "souple/contacts/surfaces/motion_limit.h"

#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

// Lengths in mean edges: of the first limit, and of the last one.
constexpr float first_edges = 32, last_edges = 0.5f;
// Chunks have one size, and their results are joined in order: they do not depend on the number of threads.
constexpr std::size_t limit_chunk = 2048;

// A motion that is shorter than the result stays: nothing is carried along.
Vec3f shorten_by(const Vec3f& motion, const Vec3f& frame, float factor) {
  if (!(factor < 1)) return motion;
  const Vec3f result = frame + (motion - frame) * factor;
  return length_squared(result) < length_squared(motion) ? result : motion;
}

}  // namespace

void MotionLimit::begin_step(const ElementSurfaces& surfaces) {
  length_ = infinity;
  has_frame_ = false;
  shortened_ = {}, common_frame_ = {};
  limits_.assign(surfaces.size(), 0);
  frame_.assign(surfaces.size(), {});
}

// Sets u of all limited surfaces.
void MotionLimit::find_frame(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                             const ParticleView& particles, std::span<const Vec4f> velocity) {
  bool any_held = false;
  float slowest = infinity;
  for (std::size_t a = 0; a < surfaces.size(); ++a) {
    Vec3d sum;
    double count = 0;
    surfaces.for_each_sample(a, [&](std::uint32_t i) {
      if (is_finite(velocity[i].xyz())) sum += Vec3d(velocity[i].xyz()), ++count;
    });
    frame_[a] = Vec3f(count > 0 ? sum / count : sum);
    if (overlaps_other[a] == 0 || count == 0) continue;
    for (std::uint32_t i = surfaces[a].begin; i < surfaces[a].end; ++i)
      any_held = any_held || (particles.inverse_mass(i) == 0 && length_squared(velocity[i].xyz()) == 0);
    if (length_squared(frame_[a]) < slowest) slowest = length_squared(frame_[a]), common_frame_ = frame_[a];
  }
  if (any_held) common_frame_ = {};
  for (std::size_t a = 0; a < surfaces.size(); ++a)
    if (overlaps_other[a] != 0) frame_[a] = common_frame_;
}

// The first call finds the frame. If that is not at rest, a search in it comes before any limit.
bool MotionLimit::shorten(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                          const ParticleView& particles, std::span<const Vec4f> velocity, float h) {
  if (!has_frame_) {
    has_frame_ = true;
    float edges = 0, count = 0;
    for (std::size_t a = 0; a < surfaces.size(); ++a) {
      if (overlaps_other[a] == 0 && !surfaces[a].self_collision) continue;
      limits_[a] = 1;
      if (surfaces.mean_edge(a) > 0) edges += surfaces.mean_edge(a), ++count;
    }
    mean_edge_ = count > 0 ? edges / count : 0;
    find_frame(surfaces, overlaps_other, particles, velocity);
    if (common_frame_ != Vec3f{}) return true;
  }
  const float shortest = last_edges * mean_edge_;
  if (is_active()) {
    if (!(length_ > shortest)) return false;
    length_ = max(0.5f * length_, shortest);
    return true;
  }
  float longest = 0;
  for (std::uint32_t i = 0; i < surfaces.particle_count(); ++i)
    if (is_limited(surfaces.of(i)) && is_finite(velocity[i].xyz()))
      longest = max(longest, length_squared(velocity[i].xyz() - frame_[surfaces.of(i)]));
  longest = h * sqrt(longest);
  if (!(longest > shortest)) return false;
  length_ = max(shortest, min(first_edges * mean_edge_, 0.5f * longest));
  return true;
}

std::span<const Vec4f> MotionLimit::limited(const ElementSurfaces& surfaces, const ParticleView& particles,
                                            std::span<const Vec4f> velocity, float h) {
  if (!is_active()) return velocity;
  limited_velocity_.assign(velocity.begin(), velocity.end());
  const auto v = [&](std::uint32_t i) { return velocity[i].xyz(); };
  find_driven_factors(surfaces, particles, v, 1, length_ / h);
  for (std::uint32_t i = 0; i < surfaces.particle_count(); ++i) {
    const std::uint32_t a = surfaces.of(i);
    if (is_limited(a))
      limited_velocity_[i].set_xyz(
          shorten_by(v(i), frame_[a], factor(particles, i, a, v(i) - frame_[a], length_ / h)));
  }
  return limited_velocity_;
}

// Driven particles of a surface are shortened by one factor, so that an obstacle keeps its shape.
template <class Motion>
void MotionLimit::find_driven_factors(const ElementSurfaces& surfaces, const ParticleView& particles,
                                      const Motion& motion, float time, float limit) {
  driven_factor_.assign(surfaces.size(), 1);
  for (std::uint32_t i = 0; i < surfaces.particle_count(); ++i) {
    const std::uint32_t a = surfaces.of(i);
    if (!is_limited(a) || particles.inverse_mass(i) > 0) continue;
    const float distance = length(motion(i) - frame_[a] * time);
    if (distance > limit) driven_factor_[a] = min(driven_factor_[a], limit / distance);
  }
}

float MotionLimit::factor(const ParticleView& particles, std::uint32_t particle, std::uint32_t surface,
                          const Vec3f& motion, float limit) const {
  if (particles.inverse_mass(particle) == 0) return driven_factor_[surface];
  const float squared = length_squared(motion);
  return squared > limit * limit && is_finite(motion) ? limit / sqrt(squared) : 1;
}

void MotionLimit::apply(const ElementSurfaces& surfaces, const ParticleView& particles, float h,
                        Threads& threads) {
  if (!is_active()) return;
  const std::size_t n = surfaces.particle_count(), chunks = (n + limit_chunk - 1) / limit_chunk;
  largest_of_chunk_.assign(chunks, {});
  find_driven_factors(
      surfaces, particles, [&](std::uint32_t i) { return particles.moved(i); }, h, length_);
  threads.for_each(chunks, 1, [&](std::size_t c, std::size_t last) {
    for (; c < last; ++c) {
      for (std::size_t k = c * limit_chunk; k < std::min(n, (c + 1) * limit_chunk); ++k) {
        const auto i = static_cast<std::uint32_t>(k);
        const std::uint32_t a = surfaces.of(i);
        if (!is_limited(a)) continue;
        const Vec3f motion = particles.moved(i), frame = frame_[a] * h,
                    kept = shorten_by(motion, frame, factor(particles, i, a, motion - frame, length_));
        if (kept == motion) continue;
        particles.moving[i].set_xyz(particles.start[i].xyz() + kept);
        Largest& largest = largest_of_chunk_[c];
        if (length_squared(motion) > largest.squared) largest = {length_squared(motion), i};
      }
    }
  });
  for (const Largest& largest : largest_of_chunk_) {
    const float speed = sqrt(largest.squared) / h;
    if (speed > shortened_.speed) shortened_ = {surfaces.of(largest.particle), speed, length_ / h};
  }
}

std::size_t MotionLimit::bytes() const {
  return bytes_of(driven_factor_, limits_, frame_, limited_velocity_, largest_of_chunk_);
}

}  // namespace souple
