#pragma once

#include "souple/constraints/constraint.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

/// The arrays of many constraints of one kind: data only, sorted by colour. Constraint i of every array is
/// the same one.
template <class Kind>
struct ConstraintSet {
  using Params = typename Kind::template Params<float>;
  using Indices = std::array<std::uint32_t, Kind::arity>;
  using Compliance = std::array<float, compliance_size<Kind>>;
  using Multipliers = std::array<float, rows_of<Kind>>;

  std::vector<Indices> indices;             ///< particles
  std::vector<Params> params;               ///< rest lengths and the like
  std::vector<Compliance> compliance;       ///< alpha, packed lower triangle; unit: (unit of C)^2 / J
  std::vector<float> damping_time;          ///< tau [s]: damping coefficient is tau / alpha (Kelvin-Voigt)
  std::vector<float> stiffness;             ///< PBD mode only: k in [0, 1]
  std::vector<Multipliers> multipliers;     ///< lambda of the substep; only as long as they are stored
  std::vector<std::uint32_t> colour_begin;  ///< colour c is [colour_begin[c], colour_begin[c + 1])

  std::size_t size() const { return indices.size(); }
};

}  // namespace souple
