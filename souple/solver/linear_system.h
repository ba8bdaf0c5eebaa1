#pragma once

#include "souple/solver/projector.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace souple {

/// Whether a projector can linearize its constraints (see Projector::linearize).
bool has_linear_form(const Projector& projector, const ParticleView& particles);

/// The constraints of all kinds that have a linear form, linearized where the particles are now: what the
/// solvers of the global system share. All in double; J is kept in the float it is computed in.
///
/// One constraint is a block of rows. With alpha~ = alpha / h^2 and gamma = tau / h (kernels/projection.h) it
/// asks of a move dx and its multipliers dlambda (Macklin et al. 2016, eqs. 17 and 26)
///
///   (1 + gamma) J dx + alpha~ dlambda = -C - alpha~ lambda - gamma J (x - x_start),   M dx = J^T dlambda
///
/// and is stored divided by 1 + gamma:   J dx + A dlambda = b.   Eliminating one or the other unknown gives
///
///   dual     (J W J^T + A) dlambda = b,           dx = W J^T dlambda
///   primal   (M + J^T A^-1 J) dx = J^T A^-1 b,    dlambda = A^-1 (b - J dx).
///
/// The geometric stiffness lambda d2C/dx2 and the residual M (x - x*) - J^T lambda of the first line are left
/// out, as position-based dynamics leaves them out. In PBD mode alpha~ = 0 and C is asked to shrink by k'.
///
/// Pinned particles are no unknowns. An inequality that holds (C >= 0), and a constraint all of whose
/// particles are pinned, is idle: J = 0, A = 1, b = 0, so that the pattern of the matrices never changes.
class LinearSystem {
 public:
  static constexpr std::uint32_t pinned = std::numeric_limits<std::uint32_t>::max();
  static constexpr int max_rows = 6;  ///< of a block

  struct Block {
    std::uint32_t row;     ///< its first
    std::uint32_t member;  ///< its first in `unknown` and, per row, in `gradient`
    std::uint32_t gradient;
    std::uint32_t compliance;
    std::uint16_t rows, arity;
    bool inequality, inactive;
    double size;  ///< shortest distance between its particles when prepared [m]
  };

  /// Collects the structure. Throws Error where a block has more than `max_rows` rows.
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles);

  /// All multipliers to zero.
  void begin_substep();
  /// Fills J, A and b. `floor`: A is at least `floor_compliance` on its diagonal, in the measure of each row.
  void linearize(const ParticleView& particles, const Substep& substep, bool floor);
  /// Fills `inverse` with A^-1, block by block.
  void invert_compliance();

  /// dx = W J^T dlambda.
  void moves_from_multipliers();
  /// dlambda = A^-1 (b - J dx). `invert_compliance` comes first.
  void multipliers_from_moves();
  /// Idles the inequalities whose multiplier would become negative: they pull. Whether there were any.
  bool deactivate_pulling();
  /// 1/2 b^T A^-1 b [J h^2], what is left to solve. `invert_compliance` comes first.
  double violation() const;

  /// 1/2 dx^T M dx [J h^2], what the move dx costs.
  double kinetic() const;
  /// How far dx moves two particles of a constraint apart or past each other, as a share of its size: the
  /// largest of all.
  double largest_deformation() const;
  /// Moves the particles by `factor` dx.
  void move(const ParticleView& particles, double factor) const;
  /// lambda += factor dlambda.
  void accept(double factor);

  std::size_t rows() const { return b.size(); }
  /// Free particles in a constraint, 3 numbers each.
  std::size_t unknowns() const { return particle_of.size(); }
  /// How soft the floor makes rigid constraints: m / N for a gradient of length 1, for the whole scene's
  /// smallest constraint.
  double floor_compliance() const { return floor_ * smallest_size_; }
  /// Rows that the last `linearize` lifted to the floor.
  std::size_t floored() const { return floored_; }

  std::span<const Block> blocks() const { return blocks_; }
  std::span<const std::uint32_t> members(const Block& block) const {
    return std::span(unknown).subspan(block.member, block.arity);
  }
  const Vec3f* gradient_of(const Block& block, int row) const {
    return &gradient[block.gradient + static_cast<std::size_t>(row) * block.arity];
  }

  std::vector<std::uint32_t> particle_of;  ///< of each unknown
  std::vector<std::uint32_t> unknown;      ///< of each member of each block, or `pinned`
  std::vector<double> mass;                ///< of each unknown [kg]
  std::vector<Vec3f> gradient;             ///< J: per block [row * arity + k]
  std::vector<double> compliance;          ///< A: per block, packed lower triangle
  std::vector<double> inverse;             ///< A^-1, likewise
  std::vector<double> b, lambda, dlambda;  ///< per row
  std::vector<Vec3d> dx;                   ///< per unknown [m]

 private:
  void add_structure(const LinearConstraint& constraint, const ParticleView& particles);
  void fill(Block& block, const LinearConstraint& constraint, const ParticleView& particles);
  void raise_to_floor(const Block& block, double inverse_h2);
  void deactivate(Block& block);

  std::vector<Projector*> projectors_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> unknown_of_;  // of each particle
  double smallest_size_ = 0;               // of the blocks [m]
  double floor_ = 0;                       // compliance over size [1/N]
  std::size_t floored_ = 0;
};

}  // namespace souple
