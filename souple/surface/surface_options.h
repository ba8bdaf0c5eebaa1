#pragma once

namespace souple {

/// How the field is made whose level is a fluid's surface.
enum class SurfaceMethod {
  anisotropic,  ///< kernels stretched along the surface (Yu and Turk 2013): flat where the fluid is
  isotropic     ///< the same ball for every particle (Müller et al. 2003): bumpy, to compare with
};

/// Lengths but `spacing` and `cell` are in spacings.
struct SurfaceOptions {
  SurfaceMethod method = SurfaceMethod::anisotropic;
  float spacing = 0;  ///< d, distance of particles at rest, two of their radii [m]; to be set
  float cell = 0;     ///< of the grid the surface is cut out of [m]; 0: d / 2, a particle's radius
  /// Within which a particle's surroundings are looked at: r_i of the paper.
  float neighbor_radius = 3;
  /// How far a center goes to the mean of its neighbors, lambda in [0, 1]. The surface gives the way back.
  float center_smoothing = 0.9f;
  /// Support of the kernel of a particle inside the fluid.
  float kernel_radius = 3.25f;
  float isotropic_radius = 2;  ///< the same of isotropic ones
  float max_axis_ratio = 4;    ///< of a kernel's axes, k_r
  /// With no more than so many neighbors a particle is a drop: a ball of support `drop_radius`.
  int few_neighbors = 12;
  float drop_radius = 0.8f;
  /// The field is 1 inside; the surface is where it is this. 0: found such that the mesh of a pool lies half
  /// a spacing above its topmost particles.
  float level = 0;
  /// Passes of Laplacian smoothing over the mesh, and how far a vertex goes in each, in [0, 1].
  int smoothing_passes = 0;
  float smoothing = 0.5f;
};

}  // namespace souple
