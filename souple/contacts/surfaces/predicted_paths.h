#pragma once

#include "souple/broad_phase/bounds.h"
#include "souple/contacts/kernels/element_pairs.h"
#include "souple/contacts/surfaces/element_surfaces.h"
#include "souple/solver/projector.h"
#include "souple/threads/threads.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

inline constexpr float min_thickness = 1e-5f;  // m

/// Where each particle of the surfaces will be within the time that a search for pairs covers: on a straight path,
/// within a margin. Paths for self-collision are relative to the object's mean motion: a heap that falls as a whole
/// has no more pairs than one at rest.
class PredictedPaths {
 public:
  PredictedPaths() = default;
  /// `particles`: how many particles paths are predicted for.
  explicit PredictedPaths(std::size_t particles) { off_path_.reserve(particles); }
  /// radius[i]: half the thickness of particle i [m]. contact_margin[i]: additional distance at which contacts of
  /// particle i begin [m]. Both must live until the step ends. still[a]: surface a did not move in the last step, and does
  /// not in this one.
  void begin_step(const ElementSurfaces& surfaces, std::span<const float> radius,
                  std::span<const float> contact_margin, std::span<const std::uint8_t> still, float gravity);

  /// Sets the mean motion of a surface, relative to which its next paths are predicted.
  void find_mean(const ElementSurfaces& surfaces, std::size_t surface, const ParticleView& particles,
                 std::span<const Vec4f> velocity);
  /// Sets the velocity of the frame in which the next boxes() of a surface are swept [m/s]. It is 0 in a new step.
  void set_frame(std::uint32_t surface, const Vec3f& velocity) { frame_[surface] = velocity; }
  /// Velocity of a particle relative to its surface's mean [m/s].
  Vec3f relative_velocity(const Vec3f& velocity, std::size_t surface) const {
    return velocity - mean_velocity_[surface];
  }
  /// Thickness of a particle in contacts [m].
  float thickness(std::uint32_t particle) const { return 2 * max(radius_[particle], min_thickness); }
  /// Predicts the paths of a surface for a time of `dt` [s], from a moment that was `ago` [s]. Returns whether boxes changed.
  bool predict_surface(const ElementSurfaces& surfaces, std::uint32_t surface, const ParticleView& particles,
                       std::span<const Vec4f> velocity, float ago, float dt, Threads& threads);
  /// Starts the next substep.
  void advance(float h) { elapsed_ += h; }
  /// Finds the particles that have left their paths. If overlaps_other is 0, a surface is far from all others. Its
  /// positions are compared relative to their mean only, because the margin of their bounds covers their motion.
  void find_off_path(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                     const ParticleView& particles, Threads& threads);
  /// Compares `moved` alone, the particles that have moved since. The particles of a surface share one shift, that of
  /// the last search of all particles.
  void find_off_path(const ElementSurfaces& surfaces, std::span<const std::uint8_t> overlaps_other,
                     const ParticleView& particles, std::span<const std::uint32_t> moved);
  std::span<const std::uint32_t> off_path() const { return off_path_; }
  /// Predicts a particle again, from the start of the substep of length h, for a time of `dt`. `shift`: of its surface's
  /// mean then [m].
  void predict_off_path(std::uint32_t particle, std::uint32_t surface, const Vec3f& shift,
                        const ParticleView& before, const Vec3f& velocity, float h, float dt);
  /// Around what a surface passes from `ago` until `dt` after that [s], if its paths were predicted so.
  Bounds bounds_of(const ContactSurface& surface, std::uint32_t index, float ago, float dt) const;
  /// The motion of a surface's mean since its pairs were found [m].
  Vec3f shift_of(const ElementSurfaces& surfaces, std::size_t surface, const ParticleView& particles) const;
  /// Sets the motion of a surface's mean since its pairs were found.
  void find_shift(const ElementSurfaces& surfaces, std::size_t surface, const ParticleView& particles) {
    shift_[surface] = shift_of(surfaces, surface, particles);
  }

  /// Per particle: around its path, in its surface's frame and relative to its surface's mean motion.
  std::span<const Bounds> boxes() const { return boxes_; }
  std::span<const Bounds> relative_boxes() const { return relative_boxes_; }
  /// Per particle: predicted velocity [m/s].
  std::span<const Vec4f> velocity() const { return predicted_velocity_; }
  kernels::PredictionMargins margins(bool inter_object) const;
  std::span<const float> contact_margin() const { return contact_margin_; }
  std::size_t bytes() const;

 private:
  /// Predicted positions of a particle at the time t since pairs were found [m]. In world space they are within
  /// `margin` of origin + v t. Relative to the surface's shift they are within `relative_margin` of relative_origin +
  /// (v - mean_velocity) t.
  struct Path {
    Vec3f origin, relative_origin;
    float margin, relative_margin;
    float valid_until;  // end of the time that the search covers, since pairs were found [s]
  };
  bool keeps_paths(std::uint32_t surface, float dt) const;
  void predict(std::uint32_t particle, std::uint32_t surface, const Vec3f& x, const Vec3f& shift,
               const Vec3f& v, float since, float dt, float margin);
  bool is_on_path(std::uint32_t particle, const ContactSurface& surface, std::uint32_t index,
                  bool checks_world, const Vec3f& x) const;

  std::span<const float> radius_, contact_margin_;
  float gravity_ = 0;
  std::vector<Vec3f> mean_velocity_;  // per surface: when pairs were found [m/s]
  std::vector<Vec3f> frame_;          // per surface: of its boxes_ [m/s]
  // Per surface that is still: time and gravity that its paths were predicted for, in the frame at rest. Time -1: none.
  std::vector<std::array<float, 2>> kept_;
  std::vector<std::uint8_t> still_;
  std::vector<float> predicted_margin_;  // per particle: its contact margin in its box [m]
  std::vector<IndexRange> checked_;      // chunks of the particles of surfaces that are not still
  std::vector<Vec3d> mean_position_;     // per surface: mean of sampled particles, when pairs were found [m]
  std::vector<Vec3f> shift_;             // per surface: motion of that mean since then [m]
  std::vector<Bounds> boxes_, relative_boxes_;
  std::vector<Path> path_;
  std::vector<Vec4f> predicted_velocity_;  // v above
  float elapsed_ = 0;                      // from the step's start to the substep's end [s]
  std::vector<std::vector<std::uint32_t>> off_path_of_chunk_;  // off_path_, by chunks of particles
  std::vector<std::uint32_t> off_path_;                        // particles that have left their paths
};

}  // namespace souple
