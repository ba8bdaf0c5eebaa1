#pragma once

#include <cstddef>

// Prediction and velocity update of particles under semi-implicit Euler, the two passes over all particles in every
// substep. Gravity and air are the only accelerations. stages/motion.cpp has the same formulas for all other cases, one
// particle at a time; both give the same bits.

namespace souple::kernels {

/// Arrays of 16-byte records, one per particle (see state/particles.h).
struct MotionArrays {
  float* position = nullptr;  ///< w = inverse mass [1/kg]
  float* moving = nullptr;    ///< the offset
  float* start =
      nullptr;  ///< `moving` at the start of the substep; before predict_in_air the air's force f [N]
  float* velocity = nullptr;  ///< m/s
};

/// v = v + (gravity + w f) h, f = 0 without air; start = moving; moving += v h; if w = 0, only the second. Particles [begin,
/// end). Returns false if a value may be non-finite; the caller then searches for it.
using Predict = bool (*)(const MotionArrays&, std::size_t begin, std::size_t end, const float (&gravity)[3],
                         float h);
/// v += (moving - (start + v h)) / h, from v = 0 if w = 0. Then x += q, and the offset keeps
/// the rounding remainder of x. Particles [begin, end). Returns false if a value may be non-finite; the caller
/// then searches for it.
using Finish = bool (*)(const MotionArrays&, std::size_t begin, std::size_t end, float h);

struct MotionKernels {
  Predict predict, predict_in_air;
  Finish finish;
};

/// Compiled in one translation unit per instruction set (compile_motion.h).
template <class Isa>
const MotionKernels& motion_kernels();

}  // namespace souple::kernels
