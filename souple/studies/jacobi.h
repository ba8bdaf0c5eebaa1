#pragma once

#include "souple/studies/chebyshev.h"

#include <vector>

namespace souple {

/// Jacobi: projects all constraints from the same positions and averages their corrections at each particle.
///
/// A plain average divides the corrections of particle i by the number n_i of its constraints. Where n_i
/// differs between the particles of a constraint, its ends then move by different impulses, and momentum is
/// lost. So the mass is split instead: each constraint acts on its own copy of a particle, of mass m_i / n_i. See Tonge
/// et al. 2012, "Mass splitting for jitter-free parallel rigid body simulation":
///
///   dlambda = (-C - alpha~ lambda) / (sum_i n_i w_i |grad_i C|^2 + alpha~)
///   dx_i = omega / n_i sum (n_i w_i grad_i C dlambda)
///
/// This is the average if all n_i are equal. It keeps momentum everywhere and converges for every omega in
/// (0, 2) (`SolverSettings::relaxation`; 1.5 to 1.9 pays). Gauss-Seidel projects kinds without a linear form
/// after each iteration. `SolverSettings::chebyshev` accelerates it as in GaussSeidel.
class Jacobi final : public AcceleratedSolver {
 public:
  explicit Jacobi(const SolverSettings& settings) : AcceleratedSolver(settings.chebyshev) {}

  std::string_view name() const override { return "jacobi"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;

 private:
  void iterate(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
               Threads& threads) override;

  std::vector<float> count_;       // n_i, per particle
  std::vector<Vec4f> split_;       // positions, with inverse mass n_i w_i
  std::vector<Vec4f> correction_;  // sum of corrections, per particle
};

}  // namespace souple
