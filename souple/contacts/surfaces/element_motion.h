#pragma once

#include "souple/broad_phase/near_pair.h"
#include "souple/math/vec3.h"
#include "souple/solver/projector.h"

namespace souple {

/// Positions of the four particles of a pair relative to the first: x at the start of the substep, p at its
/// end.
struct Motion {
  Vec3f x[4], p[4];
};

Motion motion_of(const NearPair& pair, const ParticleView& particles);
/// The part of the motion x -> p up to which the two elements do not touch, at most 1.
float safe_time(const Motion& motion, bool edges);
/// Whether the nearest points at `toi` differ, so that they have a normal, and a particle can move along it.
bool has_normal(const NearPair& pair, const Motion& motion, float toi, bool edges,
                const ParticleView& particles);

}  // namespace souple
