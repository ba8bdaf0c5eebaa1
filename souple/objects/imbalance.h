#pragma once

#include <cstdint>

namespace souple {

/// The last measurement of how far the forces of an object are out of balance, see stages/balance.h.
struct Imbalance {
  double unbalanced = 0, stretch = 0;     ///< ratios, 0 in equilibrium
  std::uint64_t times_not_converged = 0;  ///< successive measurements
};

}  // namespace souple
