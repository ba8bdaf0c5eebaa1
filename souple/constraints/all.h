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

namespace souple {

/// Every kind that Souple ships: what the kernels are compiled for and the typed test runs over. A new kind
/// is registered here.
using EveryConstraint =
    std::tuple<Distance, DihedralBending, IsometricBending, TriangleMembrane, TetVolume, NeoHookean,
               RopeBending, ParticleContact, Attachment, BallJoint, ConeLimit, TwistLimit, Tether>;

}  // namespace souple
