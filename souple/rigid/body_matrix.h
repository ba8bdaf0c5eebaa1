#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace souple {

/// A sparse, symmetric, positive definite matrix with a block of 6 x 6 for each pair of bodies that touch. It is
/// factorized as L L^T in an order of minimum degree. Allocates only where it grows.
class BodyMatrix {
 public:
  static constexpr std::size_t rows = 6;
  static constexpr std::uint32_t most_bodies = 2048;
  using Block = std::array<double, rows * rows>;  ///< row by row

  /// `pairs`: i < j, ascending, each once.
  void analyze(std::uint32_t bodies, std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  /// Multiplications of a factorization, approximately.
  double cost() const { return cost_; }
  /// Multiplications of `solve`.
  double solve_cost() const {
    return static_cast<double>((lower_.size() * 2 + diagonal_.size()) * rows * rows);
  }
  void clear();
  Block& diagonal(std::uint32_t body) { return diagonal_[position_[body]]; }
  /// The block of two bodies and whether its rows are those of j.
  std::pair<Block*, bool> beside(std::uint32_t i, std::uint32_t j);
  /// Replaces the matrix by its factor.
  void factorize();
  /// Replaces the right side, six numbers a body, by the solution.
  void solve(std::span<double> x) const;
  std::size_t bytes() const;

 private:
  std::size_t find(std::uint32_t row, std::uint32_t column) const;

  std::vector<std::uint32_t> position_;      // of each body in the order
  std::vector<std::uint32_t> order_;         // bodies
  std::vector<std::uint32_t> column_begin_;  // per position: into below_ and lower_
  std::vector<std::uint32_t> below_;         // positions of the blocks below the diagonal, ascending
  std::vector<std::uint64_t> neighbors_;     // per body, while the order is found: a bit per body
  std::vector<int> degree_;                  // likewise: the number of these bits
  std::vector<Block> diagonal_, lower_;
  double cost_ = 0;
};

}  // namespace souple
