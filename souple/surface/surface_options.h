#pragma once

namespace souple {

/// Kernels of the field whose level set is the surface of a fluid.
enum class SurfaceMethod {
  anisotropic,  ///< stretched along the surface (Yu and Turk 2013): flat where the fluid is flat
  isotropic     ///< the same ball for every particle (Müller et al. 2003): bumpy, for comparison
};

/// Options of FluidSurface. All lengths except `spacing` and `cell` are in units of `spacing`.
struct SurfaceOptions {
  SurfaceMethod method = SurfaceMethod::anisotropic;
  float spacing = 0;  ///< d, distance of particles at rest, twice their radius [m]; required
  float cell = 0;     ///< spacing of the grid for marching cubes [m]; 0: d / 2, a particle's radius
  /// Radius of a particle's neighborhood: r_i of the paper.
  float neighbor_radius = 3;
  /// How far a center moves to the mean of its neighbors: lambda, in [0, 1]. Vertices are moved back by the
  /// shift.
  float center_smoothing = 0.9f;
  /// Support radius of the kernel of a particle inside the fluid.
  float kernel_radius = 3.25f;
  float isotropic_radius = 2;  ///< support radius of isotropic kernels
  float max_axis_ratio = 4;    ///< greatest ratio of a kernel's axes: k_r of the paper
  /// A particle with at most this many neighbors is a drop: a ball with support radius `drop_radius`.
  int few_neighbors = 12;
  float drop_radius = 0.8f;
  /// Value of the field at the surface; it is about 1 inside. 0: computed so that the mesh of a pool is half
  /// a spacing above its topmost particles.
  float level = 0;
  /// Passes of Laplacian smoothing of the mesh, and how far each pass moves a vertex, in [0, 1].
  int smoothing_passes = 0;
  float smoothing = 0.5f;
};

}  // namespace souple
