#pragma once

#include "souple/studies/segment_triangle/choice.h"

namespace souple::benchmarks {

/// Prints as JSON what discrete detection lets through, with each segment-triangle test.
void print_path_leaks(long long shots);

}  // namespace souple::benchmarks
