#pragma once

#include "souple/error.h"

#include <cstdlib>

namespace souple::fuzz {

/// A reader may reject a file, but its results must be valid. A fuzzer reports an abort.
inline void require(bool sound) {
  if (!sound) std::abort();
}

/// Returns the result of `read` for valid files that Souple wrote; an Error aborts too.
template <class Read>
auto must_read(Read&& read) {
  try {
    return read();
  } catch (const Error&) {
    std::abort();
  }
}

}  // namespace souple::fuzz
