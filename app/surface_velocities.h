#pragma once

#include "souple/math/vec3.h"
#include "souple/surface/narrow_band.h"
#include "souple/threads/threads.h"

#include <span>
#include <vector>

namespace souple::app {

/// The velocity of the particles around each point, such as a vertex of a surface. It is their mean with the weights (1 - r^2 /
/// radius^2)^2, r the distance [m]; zero without a particle within `radius`. As many velocities as positions. Equal for
/// any number of threads.
std::vector<Vec3f> surface_velocities(std::span<const Vec3f> points, std::span<const Vec3f> positions,
                                      std::span<const Vec3f> velocities, float radius, Threads& threads);

/// The points of a narrow band in the order of its bricks. [m]
std::vector<Vec3f> band_points(const NarrowBand& band);

}  // namespace souple::app
