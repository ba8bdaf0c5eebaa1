#pragma once

#include "souple/broad_phase/largest_motion.h"
#include "souple/fluid/coarse_pressure.h"
#include "souple/fluid/neighbors.h"
#include "souple/fluid/smoothing.h"

#include <span>
#include <vector>

namespace souple {

/// Contribution of walls and bodies to a particle's density constraint.
struct BoundarySums {
  float value = 0;  ///< added to V sum W [-]
  Vec3f slope{};    ///< gradient of `value` by the particle's position [1/m]
  /// Contribution of movable bodies to w |grad C|^2: of all bodies, and of per-vertex bodies alone
  /// [1/(kg m^2)].
  float response = 0, local_response = 0;
};

/// Base of boundaries without movable bodies; derived classes add sample(index, x). See DensitySolver::solve.
struct FixedBoundary {
  template <class Function>
  void for_near(std::size_t count, Threads& threads, const Function& f) const {
    threads.each(count, 256, [&](std::size_t k) { f(k); });
  }
  void after_sampling(std::span<const Vec4f>, CoarsePressure&) const {}
  void add_response(std::size_t, BoundarySums&) const {}
  void add_push(std::size_t, float) const {}
  void after_pushes(std::span<const float>) const {}
};

/// Keeps a fluid incompressible (Macklin & Müller 2013, "Position based fluids"). For each particle
///
///   C_i = V sum_j W_ij + boundary - 1 <= 0,
///   dx_i = w (V sum_j (lambda_i + lambda_j) grad W_ij + lambda_i g_i)
///
/// with V the rest volume of a particle, equal for all, w its inverse mass, g_i the boundary's slope and
/// lambda_i <= 0. Its pressure after a substep of h seconds is -lambda_i / (V h^2). Corrections between two
/// particles are equal and opposite.
///
/// The paper's Jacobi iterations transport pressure by one particle spacing each. Here a coarse level
/// computes the smooth part of lambda (coarse_pressure.h), and `passes` Jacobi passes correct the rest:
///
///   lambda_i <- min(0, lambda_i - omega C_i / (w |V sum_j grad W + g|^2 + V^2 sum_j w_j |grad W|^2))
///
/// With a compressibility kappa [1/Pa] the fluid is compliant, C = kappa p at rest. Each particle is a constraint of
/// energy V C^2 / (2 kappa), as in Macklin et al. 2016 ("XPBD"), equation 18, with alpha~ = alpha / h^2 and alpha =
/// kappa / V:
///
///   lambda_i <- min(0, lambda_i - omega (C_i + alpha~ lambda_i) / (w |grad_i C|^2 + ... + alpha~))
///
/// The coarse level's diagonal contains alpha~ too, scaled by the coarse level's share of lambda.
/// Constraint-force mixing (Macklin and Müller 2013, equation 11) is an alpha~ given as a number: its
/// stiffness changes with h.
///
/// Nothing is kept from substep to substep. Warm-started multipliers that only a few iterations solve for are
/// in effect integrated three times, which is unstable. The substep is limited: h sqrt(p / rho) must stay
/// below about a third of the spacing, with p the largest pressure.
class DensitySolver {
 public:
  struct Options {
    SmoothingShape shape = SmoothingShape::wendland;
    int passes = 1;       ///< 0: the residual is added to the coarse level's lambda, at half the cost
    float omega = 0.45f;  ///< relaxation of a pass; above 0.75 it may diverge
    float tolerance = 0;  ///< > 0: passes go on until the mean of max(0, C) is below it
    int max_passes = 50;
    float compressibility = 0;  ///< kappa [1/Pa]; 0: incompressible
    /// Keeps particles from clumping (Macklin and Müller 2013, equation 13, n = 4, |dq| = 0.2 of the support). It is an
    /// extra pressure between two particles at this distance, besides the pressure of their density [Pa].
    float artificial_pressure = 0;
    friend bool operator==(const Options&, const Options&) = default;
  };
  DensitySolver(float spacing, const Options& options);

  const Smoothing& smoothing() const { return smoothing_; }

  /// Discards all data about particles: a step's result depends only on its initial state.
  void begin_step() { listed_.clear(), coarse_.reset(); }

  /// Sets the predicted positions: x, y, z [m] and inverse mass w > 0 [1/kg]. Sorts the particles and
  /// rebuilds neighbor lists if some particle has moved too far, relative to the mean motion, since the last
  /// rebuild.
  void set_positions(std::span<const Vec4f> positions, Threads& threads);

  /// Solves for lambda and displaces the particles. The solver calls the boundary per sorted index, on all
  /// threads:
  ///
  ///   boundary.for_near(count, threads, f)       calls f(index) for particles near a boundary; for these
  ///   boundary.sample(index, x) -> BoundarySums  its contribution at x, the particle's current position
  ///   boundary.add_response(index, sums)         adds the response of movable bodies
  ///   boundary.add_push(index, change)           the particle was pushed by slope times this change of lambda
  ///
  /// Once after all samples it calls boundary.after_sampling(positions, coarse level), and once after all
  /// pushes boundary.after_pushes(changes of lambda). The substep h > 0 [s] matters only with compressibility
  /// or artificial pressure.
  template <class Boundary>
  void solve(Boundary& boundary, Threads& threads, float h = 1) {
    h_ = h;
    find_sums(boundary, threads);
    start_from_coarse_level(threads);
    push(boundary, threads);
    repulsion_ = {};
    for (passes_ = 0; passes_ < options_.passes || options_.tolerance > 0; ++passes_) {
      find_sums(boundary, threads);
      if (passes_ >= options_.passes &&
          (passes_ >= options_.max_passes || mean_error() <= options_.tolerance))
        break;
      relax(threads);
      push(boundary, threads);
    }
  }

  std::size_t size() const { return order_.size(); }
  /// Per sorted index: the particle's index in set_positions.
  std::span<const std::uint32_t> order() const { return order_.order(); }
  std::span<const Vec4f> positions() const { return {x_.data(), size()}; }
  std::span<const Vec4f> padded_positions() const { return x_; }  ///< and one extra record, far away
  std::span<const Vec3f> moved() const { return moved_; }         ///< displacement by `solve` [m]
  std::span<const float> lambda() const { return lambda_; }
  /// C at the last sampling, before the last push.
  float density_error(std::size_t index) const { return samples_[index].c; }
  const Neighbors& neighbors() const { return neighbors_; }
  double mean_error() const;              ///< of max(0, C), at the last sampling
  int passes() const { return passes_; }  ///< passes of the last solve
  int coarse_iterations() const { return coarse_.iterations(); }

 private:
  bool lists_are_valid(std::span<const Vec4f> positions, Threads& threads);
  void find_neighbors(std::span<const Vec4f> positions, Threads& threads);
  template <class Boundary>
  void find_sums(Boundary& boundary, Threads& threads) {
    boundary.for_near(size(), threads,
                      [&](std::size_t k) { boundary_[k] = boundary.sample(k, x_[k].xyz()); });
    boundary.after_sampling(positions(), coarse_);
    boundary.for_near(size(), threads, [&](std::size_t k) { boundary.add_response(k, boundary_[k]); });
    find_fluid_sums(threads);
  }
  template <class Boundary>
  void push(Boundary& boundary, Threads& threads) {
    push_fluid(threads);
    boundary.for_near(size(), threads, [&](std::size_t k) { boundary.add_push(k, change_[k]); });
    boundary.after_pushes(std::span<const float>(change_));
  }
  void find_fluid_sums(Threads& threads);
  void start_from_coarse_level(Threads& threads);
  void relax(Threads& threads);
  void push_fluid(Threads& threads);
  float softness() const { return options_.compressibility / (smoothing_.volume() * h_ * h_); }  // alpha~
  float surface() const { return 0.5f * smoothing_.wall(0.5f * smoothing_.spacing()).value; }
  template <class Function>
  void for_lists(Threads& threads, const Function& f) const;

  Options options_;
  Smoothing smoothing_;
  const kernels::DensityKernels* kernels_;
  float margin_;
  int passes_ = 0;
  float h_ = 1;                     // substep [s]
  kernels::Repulsion repulsion_{};  // for the next push
  CellOrder order_;
  Neighbors neighbors_;
  CoarsePressure coarse_;
  std::vector<Vec4f> listed_;     // positions at the last neighbor search, by particle
  LargestMotion largest_motion_;  // since then
  // By sorted index, plus one extra record far away. x_: x, y, z and w; q_: x, y, z and V dlambda of the next
  // push.
  std::vector<Vec4f> x_, q_;
  std::vector<BoundarySums> boundary_;
  std::vector<float> denominator_;  // w |grad_i C|^2 + ...
  std::vector<CoarsePressure::Sample> samples_;
  std::vector<float> lambda_, change_;  // lambda, and its change by the last pass
  std::vector<Vec3f> moved_;
};

}  // namespace souple
