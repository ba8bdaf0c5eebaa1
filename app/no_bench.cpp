#include "app/commands.h"
#include "souple/error.h"

// Replaces bench.cpp where SOUPLE_WITH_BENCH is off.

namespace souple::app {

int bench(const BenchRequest&) {
  throw Error("this program was built without its benchmarks: build it again with -D SOUPLE_WITH_BENCH=ON");
}

}  // namespace souple::app
