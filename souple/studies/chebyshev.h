#pragma once

#include "souple/solver/solver.h"

#include <span>
#include <vector>

namespace souple {

/// Chebyshev semi-iterative acceleration of any iteration x_k -> x^ (Wang 2015, "A Chebyshev semi-iterative
/// approach for accelerating projective and position-based dynamics", eqs. 9, 10 and 18):
///
///   x_{k+1} = omega_{k+1} (gamma (x^ - x_k) + x_k - x_{k-1}) + x_{k-1}
///   omega_{k+1} = 1 for k < S,   2 / (2 - rho^2) for k = S,   4 / (4 - rho^2 omega_k) beyond
///
/// rho is the assumed spectral radius of the iteration. gamma = 0.9 keeps a nonlinear iteration from
/// overshooting. S = 2 lets the first iterations smooth the error (Wang uses 10: he iterates 100 times).
/// Multipliers are extrapolated with the positions, so compliance is unchanged.
class Chebyshev {
 public:
  /// rho in [0, 1); 0: no acceleration.
  explicit Chebyshev(float rho) : rho_squared_(rho * rho) {}

  /// Whether this many iterations per substep are enough for acceleration.
  bool helps(int iterations) const { return rho_squared_ > 0 && iterations > delay; }
  /// Before the first iteration of a substep. `projectors`: their multipliers are extrapolated too.
  void begin(std::span<Projector* const> projectors, const ParticleView& particles);
  /// After each iteration: `moving` and the multipliers hold x^ and become x_{k+1}. Unchanged values keep
  /// their bits.
  void accelerate(std::span<Projector* const> projectors, const ParticleView& particles);

 private:
  static constexpr int delay = 2;
  static constexpr float gamma = 0.9f;

  /// The last two iterates of one array.
  template <class T>
  struct History {
    std::vector<T> last, before;
  };

  void extrapolate(float& x, float last, float before) const {
    x = omega_ * (gamma * (x - last) + (last - before)) + before;
  }
  void extrapolate(Vec4f& x, const Vec4f& last, const Vec4f& before) const;
  template <class T>
  static void begin(std::span<T> x, History<T>& history);
  template <class T>
  void accelerate(std::span<T> x, History<T>& history) const;

  float rho_squared_;
  float omega_ = 1;
  int iteration_ = 0;
  History<Vec4f> moving_;
  std::vector<History<float>> multipliers_;  // per array of multipliers, in the order of the projectors
};

/// A solver whose iterations Chebyshev may accelerate, from the third of a substep on. It excludes substeps in which a
/// kind without a linear form has constraints, because an extrapolated contact bounces.
class AcceleratedSolver : public Solver {
 public:
  using Solver::prepare;
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) final;

 protected:
  /// `rho`: as for Chebyshev.
  explicit AcceleratedSolver(float rho) : chebyshev_(rho) {}
  virtual void iterate(std::span<Projector* const> projectors, const ParticleView& particles,
                       const Substep& substep, Threads& threads) = 0;

  std::vector<Projector*> linear_, others_;  ///< with and without a linear form

 private:
  Chebyshev chebyshev_;
};

}  // namespace souple
