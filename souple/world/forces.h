#pragma once

#include "souple/world/state.h"

namespace souple {

/// The wind at time t [m/s]: its velocity, strengthened and weakened by gusts (a sum of sines whose phases
/// come from the seed, so that every run sees the same weather).
Vec3f wind_at(const Settings& settings, double t);

/// Fills world.force with the wind's drag and lift on the triangles of cloths [N]; false when there is none.
bool accumulate_wind(WorldState& world, float h);

/// External acceleration of particle i at position x and velocity v: gravity, linear drag, wind, force
/// fields. [m/s^2]
Vec3f acceleration(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v, bool windy,
                   const Vec3f& wind, double t);

/// v = a solution of v = v0 + h a(x + h v, v, t), by Newton's method with a differenced 3 x 3 Jacobian. The
/// wind on triangles is taken from the substep's start.
Vec3f implicit_velocity(WorldState& world, std::size_t i, const Vec3f& x, const Vec3f& v0, float h,
                        bool windy, const Vec3f& wind, double t);

}  // namespace souple
