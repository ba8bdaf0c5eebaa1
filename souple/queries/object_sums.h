#pragma once

#include "souple/queries/query_view.h"

namespace souple {

double kinetic_energy(const QueryView& view, const Object& object);  ///< with the rotation of grains [J]
/// Energy of an object's weight; 0 at the origin [J]. `gravity`: m/s^2.
double potential_energy(const QueryView& view, const Object& object, const Vec3f& gravity);
Vec3d momentum(const QueryView& view, const Object& object);  ///< kg m/s
Vec3d center_of_mass(const QueryView& view,
                     const Object& object);  ///< m; without mass the mean of the particles

}  // namespace souple
