#include "souple/stages/energy.h"

#include "souple/solver/facets.h"
#include "souple/solver/kernels/projection.h"

#include <vector>

namespace souple {
namespace {

/// Part of D in the compliance of a sweep: see SetProjector::find_shared.
constexpr double sweep_part = 0.55;

/// Particles that several constraints of a projector share: a sweep is exact for constraints that share none.
std::vector<bool> shared_particles(const LinearFacet& constraints, const ParticleView& particles,
                                   const Substep& substep) {
  std::vector<bool> seen(particles.position.size()), shared(seen.size());
  constraints.linearize(particles, substep, [&](const LinearConstraint& constraint) {
    for (const std::uint32_t i : constraint.particles) {
      if (seen[i]) shared[i] = true;
      seen[i] = true;
    }
  });
  return shared;
}

/// By how much 1/2 C^T alpha~^-1 C exceeds the same with `more` added to the diagonal of alpha~.
template <int rows>
double lost_energy(const LinearConstraint& constraint, const double (&more)[rows]) {
  double alpha[rows * (rows + 1) / 2], softer[rows * (rows + 1) / 2], y[rows], z[rows], lost = 0;
  for (int k = 0; k < rows * (rows + 1) / 2; ++k)
    alpha[k] = softer[k] = static_cast<double>(constraint.alpha[static_cast<std::size_t>(k)]);
  for (int r = 0; r < rows; ++r) {
    if (!(alpha[r * (r + 3) / 2] > 0)) return 0;
    softer[r * (r + 3) / 2] += more[r];
    y[r] = z[r] = static_cast<double>(constraint.C[static_cast<std::size_t>(r)]);
  }
  solve_symmetric<rows>(alpha, y), solve_symmetric<rows>(softer, z);
  for (int r = 0; r < rows; ++r)
    lost += 0.5 * (y[r] - z[r]) * static_cast<double>(constraint.C[static_cast<std::size_t>(r)]);
  return lost;
}

/// On a smooth stress, n sweeps of a substep act as springs of the compliance alpha~ + phi D / (2 n). Less what sweeps
/// subtract (kernels/projection.h), the compliance is max(alpha~, phi D / (2 n)). With stored multipliers nothing is
/// subtracted.
class Sweeps {
 public:
  Sweeps(const ParticleView& particles, const Substep& substep, int n, const std::vector<bool>& shared)
      : particles_(particles),
        stored_(substep.stores_multipliers()),
        part_(sweep_part / n),
        shared_(shared) {}

  double lost(const LinearConstraint& constraint) const {
    if (constraint.inequality && constraint.C[0] >= 0) return 0;
    if (constraint.C.size() == 1) return lost_of<1>(constraint);
    if (constraint.C.size() == 2) return lost_of<2>(constraint);
    return constraint.C.size() == 3 ? lost_of<3>(constraint) : 0;
  }

 private:
  template <int rows>
  double lost_of(const LinearConstraint& constraint) const {
    double more[rows];
    for (int r = 0; r < rows; ++r) {
      const auto alpha = static_cast<double>(constraint.alpha[static_cast<std::size_t>(r * (r + 3) / 2)]);
      const double added = part_ * shared_diagonal(constraint, static_cast<std::size_t>(r));
      more[r] = stored_ ? added : max(0.0, added - alpha);
    }
    return lost_energy<rows>(constraint, more);
  }
  // phi D = sum of w_i |grad_i C|^2 over the particles that are shared.
  double shared_diagonal(const LinearConstraint& constraint, std::size_t row) const {
    const std::size_t arity = constraint.particles.size();
    double sum = 0;
    for (std::size_t k = 0; k < arity; ++k)
      if (const std::uint32_t i = constraint.particles[k]; shared_[i])
        sum += static_cast<double>(particles_.inverse_mass(i) *
                                   length_squared(constraint.gradient[row * arity + k]));
    return sum;
  }

  const ParticleView& particles_;
  bool stored_;
  double part_;
  const std::vector<bool>& shared_;
};

}  // namespace

double elastic_energy(std::span<Projector* const> constraints, const ParticleView& particles) {
  double sum = 0;
  for (const Projector* projector : constraints) sum += projector->residual(particles).energy;
  return sum;
}

double unconverged_energy(std::span<Projector* const> constraints, const ParticleView& particles,
                          const Substep& substep, const Solver& solver) {
  if (substep.mode == Mode::pbd) return 0;
  const LeftOut exact = solver.solved_exactly(substep);
  double sum = 0;
  for (Projector* projector : constraints) {
    const LinearFacet* const linear = projector->facets().linear;
    const int n = solver.sweep_count(*projector, substep);
    if (linear == nullptr || n == 0) continue;
    const std::vector<bool> shared = shared_particles(*linear, particles, substep);
    const Sweeps sweeps(particles, substep, n, shared);
    std::vector<bool> swept(projector->size());
    exact.for_each_kept(*projector, 0, projector->size(), [&](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) swept[begin] = true;
    });
    std::size_t i = 0;
    linear->linearize(particles, substep, [&](const LinearConstraint& constraint) {
      if (swept[i++]) sum += sweeps.lost(constraint);
    });
  }
  return sum / (static_cast<double>(substep.h) * static_cast<double>(substep.h));
}

}  // namespace souple
