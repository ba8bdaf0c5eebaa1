#pragma once

#include "souple/collision/shapes.h"
#include "souple/math/transform.h"
#include "souple/queries/query.h"

#include <cstddef>
#include <vector>

namespace souple {

struct QueryView;

/// Objects and colliders that a shape at a pose of scale 1 overlaps: World::overlap.
std::vector<Overlap> find_overlaps(const QueryView& view, const Shape& shape, const Transform& pose,
                                   const QueryFilter& filter);
/// Whether an object, by its index, overlaps the shape. Needs a query index that is up to date.
bool overlaps(const QueryView& view, std::size_t object, const Shape& shape, const Transform& pose);

}  // namespace souple
