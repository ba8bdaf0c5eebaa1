#include "souple/rigid/joints/block_cholesky.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace souple::joint {
namespace {

/// A pivot below this part of the diagonal is rounding.
constexpr double least_pivot = 1e-13;
/// Instead of a pivot that vanished: makes its unknown 0.
constexpr double no_pivot = 1e100;

void factorize_diagonal(double* A, int n) {
  for (int j = 0; j < n; ++j) {
    const double original = A[j * n + j];
    double d = original;
    for (int k = 0; k < j; ++k) d -= A[j * n + k] * A[j * n + k];
    const double pivot = d > least_pivot * std::abs(original) ? std::sqrt(d) : no_pivot;
    A[j * n + j] = pivot;
    for (int i = j + 1; i < n; ++i) {
      double s = A[i * n + j];
      for (int k = 0; k < j; ++k) s -= A[i * n + k] * A[j * n + k];
      A[i * n + j] = s / pivot;
    }
  }
}

/// x := L^-1 x.
void forward(const double* L, int n, double* x) {
  for (int i = 0; i < n; ++i) {
    double s = x[i];
    for (int k = 0; k < i; ++k) s -= L[i * n + k] * x[k];
    x[i] = s / L[i * n + i];
  }
}

/// x := L^-T x.
void backward(const double* L, int n, double* x) {
  for (int i = n - 1; i >= 0; --i) {
    double s = x[i];
    for (int k = i + 1; k < n; ++k) s -= L[k * n + i] * x[k];
    x[i] = s / L[i * n + i];
  }
}

/// C -= A B^T, of `a` and `b` rows and n columns.
void subtract_product(const double* A, int a, const double* B, int b, int n, double* C) {
  for (int i = 0; i < a; ++i)
    for (int j = 0; j < b; ++j) {
      double s = 0;
      for (int k = 0; k < n; ++k) s += A[i * n + k] * B[j * n + k];
      C[i * b + j] -= s;
    }
}

}  // namespace

void solve_dense(double* A, int n, double* x) {
  factorize_diagonal(A, n);
  forward(A, n, x);
  backward(A, n, x);
}

void BlockCholesky::analyze(std::span<const int> sizes,
                            std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  sizes_.assign(sizes.begin(), sizes.end());
  first_row_.assign(1, 0);
  for (const int n : sizes_) first_row_.push_back(first_row_.back() + static_cast<std::size_t>(n));
  order(pairs);
  find_updates();
}

/// Minimum degree; among equal degrees the lowest index. Each column gets its blocks below the diagonal, fill included.
void BlockCholesky::order(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const std::size_t n = sizes_.size();
  std::vector<std::vector<std::uint32_t>> neighbors(n);
  for (const auto& [i, j] : pairs) neighbors[i].push_back(j), neighbors[j].push_back(i);
  std::set<std::pair<std::size_t, std::uint32_t>> queue;
  for (std::uint32_t i = 0; i < n; ++i) {
    std::sort(neighbors[i].begin(), neighbors[i].end());
    neighbors[i].erase(std::unique(neighbors[i].begin(), neighbors[i].end()), neighbors[i].end());
    queue.emplace(neighbors[i].size(), i);
  }
  columns_.clear(), below_.clear();
  position_.assign(n, 0);
  std::vector<std::uint32_t> merged;
  while (!queue.empty()) {
    const std::uint32_t block = queue.begin()->second;
    queue.erase(queue.begin());
    position_[block] = static_cast<std::uint32_t>(columns_.size());
    columns_.push_back({block, below_.size(), below_.size() + neighbors[block].size(), 0, 0});
    for (const std::uint32_t i : neighbors[block]) {
      below_.push_back({i, 0});
      queue.erase({neighbors[i].size(), i});
      merged.clear();
      std::set_union(neighbors[i].begin(), neighbors[i].end(), neighbors[block].begin(),
                     neighbors[block].end(), std::back_inserter(merged));
      std::erase_if(merged, [&](std::uint32_t k) { return k == i || k == block; });
      neighbors[i] = merged;
      queue.emplace(neighbors[i].size(), i);
    }
  }
}

void BlockCholesky::find_updates() {
  std::size_t end = 0;
  diagonal_.assign(sizes_.size(), 0);
  const auto reserve = [&](int count) { return std::exchange(end, end + static_cast<std::size_t>(count)); };
  for (const Column& column : columns_) {
    diagonal_[column.block] = reserve(size(column.block) * size(column.block));
    const auto begin = below_.begin() + static_cast<std::ptrdiff_t>(column.below);
    std::sort(begin, below_.begin() + static_cast<std::ptrdiff_t>(column.below_end),
              [&](const Below& a, const Below& b) { return position_[a.row] < position_[b.row]; });
    for (std::size_t p = column.below; p < column.below_end; ++p)
      below_[p].offset = reserve(size(below_[p].row) * size(column.block));
  }
  values_.assign(end, 0);
  updates_.clear(), cost_ = 0;
  for (Column& column : columns_) {
    column.updates = updates_.size();
    for (std::size_t p = column.below; p < column.below_end; ++p)
      for (std::size_t q = column.below; q <= p; ++q) {
        updates_.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q),
                            place(below_[p].row, below_[q].row).offset});
        cost_ += static_cast<double>(size(below_[p].row) * size(below_[q].row) * size(column.block));
      }
    column.updates_end = updates_.size();
  }
}

BlockCholesky::Place BlockCholesky::place(std::uint32_t i, std::uint32_t j) const {
  if (i == j) return {diagonal_[i], false};
  const bool swapped = position_[i] < position_[j];
  const std::uint32_t row = swapped ? j : i, block = swapped ? i : j;
  const Column& column = columns_[position_[block]];
  const auto begin = below_.begin() + static_cast<std::ptrdiff_t>(column.below);
  const auto found = std::lower_bound(
      begin, below_.begin() + static_cast<std::ptrdiff_t>(column.below_end), position_[row],
      [&](const Below& below, std::uint32_t position) { return position_[below.row] < position; });
  return {found->offset, swapped};
}

void BlockCholesky::clear() {
  std::fill(values_.begin(), values_.end(), 0.0);
}

void BlockCholesky::factorize() {
  for (const Column& column : columns_) {
    const int n = size(column.block);
    double* D = at(diagonal_[column.block]);
    factorize_diagonal(D, n);
    for (std::size_t p = column.below; p < column.below_end; ++p)
      for (int i = 0; i < size(below_[p].row); ++i)
        forward(D, n, at(below_[p].offset + static_cast<std::size_t>(i * n)));
    for (std::size_t u = column.updates; u < column.updates_end; ++u) {
      const Below &first = below_[updates_[u].first], &second = below_[updates_[u].second];
      subtract_product(at(first.offset), size(first.row), at(second.offset), size(second.row), n,
                       at(updates_[u].offset));
    }
  }
}

void BlockCholesky::solve(std::span<double> x) const {
  for (const Column& column : columns_) {
    const int n = size(column.block);
    double* own = x.data() + first_row_[column.block];
    forward(values_.data() + diagonal_[column.block], n, own);
    for (std::size_t p = column.below; p < column.below_end; ++p)
      subtract_product(values_.data() + below_[p].offset, size(below_[p].row), own, 1, n,
                       x.data() + first_row_[below_[p].row]);
  }
  for (auto column = columns_.rbegin(); column != columns_.rend(); ++column) {
    const int n = size(column->block);
    double* own = x.data() + first_row_[column->block];
    for (std::size_t p = column->below; p < column->below_end; ++p) {
      const double* B = values_.data() + below_[p].offset;
      const double* other = x.data() + first_row_[below_[p].row];
      for (int i = 0; i < size(below_[p].row); ++i)
        for (int k = 0; k < n; ++k) own[k] -= B[i * n + k] * other[i];
    }
    backward(values_.data() + diagonal_[column->block], n, own);
  }
}

}  // namespace souple::joint
