#pragma once

#if defined(__unix__) || defined(__APPLE__)
#include <unistd.h>
#endif

namespace souple {

/// Number of this process. A child made by fork has another one, and none of its parent's threads but the caller's.
inline long process_number() {
#if defined(__unix__) || defined(__APPLE__)
  return static_cast<long>(getpid());
#else
  return 0;
#endif
}

}  // namespace souple
