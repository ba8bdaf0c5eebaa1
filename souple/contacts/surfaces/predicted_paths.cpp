#include "souple/contacts/surfaces/predicted_paths.h"

#include "souple/assert.h"
#include "souple/contacts/contact_law.h"
#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <atomic>

namespace souple {
namespace {

// The search skips boxes that are not finite.
constexpr Bounds infinite_box{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
// Chunks have one size, and their results are joined in order: they do not depend on the number of threads.
constexpr std::size_t path_chunk = 1024;
constexpr std::size_t particle_grain = 2048;
// Margin around the path that follows from a particle's velocity, as parts of the path's length and of the
// radius: contacts may move the particle. `predict` adds the fall by gravity: a particle may fall where the
// rest of its object does not, or the reverse.
constexpr float motion_margin_part = 0.15f, radius_margin_part = 0.25f;
// Margin around the path of a particle that has left its path: contacts move it again.
constexpr float off_path_margin_part = 0.5f;

Vec3d mean_position(const ElementSurfaces& surfaces, std::size_t surface, const ParticleView& particles) {
  Vec3d sum;
  double count = 0;
  surfaces.for_each_sample(surface, [&](std::uint32_t i) {
    if (particles.inverse_mass(i) == 0) return;
    sum += Vec3d(particles.relative(i, {}));
    ++count;
  });
  return count > 0 ? sum / count : sum;
}

}  // namespace

// Paths of the last step stay for what is still.
void PredictedPaths::begin_step(const ElementSurfaces& surfaces, std::span<const float> radius,
                                std::span<const float> contact_margin, std::span<const std::uint8_t> still,
                                float gravity) {
  radius_ = radius, contact_margin_ = contact_margin, gravity_ = gravity;
  still_.assign(still.begin(), still.end());
  elapsed_ = 0;
  const std::size_t n = surfaces.particle_count();
  if (path_.size() != n) {
    boxes_.assign(n, infinite_box), kept_.assign(surfaces.size(), {-1, 0});
    relative_boxes_.resize(n), path_.resize(n), predicted_velocity_.resize(n), predicted_margin_.resize(n);
  }
  mean_velocity_.assign(surfaces.size(), {}), shift_.assign(surfaces.size(), {});
  frame_.assign(surfaces.size(), {});
  mean_position_.assign(surfaces.size(), {});
  checked_.clear();
  for (std::uint32_t a = 0; a < surfaces.size(); ++a) {
    const ContactSurface& surface = surfaces[a];
    std::fill(boxes_.data() + surface.end, boxes_.data() + max(surface.end, surface.reserved_end),
              infinite_box);
    for (std::size_t k = surface.begin; still_[a] == 0 && k < surface.end; k += path_chunk)
      checked_.push_back({k, std::min<std::size_t>(surface.end, k + path_chunk)});
  }
}

// Mean velocity and position of the particles that can move.
void PredictedPaths::find_mean(const ElementSurfaces& surfaces, std::size_t surface,
                               const ParticleView& particles, std::span<const Vec4f> velocity) {
  Vec3d sum;
  double count = 0;
  surfaces.for_each_sample(surface, [&](std::uint32_t i) {
    if (particles.inverse_mass(i) == 0) return;
    sum += Vec3d(velocity[i].xyz());
    ++count;
  });
  const Vec3f mean(count > 0 ? sum / count : sum);
  mean_velocity_[surface] = is_finite(mean) ? mean : Vec3f{};
  shift_[surface] = {};
  mean_position_[surface] = mean_position(surfaces, surface, particles);
}

Vec3f PredictedPaths::shift_of(const ElementSurfaces& surfaces, std::size_t surface,
                               const ParticleView& particles) const {
  if (!surfaces[surface].self_collision) return {};
  return Vec3f(mean_position(surfaces, surface, particles) - mean_position_[surface]);
}

// In the world, a box moves with its frame.
Bounds PredictedPaths::bounds_of(const ContactSurface& surface, std::uint32_t index, float ago,
                                 float dt) const {
  Bounds bounds = empty_bounds;
  for (std::uint32_t i = surface.begin; i < surface.end; ++i) bounds = united(bounds, boxes_[i]);
  const Vec3f from = frame_[index] * (elapsed_ - ago), to = from + frame_[index] * dt;
  return united({bounds.lo + from, bounds.hi + from}, {bounds.lo + to, bounds.hi + to});
}

bool PredictedPaths::keeps_paths(std::uint32_t surface, float dt) const {
  return still_[surface] != 0 && frame_[surface] == Vec3f{} && kept_[surface] == std::array{dt, gravity_};
}

bool PredictedPaths::predict_surface(const ElementSurfaces& surfaces, std::uint32_t surface,
                                     const ParticleView& particles, std::span<const Vec4f> velocity,
                                     float ago, float dt, Threads& threads) {
  const bool keeps = keeps_paths(surface, dt);
  std::atomic<bool> changed{!keeps};
  const std::uint32_t first = surfaces[surface].begin;
  threads.for_each(surfaces[surface].end - first, particle_grain, [&](std::size_t begin, std::size_t end) {
    for (std::uint32_t i = first + static_cast<std::uint32_t>(begin); i < first + end; ++i) {
      if (surfaces.of(i) != surface || (keeps && predicted_margin_[i] == contact_margin_[i])) continue;
      if (keeps) changed.store(true, std::memory_order_relaxed);
      predict(i, surface, particles.relative(i, {}), {}, velocity[i].xyz(), elapsed_ - ago, dt,
              radius_margin_part * max(radius_[i], 0.0f));
    }
  });
  kept_[surface] = {still_[surface] != 0 && frame_[surface] == Vec3f{} ? dt : -1, gravity_};
  return changed;
}

// The path of a particle that is at x at the time `since` after the step began and moves with v for dt.
void PredictedPaths::predict(std::uint32_t i, std::uint32_t surface, const Vec3f& x, const Vec3f& shift,
                             const Vec3f& v, float since, float dt, float margin) {
  const Vec3f relative_v = v - mean_velocity_[surface], relative_x = x - shift;
  const float contact_distance = max(radius_[i], min_thickness) * (1 + speculative_part) + contact_margin_[i];
  const float fall = 0.5f * gravity_ * dt * dt, relative_length = dt * length(relative_v);
  Path& path = path_[i];
  path = {x - v * since, relative_x - relative_v * since,
          margin + 2 * fall + motion_margin_part * dt * length(v - frame_[surface]),
          margin + min(fall, relative_length) + motion_margin_part * relative_length, since + 1.01f * dt};
  const Vec3f in_frame = x - frame_[surface] * since;
  boxes_[i] = around(in_frame, in_frame + (v - frame_[surface]) * dt, contact_distance + path.margin);
  relative_boxes_[i] =
      around(relative_x, relative_x + relative_v * dt, contact_distance + path.relative_margin);
  predicted_velocity_[i].set_xyz(v);
  predicted_margin_[i] = contact_margin_[i];
}

bool PredictedPaths::is_on_path(std::uint32_t i, const ContactSurface& surface, std::uint32_t index,
                                bool checks_world, const Vec3f& x) const {
  const Path& path = path_[i];
  if (elapsed_ > path.valid_until) return false;
  const Vec3f v = predicted_velocity_[i].xyz();
  const auto within = [](const Vec3f& d, float margin) { return length_squared(d) <= margin * margin; };
  if (checks_world && !within(x - (path.origin + v * elapsed_), path.margin)) return false;
  if (!surface.self_collision) return true;
  return within(x - shift_[index] - (path.relative_origin + (v - mean_velocity_[index]) * elapsed_),
                path.relative_margin);
}

void PredictedPaths::find_off_path(const ElementSurfaces& surfaces,
                                   std::span<const std::uint8_t> overlaps_other,
                                   const ParticleView& particles, Threads& threads) {
  for (std::size_t a = 0; a < surfaces.size(); ++a) find_shift(surfaces, a, particles);
  const std::size_t chunks = checked_.size();
  for (std::size_t c = off_path_of_chunk_.size(); c < chunks; ++c)
    off_path_of_chunk_.emplace_back().reserve(path_chunk);
  threads.each(chunks, 2, [&](std::size_t c) {
    off_path_of_chunk_[c].clear();
    for (std::size_t k = checked_[c].begin; k < checked_[c].end; ++k) {
      const auto i = static_cast<std::uint32_t>(k);
      const std::uint32_t a = surfaces.of(i);
      if (a != no_surface &&
          !is_on_path(i, surfaces[a], a, overlaps_other[a] != 0, particles.relative(i, {})))
        off_path_of_chunk_[c].push_back(i);
    }
  });
  off_path_.clear();
  for (std::size_t c = 0; c < chunks; ++c)
    off_path_.insert(off_path_.end(), off_path_of_chunk_[c].begin(), off_path_of_chunk_[c].end());
}

void PredictedPaths::find_off_path(const ElementSurfaces& surfaces,
                                   std::span<const std::uint8_t> overlaps_other,
                                   const ParticleView& particles, std::span<const std::uint32_t> moved) {
  off_path_.clear();
  for (const std::uint32_t i : moved) {
    const std::uint32_t a = surfaces.of(i);
    SOUPLE_ASSERT(a != no_surface, "a particle of a surface");
    if (!is_on_path(i, surfaces[a], a, overlaps_other[a] != 0, particles.relative(i, {})))
      off_path_.push_back(i);
  }
}

void PredictedPaths::predict_off_path(std::uint32_t particle, std::uint32_t surface, const Vec3f& shift,
                                      const ParticleView& before, const Vec3f& velocity, float h, float dt) {
  predict(particle, surface, before.relative(particle, {}), shift, velocity, elapsed_ - h, dt,
          off_path_margin_part * max(radius_[particle], 0.0f));
}

kernels::PredictionMargins PredictedPaths::margins(bool inter_object) const {
  return {radius_.data(), inter_object ? &path_[0].margin : &path_[0].relative_margin,
          sizeof(Path) / sizeof(float), min_thickness, speculative_part};
}

std::size_t PredictedPaths::bytes() const {
  return bytes_of(boxes_, relative_boxes_, path_, predicted_velocity_, predicted_margin_);
}

}  // namespace souple
