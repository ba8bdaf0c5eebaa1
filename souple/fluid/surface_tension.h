#pragma once

#include "souple/fluid/fluid_view.h"

#include <vector>

namespace souple {

/// What is near a particle besides fluid, for surface tension.
struct NearWall {
  Vec3f normal{};      ///< away from the wall, of length 1; zero where there is none
  float distance = 0;  ///< [m]
};

/// Surface tension (Akinci, Akinci and Teschner 2013, "Versatile surface tension and adhesion for SPH
/// fluids", equations 1 to 5): neighbors attract one another, and normals that differ flatten the surface.
///
///   F_ij = -2 / (rho_i + rho_j) (a c(r) d / r + b value(r) (n_i - n_j)),   n_i = 2 d V sum_j grad W_ij
///
/// Equal and opposite in pairs; rho is V sum W. c is the paper's C, 1 where it is strongest, and value(r)
/// falls from 1 to 0 at the support, where the paper lets differences of normals count all the same and then
/// jump to nothing.
///
/// The paper has a factor of its own; here both follow from sigma [N/m], a = 0.3 sigma d and b = 2 sigma d
/// (both 0.56 times that with poly6 and spiky, 1.17 times with the cubic spline, 0.49 times with the wide
/// one). Measured with them: drops of 6 to 16 spacings have a pressure of 0.85 to 1.05 times 2 sigma / R, and
/// they swing as Rayleigh's do with a sigma within 5 %. Attraction alone (b = 0) makes cubes round, but
/// presses no more on a small drop than on a large one; alone, b lets the surface evaporate. Attraction also
/// presses everywhere: a fluid with a free surface has about 0.8 sigma / d more in it, be it flat or not.
///
/// A wall attracts as a fluid would that fills it, `adhesion` times: see adhesion_of.
class SurfaceTension {
 public:
  struct Parameters {
    float sigma = 0.072f;  ///< [N/m]; water in air
    float adhesion = 1;    ///< of walls
  };
  explicit SurfaceTension(SmoothingShape shape = SmoothingShape::wendland);

  /// The longest substep [s] that shows the shortest wave the particles can carry (Brackbill, Kothe and
  /// Zemach 1992, equation 61), `density` in kg/m^3:
  ///
  ///   h < 0.4 sqrt(rho d^3 / (2 pi sigma))
  ///
  /// It is stable to about three times that, but drops are then pressed together by some per cent.
  static float max_substep(float sigma, float density, float spacing);

  /// The adhesion with which a drop meets the wall at an angle [rad], measured within it, from drops of 10
  /// spacings without gravity, with Wendland's kernel: 0 gives 160 degrees, 1 gives 84, 2 gives 34. Angles
  /// beyond these give the last. Other kernels are up to 16 degrees below.
  static float adhesion_of(float contact_angle);

  /// Changes v over h seconds. `walls` by place, or empty.
  void apply(const FluidView& fluid, std::span<const NearWall> walls, const Parameters& parameters, float h,
             Threads& threads);
  /// With which impulse each place was pulled to its wall by the last apply with walls. [kg m/s]
  std::span<const float> wall_pulls() const { return wall_pulls_; }

 private:
  void find_normals(const FluidView& fluid, std::span<const NearWall> walls, float adhesion,
                    Threads& threads);
  float wall_pull(const Smoothing& smoothing, float distance) const;

  const kernels::DensityKernels* density_;
  const kernels::VelocityKernels* velocity_;
  float share_;
  std::vector<float> wall_pull_;  // by the distance to a wall, in units of a
  std::vector<float> wall_pulls_;
  std::vector<Vec4f> normals_;  // and rho; one more, far away
};

}  // namespace souple
