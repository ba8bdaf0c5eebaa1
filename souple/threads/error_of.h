#pragma once

#include "souple/threads/threads.h"

#include <cstddef>
#include <exception>

namespace souple {

/// Calls f(begin, end). Returns the exception that f threw, for the thread that called the loop; null: none.
inline std::exception_ptr error_of(const RangeFunction& f, std::size_t begin, std::size_t end) noexcept {
  try {
    f(begin, end);
  } catch (...) {
    return std::current_exception();
  }
  return {};
}

}  // namespace souple
