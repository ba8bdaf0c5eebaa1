#pragma once

#include <cstddef>
#include <cstdint>

// Contacts of balls at the vertices of one surface, a register of pairs at a time. The version with one lane serves
// tests, and processors without these instruction sets. All versions return the same bits.

namespace souple::kernels {

/// Arrays with one 16-byte record per particle (see solver/projector.h).
struct BallRecords {
  const float* position = nullptr;  ///< w = inverse mass [1/kg]
  float* moving = nullptr;          ///< displacements
  float* corrected = nullptr;       ///< project adds to it: `moving`, unless the solver is Jacobi's
  const float* start = nullptr;     ///< `moving` at the substep's start
};

/// Pairs of balls.
struct BallPairColumns {
  std::uint32_t* first_float[2];  ///< of the records of both
  float* distance;                ///< that they keep [m]
};

/// Data that the contacts of one surface have in common, in a substep.
struct BallLaw {
  float static_friction, kinetic_friction;
  float sliding_threshold;  ///< pairs that move by less in the substep have the static coefficient alone [m]
  float release;            ///< an overlap that is older becomes smaller by that much [m]
};

/// Contacts, as columns.
struct BallContactColumns {
  std::uint32_t* first_float[2];
  float* share[2];          ///< of a correction of x_i - x_j: w / (w_i + w_j)
  float* normal[3];         ///< unit, from j to i at the substep's start
  float* gap;               ///< what n . (q_i - q_j) leaves of C, q: `moving` [m]
  float* start[3];          ///< q_i - q_j at the substep's start [m]
  float* kinetic_friction;  ///< of this contact in this substep
  float* normal_sum;        ///< sum of normal corrections of x_i - x_j [m]
  float* tangent_sum[3];    ///< sum of tangential corrections of x_i - x_j [m]
};

/// Balls in cells, as columns (ball_cells.h). A register can be loaded from any slot.
struct BallCellColumns {
  float* place[3];
  float* rest[3];  ///< null: see find_in_runs
  float* radius;
  float* reach;  ///< radius and margin
  float* row;    ///< number of the row of cells
};

/// Slots [begin, end), of which those of one row count.
struct BallRun {
  std::size_t begin, end;
  float row;
};

/// Each function processes [begin, end).
struct VertexBallKernels {
  /// Appends the slots of balls in the runs that are nearer to that of `slot` than both reaches. Balls whose distance at
  /// rest times rest_part is below the sum of their radii do not count; without places at rest, all count. Returns the
  /// number of slots.
  std::size_t (*find_in_runs)(const BallCellColumns&, std::size_t slot, float rest_part, const BallRun* runs,
                              std::size_t run_count, std::uint32_t* found);
  /// Appends the pairs that will be nearer than their distance plus a part of it to `found`, ascending, and returns their
  /// number. `place`: records of x, y, z where the particles will be, and inverse mass.
  std::size_t (*find_near)(const float* place, const BallPairColumns&, float part, std::size_t begin,
                           std::size_t end, std::uint32_t* found);
  /// Contacts [begin, end) of the pairs `found`, from its first one on.
  void (*describe)(const BallRecords&, const BallPairColumns&, const BallLaw&, const std::uint32_t* found,
                   const BallContactColumns&, std::size_t begin, std::size_t end);
  /// They share no particle.
  void (*project)(const BallRecords&, const BallContactColumns&, float static_friction, std::size_t begin,
                  std::size_t end);
};

/// Compiled in one translation unit per instruction set (compile_vertex_balls.h).
template <class Isa>
const VertexBallKernels& vertex_ball_kernels();

}  // namespace souple::kernels
