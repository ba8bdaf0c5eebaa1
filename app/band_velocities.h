#pragma once

#include "souple/surface/narrow_band.h"

#include <array>
#include <span>
#include <vector>

namespace souple::app {

/// Velocities at the points of a brick; zero outside the band.
using BrickVelocities = std::array<Vec3f, NarrowBand::brick_points>;

/// The velocity of the particles around each point of a band, per brick: their mean with the weights (1 - r^2 / radius^2)^2,
/// r the distance. Zero at points without a particle within `radius` [m]. As many velocities as positions.
std::vector<BrickVelocities> band_velocities(const NarrowBand& band, std::span<const Vec3f> positions,
                                             std::span<const Vec3f> velocities, float radius);

}  // namespace souple::app
