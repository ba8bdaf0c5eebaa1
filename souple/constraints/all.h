#pragma once

#include "souple/constraints/attachment.h"
#include "souple/constraints/ball_joint.h"
#include "souple/constraints/cone_limit.h"
#include "souple/constraints/dihedral_bending.h"
#include "souple/constraints/distance.h"
#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/neo_hookean.h"
#include "souple/constraints/particle_contact.h"
#include "souple/constraints/rope_bending.h"
#include "souple/constraints/tet_volume.h"
#include "souple/constraints/tether.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/constraints/twist_limit.h"

#include <tuple>
#include <type_traits>

namespace souple {

namespace detail {
template <class... A, class... B>
std::type_identity<std::tuple<A..., B...>> joined(std::type_identity<std::tuple<A...>>,
                                                  std::type_identity<std::tuple<B...>>);
}  // namespace detail

// The kernels of each list are compiled in a separate translation unit.

/// Kinds of cloth and solids.
using MeshConstraints =
    std::tuple<Distance, DihedralBending, IsometricBending, TriangleMembrane, TetVolume, NeoHookean>;
/// Kinds of ropes, connections, limits and contacts.
using OtherConstraints =
    std::tuple<RopeBending, ParticleContact, Attachment, BallJoint, ConeLimit, TwistLimit, Tether>;

/// All kinds that Souple ships. The kernels are compiled for each of them, and the typed test runs each. To
/// register a new kind, add it to one of the lists above.
using EveryConstraint = decltype(detail::joined(std::type_identity<MeshConstraints>{},
                                                std::type_identity<OtherConstraints>{}))::type;

}  // namespace souple
