#pragma once

#include "souple/surface/narrow_band.h"

#include <string>

namespace souple::app {

/// Whether the program was built with OpenVDB.
bool has_vdb();
/// Throws Error that names the package, if the program was built without OpenVDB.
void require_vdb();

/// An OpenVDB file: a level set named "surface" (float, negative inside, meters) with filled interior tiles.
/// The metadata entry "object" holds `object`. Equal bands give equal bytes.
std::string vdb_bytes(const NarrowBand& band, const std::string& object);

}  // namespace souple::app
