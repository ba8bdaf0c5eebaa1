#pragma once

#include "app/surface_velocities.h"
#include "souple/surface/narrow_band.h"

#include <span>
#include <string>

namespace souple::app {

/// Whether the build includes OpenVDB.
bool has_vdb();
/// Throws Error that names the package to install when the build does not include OpenVDB.
void require_vdb();

/// An OpenVDB file with a level set named "surface" (float, negative inside, meters), tiles inside filled.
/// `object` becomes its metadata entry of that name. Unless `velocities`, of `band_points`, are empty, a grid "velocity" (vectors,
/// m/s) has them at the points of the band. Equal values give equal bytes.
std::string vdb_bytes(const NarrowBand& band, const std::string& object,
                      std::span<const Vec3f> velocities = {});

}  // namespace souple::app
