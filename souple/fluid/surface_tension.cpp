#include "souple/fluid/surface_tension.h"

#include "souple/fluid/kernels/shapes.h"

#include <cmath>

namespace souple {

namespace {

// Measured, see surface_tension.h. In units of sigma d, for Wendland's kernel.
constexpr float attraction = 0.3f, flattening = 2;

// Factor for other kernels: their slopes give other normals.
float share_of(SmoothingShape shape) {
  switch (shape) {
    case SmoothingShape::poly6_spiky:
      return 0.56f;
    case SmoothingShape::cubic_spline:
      return 1.17f;
    case SmoothingShape::wide_wendland:
      return 0.49f;
    case SmoothingShape::wendland:
      break;
  }
  return 1;
}

constexpr int wall_steps = 64;

/// Attraction of a wall at a distance of z = 2 k / wall_steps spacings, in units of a, for a support of two spacings.
/// The wall is filled with one particle per d^3. A slice at the distance t contributes
///
///   2 pi t integral_t^2 c(s) ds
std::vector<float> half_space_pull() {
  constexpr int fine = 16 * wall_steps;
  constexpr double dt = 2.0 / fine;
  std::vector<float> table(wall_steps + 2, 0.0f);
  double slice = 0, sum = 0;
  for (int k = fine; k-- > 0;) {
    const double t = (k + 0.5) * dt;
    slice += kernels::Cohesion::slope(t / 2) * (t / 2) * dt;
    sum += 2 * pi * t * slice * dt;
    if (k % 16 == 0) table[static_cast<std::size_t>(k / 16)] = static_cast<float>(sum);
  }
  return table;
}

}  // namespace

SurfaceTension::SurfaceTension(SmoothingShape shape)
    : density_(&kernels::find_density_kernels(instruction_set(), shape)),
      velocity_(&kernels::find_velocity_kernels(instruction_set(), shape)),
      share_(share_of(shape)),
      wall_pull_(half_space_pull()) {}

float SurfaceTension::max_substep(float sigma, float density, float spacing) {
  const float volume = spacing * spacing * spacing;
  return 0.4f * std::sqrt(density * volume / (2 * static_cast<float>(pi) * sigma));
}

float SurfaceTension::adhesion_of(float contact_angle) {
  constexpr float degrees[] = {160, 142, 122, 104, 84, 64, 49, 40, 34};  // for adhesion 0, 1/4, ... 2
  const float angle = contact_angle * 180 / static_cast<float>(pi);
  if (angle >= degrees[0]) return 0;
  for (int k = 0; k < 8; ++k)
    if (angle >= degrees[k + 1])
      return 0.25f * (static_cast<float>(k) + (degrees[k] - angle) / (degrees[k] - degrees[k + 1]));
  return 2;
}

void SurfaceTension::find_normals(const FluidView& fluid, std::span<const NearWall> walls, float adhesion,
                                  Threads& threads) {
  const Smoothing& smoothing = fluid.smoothing;
  const float V = smoothing.volume();
  normals_.resize(fluid.size() + 1);
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    const kernels::DensitySums sums =
        density_->sums(fluid.x.data(), fluid.x[k], list.data(), list.size(), smoothing.factors());
    Vec3f gradient = sums.gradient * V;
    float rho = V * (sums.density + smoothing.center());
    if (!walls.empty() && dot(walls[k].normal, walls[k].normal) > 0) {
      // Half of the wall's slope: the full slope includes the motion of the mirrored fluid.
      const Smoothing::Wall wall = smoothing.wall(walls[k].distance);
      gradient += walls[k].normal * (0.5f * adhesion * wall.slope);
      rho += wall.value;
    }
    normals_[k].set_xyz(gradient * smoothing.support());
    normals_[k].w = rho;
  });
  normals_[fluid.size()] = {0, 0, 0, 1};
}

float SurfaceTension::wall_pull(const Smoothing& smoothing, float distance) const {
  const float at = max(distance, 0.0f) * (wall_steps * smoothing.factors().inverse_h);
  if (!(at < wall_steps)) return 0;
  const auto step = static_cast<std::size_t>(at);
  const float wider = 0.5f * smoothing.support() / smoothing.spacing();
  return wider * wider * wider *
         (wall_pull_[step] + (at - static_cast<float>(step)) * (wall_pull_[step + 1] - wall_pull_[step]));
}

void SurfaceTension::apply(const FluidView& fluid, std::span<const NearWall> walls,
                           const Parameters& parameters, float h, Threads& threads) {
  find_normals(fluid, walls, parameters.adhesion, threads);
  const Smoothing& smoothing = fluid.smoothing;
  const float d = smoothing.spacing(), unit = share_ * parameters.sigma * d;
  const kernels::CohesionFactors factors{attraction * unit, flattening * unit};
  wall_pulls_.resize(walls.size());
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    Vec3f force = velocity_->cohesion(fluid.x.data(), normals_.data(), fluid.x[k], normals_[k], list.data(),
                                      list.size(), smoothing.factors(), factors);
    if (!walls.empty()) {
      const float pull =
          factors.attraction * parameters.adhesion * wall_pull(smoothing, walls[k].distance) / normals_[k].w;
      force -= walls[k].normal * pull;
      wall_pulls_[k] = h * pull;
    }
    fluid.v[k].set_xyz(fluid.v[k].xyz() + force * (h * fluid.x[k].w));
  });
}

}  // namespace souple
