#pragma once

#include <cstddef>

namespace souple {

/// Indices [begin, end).
struct IndexRange {
  std::size_t begin = 0, end = 0;
};

}  // namespace souple
