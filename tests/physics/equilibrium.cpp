#include "tests/physics/equilibrium.h"

#include "souple/constraints/isometric_bending.h"
#include "souple/constraints/triangle_membrane.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/rest_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <Eigen/Sparse>

namespace souple {
namespace {

constexpr double gravity = 9.81;

double area_of(const TriangleMesh& mesh, const Triangle& t) {
  const auto& x = mesh.positions;
  return 0.5 * length(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]));
}

}  // namespace

struct Equilibrium::Matrix {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::SparseMatrix<double> sum;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors;
  bool analyzed = false;
};

Equilibrium::Equilibrium(int dimensions) : dimensions_(dimensions), matrix_(std::make_unique<Matrix>()) {}
Equilibrium::~Equilibrium() = default;

std::uint32_t Equilibrium::add_cloth(const TriangleMesh& mesh, const ClothMaterial& material) {
  const auto begin = static_cast<std::uint32_t>(x_.size());
  x_.insert(x_.end(), mesh.positions.begin(), mesh.positions.end());
  mass_.resize(x_.size()), pinned_.resize(x_.size());
  for (auto i = begin; i < x_.size(); ++i) same_as_.push_back(i);
  const auto triangles = mesh.triangles;
  const TriangleEdges edges = triangle_edges(triangles);
  std::vector<double> area(edges.edges.size());
  const std::vector<RestFrame> frames = rest_frames(mesh);
  const auto Y = static_cast<double>(material.membrane_stiffness),
             nu = static_cast<double>(material.poisson_ratio);
  const double shear =
      material.shear_stiffness > 0 ? static_cast<double>(material.shear_stiffness) : Y / (2 * (1 + nu));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double A = area_of(mesh, triangles[t]);
    for (const std::uint32_t edge : edges.of_triangle[t])
      if (edge != TriangleEdges::no_edge) area[edge] += A;
    for (const std::uint32_t i : triangles[t])
      mass_[begin + i] += static_cast<double>(material.areal_density) * A / 3;
    if (material.stretch != StretchModel::membrane || !(A > 0)) continue;
    const Vec3d corners[3] = {mesh.positions[triangles[t][0]], mesh.positions[triangles[t][1]],
                              mesh.positions[triangles[t][2]]};
    const auto p = TriangleMembrane::from_rest(corners, frames[t].warp);
    const auto a = TriangleMembrane::compliance(Y, Y, nu, shear, A);
    Eigen::Matrix3d alpha;
    alpha << static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[3]),
        static_cast<double>(a[1]), static_cast<double>(a[2]), static_cast<double>(a[4]),
        static_cast<double>(a[3]), static_cast<double>(a[4]), static_cast<double>(a[5]);
    const Eigen::Matrix3d S = alpha.inverse();
    const double b[2][2] = {{static_cast<double>(p.b00), static_cast<double>(p.b10)},
                            {static_cast<double>(p.b01), static_cast<double>(p.b11)}};
    Membrane m{{begin + triangles[t][0], begin + triangles[t][1], begin + triangles[t][2]}, {}, {}};
    for (int d = 0; d < 2; ++d) m.b[d][0] = -b[d][0] - b[d][1], m.b[d][1] = b[d][0], m.b[d][2] = b[d][1];
    for (int r = 0; r < 3; ++r)
      for (int s = 0; s < 3; ++s) m.stiffness[r][s] = S(r, s);
    membranes_.push_back(m);
  }
  if (material.stretch == StretchModel::springs)
    for (std::size_t e = 0; e < edges.edges.size(); ++e) {
      const Edge& edge = edges.edges[e];
      const double l = length(mesh.positions[edge[0]] - mesh.positions[edge[1]]);
      springs_.push_back({{begin + edge[0], begin + edge[1]}, l, Y * area[e] / (l * l)});
    }
  if (material.bending == BendingModel::isometric && dimensions_ == 3)
    for (const Hinge& hinge : interior_edges(triangles)) {
      const Vec3d x[4] = {mesh.positions[hinge[0]], mesh.positions[hinge[1]], mesh.positions[hinge[2]],
                          mesh.positions[hinge[3]]};
      const auto p = IsometricBending::from_rest(x);
      const auto k1 = static_cast<double>(p.k1), k2 = static_cast<double>(p.k2),
                 k3 = static_cast<double>(p.k3);
      bendings_.push_back({4,
                           {begin + hinge[0], begin + hinge[1], begin + hinge[2], begin + hinge[3]},
                           {-k1 - k2 - k3, k1, k2, k3},
                           static_cast<double>(material.bending_stiffness)});
    }
  return begin;
}

std::uint32_t Equilibrium::add_rope(std::span<const Vec3d> points, const RopeMaterial& material) {
  const auto begin = static_cast<std::uint32_t>(x_.size());
  x_.insert(x_.end(), points.begin(), points.end());
  mass_.resize(x_.size()), pinned_.resize(x_.size());
  const double r = static_cast<double>(material.radius), section = std::numbers::pi * r * r;
  for (auto i = begin; i < x_.size(); ++i) {
    same_as_.push_back(i);
    if (i + 1 >= x_.size()) continue;
    const double l = length(x_[i + 1] - x_[i]);
    springs_.push_back({{i, i + 1}, l, static_cast<double>(material.young_modulus) * section / l});
    for (const auto k : {i, i + 1}) mass_[k] += static_cast<double>(material.density) * section * l / 2;
    if (i + 2 < x_.size() && material.bending_stiffness > 0)
      bendings_.push_back(
          {3, {i, i + 1, i + 2}, {1, -2, 1}, static_cast<double>(material.bending_stiffness) / (l * l * l)});
  }
  return begin;
}

void Equilibrium::tie(std::uint32_t a, std::uint32_t b) {
  same_as_[b] = a;
  mass_[a] += mass_[b];
}

void Equilibrium::pin(std::span<const std::uint32_t> particles) {
  for (const std::uint32_t i : particles) pinned_[i] = true;
}

void Equilibrium::set_positions(std::span<const Vec3f> positions) {
  for (std::size_t i = 0; i < positions.size(); ++i) x_[i] = Vec3d(positions[i]);
}

void Equilibrium::add_force(std::uint32_t i, const Vec3d& force) {
  force_[same_as_[i]] += force;
}

// Adds factor times column row^T.
void Equilibrium::add_block(std::uint32_t i, std::uint32_t j, const Vec3d& column, const Vec3d& row,
                            double factor) {
  const int p = unknown_[same_as_[i]], q = unknown_[same_as_[j]];
  if (!with_matrix_ || p < 0 || q < 0) return;
  for (int r = 0; r < dimensions_; ++r)
    for (int s = 0; s < dimensions_; ++s)
      if (p + r >= q + s) matrix_->entries.emplace_back(p + r, q + s, factor * column[r] * row[s]);
}

void Equilibrium::add_diagonal(std::uint32_t i, std::uint32_t j, double factor) {
  const int p = unknown_[same_as_[i]], q = unknown_[same_as_[j]];
  if (!with_matrix_ || p < 0 || q < 0 || p < q) return;
  for (int r = 0; r < dimensions_; ++r) matrix_->entries.emplace_back(p + r, q + r, factor);
}

double Equilibrium::add(const Spring& s) {
  const auto [a, b] = s.particle;
  const Vec3d u = x_[b] - x_[a];
  const double l = length(u), C = l - s.length;
  const Vec3d n = u / l;
  add_force(a, n * (s.stiffness * C)), add_force(b, n * (-s.stiffness * C));
  const double transverse = std::max(0.0, C / l);
  for (const auto i : s.particle)
    for (const auto j : s.particle) {
      const double sign = i == j ? s.stiffness : -s.stiffness;
      add_block(i, j, n, n, sign * (1 - transverse)), add_diagonal(i, j, sign * transverse);
    }
  return 0.5 * s.stiffness * C * C;
}

double Equilibrium::add(const Membrane& m) {
  Vec3d f[2];
  for (int d = 0; d < 2; ++d)
    for (std::size_t k = 0; k < 3; ++k) f[d] += x_[m.particle[k]] * m.b[d][k];
  const double C[3] = {(dot(f[0], f[0]) - 1) / 2, (dot(f[1], f[1]) - 1) / 2, dot(f[0], f[1])};
  double stress[3], energy = 0;
  for (int r = 0; r < 3; ++r) {
    stress[r] = m.stiffness[r][0] * C[0] + m.stiffness[r][1] * C[1] + m.stiffness[r][2] * C[2];
    energy += 0.5 * stress[r] * C[r];
  }
  Vec3d gradient[3][3];
  for (std::size_t k = 0; k < 3; ++k) {
    gradient[0][k] = f[0] * m.b[0][k], gradient[1][k] = f[1] * m.b[1][k];
    gradient[2][k] = f[0] * m.b[1][k] + f[1] * m.b[0][k];
    add_force(m.particle[k],
              gradient[0][k] * -stress[0] + gradient[1][k] * -stress[1] + gradient[2][k] * -stress[2]);
  }
  Eigen::Matrix2d sigma;
  sigma << stress[0], stress[2], stress[2], stress[1];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(sigma);
  const Eigen::Matrix2d tension =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t l = 0; l < 3; ++l) {
      for (int r = 0; r < 3; ++r)
        for (int s = 0; s < 3; ++s)
          add_block(m.particle[k], m.particle[l], gradient[r][k], gradient[s][l], m.stiffness[r][s]);
      double geometric = 0;
      for (int r = 0; r < 2; ++r)
        for (int s = 0; s < 2; ++s) geometric += tension(r, s) * m.b[r][k] * m.b[s][l];
      add_diagonal(m.particle[k], m.particle[l], geometric);
    }
  return energy;
}

double Equilibrium::add(const Bending& b) {
  Vec3d v{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(b.count); ++k) v += x_[b.particle[k]] * b.c[k];
  for (std::size_t k = 0; k < static_cast<std::size_t>(b.count); ++k) {
    add_force(b.particle[k], v * (-b.stiffness * b.c[k]));
    for (std::size_t l = 0; l < static_cast<std::size_t>(b.count); ++l)
      add_diagonal(b.particle[k], b.particle[l], b.stiffness * b.c[k] * b.c[l]);
  }
  return 0.5 * b.stiffness * dot(v, v);
}

// Fills the forces, and the entries of the matrix if asked.
double Equilibrium::energy(bool with_matrix) {
  with_matrix_ = with_matrix;
  force_.assign(x_.size(), {});
  matrix_->entries.clear();
  double sum = 0;
  for (const Spring& spring : springs_) sum += add(spring);
  for (const Membrane& membrane : membranes_) sum += add(membrane);
  for (const Bending& bending : bendings_) sum += add(bending);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (same_as_[i] != i) continue;
    force_[i].y -= mass_[i] * gravity;
    sum += mass_[i] * gravity * x_[i].y;
  }
  return sum;
}

void Equilibrium::number_unknowns() {
  unknown_.assign(x_.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < x_.size(); ++i)
    if (!pinned_[i] && same_as_[i] == i) unknown_[i] = next, next += dimensions_;
}

double Equilibrium::solve() {
  number_unknowns();
  double weight = 0;
  int unknowns = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (same_as_[i] == i) weight += mass_[i] * gravity;
    if (unknown_[i] >= 0) unknowns = std::max(unknowns, unknown_[i] + dimensions_);
  }
  double tau = 0.01, unbalanced = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double before = energy(true);
    Eigen::VectorXd b(unknowns);
    unbalanced = 0;
    for (std::uint32_t i = 0; i < x_.size(); ++i) {
      if (unknown_[i] < 0) continue;
      for (int d = 0; d < dimensions_; ++d) b[unknown_[i] + d] = force_[i][d];
      const double square = dot(force_[i], force_[i]) - (dimensions_ == 2 ? force_[i].z * force_[i].z : 0);
      unbalanced = std::max(unbalanced, std::sqrt(square) / weight);
      with_matrix_ = true, add_diagonal(i, i, mass_[i] / (tau * tau));
    }
    if (unbalanced < 1e-9) break;
    matrix_->sum.resize(unknowns, unknowns);
    matrix_->sum.setFromTriplets(matrix_->entries.begin(), matrix_->entries.end());
    if (!matrix_->analyzed) matrix_->factors.analyzePattern(matrix_->sum), matrix_->analyzed = true;
    matrix_->factors.factorize(matrix_->sum);
    const Eigen::VectorXd step = matrix_->factors.solve(b);
    const std::vector<Vec3d> start = x_;
    double part = 1;
    for (int halving = 0; halving < 30; ++halving, part /= 2) {
      for (std::size_t i = 0; i < x_.size(); ++i)
        for (int d = 0; d < dimensions_ && unknown_[i] >= 0; ++d)
          x_[i][d] = start[i][d] + part * step[unknown_[i] + d];
      for (std::size_t i = 0; i < x_.size(); ++i)
        if (same_as_[i] != i) x_[i] = x_[same_as_[i]];
      if (energy(false) <= before) break;
    }
    tau = part == 1 ? tau * 3 : std::max(tau / 3, 1e-4);
  }
  return unbalanced;
}

}  // namespace souple
