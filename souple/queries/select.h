#pragma once

#include "souple/queries/selector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct Object;

/// The vertices that a selector selects: user order, ascending. Throws Error if there is none. `positions`: of the
/// object's vertices [m].
std::vector<std::uint32_t> select_vertices(const Object& object, std::span<const Vec3f> positions,
                                           const Selector& selector);

}  // namespace souple
