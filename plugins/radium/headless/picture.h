#pragma once

#include "plugins/radium/headless/window.h"

namespace souple::radium {

/// Writes a PNG file. Throws Error on failure.
void write_png(const std::string& file, const Picture& picture);

}  // namespace souple::radium
