#pragma once

#include "souple/fluid/fluid_view.h"
#include "souple/fluid/kernels/find_kernels.h"

#include <vector>

namespace souple {

/// The wall nearest to a particle, for surface tension.
struct NearWall {
  Vec3f normal{};      ///< unit vector away from the wall; zero if no wall is near
  float distance = 0;  ///< [m]
};

/// Surface tension: neighbors attract one another, and differences of normals flatten the surface. Source: Akinci,
/// Akinci and Teschner 2013, "Versatile surface tension and adhesion for SPH fluids", equations 1 to 5.
///
///   F_ij = -2 / (rho_i + rho_j) (a c(r) d / r + b value(r) (n_i - n_j)),   n_i = h V sum_j grad W_ij
///
/// with h the support. Forces of a pair are equal and opposite; rho is V sum W. c is the paper's C,
/// normalized to a maximum of 1. value(r) falls from 1 to 0 at the support; the paper's weight of the normals
/// is constant and drops to 0 there.
///
/// Instead of the paper's factor, a and b follow from sigma [N/m]: a = 0.3 sigma d and b = 2 sigma d. They are
/// multiplied by 0.56 with poly6 and spiky, 1.17 with the cubic spline, 0.49 with the wide kernel. With these factors,
/// measured drops of 6 to 16 spacings have a pressure of 0.85 to 1.05 times 2 sigma / R. Their oscillation matches
/// Rayleigh's with a sigma within 5 %. With attraction alone (b = 0) cubes become round, but small drops have no more
/// pressure than large ones. With b alone the surface evaporates. Attraction adds pressure everywhere: about 0.8 sigma
/// / d in a fluid with a free surface, whether flat or not.
///
/// A wall attracts like fluid in its place, times `adhesion`: see adhesion_of.
class SurfaceTension {
 public:
  struct Parameters {
    float sigma = 0.072f;  ///< [N/m]; water in air
    float adhesion = 1;    ///< of walls, relative to the fluid's own attraction
  };
  explicit SurfaceTension(SmoothingShape shape = SmoothingShape::wendland);

  /// The largest substep [s] that resolves the shortest capillary wave of the particles (Brackbill, Kothe and
  /// Zemach 1992, equation 61), `density` in kg/m^3:
  ///
  ///   h < 0.4 sqrt(rho d^3 / (2 pi sigma))
  ///
  /// The method is stable up to about three times this substep, but drops are then compressed by some
  /// percent.
  static float max_substep(float sigma, float density, float spacing);

  /// The adhesion for a contact angle [rad], measured inside the drop. Drops of 10 spacings without gravity, with
  /// Wendland's kernel, gave 160 degrees for 0, 84 for 1 and 34 for 2. Angles outside this range are clamped. Other
  /// kernels give angles up to 16 degrees smaller.
  static float adhesion_of(float contact_angle);

  /// Updates v over h seconds. `walls` by sorted index, or empty.
  void apply(const FluidView& fluid, std::span<const NearWall> walls, const Parameters& parameters, float h,
             Threads& threads);
  /// By sorted index: impulse of the wall's attraction in the last apply with walls [kg m/s].
  std::span<const float> wall_pulls() const { return wall_pulls_; }

 private:
  void find_normals(const FluidView& fluid, std::span<const NearWall> walls, float adhesion,
                    Threads& threads);
  float wall_pull(const Smoothing& smoothing, float distance) const;

  const kernels::DensityKernels* density_;
  const kernels::VelocityKernels* velocity_;
  float share_;
  std::vector<float> wall_pull_;  // by distance to a wall, in units of a
  std::vector<float> wall_pulls_;
  std::vector<Vec4f> normals_;  // and rho; plus one extra record, far away
};

}  // namespace souple
