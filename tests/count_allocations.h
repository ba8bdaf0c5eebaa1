#pragma once

namespace souple::test {

/// How often this program has called operator new.
long allocations();

}  // namespace souple::test
