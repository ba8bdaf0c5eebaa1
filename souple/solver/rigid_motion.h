#pragma once

#include "souple/solver/linear_system.h"

#include <vector>

namespace souple {

/// The rigid motions that internal constraints cannot cause: J dx = 0 for them, so the exact solution of
/// M dx = J^T dlambda has no momentum and no angular momentum in any piece that nothing holds. A solution
/// that stops early has some, and more of it the stiffer the piece; this takes it out.
class RigidMotion {
 public:
  /// Finds the pieces: unknowns that blocks join, none of them joined to a pinned particle.
  void prepare(const LinearSystem& system);
  /// Takes momentum and angular momentum out of dx, piece by piece; where a block of the piece is not
  /// invariant to translation or rotation (an attachment), these stay.
  void remove(LinearSystem& system, const ParticleView& particles);

 private:
  struct Piece {
    std::uint32_t begin, end;              // in unknowns_
    std::uint32_t block_begin, block_end;  // in blocks_
  };

  static bool is_invariant(const LinearSystem& system, const LinearSystem::Block& block, std::uint32_t first,
                           const ParticleView& particles, bool& turns);
  void remove(const Piece& piece, LinearSystem& system, const ParticleView& particles) const;

  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> unknowns_, blocks_;
};

}  // namespace souple
