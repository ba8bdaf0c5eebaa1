#pragma once

#include "souple/geometry/tet_mesh.h"

#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Sparse>

namespace souple {

/// Displacement of every vertex of a body of linear tets under nodal forces, with some vertices fixed. Solves static
/// small-strain finite elements in double: K u = f with K = sum V B^T D B.
inline std::vector<Vec3d> solve_linear_elasticity(const TetMesh& mesh, double E, double nu,
                                                  const std::vector<bool>& held,
                                                  const std::vector<Vec3d>& force) {
  const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  const auto n = static_cast<Eigen::Index>(3 * mesh.positions.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (const Tet& tet : mesh.tets) {
    Eigen::Matrix3d edges;
    const Vec3d& o = mesh.positions[tet[0]];
    for (int k = 0; k < 3; ++k) {
      const Vec3d e = mesh.positions[tet[static_cast<std::size_t>(k) + 1]] - o;
      edges.col(k) = Eigen::Vector3d(e.x, e.y, e.z);
    }
    const double volume = edges.determinant() / 6;
    Eigen::Matrix<double, 4, 3> grad;  // of the shape functions, one per row
    grad.bottomRows<3>() = edges.inverse();
    grad.row(0) = -grad.bottomRows<3>().colwise().sum();
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        const Eigen::Vector3d ga = grad.row(a), gb = grad.row(b);
        const Eigen::Matrix3d block = volume * (lambda * ga * gb.transpose() + mu * gb * ga.transpose() +
                                                mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            const std::uint32_t va = tet[static_cast<std::size_t>(a)], vb = tet[static_cast<std::size_t>(b)];
            if (!held[va] && !held[vb])
              entries.emplace_back(static_cast<int>(3 * va) + i, static_cast<int>(3 * vb) + j, block(i, j));
          }
      }
  }
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n);
  for (std::size_t v = 0; v < held.size(); ++v)
    for (int i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(3 * v) + i;
      if (held[v]) {
        entries.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
      } else {
        f[row] = i == 0 ? force[v].x : (i == 1 ? force[v].y : force[v].z);
      }
    }
  Eigen::SparseMatrix<double> K(n, n);
  K.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(K);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the stiffness matrix is singular");
  const Eigen::VectorXd u = solver.solve(f);
  std::vector<Vec3d> result(held.size());
  for (std::size_t v = 0; v < held.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(3 * v);
    result[v] = {u[row], u[row + 1], u[row + 2]};
  }
  return result;
}

}  // namespace souple
