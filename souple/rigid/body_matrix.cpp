#include "souple/rigid/body_matrix.h"

#include "souple/assert.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace souple {
namespace {

constexpr std::size_t dof = BodyMatrix::rows;

void factorize_block(BodyMatrix::Block& A) {
  for (std::size_t j = 0; j < dof; ++j) {
    double d = A[j * dof + j];
    for (std::size_t k = 0; k < j; ++k) d -= A[j * dof + k] * A[j * dof + k];
    const double pivot = std::sqrt(d);
    A[j * dof + j] = pivot;
    for (std::size_t i = j + 1; i < dof; ++i) {
      double s = A[i * dof + j];
      for (std::size_t k = 0; k < j; ++k) s -= A[i * dof + k] * A[j * dof + k];
      A[i * dof + j] = s / pivot;
    }
  }
}

/// x := L^-1 x.
void forward(const BodyMatrix::Block& L, double* x) {
  for (std::size_t i = 0; i < dof; ++i) {
    double s = x[i];
    for (std::size_t k = 0; k < i; ++k) s -= L[i * dof + k] * x[k];
    x[i] = s / L[i * dof + i];
  }
}

/// x := L^-T x.
void backward(const BodyMatrix::Block& L, double* x) {
  for (std::size_t i = dof; i-- > 0;) {
    double s = x[i];
    for (std::size_t k = i + 1; k < dof; ++k) s -= L[k * dof + i] * x[k];
    x[i] = s / L[i * dof + i];
  }
}

BodyMatrix::Block transposed(const BodyMatrix::Block& A) {
  BodyMatrix::Block T;
  for (std::size_t i = 0; i < dof; ++i)
    for (std::size_t j = 0; j < dof; ++j) T[j * dof + i] = A[i * dof + j];
  return T;
}

/// C -= A B.
void subtract_product(const BodyMatrix::Block& A, const BodyMatrix::Block& B, BodyMatrix::Block& C) {
  for (std::size_t i = 0; i < dof; ++i)
    for (std::size_t k = 0; k < dof; ++k) {
      const double a = A[i * dof + k];
      for (std::size_t j = 0; j < dof; ++j) C[i * dof + j] -= a * B[k * dof + j];
    }
}

/// y -= A x, each sum in two halves that fill a register.
void subtract_from(double* y, const BodyMatrix::Block& A, const double* x) {
  for (std::size_t i = 0; i < dof; ++i) {
    const double* const row = &A[i * dof];
    const double even = row[0] * x[0] + row[2] * x[2] + row[4] * x[4];
    const double odd = row[1] * x[1] + row[3] * x[3] + row[5] * x[5];
    y[i] -= even + odd;
  }
}

/// y -= A^T x.
void subtract_transposed_from(double* y, const BodyMatrix::Block& A, const double* x) {
  std::array<double, dof> sum{};
  for (std::size_t i = 0; i < dof; ++i)
    for (std::size_t k = 0; k < dof; ++k) sum[k] += A[i * dof + k] * x[i];
  for (std::size_t k = 0; k < dof; ++k) y[k] -= sum[k];
}

}  // namespace

// Minimum degree; among equal degrees the first body.
void BodyMatrix::analyze(std::uint32_t bodies,
                         std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  SOUPLE_ASSERT(bodies <= most_bodies, "a larger matrix costs too much");
  const std::size_t words = (bodies + 63) / 64;
  neighbors_.assign(bodies * words, 0);
  const auto set = [&](std::uint32_t i, std::uint32_t j) {
    neighbors_[i * words + j / 64] |= std::uint64_t{1} << (j % 64);
  };
  for (const auto& [i, j] : pairs) set(i, j), set(j, i);
  const auto count = [&](std::uint32_t i) {
    degree_[i] = 0;
    for (std::size_t w = 0; w < words; ++w) degree_[i] += std::popcount(neighbors_[i * words + w]);
  };
  degree_.resize(bodies);
  for (std::uint32_t i = 0; i < bodies; ++i) count(i);
  position_.assign(bodies, bodies);
  order_.clear(), below_.clear(), column_begin_.assign(1, 0), cost_ = 0;
  while (order_.size() < bodies) {
    const auto best =
        static_cast<std::uint32_t>(std::min_element(degree_.begin(), degree_.end()) - degree_.begin());
    degree_[best] = std::numeric_limits<int>::max();
    position_[best] = static_cast<std::uint32_t>(order_.size());
    order_.push_back(best);
    for (std::uint32_t j = 0; j < bodies; ++j) {
      if (!(neighbors_[best * words + j / 64] >> (j % 64) & 1)) continue;
      below_.push_back(j);
      for (std::size_t w = 0; w < words; ++w) neighbors_[j * words + w] |= neighbors_[best * words + w];
      neighbors_[j * words + j / 64] &= ~(std::uint64_t{1} << (j % 64));
      neighbors_[j * words + best / 64] &= ~(std::uint64_t{1} << (best % 64));
      count(j);
    }
    const double below = static_cast<double>(below_.size() - column_begin_.back());
    cost_ += (below * (below + 1) / 2 + below / 2 + 0.5) * static_cast<double>(dof * dof * dof);
    column_begin_.push_back(static_cast<std::uint32_t>(below_.size()));
  }
  for (std::uint32_t& row : below_) row = position_[row];
  for (std::uint32_t c = 0; c < bodies; ++c)
    std::sort(below_.data() + column_begin_[c], below_.data() + column_begin_[c + 1]);
  diagonal_.resize(bodies), lower_.resize(below_.size());
}

void BodyMatrix::clear() {
  std::fill(diagonal_.begin(), diagonal_.end(), Block{});
  std::fill(lower_.begin(), lower_.end(), Block{});
}

std::size_t BodyMatrix::find(std::uint32_t row, std::uint32_t column) const {
  const std::uint32_t* at =
      std::lower_bound(below_.data() + column_begin_[column], below_.data() + column_begin_[column + 1], row);
  return static_cast<std::size_t>(at - below_.data());
}

std::pair<BodyMatrix::Block*, bool> BodyMatrix::beside(std::uint32_t i, std::uint32_t j) {
  const std::uint32_t p = position_[i], q = position_[j];
  return {&lower_[find(std::max(p, q), std::min(p, q))], p < q};
}

void BodyMatrix::factorize() {
  for (std::uint32_t c = 0; c < order_.size(); ++c) {
    factorize_block(diagonal_[c]);
    const std::uint32_t begin = column_begin_[c], end = column_begin_[c + 1];
    for (std::uint32_t p = begin; p < end; ++p)
      for (std::size_t i = 0; i < dof; ++i) forward(diagonal_[c], &lower_[p][i * dof]);
    for (std::uint32_t q = begin; q < end; ++q) {
      const Block T = transposed(lower_[q]);
      const std::uint32_t column = below_[q];
      subtract_product(lower_[q], T, diagonal_[column]);
      // All later rows of this column are rows of that one too.
      std::size_t target = column_begin_[column];
      for (std::uint32_t p = q + 1; p < end; ++p) {
        while (below_[target] != below_[p]) ++target;
        subtract_product(lower_[p], T, lower_[target]);
      }
    }
  }
}

void BodyMatrix::solve(std::span<double> x) const {
  const auto at = [&](std::uint32_t position) { return &x[order_[position] * dof]; };
  for (std::uint32_t c = 0; c < order_.size(); ++c) {
    forward(diagonal_[c], at(c));
    for (std::uint32_t p = column_begin_[c]; p < column_begin_[c + 1]; ++p)
      subtract_from(at(below_[p]), lower_[p], at(c));
  }
  for (auto c = static_cast<std::uint32_t>(order_.size()); c-- > 0;) {
    for (std::uint32_t p = column_begin_[c]; p < column_begin_[c + 1]; ++p)
      subtract_transposed_from(at(c), lower_[p], at(below_[p]));
    backward(diagonal_[c], at(c));
  }
}

std::size_t BodyMatrix::bytes() const {
  return bytes_of(position_, order_, column_begin_, below_, neighbors_, degree_, diagonal_, lower_);
}

}  // namespace souple
