#include "souple/solver/conjugate_gradient.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace souple {
namespace {

constexpr std::size_t chunk =
    1024;  // unknowns summed by one thread: fixed, so that sums do not depend on threads
constexpr std::size_t grain = 512;

double stiffness(const LinearSystem& system, const LinearSystem::Block& block, int r, int s) {
  return system.inverse[block.compliance +
                        static_cast<std::size_t>(r >= s ? r * (r + 1) / 2 + s : s * (s + 1) / 2 + r)];
}

// A^-1 y for the rows of a block.
void weigh(const LinearSystem& system, const LinearSystem::Block& block, const double* y, double* result) {
  for (int r = 0; r < block.rows; ++r) {
    result[r] = 0;
    for (int s = 0; s < block.rows; ++s) result[r] += stiffness(system, block, r, s) * y[s];
  }
}

}  // namespace

void ConjugateGradient::prepare_system(LinearSystem& system, const ParticleView&) {
  floors_ = true;
  const std::size_t n = system.unknowns();
  incidence_begin_.assign(n + 1, 0);
  for (const LinearSystem::Block& block : system.blocks())
    for (const std::uint32_t u : system.members(block))
      if (u != LinearSystem::pinned) ++incidence_begin_[u + 1];
  for (std::size_t u = 0; u < n; ++u) incidence_begin_[u + 1] += incidence_begin_[u];
  incidences_.resize(incidence_begin_[n]);
  std::vector<std::uint32_t> next(incidence_begin_.begin(), incidence_begin_.end() - 1);
  for (std::uint32_t i = 0; i < system.blocks().size(); ++i) {
    const auto of = system.members(system.blocks()[i]);
    for (std::uint32_t k = 0; k < of.size(); ++k)
      if (of[k] != LinearSystem::pinned) incidences_[next[of[k]]++] = {i, k};
  }
  preconditioner_.resize(n);
  force_.resize(system.rows());
  for (std::vector<Vec3d>* v : {&residual_, &direction_, &product_, &preconditioned_}) v->resize(n);
  partial_.resize((n + chunk - 1) / chunk);
  rigid_.prepare(system);
  products_ = most_used_ = 0;
  reached_ = worst_ = 0;
}

void ConjugateGradient::build_preconditioner(const LinearSystem& system, Threads& threads) {
  threads.for_each(system.unknowns(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      Mat3d diagonal = Mat3d::identity() * system.mass[u];
      for (std::uint32_t i = incidence_begin_[u]; i < incidence_begin_[u + 1]; ++i) {
        const LinearSystem::Block& block = system.blocks()[incidences_[i].block];
        for (int r = 0; r < block.rows; ++r)
          for (int s = 0; s < block.rows; ++s)
            diagonal = diagonal + outer(Vec3d(system.gradient_of(block, r)[incidences_[i].member]) *
                                            stiffness(system, block, r, s),
                                        Vec3d(system.gradient_of(block, s)[incidences_[i].member]));
      }
      preconditioner_[u] = inverse(diagonal);
    }
  });
}

// residual = J^T A^-1 b.
void ConjugateGradient::build_right_side(const LinearSystem& system, Threads& threads) {
  threads.for_each(system.blocks().size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const LinearSystem::Block& block = system.blocks()[i];
      weigh(system, block, &system.b[block.row], &force_[block.row]);
    }
  });
  threads.for_each(system.unknowns(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      Vec3d sum{};
      for (std::uint32_t i = incidence_begin_[u]; i < incidence_begin_[u + 1]; ++i) {
        const LinearSystem::Block& block = system.blocks()[incidences_[i].block];
        for (int r = 0; r < block.rows; ++r)
          sum += Vec3d(system.gradient_of(block, r)[incidences_[i].member]) *
                 force_[block.row + static_cast<std::size_t>(r)];
      }
      residual_[u] = sum;
    }
  });
}

// product = (M + J^T A^-1 J) direction: by rows, then by particles, so that no two threads add to one number.
void ConjugateGradient::multiply(const LinearSystem& system, Threads& threads) {
  threads.for_each(system.blocks().size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const LinearSystem::Block& block = system.blocks()[i];
      const auto of = system.members(block);
      double y[LinearSystem::most_rows];
      for (int r = 0; r < block.rows; ++r) {
        y[r] = 0;
        for (std::size_t k = 0; k < block.arity; ++k)
          if (of[k] != LinearSystem::pinned)
            y[r] += dot(Vec3d(system.gradient_of(block, r)[k]), direction_[of[k]]);
      }
      weigh(system, block, y, &force_[block.row]);
    }
  });
  threads.for_each(system.unknowns(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      Vec3d sum = direction_[u] * system.mass[u];
      for (std::uint32_t i = incidence_begin_[u]; i < incidence_begin_[u + 1]; ++i) {
        const LinearSystem::Block& block = system.blocks()[incidences_[i].block];
        for (int r = 0; r < block.rows; ++r)
          sum += Vec3d(system.gradient_of(block, r)[incidences_[i].member]) *
                 force_[block.row + static_cast<std::size_t>(r)];
      }
      product_[u] = sum;
    }
  });
}

template <class Term>
double ConjugateGradient::sum(Threads& threads, const Term& term) {
  const std::size_t n = residual_.size();
  threads.for_each(partial_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      partial_[c] = 0;
      for (std::size_t u = c * chunk; u < std::min(n, (c + 1) * chunk); ++u) partial_[c] += term(u);
    }
  });
  double total = 0;
  for (const double part : partial_) total += part;
  return total;
}

// preconditioned = P residual; returns residual . P residual.
double ConjugateGradient::precondition(Threads& threads) {
  return sum(threads, [&](std::size_t u) {
    preconditioned_[u] = preconditioner_[u] * residual_[u];
    return dot(residual_[u], preconditioned_[u]);
  });
}

bool ConjugateGradient::solve_system(LinearSystem& system, const ParticleView& particles, Threads& threads) {
  build_preconditioner(system, threads);
  build_right_side(system, threads);
  std::fill(system.dx.begin(), system.dx.end(), Vec3d{});
  double rho = precondition(threads);
  const double first = rho;
  if (!std::isfinite(first)) return false;
  direction_ = preconditioned_;
  products_ = 0;
  while (products_ < most_products && rho > tolerance * tolerance * first) {
    multiply(system, threads);
    ++products_;
    const double curvature = sum(threads, [&](std::size_t u) { return dot(direction_[u], product_[u]); });
    if (!(curvature > 0)) break;
    const double alpha = rho / curvature;
    const double next = sum(threads, [&](std::size_t u) {
      system.dx[u] += direction_[u] * alpha;
      residual_[u] -= product_[u] * alpha;
      preconditioned_[u] = preconditioner_[u] * residual_[u];
      return dot(residual_[u], preconditioned_[u]);
    });
    const double beta = next / rho;
    rho = next;
    sum(threads, [&](std::size_t u) {
      direction_[u] = preconditioned_[u] + direction_[u] * beta;
      return 0.0;
    });
  }
  reached_ = first > 0 ? std::sqrt(rho / first) : 0;
  most_used_ = std::max(most_used_, products_);
  worst_ = std::max(worst_, reached_);
  rigid_.remove(system, particles);
  system.multipliers_from_moves();
  return std::isfinite(rho);
}

std::string ConjugateGradient::remark() const {
  char line[160];
  std::snprintf(line, sizeof line,
                "conjugate gradients: %d products to a residual of %.1e of the first, at worst %d to %.1e",
                products_, reached_, most_used_, worst_);
  const std::string floor = floor_remark();
  return floor.empty() ? line : line + ("; " + floor);
}

}  // namespace souple
