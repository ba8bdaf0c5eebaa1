#pragma once

#include "souple/solver/threads.h"

namespace souple {

/// oneTBB's threads. Exists only if the library was built with SOUPLE_WITH_TBB.
std::unique_ptr<Threads> make_tbb_threads(int count);

}  // namespace souple
