#include "souple/studies/dense.h"

#include "souple/error.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/core.h>

namespace souple {
namespace {

// Singular values below this fraction of the largest count as zero: rows of length 1 that agree within a
// thousandth of a radian. J is computed in float, and the constraints of a rigid cloth are nearly dependent
// in some directions. The next linearization handles the discarded part.
constexpr double singular = 1e-6;

}  // namespace

struct Dense::Impl {
  Eigen::MatrixXd J, weighted, matrix;
  Eigen::VectorXd scale, rhs;
  // For a symmetric positive semidefinite matrix, the eigenvalues are the singular values and the
  // eigenvectors are both sets of singular vectors. (Eigen's BDCSVD sometimes returns NaN for such matrices;
  // JacobiSVD takes many times as long.)
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> svd;

  void fill(const LinearSystem& system);
};

Dense::Dense() : impl_(std::make_unique<Impl>()) {}
Dense::~Dense() = default;

void Dense::prepare_system(LinearSystem& system, const ParticleView&) {
  floors_ = false;
  if (system.rows() > max_rows)
    throw Error(
        fmt::format("the solver dense takes at most {} rows of constraints, but the scene has {}: use the "
                    "solver direct or conjugate_gradient",
                    max_rows, system.rows()));
  impl_->J.resize(static_cast<Eigen::Index>(system.rows()), static_cast<Eigen::Index>(3 * system.unknowns()));
}

// J W J^T + A, each row and column divided by the square root of its diagonal. This makes rows in meters and
// rows in radians comparable and gives "singular" a meaning.
void Dense::Impl::fill(const LinearSystem& system) {
  J.setZero();
  matrix.setZero(J.rows(), J.rows());
  rhs.resize(J.rows());
  for (const LinearSystem::Block& block : system.blocks()) {
    const auto of = system.members(block);
    for (int r = 0; r < block.rows; ++r) {
      const Eigen::Index row = static_cast<Eigen::Index>(block.row) + r;
      rhs[row] = system.b[static_cast<std::size_t>(row)];
      for (std::size_t k = 0; k < block.arity; ++k)
        for (int axis = 0; axis < 3; ++axis)
          if (of[k] != LinearSystem::pinned)
            J(row, 3 * static_cast<Eigen::Index>(of[k]) + axis) =
                static_cast<double>(system.gradient_of(block, r)[k][axis]);
      for (int s = 0; s <= r; ++s)
        matrix(row, row - r + s) = matrix(row - r + s, row) =
            system.compliance[block.compliance + static_cast<std::size_t>(r * (r + 1) / 2 + s)];
    }
  }
  weighted = J;
  for (Eigen::Index column = 0; column < J.cols(); ++column)
    weighted.col(column) /= system.mass[static_cast<std::size_t>(column / 3)];
  matrix.noalias() += weighted * J.transpose();
  scale = matrix.diagonal();
  for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 0;
  matrix = scale.asDiagonal() * matrix * scale.asDiagonal();
  rhs = scale.cwiseProduct(rhs);
}

bool Dense::solve_system(LinearSystem& system, Threads&) {
  impl_->fill(system);
  if (!impl_->matrix.allFinite() || !impl_->rhs.allFinite()) return false;
  impl_->svd.compute(impl_->matrix);
  if (impl_->svd.info() != Eigen::Success) return false;
  const Eigen::VectorXd& sigma = impl_->svd.eigenvalues();  // ascending
  const Eigen::MatrixXd& u = impl_->svd.eigenvectors();
  Eigen::VectorXd solution = u.transpose() * impl_->rhs;
  const double threshold = singular * sigma[sigma.size() - 1];
  for (Eigen::Index k = 0; k < solution.size(); ++k)
    solution[k] = sigma[k] > threshold ? solution[k] / sigma[k] : 0;
  solution = impl_->scale.cwiseProduct(u * solution);
  for (std::size_t r = 0; r < system.rows(); ++r) system.dlambda[r] = solution[static_cast<Eigen::Index>(r)];
  system.moves_from_multipliers();
  return true;
}

}  // namespace souple
