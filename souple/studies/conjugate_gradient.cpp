#include "souple/studies/conjugate_gradient.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

namespace souple {
namespace {

// Unknowns per partial sum: fixed, so that sums do not depend on the number of threads.
constexpr std::size_t chunk = 1024;
constexpr std::size_t grain = 512;

// A^-1 y for the rows of a block.
void apply_inverse_compliance(const LinearSystem& system, const LinearSystem::Block& block, const double* y,
                              double* result) {
  for (int r = 0; r < block.rows; ++r)
    result[r] = row_times(block.rows, &system.inverse[block.compliance], r, y);
}

}  // namespace

int ConjugateGradient::max_products(std::size_t particles) {
  return std::max(50, static_cast<int>(1.5 * std::sqrt(static_cast<double>(particles))));
}

void ConjugateGradient::prepare_system(LinearSystem& system, const ParticleView&) {
  floors_ = true;
  const std::size_t n = system.unknowns();
  entry_begin_.assign(n + 1, 0);
  for (const LinearSystem::Block& block : system.blocks())
    for (const std::uint32_t u : system.members(block))
      if (u != LinearSystem::pinned) entry_begin_[u + 1] += block.rows;
  for (std::size_t u = 0; u < n; ++u) entry_begin_[u + 1] += entry_begin_[u];
  entries_.resize(entry_begin_[n]);
  gradient_of_.resize(entries_.size());
  std::vector<std::uint32_t> next(entry_begin_.begin(), entry_begin_.end() - 1);
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for (std::uint32_t r = 0; r < block.rows; ++r)
      for (std::uint32_t k = 0; k < of.size(); ++k) {
        if (of[k] == LinearSystem::pinned) continue;
        const std::uint32_t at = next[of[k]]++;
        entries_[at].row = block.row + r;
        gradient_of_[at] = block.gradient + r * block.arity + k;
      }
  }
  for (std::vector<double>* v : {&row_residual_, &row_direction_, &force_}) v->assign(system.rows(), 0);
  for (std::vector<Vec3d>* v : {&residual_, &direction_, &product_}) v->resize(n);
  partial_.resize((n + chunk - 1) / chunk);
  products_ = max_products_used_ = 0;
  reached_ = worst_ = 0;
}

// Copies the gradients so that the entries of one particle are contiguous.
void ConjugateGradient::gather_entries(const LinearSystem& system, Threads& threads) {
  threads.each(entries_.size(), grain,
               [&](std::size_t i) { entries_[i].gradient = system.gradient[gradient_of_[i]]; });
}

// J^T force at one unknown.
Vec3d ConjugateGradient::constraint_force(std::size_t unknown) const {
  Vec3d sum{};
  for (std::uint32_t i = entry_begin_[unknown]; i < entry_begin_[unknown + 1]; ++i)
    sum += Vec3d(entries_[i].gradient) * force_[entries_[i].row];
  return sum;
}

template <class Term>
double ConjugateGradient::sum(Threads& threads, const Term& term) {
  const std::size_t n = residual_.size();
  threads.each(partial_.size(), 1, [&](std::size_t c) {
    double part = 0;
    for (std::size_t u = c * chunk; u < std::min(n, (c + 1) * chunk); ++u) part += term(u);
    partial_[c] = part;
  });
  return std::accumulate(partial_.begin(), partial_.end(), 0.0);
}

// dx = 0, residual = J^T A^-1 b, direction = W residual.
void ConjugateGradient::begin(LinearSystem& system, Threads& threads) {
  gather_entries(system, threads);
  threads.for_each(system.blocks().size(), grain, [&](std::size_t begin, std::size_t end) {
    for (const LinearSystem::Block& block : system.blocks().subspan(begin, end - begin)) {
      apply_inverse_compliance(system, block, &system.b[block.row], &force_[block.row]);
      for (std::uint32_t r = block.row; r < block.row + block.rows; ++r) {
        row_residual_[r] = row_direction_[r] = force_[r];
        system.dlambda[r] = 0;
      }
    }
  });
  threads.each(system.unknowns(), grain, [&](std::size_t u) {
    residual_[u] = constraint_force(u);
    direction_[u] = residual_[u] / system.mass[u];
    system.dx[u] = {};
  });
}

// product = (M + J^T A^-1 J) direction: first by rows, then by particles, so that no two threads add to one
// number. The row loop first applies the previous step, which the particle vectors contain already.
void ConjugateGradient::multiply(LinearSystem& system, const StepCoefficients& last, Threads& threads) {
  threads.for_each(system.blocks().size(), grain, [&](std::size_t begin, std::size_t end) {
    for (const LinearSystem::Block& block : system.blocks().subspan(begin, end - begin)) {
      const auto of = system.members(block);
      double y[LinearSystem::max_rows];
      for (int r = 0; r < block.rows; ++r) {
        const std::size_t row = block.row + static_cast<std::size_t>(r);
        system.dlambda[row] += last.alpha * row_direction_[row];
        if (last.alpha != 0) {
          row_residual_[row] -= last.alpha * (row_direction_[row] + force_[row]);
          row_direction_[row] = row_residual_[row] + last.beta * row_direction_[row];
        }
        y[r] = 0;
        const Vec3f* gradient = system.gradient_of(block, r);
        for (std::size_t k = 0; k < block.arity; ++k)
          if (of[k] != LinearSystem::pinned) y[r] += dot(Vec3d(gradient[k]), direction_[of[k]]);
      }
      apply_inverse_compliance(system, block, y, &force_[block.row]);
    }
  });
  threads.each(system.unknowns(), grain,
               [&](std::size_t u) { product_[u] = direction_[u] * system.mass[u] + constraint_force(u); });
}

bool ConjugateGradient::solve_system(LinearSystem& system, Threads& threads) {
  begin(system, threads);
  double rho = sum(threads, [&](std::size_t u) { return dot(residual_[u], direction_[u]); });
  const double first = rho;
  StepCoefficients coefficients;
  const int limit = max_products(system.unknowns());
  for (products_ = 0; products_ < limit && rho > tolerance * tolerance * first; ++products_) {
    multiply(system, coefficients, threads);
    const double curvature = sum(threads, [&](std::size_t u) { return dot(direction_[u], product_[u]); });
    if (!(curvature > 0)) break;
    const double alpha = rho / curvature;
    const double next = sum(threads, [&](std::size_t u) {
      system.dx[u] += direction_[u] * alpha;
      residual_[u] -= product_[u] * alpha;
      return length_squared(residual_[u]) / system.mass[u];
    });
    coefficients = {alpha, next / rho};
    rho = next;
    sum(threads, [&](std::size_t u) {
      direction_[u] = residual_[u] / system.mass[u] + direction_[u] * coefficients.beta;
      return 0.0;
    });
  }
  if (products_ > 0)
    for (std::size_t r = 0; r < system.rows(); ++r)
      system.dlambda[r] += coefficients.alpha * row_direction_[r];
  reached_ = first > 0 ? std::sqrt(rho / first) : 0;
  max_products_used_ = std::max(max_products_used_, products_);
  worst_ = std::max(worst_, reached_);
  return std::isfinite(rho);
}

std::string ConjugateGradient::diagnostic() const {
  const std::string floor = floor_diagnostic();
  return fmt::format(
      "conjugate gradients: {} products to a residual of {:.1e} of the first, at most {} and {:.1e}{}{}",
      products_, reached_, max_products_used_, worst_, floor.empty() ? "" : "; ", floor);
}

}  // namespace souple
