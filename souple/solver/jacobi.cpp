#include "souple/solver/jacobi.h"

#include "souple/solver/kernels/projection.h"

#include <algorithm>
#include <cmath>

namespace souple {

void Jacobi::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  others_.clear();
  for (Projector* projector : projectors)
    if (!has_linear_form(*projector, particles)) others_.push_back(projector);
  system_.prepare(projectors, particles);
  split_.resize(system_.unknowns());
}

void Jacobi::solve(std::span<Projector* const>, const ParticleView& particles, const Substep& substep,
                   Threads& threads) {
  const bool accelerated =
      chebyshev_.helps(substep.iterations) &&
      std::all_of(others_.begin(), others_.end(), [](const Projector* p) { return p->size() == 0; });
  system_.begin_substep();
  if (accelerated) {
    chebyshev_.begin();
    moving_.begin(particles.moving);
    multipliers_.begin(system_.lambda);
  }
  for (int iteration = 0; iteration < substep.iterations; ++iteration) {
    iterate(particles, substep);
    for (Projector* projector : others_) sweep(*projector, particles, substep, threads);
    if (!accelerated) continue;
    chebyshev_.advance();
    chebyshev_.accelerate(particles.moving, moving_);
    chebyshev_.accelerate(std::span(system_.lambda), multipliers_);
  }
}

void Jacobi::iterate(const ParticleView& particles, const Substep& substep) {
  system_.linearise(particles, substep, false);
  count_constraints();
  for (const LinearSystem::Block& block : system_.blocks()) solve_block(block);
  system_.moves_from_multipliers();
  system_.move(particles, relaxation_);
  system_.accept(relaxation_);
}

void Jacobi::count_constraints() {
  std::fill(split_.begin(), split_.end(), 0.0);
  for (const LinearSystem::Block& block : system_.blocks())
    if (!block.idle)
      for (const std::uint32_t u : system_.members(block))
        if (u != LinearSystem::pinned) split_[u] += 1 / system_.mass[u];
}

namespace {

template <int rows>
void solve_packed(const double* A, double* y) {
  double copy[rows * (rows + 1) / 2], x[rows];
  std::copy_n(A, rows * (rows + 1) / 2, copy);
  std::copy_n(y, rows, x);
  solve_symmetric<rows>(copy, x);
  std::copy_n(x, rows, y);
}

void solve_packed(int rows, const double* A, double* y) {
  switch (rows) {
    case 1:
      return solve_packed<1>(A, y);
    case 2:
      return solve_packed<2>(A, y);
    case 3:
      return solve_packed<3>(A, y);
    case 4:
      return solve_packed<4>(A, y);
    case 5:
      return solve_packed<5>(A, y);
    default:
      return solve_packed<6>(A, y);
  }
}

}  // namespace

void Jacobi::solve_block(const LinearSystem::Block& block) {
  double* dlambda = &system_.dlambda[block.row];
  std::fill_n(dlambda, block.rows, 0.0);
  if (block.idle) return;
  const auto of = system_.members(block);
  double A[LinearSystem::most_rows * (LinearSystem::most_rows + 1) / 2];
  for (int r = 0, at = 0; r < block.rows; ++r) {
    dlambda[r] = system_.b[block.row + static_cast<std::size_t>(r)];
    for (int s = 0; s <= r; ++s, ++at) {
      A[at] = system_.compliance[block.compliance + static_cast<std::size_t>(at)];
      for (std::size_t k = 0; k < block.arity; ++k)
        if (of[k] != LinearSystem::pinned)
          A[at] += split_[of[k]] *
                   dot(Vec3d(system_.gradient_of(block, r)[k]), Vec3d(system_.gradient_of(block, s)[k]));
    }
  }
  solve_packed(block.rows, A, dlambda);
  if (block.inequality) dlambda[0] = std::max(dlambda[0], -system_.lambda[block.row] / relaxation_);
  // A gradient that all but vanishes (a crushed tet) must not throw its particles further than the constraint
  // is large.
  double farthest = 0;
  for (std::size_t k = 0; k < block.arity; ++k) {
    if (of[k] == LinearSystem::pinned) continue;
    Vec3d move{};
    for (int r = 0; r < block.rows; ++r) move += Vec3d(system_.gradient_of(block, r)[k]) * dlambda[r];
    farthest = std::max(farthest, length(move) * split_[of[k]]);
  }
  if (farthest > block.size && block.arity > 1)
    for (int r = 0; r < block.rows; ++r) dlambda[r] *= block.size / farthest;
}

}  // namespace souple
