#pragma once

#include "souple/stages/forces.h"

#include <cstddef>
#include <optional>
#include <vector>

// From velocities to predicted positions, and back. Both directions return the lowest particle with a non-finite value:
// the origin, because the solver would spread the value within the substep.

namespace souple {

/// v* and p* - x of a particle.
struct Predicted {
  Vec3f velocity, move;
};
/// Predicts particle i at position x and velocity v in a substep of h seconds that begins at time t.
using Integrate = Predicted (*)(const ExternalForces& forces, std::size_t i, const Vec3f& x, const Vec3f& v,
                                float h, double t);

/// Data of a substep, kept so that a step allocates nothing.
struct MotionScratch {
  std::vector<Vec4f> air_thirds;  ///< of some triangles: a third of the air's force [N]
  Integrate integrate = nullptr;  ///< null: semi-implicit Euler
  std::vector<Vec4f> predicted;   ///< p* of other integrators
};

/// v* and p* from external forces, by the integrator of `scratch`.
std::optional<std::size_t> predict_motion(const StageView& stage,
                                          const CallbackList<VertexForceField>& fields,
                                          const Substep& substep, MotionScratch& scratch);
/// Call when all that is driven has its predicted position.
void keep_prediction(const StageView& stage, MotionScratch& scratch);
/// v = v* + (p - p*) / h, which is (p - x) / h if p* = x + h v*; x = p.
std::optional<std::size_t> finish_motion(const StageView& stage, const Substep& substep,
                                         const MotionScratch& scratch);

/// The lowest particle that has no finite position or velocity.
std::optional<std::size_t> find_non_finite(const StageView& stage);
/// The lowest particle of an object that is farther than range::coordinate from the origin along an axis.
std::optional<std::size_t> find_out_of_range(const ObjectsView& objects, Threads& threads);

}  // namespace souple
