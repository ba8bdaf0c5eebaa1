#pragma once

#include "souple/rigid/body_matrix.h"
#include "souple/rigid/contact_block.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// The contacts of an island, blocks[i] for i in `island`, and the bodies. `local`: per body, scratch memory.
struct ContactSystem {
  std::span<ContactBlock> blocks;
  std::span<const std::uint32_t> island;
  std::span<std::uint32_t> local;
  std::span<ContactBody> states;
};

/// Newton's method for all contacts of an island at once. Sweeps alone are slow for a stack: each passes a force on by
/// one body. The tilt error of a tower shrinks by a part of 1 / bodies^4.
///
/// Contacts are springs, so their impulses are functions of the motions q:
///   p_n = max(0, -(gap + J_n q)_n / softness),   p_t = -(slip + J_t q) / softness, cut to |p_t| <= mu p_n,
/// and q minimizes a convex energy: |q|^2_M / 2 and the energy of the springs, with mu p_n from the previous iteration.
/// A few solves of (M + J^T K J) dq = J^T p - M q find the minimum. The matrix has one block of 6 x 6 for each pair
/// that touches. K is the stiffness of the rows that push. A row that slides has stiffness along the normal and across
/// the slip. The unknowns are motions of bodies, not impulses. With impulses as unknowns, cutting the negative ones
/// moved stiff contacts far apart: in a wall of twenty layers no step decreased the energy.
class ContactNewton {
 public:
  /// A new step begins: drops the factor, so that results depend on this step alone.
  void forget() { factored_ = false; }
  void prepare(const ContactSystem& system);
  /// Multiplications of a factorization, approximately; infinite if the island is too large.
  double cost() const { return cost_; }
  struct Limits {
    int solves = 0;    ///< at most
    double error = 0;  ///< of motions, below which it ends [m]
  };
  /// Iterates until motions are exact. Takes the multiplications of its solves from `budget`, and begins no solve that
  /// exceeds the rest. If it has not converged, it moves by the part of the step that decreases the energy. If no part
  /// does, it restores the state and returns false.
  bool step(const ContactSystem& system, const Limits& limits, double& budget);
  bool converged() const { return converged_; }
  std::size_t bytes() const;

 private:
  /// Whether a contact pushes, and its friction holds.
  enum class Phase : std::uint8_t { apart, slides, sticks };
  /// A row at the current motions.
  struct Row {
    ContactVector gap{}, rate{};  ///< C and slip, and their changes by the solution [m]
    ContactVector slide{};        ///< impulse of friction while it slides [kg m]
    double limit = 0;             ///< of friction [kg m]
    double hold = 0;              ///< coefficient of friction up to which it sticks
    double across = 0;            ///< stiffness across the slip while it slides [kg]
    Phase phase = Phase::apart;
    Phase factored = Phase::apart;    ///< in the factor
    ContactVector before{}, after{};  ///< impulse before the step and after it [kg m]
  };

  /// Calls visit(axis, stiffness) for the springs of a row that pushes.
  template <class Visit>
  static void for_each_spring(const ContactBlock& block, const ContactRow& row, const Row& state,
                              const Visit& visit) {
    visit(block.axes[0], 1 / row.normal_softness);
    if (state.phase == Phase::sticks) {
      for (const std::size_t k : {1u, 2u}) visit(block.axes[k], 1 / row.tangent_softness);
    } else if (state.across > 0) {
      const Vec3d slip = block.in_world({0, -state.slide[2], state.slide[1]});
      visit(slip * (1 / length(slip)), state.across);
    }
  }
  static ContactVector impulse_of(const ContactRow& row, const Row& state) {
    const double normal = -state.gap[0] / row.normal_softness;
    if (state.phase == Phase::slides) return {normal, state.slide[1], state.slide[2]};
    return {normal, -state.gap[1] / row.tangent_softness, -state.gap[2] / row.tangent_softness};
  }
  void begin(const ContactSystem& system);
  void find_residual(const ContactSystem& system);
  void assemble(const ContactSystem& system);
  /// y = (M + J^T K J) x, with K of the phases that rows have now.
  void multiply(const ContactSystem& system, std::span<const double> x, std::span<double> y) const;
  void multiply_mass(const ContactSystem& system, std::span<const double> x, std::span<double> y) const;
  bool solve(const ContactSystem& system, double& budget);
  bool solve_with_kept_factor(const ContactSystem& system, int iterations);
  void find_rates(const ContactSystem& system);
  double slope(const ContactSystem& system, double part) const;
  double best_part(const ContactSystem& system);
  void advance(const ContactSystem& system, double part);
  double error(const ContactSystem& system) const;
  bool iterate(const ContactSystem& system, const Limits& limits, double& budget);
  void find_impulses(const ContactSystem& system);
  double apply(const ContactSystem& system, double part) const;

  std::vector<std::uint32_t> bodies_, last_bodies_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_, last_pairs_;
  double cost_ = 0;
  BodyMatrix matrix_;
  bool factored_ = false;         // matrix_ is the factor of rows in their phases `factored`
  bool converged_ = false;        // in the last step
  std::vector<Mat3d> inertia_;    // per body
  std::vector<double> motion_;    // q: six numbers a body, as in those below
  std::vector<double> residual_;  // J^T p - M q
  std::vector<double> solution_;  // dq
  std::vector<double> direction_, image_, smoothed_;  // of conjugate gradients
  std::vector<Row> rows_;                             // four a contact
};

}  // namespace souple
