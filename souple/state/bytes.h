#pragma once

#include <cstddef>
#include <vector>

namespace souple {

/// Heap memory of vectors of plain items [bytes].
template <class... Item>
std::size_t bytes_of(const std::vector<Item>&... vectors) {
  return (std::size_t{0} + ... + (vectors.capacity() * sizeof(Item)));
}

}  // namespace souple
