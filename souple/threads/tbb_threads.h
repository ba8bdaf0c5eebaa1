#pragma once

#include "souple/threads/threads.h"

namespace souple {

/// Creates threads of oneTBB. Exists only if the library was built with SOUPLE_WITH_TBB.
std::unique_ptr<Threads> make_tbb_threads(int count);

}  // namespace souple
