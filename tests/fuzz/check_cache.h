#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <vector>

namespace souple::fuzz {

/// Reads the first and the last frame, which detects headers with too many frames.
template <class Reader>
void read_ends(Reader& reader) {
  if (reader.frames() == 0) return;
  std::vector<Vec3f> positions(reader.points());
  reader.read(0, positions);
  reader.read(reader.frames() - 1, positions);
}

}  // namespace souple::fuzz
