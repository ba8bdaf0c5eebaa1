#pragma once

#include "souple/solver/left_out.h"
#include "souple/solver/projector.h"

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace souple {

struct Components;

/// Solves the bending of stiff, finely divided sheets and ropes at once. Bending is of fourth order. One sweep from
/// lambda = 0 reaches a stiffness D only while D h^2 is below the areal density times the fourth power of the cell. To
/// first order a bending constraint is the length of a fixed combination of positions,
///
///   C_j = |sum_k K_jk x_k|     (exactly so for IsometricBending and RopeBending)
///
/// so that the step of implicit Euler has a constant matrix, equal for all three axes:
///
///   (M + h^2 sum_j K_j K_j^T / alpha_j) dx = -h^2 sum_j K_j K_j^T x / alpha_j - M (what it moved before)
///
/// Its sparse Cholesky factors are computed once per mesh and length of the substep. DihedralBending is solved as
/// IsometricBending, with 2 sin(theta/2) for theta, and only where it is flat at rest. Elsewhere its matrix would turn
/// with the sheet.
///
/// Only pieces whose sweep would be too soft are solved so, and their constraints are then not swept. Limp cloth costs
/// nothing. Pieces whose factors would be too large are left to the sweeps.
class StiffBending {
 public:
  struct Bending;  ///< one constraint

  StiffBending();
  ~StiffBending();

  /// Call when constraints or masses may have changed. Keeps pointers to the projectors.
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles);
  /// Factorizes and allocates when the length of the substep is another than before, and then returns true.
  bool begin_substep(const Substep& substep);
  /// Adds the constraints that are solved here: sweeps must omit them.
  void leave_out(LeftOut& left_out) const;
  /// Corrects what `particles` moves. `iteration` of the substep, from 0.
  void solve(const ParticleView& particles, int iteration, Threads& threads);

 private:
  struct Piece;
  void build(float h);
  std::vector<std::unique_ptr<Piece>> stiff_pieces(std::span<const std::vector<Bending>> sets,
                                                   const Components& components, float h) const;

  std::vector<std::pair<Projector*, std::uint64_t>> revisions_;  // of the bending constraints
  std::vector<float> inverse_masses_;                            // of the world's particles, awake
  float softest_ = 0;  // largest sum_k w_k K_k^2 / alpha of a constraint [1/s^2]
  std::vector<std::unique_ptr<Piece>> pieces_;
  std::vector<std::vector<std::uint32_t>> solved_;  // per set: constraints of the pieces; empty: none
  float built_for_ = 0;                             // length of the substep [s]
};

}  // namespace souple
