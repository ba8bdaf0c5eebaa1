#pragma once

#include "souple/constraints/dihedral_bending.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/rope_bending.h"
#include "souple/constraints/tet_volume.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/objects/set_kinds.h"
#include "souple/solver/set_projector.h"

#include <tuple>

namespace souple {

/// The sets of constraints that objects are built of: of one object, with particles numbered from 0, or of all objects of
/// a world.
struct ConstraintSets {
  /// In the order of SetKind, which is that of solution.
  std::tuple<SetProjector<Distance>, SetProjector<TriangleMembrane>, SetProjector<IsometricBending>,
             SetProjector<DihedralBending>, SetProjector<RopeBending>, SetProjector<NeoHookean>,
             SetProjector<TetVolume>>
      sets;
  std::size_t skipped = 0;  ///< elements of cloths that are too thin
};
static_assert(std::tuple_size_v<decltype(ConstraintSets::sets)> == set_kind_count);

}  // namespace souple
