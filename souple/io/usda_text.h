#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>

// Values and names in the text form of USD (.usda).

namespace souple::usda {

/// "[(1, 2, 3), ...]": the shortest texts that read back to the same floats.
std::string exact(std::span<const Vec3f> values);
/// Texts to six digits, for velocities, or to four, for normals.
std::string rounded(std::span<const Vec3f> values, int digits);
std::string pairs(std::span<const std::array<float, 2>> values);
std::string integers(std::span<const std::uint32_t> values);
/// `count` times the same number.
std::string repeated(std::size_t count, std::uint32_t value);
/// The box around balls of a radius, as `extent` holds it. Without positions, a point at the origin.
std::string extent(std::span<const Vec3f> positions, float radius);
/// A text in quotation marks.
std::string string_text(std::string_view text);

/// Generates prim names, which are ASCII identifiers that differ within their parent: "ball_2" for "ball 2".
class PrimNames {
 public:
  std::string add(std::string_view name);

 private:
  std::set<std::string> taken_;
};

}  // namespace souple::usda
