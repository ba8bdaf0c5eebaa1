#pragma once

#include "souple/constraints/distance.h"
#include "souple/constraints/tether.h"
#include "souple/solver/hierarchical_levels.h"
#include "souple/solver/set_projector.h"
#include "souple/solver/solver.h"

#include <string>
#include <vector>

namespace souple {

/// Hierarchical position-based dynamics, Müller 2008.
class Hierarchical final : public Solver {
 public:
  explicit Hierarchical(const SolverSettings& settings) : settings_(settings) {}

  std::string_view name() const override { return "hierarchical"; }
  void prepare(std::span<Projector* const> projectors, const ParticleView& particles) override;
  void solve(std::span<Projector* const> projectors, const ParticleView& particles, const Substep& substep,
             Threads& threads) override;
  std::string remark() const override;

  /// A coarser level with what its particles hold during a solve.
  struct Level {
    CoarseLevel map;
    std::vector<std::uint32_t> link;         ///< of each constraint
    std::vector<float> excess, path, ratio;  ///< of each link
    std::vector<std::uint32_t> particle;     ///< of the world
    std::vector<Vec4f> position, moving, before;
    SetProjector<Tether> constraints;
  };
  const std::vector<Level>& levels() const { return levels_; }

  bool fas = true, geo = true;
  float beta = 1;
  int pre = 0, post = 1;
  int sweeps = 2, coarsest_sweeps = 8, cycles = 1;
  double projections = 0;

 private:
  void set_compliance(const Substep& substep);
  void measure(const ParticleView& particles, Threads& threads);
  void restrict_to(std::size_t l, const ParticleView& particles, Threads& threads);
  void prolong(const Level& from, std::span<const std::uint32_t> to, std::span<Vec4f> moving,
               std::span<const Vec4f> masses, bool scattered, Threads& threads) const;
  void descend(const ParticleView& particles, const Substep& substep, Threads& threads);

  SolverSettings settings_;
  std::vector<Link> links_;
  std::vector<float> masses_;
  std::vector<std::uint32_t> particle_;  ///< of the finest level, of the world
  std::vector<Level> levels_;
  bool compliant_ = false;
  float h_ = 0;
};

}  // namespace souple
