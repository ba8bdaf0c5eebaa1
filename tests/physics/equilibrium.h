#pragma once

#include "souple/geometry/triangle_mesh.h"
#include "souple/objects/materials.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace souple {

/// The discrete model of a hanging cloth or rope in static equilibrium, in double precision: the reference that
/// the default solver is compared with. It has the energies of souple/world/build.cpp: springs, membranes, isometric
/// bending and the bending of ropes.
///
///   minimize   E(x) = sum_j 1/2 C_j^T alpha_j^-1 C_j - sum_i m_i g . x_i
///
/// by Newton's method on an energy whose second derivatives are made positive: compressed springs have no transverse
/// stiffness. The masses over the square of a growing pseudo time step are added to the matrix, and steps are halved
/// until the energy decreases.
class Equilibrium {
 public:
  /// `dimensions` 2: particles stay in the plane z = 0, and bending is ignored.
  explicit Equilibrium(int dimensions = 3);
  ~Equilibrium();

  /// Adds particles; the index of the first.
  std::uint32_t add_cloth(const TriangleMesh& mesh, const ClothMaterial& material);
  std::uint32_t add_rope(std::span<const Vec3d> points, const RopeMaterial& material);
  /// Makes one particle of two: b moves as a.
  void tie(std::uint32_t a, std::uint32_t b);
  void pin(std::span<const std::uint32_t> particles);
  /// Positions to start from.
  void set_positions(std::span<const Vec3f> positions);

  /// Largest force out of balance at the end, relative to the weight.
  double solve();
  std::span<const Vec3d> positions() const { return x_; }

 private:
  struct Spring {
    std::array<std::uint32_t, 2> particle;
    double length, stiffness;
  };
  struct Membrane {
    std::array<std::uint32_t, 3> particle;
    double b[2][3];          // f_u = sum_k b[0][k] x_k, f_v = sum_k b[1][k] x_k
    double stiffness[3][3];  // times area
  };
  struct Bending {  // 1/2 stiffness |sum_k c_k x_k|^2
    int count;
    std::array<std::uint32_t, 4> particle;
    std::array<double, 4> c;
    double stiffness;
  };
  struct Matrix;

  double add(const Spring& spring);
  double add(const Membrane& membrane);
  double add(const Bending& bending);
  void add_force(std::uint32_t i, const Vec3d& force);
  void add_block(std::uint32_t i, std::uint32_t j, const Vec3d& column, const Vec3d& row, double factor);
  void add_diagonal(std::uint32_t i, std::uint32_t j, double factor);
  double energy(bool with_matrix);
  void number_unknowns();

  int dimensions_;
  bool with_matrix_ = false;
  std::vector<Vec3d> x_, force_;
  std::vector<double> mass_;
  std::vector<bool> pinned_;
  std::vector<std::uint32_t> same_as_;  // per particle: the particle that it is tied to, or itself
  std::vector<int> unknown_;            // per particle: its first unknown, -1 if it is pinned
  std::vector<Spring> springs_;
  std::vector<Membrane> membranes_;
  std::vector<Bending> bendings_;
  std::unique_ptr<Matrix> matrix_;
};

}  // namespace souple
