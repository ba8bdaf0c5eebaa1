#pragma once

#include "souple/math/vec4.h"

#include <vector>

namespace souple {

struct FluidInput;
struct FluidState;
struct ParticleView;
struct Substep;
class Threads;

/// Moves the predicted particles of the fluids, and bodies in contact with them, until no fluid is compressed.
class Incompressibility {
 public:
  void solve(const FluidInput& input, const Substep& substep, FluidState& fluids);

 private:
  void set_positions(const FluidInput& input, float h, FluidState& fluids);
  void sample_boundary(FluidState& fluids, Threads& threads) const;

  // Per fluid particle.
  std::vector<Vec4f> positions_;  // x, y, z from the origin, and inverse mass
  std::vector<Vec3f> start_;      // position at the start of the substep
};

}  // namespace souple
