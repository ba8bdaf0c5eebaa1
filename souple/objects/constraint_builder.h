#pragma once

#include "souple/error.h"
#include "souple/objects/constraint_sets.h"
#include "souple/objects/set_kinds.h"

#include <cmath>
#include <tuple>

namespace souple {

/// Adds constraints of the kinds that are wanted to the sets of one object.
class ConstraintBuilder {
 public:
  ConstraintBuilder(const SetKinds& wanted, ConstraintSets& sets) : wanted_(wanted), sets_(sets) {}

  bool wants(SetKind kind) const { return wanted_.has(kind); }
  bool wants_any(const SetKinds& kinds) const { return (wanted_ & kinds).any(); }
  template <class Kind>
  SetProjector<Kind>& set() {
    return std::get<SetProjector<Kind>>(sets_.sets);
  }
  /// Slivers of an imported surface have no shape that floats could distinguish from a line: they are skipped and
  /// counted.
  template <class Function>
  void add_if_valid(const Function& add) {
    try {
      add();
    } catch (const Error&) {
      ++sets_.skipped;
    }
  }

 private:
  SetKinds wanted_;
  ConstraintSets& sets_;
};

/// A factor or stiffness of 0 makes no constraint: its compliance would be infinite.
inline bool usable(float compliance) {
  return std::isfinite(compliance);
}

}  // namespace souple
