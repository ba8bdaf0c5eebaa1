#pragma once

#include <tuple>
#include <type_traits>

// The list of all kinds of constraints; all.h includes them.

namespace souple {

struct Attachment;
template <int m, int n>
struct BallJointBetween;
using BallJoint = BallJointBetween<2, 2>;
struct ConeLimit;
struct DihedralBending;
struct Distance;
struct IsometricBending;
struct NeoHookean;
struct ParticleContact;
struct RopeBending;
struct TetVolume;
struct Tether;
struct TriangleMembrane;
struct TwistLimit;

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
