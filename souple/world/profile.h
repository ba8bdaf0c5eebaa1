#pragma once

#include <cstddef>
#include <string>
#include <string_view>

// What World::time_projections and World::time_solve measure. Results of a world never depend on these.

namespace souple {

/// How long it takes to project every constraint of one kind once.
struct KindTime {
  std::string_view kind;
  std::size_t count = 0;  ///< constraints
  double seconds = 0;     ///< median of the sweeps
};

/// How long a solver takes and how far it comes.
struct SolveTime {
  double seconds = 0;
  std::size_t count = 0;      ///< distance constraints, which have a strain:
  double mean_strain = 0;     ///< of abs((l - l0) / l0)
  double rms_strain = 0;      ///< root of the mean of its square
  double largest_strain = 0;  ///< of (l - l0) / l0
  std::string diagnostic;     ///< of the solver; may be empty
};

}  // namespace souple
