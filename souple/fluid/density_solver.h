#pragma once

#include "souple/fluid/coarse_pressure.h"
#include "souple/fluid/neighbors.h"
#include "souple/fluid/smoothing.h"

#include <span>
#include <vector>

namespace souple {

/// What surrounds a fluid's particle besides fluid: walls and bodies. [-], [1/m]
struct BoundarySums {
  float value = 0;  ///< added to V sum W
  Vec3f slope{};    ///< its gradient by the particle's position
  /// What bodies that give way add to w |grad C|^2: all of them, and those that do so locally. [1/(kg m^2)]
  float response = 0, local_response = 0;
};

/// What surrounds a fluid and does not move, but for sample(index, x): see DensitySolver::solve.
struct FixedBoundary {
  template <class Function>
  void for_near(std::size_t count, Threads& threads, const Function& f) const {
    threads.for_each(count, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) f(k);
    });
  }
  void after_sampling(std::span<const Vec4f>, CoarsePressure&) const {}
  void add_response(std::size_t, BoundarySums&) const {}
  void add_push(std::size_t, float) const {}
  void after_pushes(std::span<const float>) const {}
};

/// Keeps a fluid from being compressed (Macklin & Müller 2013, "Position based fluids"): for each particle
///
///   C_i = V sum_j W_ij + boundary - 1 <= 0,
///   dx_i = w (V sum_j (lambda_i + lambda_j) grad W_ij + lambda_i g_i)
///
/// with V the volume of a particle at rest, the same for all, w its inverse mass, g_i the boundary's slope
/// and lambda_i <= 0, so that its pressure is -lambda_i / (V h^2) after a substep of h seconds. Pushes
/// between particles are equal and opposite.
///
/// The paper's Jacobi iterations alone carry pressure by a particle's spacing each. Here the smooth part of
/// lambda comes from a coarse level (coarse_pressure.h), and `passes` of Jacobi mend the rest:
///
///   lambda_i <- min(0, lambda_i - omega C_i / (w |V sum_j grad W + g|^2 + w V^2 sum_j |grad W|^2))
///
/// A fluid of compressibility kappa [1/Pa] gives way, C = kappa p at rest: as Macklin et al. 2016 ("XPBD"),
/// equation 18, with alpha~ = alpha / h^2, alpha = kappa / V, each particle a constraint of energy
/// V C^2 / (2 kappa),
///
///   lambda_i <- min(0, lambda_i - omega (C_i + alpha~ lambda_i) / (w |grad_i C|^2 + ... + alpha~))
///
/// and the coarse level's diagonal has alpha~ too. Constraint-force mixing (Macklin and Müller 2013, equation
/// 11) is the same alpha~, as a number of its own: there stiffness changes with h.
///
/// Nothing is kept from substep to substep: multipliers that are kept while a few iterations solve for them
/// are integrated three times over, which is unstable. Substeps have a limit of their own: h sqrt(p / rho) is
/// to stay below about a third of the spacing, p the largest pressure.
class DensitySolver {
 public:
  struct Options {
    SmoothingShape shape = SmoothingShape::wendland;
    int passes = 1;       ///< 0: the residual is added to the coarse level's lambda, which costs half
    float omega = 0.45f;  ///< of a pass; above 0.75 it need not converge
    float tolerance = 0;  ///< > 0: more passes, until the mean of max(0, C) is below it
    int max_passes = 50;
    float compressibility = 0;  ///< kappa [1/Pa]; 0: it gives way to nothing
    /// Keeps particles from meeting (Macklin and Müller 2013, equation 13, n = 4, |dq| = 0.2 of the support):
    /// pressure with which two push each other at that distance, beside that of their density [Pa].
    float artificial_pressure = 0;
    friend bool operator==(const Options&, const Options&) = default;
  };
  DensitySolver(float spacing, const Options& options);

  const Smoothing& smoothing() const { return smoothing_; }

  /// Forgets all that was found about particles: what a step gives depends on its beginning alone.
  void begin_step() { listed_.clear(), coarse_.reset(); }

  /// Takes the particles to where they are predicted to be: x, y, z [m] and inverse mass w > 0 [1/kg]. Sorts
  /// them and finds neighbors anew when some have moved too far, against all others, since that was done
  /// last.
  void set_positions(std::span<const Vec4f> positions, Threads& threads);

  /// What surrounds the fluid is asked, index by index and on all threads,
  ///
  ///   boundary.for_near(count, threads, f)      calls f(index) for those that it is near to; for these
  ///   boundary.sample(index, x) -> BoundarySums    where the particle is now
  ///   boundary.add_response(index, sums)              of bodies that give way
  ///   boundary.add_push(index, change)               then: it was pushed by the slope times this change of
  ///                                              lambda
  ///
  /// and once, after all looks, boundary.after_sampling(positions, coarse level), and after all pushes,
  /// boundary.after_pushes(changes of lambda). h > 0 [s] is the substep's length: only a fluid that gives way, or
  /// has artificial pressure, asks for it.
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
  std::span<const std::uint32_t> order() const { return order_.order(); }  ///< of each index, the particle
  std::span<const Vec4f> positions() const { return {x_.data(), size()}; }
  std::span<const Vec4f> padded_positions() const { return x_; }  ///< and one more, far away
  std::span<const Vec3f> moved() const { return moved_; }         ///< by `solve` [m]
  std::span<const float> lambda() const { return lambda_; }
  /// C of the last look, before the last push.
  float density_error(std::size_t index) const { return samples_[index].c; }
  const Neighbors& neighbors() const { return neighbors_; }
  double mean_error() const;              ///< of max(0, C), of the last look
  int passes() const { return passes_; }  ///< of the last solve
  int coarse_iterations() const { return coarse_.iterations(); }

 private:
  bool lists_are_valid(std::span<const Vec4f> positions) const;
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
  float h_ = 1;                     // s
  kernels::Repulsion repulsion_{};  // of the next push
  CellOrder order_;
  Neighbors neighbors_;
  CoarsePressure coarse_;
  std::vector<Vec4f> listed_;  // positions when neighbors were found, by particle
  // By index: x, y, z and w; x, y, z and what is pushed, V dlambda. One more, far away.
  std::vector<Vec4f> x_, q_;
  std::vector<BoundarySums> boundary_;
  std::vector<float> denominator_;  // w |grad_i C|^2 + ...
  std::vector<CoarsePressure::Sample> samples_;
  std::vector<float> lambda_, change_;  // and what the last pass added to it
  std::vector<Vec3f> moved_;
};

}  // namespace souple
