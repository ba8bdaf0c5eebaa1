#include "souple/contacts/surfaces/motion_limit.h"

#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

// Lengths in mean edges: of the first limit, and of the last one.
constexpr float first_edges = 32, last_edges = 0.5f;
// A motion that is longer by this part stays, so that what was shortened is not shortened again.
constexpr float rounding = 1e-3f;

// A motion that is shorter than the result stays: nothing is carried along.
Vec3f shorten_by(const Vec3f& motion, const Vec3f& frame, float factor) {
  if (!(factor < 1)) return motion;
  const Vec3f result = frame + (motion - frame) * factor;
  return length_squared(result) < length_squared(motion) ? result : motion;
}

float factor_of(const Vec3f& motion, float limit) {
  const float squared = length_squared(motion);
  const float longest = (1 + rounding) * limit;
  return squared > longest * longest && is_finite(motion) ? limit / sqrt(squared) : 1;
}

template <class Function>
void for_each_particle(const ElementSurfaces& surfaces, std::uint32_t surface, const Function& f) {
  for (std::uint32_t i = surfaces[surface].begin; i < surfaces[surface].end; ++i)
    if (surfaces.of(i) == surface) f(i);
}

}  // namespace

void MotionLimit::begin_step(const ElementSurfaces& surfaces) {
  states_.assign(surfaces.size(), {});
  shortened_ = {};
}

bool MotionLimit::differs(Group group) const {
  return std::any_of(group.begin(), group.end(),
                     [&](std::uint32_t a) { return !(states_[a] == states_[group[0]]); });
}

void MotionLimit::begin_search(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                               std::span<const Vec4f> velocity) {
  State common;
  float edges = 0, count = 0;
  for (const std::uint32_t a : group) {
    common.length = min(common.length, states_[a].length);
    common.has_frame = common.has_frame || states_[a].has_frame;
    if (surfaces.mean_edge(a) > 0) edges += surfaces.mean_edge(a), ++count;
  }
  common.mean_edge = count > 0 ? edges / count : 0;
  for (const std::uint32_t a : group) states_[a] = common;
  if (common.has_frame) find_frame(surfaces, group, particles, velocity);
}

void MotionLimit::find_frame(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                             std::span<const Vec4f> velocity) {
  bool any_held = false;
  float slowest = infinity;
  Vec3f frame;
  for (const std::uint32_t a : group) {
    Vec3d sum;
    double count = 0;
    surfaces.for_each_sample(a, [&](std::uint32_t i) {
      if (is_finite(velocity[i].xyz())) sum += Vec3d(velocity[i].xyz()), ++count;
    });
    if (count == 0) continue;
    const Vec3f mean(sum / count);
    if (length_squared(mean) < slowest) slowest = length_squared(mean), frame = mean;
    for (std::uint32_t i = surfaces[a].begin; i < surfaces[a].end; ++i)
      any_held = any_held || (particles.inverse_mass(i) == 0 && length_squared(velocity[i].xyz()) == 0);
  }
  if (any_held && group.size() > 1) frame = {};
  for (const std::uint32_t a : group) states_[a].frame = frame;
}

// The first call finds the frame. If that is not at rest, a search in it comes before any limit.
bool MotionLimit::shorten(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                          std::span<const Vec4f> velocity, float h) {
  const State& state = states_[group[0]];
  if (!state.has_frame) {
    for (const std::uint32_t a : group) states_[a].has_frame = true;
    find_frame(surfaces, group, particles, velocity);
    // Paths of a surface that touches itself alone are relative to its own mean anyway.
    if (group.size() > 1 && state.frame != Vec3f{}) return true;
  }
  const float shortest = last_edges * state.mean_edge;
  float length = 0.5f * state.length;
  if (is_active(group[0])) {
    if (!(state.length > shortest)) return false;
  } else {
    float longest = 0;
    for (const std::uint32_t a : group)
      for_each_particle(surfaces, a, [&](std::uint32_t i) {
        const Vec3f v = velocity[i].xyz();
        if (is_finite(v)) longest = max(longest, length_squared(v - state.frame));
      });
    longest = h * sqrt(longest);
    if (!(longest > shortest)) return false;
    length = min(first_edges * state.mean_edge, 0.5f * longest);
  }
  for (const std::uint32_t a : group) states_[a].length = max(length, shortest);
  return true;
}

std::span<const Vec4f> MotionLimit::limited(const ElementSurfaces& surfaces, Group group,
                                            const ParticleView& particles, std::span<const Vec4f> velocity,
                                            float h) {
  if (!is_active(group[0])) return velocity;
  limited_velocity_.resize(velocity.size());
  const float limit = states_[group[0]].length / h;
  const Vec3f frame = states_[group[0]].frame;
  const auto v = [&](std::uint32_t i) { return velocity[i].xyz(); };
  for (const std::uint32_t a : group) {
    const float driven = driven_factor(surfaces, a, particles, v, 1, limit);
    for (std::uint32_t i = surfaces[a].begin; i < surfaces[a].end; ++i) {
      limited_velocity_[i] = velocity[i];
      if (surfaces.of(i) == a)
        limited_velocity_[i].set_xyz(shorten_by(
            v(i), frame, particles.inverse_mass(i) == 0 ? driven : factor_of(v(i) - frame, limit)));
    }
  }
  return limited_velocity_;
}

// Driven particles of a surface are shortened by one factor, so that an obstacle keeps its shape.
template <class Motion>
float MotionLimit::driven_factor(const ElementSurfaces& surfaces, std::uint32_t surface,
                                 const ParticleView& particles, const Motion& motion, float time,
                                 float limit) const {
  float factor = 1;
  for_each_particle(surfaces, surface, [&](std::uint32_t i) {
    if (particles.inverse_mass(i) > 0) return;
    const float distance = length(motion(i) - states_[surface].frame * time);
    if (distance > (1 + rounding) * limit) factor = min(factor, limit / distance);
  });
  return factor;
}

void MotionLimit::apply(const ElementSurfaces& surfaces, Group group, const ParticleView& particles,
                        float h) {
  if (!is_active(group[0])) return;
  const float limit = states_[group[0]].length;
  const Vec3f frame = states_[group[0]].frame * h;
  const auto moved = [&](std::uint32_t i) { return particles.moved(i); };
  for (const std::uint32_t a : group) {
    const float driven = driven_factor(surfaces, a, particles, moved, h, limit);
    float fastest = 0;
    for_each_particle(surfaces, a, [&](std::uint32_t i) {
      const Vec3f motion = moved(i);
      const Vec3f kept = shorten_by(
          motion, frame, particles.inverse_mass(i) == 0 ? driven : factor_of(motion - frame, limit));
      if (kept == motion) return;
      particles.moving[i].set_xyz(particles.start[i].xyz() + kept);
      fastest = max(fastest, length_squared(motion));
    });
    if (sqrt(fastest) / h > shortened_.speed) shortened_ = {a, sqrt(fastest) / h, limit / h};
  }
}

std::size_t MotionLimit::bytes() const {
  return bytes_of(states_, limited_velocity_);
}

}  // namespace souple
