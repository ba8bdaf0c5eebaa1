#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/objects/materials.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

// Elasticity by forces, in double precision: mass-springs and linear finite elements, with the energies of
// souple/world/build.cpp. Position-based dynamics is compared with it; the library does not use it.

namespace souple::benchmarks {

enum class Method {
  explicit_euler,    ///< x' = x + h v,   v' = v + h M^-1 f(x)
  semi_implicit,     ///< v' = v + h M^-1 f(x),   x' = x + h v'
  implicit_euler,    ///< v' = v + h M^-1 f(x'),   x' = x + h v'
  implicit_midpoint  ///< an implicit Euler step of h/2 to v_m, then x' = x + h v_m,   v' = 2 v_m - v
};

/// Particles with springs and tets.
class ElasticModel {
 public:
  /// A spring along each edge, k = Y (A0 + A1) / l^2, as cloth of StretchModel::springs without bending.
  ElasticModel(const TriangleMesh& mesh, const ClothMaterial& material);
  /// Linear tets of a stable neo-Hookean solid (Smith et al. 2018, with the constants of neo_hookean.h):
  ///   V (mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2)
  ElasticModel(const TetMesh& mesh, const SoftBodyMaterial& material);
  ElasticModel(const ElasticModel&) = delete;
  ElasticModel& operator=(const ElasticModel&) = delete;
  ~ElasticModel();

  /// Call before the first step.
  void pin(std::span<const std::uint32_t> particles);

  /// Implicit methods take one Newton step (Baraff and Witkin 1998), from x + h v, by a sparse factorization.
  void step(Method method, double h);

  double elastic_energy() const;
  double kinetic_energy() const;
  double potential_energy() const;  ///< of gravity
  double energy() const { return elastic_energy() + kinetic_energy() + potential_energy(); }
  /// Whether all positions are finite and within 1 km.
  bool is_finite() const;

  std::vector<Vec3d> x, v;  ///< m, m/s
  Vec3d gravity{0, -9.81, 0};

 private:
  struct Spring {
    std::array<std::uint32_t, 2> particle;
    double length, stiffness;
  };
  struct Tet {
    std::array<std::uint32_t, 4> particle;
    double b[4][3];     // F = sum_k x_k b[k]^T  [1/m]
    double mu, lambda;  // times rest volume [J]
  };
  struct System;

  void find_forces();
  void find_matrix(double factor);
  void implicit_step(double h);
  template <std::size_t n, class Block>
  void add_blocks(const std::array<std::uint32_t, n>& particle, const Block& block);

  std::vector<double> mass_;
  std::vector<bool> pinned_;
  std::vector<Vec3d> force_, before_;
  std::vector<Spring> springs_;
  std::vector<Tet> tets_;
  std::unique_ptr<System> system_;
};

}  // namespace souple::benchmarks
