#pragma once

#include "souple/math/vec3.h"

namespace souple {

/// Three components and a fourth lane: 16 bytes, which a SIMD register loads whole.
struct alignas(16) Vec4f {
  float x{}, y{}, z{}, w{};

  Vec3f xyz() const { return {x, y, z}; }
  void set_xyz(const Vec3f& v) { x = v.x, y = v.y, z = v.z; }
};

}  // namespace souple
