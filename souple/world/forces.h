#pragma once

#include "souple/world/state.h"

namespace souple {

/// Wind velocity at time t [m/s]. Gusts vary it by a sum of sines, whose phases are a function of the seed:
/// every run has the same weather.
Vec3f wind_at(const Settings& settings, double t);

/// Fills world.scratch.force with the wind's drag and lift on the triangles of cloths [N]. Returns false without
/// wind.
bool accumulate_wind(WorldState& world, float h);

/// External acceleration of particle i at position x and velocity v: gravity, linear drag, wind, force
/// fields. [m/s^2]
Vec3f acceleration(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v, bool windy,
                   const Vec3f& wind, double t);

/// Solves v = v0 + h a(x + h v, v, t) by Newton's method with a 3 x 3 Jacobian from central differences. The
/// wind on triangles is that of the substep's start.
Vec3f implicit_velocity(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v0, float h,
                        bool windy, const Vec3f& wind, double t);

}  // namespace souple
