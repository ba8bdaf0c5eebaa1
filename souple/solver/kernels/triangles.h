#pragma once

#include "souple/solver/kernels/air_force.h"

#include <array>
#include <cstddef>
#include <cstdint>

// Kernels over the triangles of a surface, one register of triangles at a time.

namespace souple::kernels {

/// Arrays of 16-byte records, one per particle; `result`: one per triangle.
struct TriangleArrays {
  const float* position = nullptr;
  const float* velocity = nullptr;
  const std::array<std::uint32_t, 3>* triangles = nullptr;
  std::uint32_t first = 0;  ///< added to the vertex indices of triangles
  float* result = nullptr;
};

/// Process triangles of [begin, end) in whole registers; return the first triangle that remains.
using AirForces = std::size_t (*)(const TriangleArrays&, const Air&, std::size_t begin, std::size_t end);
using AreaNormals = std::size_t (*)(const TriangleArrays&, std::size_t begin, std::size_t end);

struct TriangleKernels {
  AirForces air_forces;      ///< a third of air_force [N]; w: speed in the air [m/s]
  AreaNormals area_normals;  ///< (x_b - x_a) x (x_c - x_a) of positions [m^2]
};

/// Compiled in one translation unit per instruction set (compile_triangles.h).
template <class Isa>
const TriangleKernels& triangle_kernels();

}  // namespace souple::kernels
