#pragma once

namespace souple::test {

/// Number of calls of operator new in this program so far.
long allocations();

}  // namespace souple::test
