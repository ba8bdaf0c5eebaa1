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

// The kernels of each of these lists are a translation unit of their own.

/// What cloth and solids are made of.
using MeshConstraints =
    std::tuple<Distance, DihedralBending, IsometricBending, TriangleMembrane, TetVolume, NeoHookean>;
/// What ropes are made of, and what holds objects together or apart.
using OtherConstraints =
    std::tuple<RopeBending, ParticleContact, Attachment, BallJoint, ConeLimit, TwistLimit, Tether>;

/// Every kind that Souple ships: what the kernels are compiled for and the typed test runs over. A new kind
/// is registered in one of the lists above.
using EveryConstraint = decltype(detail::joined(std::type_identity<MeshConstraints>{},
                                                std::type_identity<OtherConstraints>{}))::type;

}  // namespace souple
