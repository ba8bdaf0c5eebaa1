#include "souple/studies/linearized_solver.h"

#include "souple/error.h"

#include <algorithm>

#include <fmt/core.h>

namespace souple {
namespace {

constexpr int max_passes = 4;  // passes over the inequalities that would pull
constexpr int max_halvings = 4;
constexpr double max_deformation = 0.5;

}  // namespace

void LinearizedSolver::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  linear_.clear();
  others_.clear();
  for (Projector* projector : projectors)
    (projector->facets().linear != nullptr ? linear_ : others_).push_back(projector);
  system_.prepare(linear_, particles);
  saved_.resize(particles.moving.size());
  failures_ = 0;
  prepare_structure(particles);
}

void LinearizedSolver::prepare_structure(const ParticleView& particles) {
  solvable_ = false;
  inverse_mass_.clear();
  for (const Vec4f& x : particles.position) inverse_mass_.push_back(x.w);
  system_.prepare(linear_, particles);
  prepare_system(system_, particles);
  solvable_ = system_.rows() > 0;
}

// Pins change between steps, and in callbacks within a step.
void LinearizedSolver::update_pins(const ParticleView& particles) {
  if (std::equal(inverse_mass_.begin(), inverse_mass_.end(), particles.position.begin(),
                 particles.position.end(), [](float w, const Vec4f& x) { return w == x.w; }))
    return;
  try {
    prepare_structure(particles);
  } catch (const Error&) {
    // Too large without its pins. A step does not throw: it projects, and `diagnostic` reports it.
  }
}

void LinearizedSolver::solve(std::span<Projector* const>, const ParticleView& particles,
                             const Substep& substep, Threads& threads) {
  update_pins(particles);
  system_.begin_substep();
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    if (solvable_ && solve_active(particles, substep, threads)) {
      advance(particles, substep);
    } else if (system_.rows() > 0) {
      ++failures_;
      for (Projector* projector : linear_) sweep(*projector, particles, substep, threads);
    }
    for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
  }
}

// Deactivates inequalities that would pull because of other constraints, and solves again.
bool LinearizedSolver::solve_active(const ParticleView& particles, const Substep& substep, Threads& threads) {
  system_.linearize(particles, substep, floors_);
  for (int pass = 0; pass < max_passes; ++pass) {
    if (floors_) system_.invert_compliance();
    if (!solve_system(system_, threads)) return false;
    if (!system_.deactivate_pulling()) break;
  }
  return true;
}

double LinearizedSolver::violation(const ParticleView& particles, const Substep& substep) {
  system_.linearize(particles, substep, true);
  system_.invert_compliance();
  return system_.violation();
}

void LinearizedSolver::advance(const ParticleView& particles, const Substep& substep) {
  const double deformation = system_.largest_deformation(), kinetic = system_.kinetic();
  double factor = deformation > max_deformation ? max_deformation / deformation : 1;
  std::copy(particles.moving.begin(), particles.moving.end(), saved_.begin());
  const double before = violation(particles, substep);
  system_.move(particles, factor);
  for (int halving = 0; halving < max_halvings; ++halving) {
    if (violation(particles, substep) + factor * factor * kinetic <= before) break;
    std::copy(saved_.begin(), saved_.end(), particles.moving.begin());
    factor /= 2;
    system_.move(particles, factor);
  }
  system_.accept(factor);
}

std::string LinearizedSolver::floor_diagnostic() const {
  std::string text;
  if (floors_ && system_.floored() > 0) {
    text += fmt::format(
        "springs approximate {} rigid rows, with {:.3g} N/m at the smallest constraint: strain below 1e-5 "
        "under the weight of the whole scene",
        system_.floored(), 1 / system_.floor_compliance());
  }
  if (failures_ > 0) {
    text += fmt::format("{}{} linearized systems could not be solved: Gauss-Seidel projected instead",
                        text.empty() ? "" : "; ", failures_);
  }
  return text;
}

}  // namespace souple
