#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// Results of World::time_projections and World::time_solve. They never influence a simulation.

namespace souple {

/// Time of one projection of all constraints of a kind.
struct KindTime {
  std::string_view kind;
  std::size_t count = 0;  ///< constraints
  double seconds = 0;     ///< median of the sweeps
};

/// Time and accuracy of a solve.
struct SolveTime {
  double seconds = 0;
  std::size_t count = 0;      ///< distance constraints; only they have a strain
  double mean_strain = 0;     ///< mean of abs((l - l0) / l0)
  double rms_strain = 0;      ///< root mean square of (l - l0) / l0
  double largest_strain = 0;  ///< maximum of (l - l0) / l0
  double energy = 0;          ///< 1/2 sum C^2 of the distances: that of links of 1 N/m [J]
  std::string diagnostic;     ///< of the solver; may be empty
};

}  // namespace souple
