#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple::joint {

/// Solves A x = b for a dense, symmetric, positive definite matrix of n rows; replaces both.
void solve_dense(double* A, int n, double* x);

/// L L^T of a sparse, symmetric, positive definite matrix of small dense blocks, in an order of minimum degree. Without
/// fill for trees. `analyze` allocates, nothing else does.
class BlockCholesky {
 public:
  /// Offset of a block, stored row by row, and which index of a pair its rows belong to.
  struct Place {
    std::size_t offset = 0;
    bool swapped = false;  ///< the rows are those of the second index
  };

  /// `sizes`: rows of each diagonal block. `pairs`: blocks beside the diagonal that are not zero, in any order.
  void analyze(std::span<const int> sizes, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  /// Multiplications of a factorization, approximately.
  double cost() const { return cost_; }
  std::size_t rows() const { return first_row_.empty() ? 0 : first_row_.back(); }
  std::size_t first_row(std::size_t block) const { return first_row_[block]; }

  /// Block (i, j) of the matrix; both halves of a pair are one block.
  Place place(std::uint32_t i, std::uint32_t j) const;
  void clear();
  double* at(std::size_t offset) { return values_.data() + offset; }

  /// Replaces the matrix by its factor. A row whose pivot vanishes is ignored: its unknown is 0.
  void factorize();
  /// Replaces the right side by the solution.
  void solve(std::span<double> x) const;

 private:
  /// A block below the diagonal.
  struct Below {
    std::uint32_t row = 0;
    std::size_t offset = 0;
  };
  /// The product of two blocks of a column changes a block of a later column.
  struct Update {
    std::uint32_t first = 0, second = 0;  ///< in below_
    std::size_t offset = 0;
  };
  struct Column {
    std::uint32_t block = 0;
    std::size_t below = 0, below_end = 0;      ///< in below_
    std::size_t updates = 0, updates_end = 0;  ///< in updates_
  };

  void order(std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  void find_updates();
  int size(std::uint32_t block) const { return sizes_[block]; }

  std::vector<int> sizes_;
  std::vector<std::size_t> first_row_;   ///< of each block, and the end
  std::vector<std::size_t> diagonal_;    ///< offset of each diagonal block
  std::vector<std::uint32_t> position_;  ///< of each block in the order
  std::vector<Column> columns_;          ///< in the order of elimination
  std::vector<Below> below_;             ///< of each column, ascending in the order
  std::vector<Update> updates_;
  std::vector<double> values_;
  double cost_ = 0;
};

}  // namespace souple::joint
