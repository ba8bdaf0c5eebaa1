#pragma once

#include "souple/studies/accelerated_gauss_seidel.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace souple {

/// Gauss-Seidel in a chosen number of colors (Fratarcangeli & Pellacini 2015). Particles with too many
/// constraints are split into phantoms (partition.h), which are joined after each sweep of a set.
///
/// A split particle divides its mass equally among its n phantoms, so w_k = n w. See Tonge et al. 2012, "Mass Splitting
/// for Jitter-Free Parallel Rigid Body Simulation". x = 1/n sum_k x_k is their common center of mass. So momentum is
/// kept whatever the numbers of phantoms are, and since
///   w grad C dlambda = 1/n (n w) grad C dlambda,
/// x = x* + W J^T lambda holds as without phantoms: the solution is the same, but convergence is slower.
///
/// Kinds that cannot be split (contacts, shape matching, enclosed volumes, custom constraints) are projected
/// as usual.
class PartitionedGaussSeidel final : public Solver {
 public:
  /// settings.colors >= 1.
  explicit PartitionedGaussSeidel(const SolverSettings& settings);
  ~PartitionedGaussSeidel() override;

  std::string_view name() const override { return "gauss_seidel"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
  std::string diagnostic() const override;

 private:
  class Split;
  /// The particles, then the phantoms.
  struct ParticlesAndPhantoms {
    std::vector<Vec4f> position, moving, start;
    ParticleView view;
    std::uint32_t substep = 0;  ///< number of the current substep
  };

  void copy_in(const ParticleView& particles, Threads& threads);

  int colors_;
  AcceleratedGaussSeidel gauss_seidel_;
  std::size_t particle_count_ = 0;
  ParticlesAndPhantoms all_;
  std::vector<std::unique_ptr<Split>> split_;
  std::vector<Projector*> projectors_;  // unsplit projectors, and Splits in place of split ones
};

}  // namespace souple
