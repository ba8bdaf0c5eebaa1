#include "souple/objects/checks.h"

#include "souple/error.h"

#include <cmath>

#include <fmt/core.h>

namespace souple {

void check_all(std::string_view owner, std::initializer_list<Check> checks) {
  for (const Check& check : checks) {
    const bool below = check.open ? check.value < check.hi : check.value <= check.hi;
    if (check.value >= check.lo && below) continue;
    throw Error(fmt::format("{}: {} is {:g}, expected a number from {:g} to {}{:g}", owner, check.field,
                            check.value, check.lo, check.open ? "below " : "", check.hi));
  }
}

void require_finite(std::string_view owner, const char* field, const Vec3f& v) {
  if (!is_finite(v))
    throw Error(
        fmt::format("{}: {} is ({:g}, {:g}, {:g}), expected finite numbers", owner, field, v.x, v.y, v.z));
}

void require_within(std::string_view owner, const char* field, const Vec3d& v, double limit) {
  if (!is_within(v, limit))
    throw Error(fmt::format("{}: {} is ({:g}, {:g}, {:g}), expected numbers from {:g} to {:g}", owner, field,
                            v.x, v.y, v.z, -limit, limit));
}

void validate(const Transform& t, std::string_view owner) {
  const double q = std::sqrt(t.rotation.x * t.rotation.x + t.rotation.y * t.rotation.y +
                             t.rotation.z * t.rotation.z + t.rotation.w * t.rotation.w);
  check_all(owner, {{"transform's scale", t.scale, range::positive, range::finite},
                    {"length of the rotation quaternion", q, 0.999, 1.001}});
  require_within(owner, "the translation", t.translation, range::coordinate);
}

}  // namespace souple
