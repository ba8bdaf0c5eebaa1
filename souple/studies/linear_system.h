#pragma once

#include "souple/solver/facets.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace souple {

/// Index of an element of a symmetric matrix that is packed lower.
inline std::size_t packed_index(int row, int column) {
  return static_cast<std::size_t>(row >= column ? row * (row + 1) / 2 + column
                                                : column * (column + 1) / 2 + row);
}
/// A row of S x for a packed symmetric S.
inline double row_times(int n, const double* s, int row, const double* x) {
  double sum = 0;
  for (int j = 0; j < n; ++j) sum += s[packed_index(row, j)] * x[j];
  return sum;
}

/// The constraints of all kinds that have a linear form, linearized at the current positions: the common base
/// of the solvers of the global system. All in double; J stays in the float in which it is computed.
///
/// One constraint is a block of rows. With A = alpha~ = alpha / h^2 (kernels/projection.h) it requires of a
/// displacement dx and its multipliers dlambda (Macklin et al. 2016, eq. 17)
///
///   J dx + A dlambda = -C - A lambda = b,   M dx = J^T dlambda.
///
/// Eliminating one of the two unknowns gives
///
///   dual     (J W J^T + A) dlambda = b,           dx = W J^T dlambda
///   primal   (M + J^T A^-1 J) dx = J^T A^-1 b,    dlambda = A^-1 (b - J dx).
///
/// As usual in position-based dynamics, the geometric stiffness lambda d2C/dx2 and the residual M (x - x*) -
/// J^T lambda of the first line are neglected. In PBD mode alpha~ = 0, and C is multiplied by k'.
///
/// Pinned particles have no unknowns. A satisfied inequality (C >= 0) and a constraint whose particles are all pinned
/// are inactive. They have J = 0, A = 1, b = 0, so that the pattern of the matrices never changes.
class LinearSystem {
 public:
  static constexpr std::uint32_t pinned = std::numeric_limits<std::uint32_t>::max();
  static constexpr int max_rows = 6;  ///< rows of a block

  struct Block {
    std::uint32_t row;         ///< first row
    std::uint32_t member;      ///< first member in `unknown`
    std::uint32_t gradient;    ///< first entry in LinearSystem::gradient
    std::uint32_t compliance;  ///< first entry in LinearSystem::compliance
    std::uint16_t rows, arity;
    bool inequality, inactive;
    double size;  ///< shortest distance between its particles at `prepare` [m]
  };

  /// Builds the structure. Throws Error when a block has more than `max_rows` rows.
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles);

  /// Resets all multipliers to zero.
  void begin_substep();
  /// Fills J, A and b. `floor`: raises the diagonal of A to a floor, which is chosen for each row.
  void linearize(const ParticleView& particles, const Substep& substep, bool floor);
  /// Fills `inverse` with A^-1, block by block.
  void invert_compliance();

  /// dx = W J^T dlambda.
  void moves_from_multipliers();
  /// dlambda = A^-1 (b - J dx). Call `invert_compliance` first.
  void multipliers_from_moves();
  /// Deactivates the inequalities whose multiplier would become negative, that is, that would pull. Returns
  /// whether there were any.
  bool deactivate_pulling();
  /// 1/2 b^T A^-1 b [J h^2], the remaining violation. Call `invert_compliance` first.
  double violation() const;

  /// 1/2 dx^T M dx [J h^2], the inertial cost of dx.
  double kinetic() const;
  /// Largest displacement by dx of a constraint's particle relative to its first particle, as a fraction of
  /// the constraint's size.
  double largest_deformation() const;
  /// Moves the particles by `factor` dx.
  void move(const ParticleView& particles, double factor) const;
  /// lambda += factor dlambda.
  void accept(double factor);

  std::size_t rows() const { return b.size(); }
  /// Free particles with constraints, 3 numbers each.
  std::size_t unknowns() const { return particle_of.size(); }
  /// Floor of the compliance of the scene's smallest rigid constraint [m/N], for a gradient of length 1.
  double floor_compliance() const { return floor_ * smallest_size_; }
  /// Number of rows that the last `linearize` raised to the floor.
  std::size_t floored() const { return floored_; }

  std::span<const Block> blocks() const { return blocks_; }
  std::span<const std::uint32_t> members(const Block& block) const {
    return std::span(unknown).subspan(block.member, block.arity);
  }
  const Vec3f* gradient_of(const Block& block, int row) const {
    return &gradient[block.gradient + static_cast<std::size_t>(row) * block.arity];
  }

  std::vector<std::uint32_t> particle_of;  ///< per unknown
  std::vector<std::uint32_t> unknown;      ///< per member of each block: its unknown, or `pinned`
  std::vector<double> mass;                ///< per unknown [kg]
  std::vector<Vec3f> gradient;             ///< J: per block [row * arity + k]
  std::vector<double> compliance;          ///< A: per block, packed lower triangle
  std::vector<double> inverse;             ///< A^-1, packed as A
  std::vector<double> b, lambda, dlambda;  ///< per row
  std::vector<Vec3d> dx;                   ///< per unknown [m]

 private:
  void add_structure(const LinearConstraint& constraint, const ParticleView& particles);
  void fill(Block& block, const LinearConstraint& constraint);
  void raise_to_floor(const Block& block, double inverse_h2);
  void deactivate(Block& block);

  std::vector<const LinearFacet*> linear_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> unknown_of_;  // per particle
  double smallest_size_ = 0;               // smallest size of a block [m]
  double floor_ = 0;                       // floor: compliance over size [1/N]
  std::size_t floored_ = 0;
};

}  // namespace souple
