#pragma once

#include "souple/surface/narrow_band.h"

#include <string>

namespace souple::app {

/// Whether OpenVDB was built in.
bool has_vdb();
/// Throws Error, saying what to install, when it was not.
void require_vdb();

/// An OpenVDB file: a level set named "surface" (float, negative inside, meters), tiles inside filled.
/// `object` becomes its metadata of that name. The same band gives the same bytes.
std::string vdb_bytes(const NarrowBand& band, const std::string& object);

}  // namespace souple::app
