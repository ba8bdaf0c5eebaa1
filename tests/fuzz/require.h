#pragma once

#include "souple/error.h"

#include <cstdlib>

namespace souple::fuzz {

/// A reader may refuse a file, but what it does return must be sound. A fuzzer takes an abort as a find.
inline void require(bool sound) {
  if (!sound) std::abort();
}

/// What `read` returns. It reads what we wrote, so here an Error is a find as well.
template <class Read>
auto must_read(Read&& read) {
  try {
    return read();
  } catch (const Error&) {
    std::abort();
  }
}

}  // namespace souple::fuzz
