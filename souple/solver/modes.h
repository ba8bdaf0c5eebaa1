#pragma once

namespace souple {

/// How constraints are enforced.
enum class Mode {
  small_steps,  ///< compliance; many substeps of one iteration (Macklin et al. 2019). Multipliers only if
                ///< iterations > 1.
  xpbd,         ///< compliance with stored multipliers at any number of iterations (Macklin et al. 2016)
  pbd  ///< stiffness k in [0, 1], made independent of the iteration count (Müller et al. 2007, section 3.3)
};

}  // namespace souple
