#pragma once

#include <cmath>

namespace souple::kernels {

/// The instruction set with one lane (see simd/instruction_sets.h): its registers are floats.
struct Single {
  static constexpr int lanes = 1;
  using Vector = float;
  using Mask = int;

  static Vector broadcast(float a) { return a; }
  static bool any(Mask a) { return a != 0; }
  static Vector sqrt(Vector a) { return std::sqrt(a); }
  static Vector min(Vector a, Vector b) { return a < b ? a : b; }
  static Vector max(Vector a, Vector b) { return a > b ? a : b; }
  static Vector load(const float* p) { return *p; }
  static void store(float* p, Vector a) { *p = a; }
};

}  // namespace souple::kernels
