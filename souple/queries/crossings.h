#pragma once

#include <cstddef>

namespace souple {

struct Object;
struct QueryView;

/// Number of edges of an object that pass through triangles of the same object, of those that share no corner.
std::size_t count_crossings(const QueryView& view, const Object& object);

}  // namespace souple
