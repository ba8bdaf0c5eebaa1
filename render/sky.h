#pragma once

#include "render/draw_list.h"
#include "render/environment.h"

// The procedural sky. shaders/sky.glsl contains the same model for a pixel's direction.

namespace souple::render {

/// The sky over a floor, in units of Light.
struct Sky {
  Vec3f zenith, horizon;
  Vec3f floor;  ///< radiance below the horizon
  Vec3f to_sun;
  bool has_floor = true;  ///< the floor reaches the horizon; otherwise the transition is as wide as above
};

/// The floor reflects sun and sky; without a floor, light.floor is below the horizon.
Sky sky_of(const Light& light, const Ground& ground);
/// Radiance from a unit direction.
Vec3f sky_radiance(const Sky& sky, const Vec3f& direction);
/// Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance environment maps", eq. 12;
/// integrated over a grid of directions.
SkyIrradiance sky_irradiance(const Sky& sky);
/// Light reflected by a white surface with this unit normal.
Vec3f irradiance_at(const SkyIrradiance& irradiance, const Vec3f& normal);

}  // namespace souple::render
