#pragma once

namespace souple::benchmarks {

/// Prints what script/figures draws of the integrators, and the numbers of docs/integrators.md.
void print_elastic_integrators();

}  // namespace souple::benchmarks
