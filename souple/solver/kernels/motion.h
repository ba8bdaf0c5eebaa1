#pragma once

#include <cstddef>

// Prediction and velocity update of particles that nothing but gravity and wind accelerates, under
// semi-implicit Euler: the two passes over all particles that every substep makes. world/stages.cpp holds the
// same formulas for every other case, one particle at a time; both give the same bits.

namespace souple::kernels {

/// Arrays of 16-byte records, one per particle (see state/particles.h).
struct MotionArrays {
  float* position = nullptr;     ///< w = inverse mass [1/kg]
  float* moving = nullptr;       ///< plain form: the same as position; else the offset
  float* start = nullptr;        ///< `moving` when the substep began
  float* velocity = nullptr;     ///< m/s
  const float* force = nullptr;  ///< of the wind [N]; null: there is none
};

/// start = moving; v = v + (gravity + w f) h; moving += v h; where w = 0 only the first. Particles
/// [begin, end). False: a number may have gone bad, look for it.
using Predict = bool (*)(const MotionArrays&, std::size_t begin, std::size_t end, const float (&gravity)[3],
                         float h);
/// v += (moving - (start + v h)) / h, from v = 0 where w = 0. Displacement form: then x += q, and the offset
/// keeps what x cannot represent. Particles [begin, end). False: a number may have gone bad, look for it.
using Finish = bool (*)(const MotionArrays&, std::size_t begin, std::size_t end, float h);

struct MotionKernels {
  Predict predict;
  Finish finish[2];  ///< [0] plain form, [1] displacement form
};

/// Compiled in one translation unit per instruction set (compile_motion.h).
template <class Isa>
const MotionKernels& motion_kernels();

}  // namespace souple::kernels
