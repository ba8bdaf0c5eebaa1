#pragma once

#include "souple/surface/narrow_band.h"

#include <string>

namespace souple::app {

/// Whether the build includes OpenVDB.
bool has_vdb();
/// Throws Error that names the package to install when the build does not include OpenVDB.
void require_vdb();

/// An OpenVDB file with a level set named "surface" (float, negative inside, meters), tiles inside filled.
/// `object` becomes its metadata entry of that name. The same band gives the same bytes.
std::string vdb_bytes(const NarrowBand& band, const std::string& object);

}  // namespace souple::app
