#pragma once

#include "souple/collision/shapes.h"
#include "souple/math/transform.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace souple {

struct WorldState;

/// Whether an object overlaps a shape at a pose, as World::overlap. Needs a query index that is up to date.
bool overlaps(const WorldState& world, std::size_t object, const Shape& shape, const Transform& pose);

}  // namespace souple
