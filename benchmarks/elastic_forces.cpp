#include "benchmarks/elastic_forces.h"

#include "souple/geometry/adjacency.h"
#include "souple/math/mat3.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Sparse>

namespace souple::benchmarks {

/// (M + h^2 K) dv = rhs of the free particles.
struct ElasticModel::System {
  Eigen::SparseMatrix<double> matrix;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd rhs;
  std::vector<int> unknown;  // per particle: its first unknown, -1 if it is pinned
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt;

  explicit System(const std::vector<bool>& pinned) {
    int count = 0;
    for (const bool is_pinned : pinned) {
      unknown.push_back(is_pinned ? -1 : count);
      if (!is_pinned) count += 3;
    }
    matrix.resize(count, count);
    rhs.resize(count);
  }
};

ElasticModel::ElasticModel(const TriangleMesh& mesh, const ClothMaterial& material)
    : x(mesh.positions), v(mesh.positions.size()), mass_(mesh.positions.size()) {
  const TriangleEdges edges = triangle_edges(mesh.triangles);
  std::vector<double> area(edges.edges.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const double A = 0.5 * length(cross(x[b] - x[a], x[c] - x[a]));
    for (const std::uint32_t edge : edges.of_triangle[t])
      if (edge != TriangleEdges::no_edge) area[edge] += A;
    for (const std::uint32_t i : mesh.triangles[t])
      mass_[i] += static_cast<double>(material.areal_density) * A / 3;
  }
  for (std::size_t e = 0; e < edges.edges.size(); ++e) {
    const Edge& edge = edges.edges[e];
    const double l = length(x[edge[0]] - x[edge[1]]);
    const auto Y = static_cast<double>(material.membrane_stiffness);
    springs_.push_back({{edge[0], edge[1]}, l, Y * area[e] / (l * l)});
  }
  pinned_.resize(x.size()), force_.resize(x.size());
}

ElasticModel::ElasticModel(const TetMesh& mesh, const SoftBodyMaterial& material)
    : x(mesh.positions), v(mesh.positions.size()), mass_(mesh.positions.size()) {
  const auto E = static_cast<double>(material.young_modulus),
             nu = static_cast<double>(material.poisson_ratio);
  const double mu = E / (2 * (1 + nu)), lambda = 2 * mu * nu / (1 - 2 * nu);
  for (const auto& tet : mesh.tets) {
    const Mat3d edges{x[tet[1]] - x[tet[0]], x[tet[2]] - x[tet[0]], x[tet[3]] - x[tet[0]]};
    const double V = determinant(edges) / 6;
    const Mat3d B = inverse(edges);
    Tet one{tet, {}, V * mu, V * lambda};
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) one.b[k + 1][axis] = B(k, axis);
      one.b[0][axis] = -B(0, axis) - B(1, axis) - B(2, axis);
    }
    tets_.push_back(one);
    for (const std::uint32_t i : tet) mass_[i] += static_cast<double>(material.density) * V / 4;
  }
  pinned_.resize(x.size()), force_.resize(x.size());
}

ElasticModel::~ElasticModel() = default;

void ElasticModel::pin(std::span<const std::uint32_t> particles) {
  for (const std::uint32_t i : particles) pinned_[i] = true;
}

bool ElasticModel::is_finite() const {
  return std::all_of(x.begin(), x.end(), [](const Vec3d& p) { return length_squared(p) < 1e6; });
}

// --- energies and forces

namespace {

struct Strain {
  Mat3d F, cof;
  double J;
};

template <class Tet>
Strain strain_of(const Tet& tet, std::span<const Vec3d> x) {
  Strain s;
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k)
      s.F.column[axis] += x[tet.particle[static_cast<std::size_t>(k)]] * tet.b[k][axis];
  s.cof = cofactor(s.F);
  s.J = dot(s.F.column[0], s.cof.column[0]);
  return s;
}

Vec3d vector(const double (&b)[3]) {
  return {b[0], b[1], b[2]};
}

}  // namespace

double ElasticModel::elastic_energy() const {
  double sum = 0;
  for (const Spring& spring : springs_) {
    const double C = length(x[spring.particle[0]] - x[spring.particle[1]]) - spring.length;
    sum += 0.5 * spring.stiffness * C * C;
  }
  for (const Tet& tet : tets_) {
    const Strain s = strain_of(tet, x);
    const double j = s.J - 1;
    sum += 0.5 * tet.mu * (frobenius_squared(s.F) - 3) - tet.mu * j + 0.5 * (tet.lambda + tet.mu) * j * j;
  }
  return sum;
}

double ElasticModel::kinetic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += 0.5 * mass_[i] * length_squared(v[i]);
  return sum;
}

double ElasticModel::potential_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!pinned_[i]) sum -= mass_[i] * dot(gravity, x[i]);
  return sum;
}

void ElasticModel::find_forces() {
  for (std::size_t i = 0; i < x.size(); ++i) force_[i] = gravity * mass_[i];
  for (const Spring& spring : springs_) {
    const auto [a, b] = spring.particle;
    const Vec3d d = x[a] - x[b];
    const double l = length(d);
    const Vec3d f = d * (spring.stiffness * (spring.length - l) / l);
    force_[a] += f, force_[b] -= f;
  }
  for (const Tet& tet : tets_) {
    const Strain s = strain_of(tet, x);
    const Mat3d P = s.F * tet.mu + s.cof * ((tet.lambda + tet.mu) * (s.J - 1) - tet.mu);
    for (std::size_t k = 0; k < 4; ++k) force_[tet.particle[k]] -= P * vector(tet.b[k]);
  }
}

// --- integrators

void ElasticModel::step(Method method, double h) {
  if (method == Method::implicit_euler || method == Method::implicit_midpoint) {
    const bool midpoint = method == Method::implicit_midpoint;
    const double part = midpoint ? h / 2 : h;
    before_ = v;
    implicit_step(part);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (pinned_[i]) continue;
      x[i] += v[i] * h;
      if (midpoint) v[i] = v[i] * 2 - before_[i];
    }
    return;
  }
  find_forces();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (pinned_[i]) continue;
    const Vec3d a = force_[i] / mass_[i];
    if (method == Method::explicit_euler) x[i] += v[i] * h;
    v[i] += a * h;
    if (method == Method::semi_implicit) x[i] += v[i] * h;
  }
}

// Finds v' = v + h M^-1 f(x + h v') by one Newton step from v' = v; leaves x.
//   (M + h^2 K) (v' - v) = h f(x + h v)
void ElasticModel::implicit_step(double h) {
  const bool is_first = !system_;
  if (is_first) system_ = std::make_unique<System>(pinned_);
  System& system = *system_;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!pinned_[i]) x[i] += v[i] * h;
  find_forces();
  find_matrix(h * h);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (int k = 0; system.unknown[i] >= 0 && k < 3; ++k)
      system.rhs[system.unknown[i] + k] = force_[i][k] * h;
  if (is_first) system.ldlt.analyzePattern(system.matrix);
  system.ldlt.factorize(system.matrix);
  const Eigen::VectorXd change = system.ldlt.solve(system.rhs);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int u = system.unknown[i];
    if (u < 0) continue;
    x[i] -= v[i] * h;
    v[i] += {change[u], change[u + 1], change[u + 2]};
  }
}

// --- matrix

/// block(a, b): the second derivative of the element's energy by its particles a and b.
template <std::size_t n, class Block>
void ElasticModel::add_blocks(const std::array<std::uint32_t, n>& particle, const Block& block) {
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const int i = system_->unknown[particle[a]], j = system_->unknown[particle[b]];
      if (i < 0 || j < 0) continue;
      const Mat3d m = block(a, b);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) system_->entries.emplace_back(i + r, j + c, m(r, c));
    }
}

// M and `factor` times the second derivative K. That of a compressed spring across its direction is left out: it is
// negative (Choi and Ko 2002).
void ElasticModel::find_matrix(double factor) {
  system_->entries.clear();
  for (const Spring& spring : springs_) {
    const Vec3d d = x[spring.particle[0]] - x[spring.particle[1]];
    const double l = length(d), across = std::max(0.0, 1 - spring.length / l);
    const Mat3d along = outer(d, d) * (1 / (l * l));
    const Mat3d k = (along + (Mat3d::identity() - along) * across) * (factor * spring.stiffness);
    add_blocks(spring.particle, [&](std::size_t a, std::size_t b) { return a == b ? k : k * -1.0; });
  }
  for (const Tet& tet : tets_) {
    const Strain s = strain_of(tet, x);
    const double pressure = (tet.lambda + tet.mu) * (s.J - 1) - tet.mu;
    add_blocks(tet.particle, [&](std::size_t a, std::size_t b) {
      const Vec3d p = vector(tet.b[a]), q = vector(tet.b[b]), w = s.F * cross(p, q) * pressure;
      const double diagonal = tet.mu * dot(p, q);
      const Mat3d turned{{diagonal, -w.z, w.y}, {w.z, diagonal, -w.x}, {-w.y, w.x, diagonal}};  // u x w
      return (turned + outer(s.cof * p, s.cof * q) * (tet.lambda + tet.mu)) * factor;
    });
  }
  for (std::uint32_t i = 0; i < x.size(); ++i)
    add_blocks(std::array{i}, [&](std::size_t, std::size_t) { return Mat3d::identity() * mass_[i]; });
  system_->matrix.setFromTriplets(system_->entries.begin(), system_->entries.end());
}

}  // namespace souple::benchmarks
