#pragma once

#include "souple/math/mat3.h"
#include "souple/objects/objects_view.h"
#include "souple/solver/external_moves.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

// How far the forces of an object are out of balance after the last solve of a step.
//
// A solve moves particle i from x* to x: its elastic constraints applied the force f_i = m_i (x_i - x*_i) / h^2. Motion
// by contacts, attachments and shape matching is excluded. If the solve has converged, that is the force of the
// deformation,
//
//   f_i = e_i = -sum_j grad_i C_j alpha_j^-1 C_j
//
// Sweeps that have not converged carry the load as well, but leave deformations whose e_i is far larger. The value
// e_i - f_i of single particles says little: the last thousandth of a percent of strain of a stiff cloth outweighs it.
// So both are compared by their virials. A virial tests the balance against affine motions about the center c of the
// pinned particles, which leave pinned particles in place. Without pinned particles c is the center of all:
//
//   E = sum_i e_i u_i^T,   F = sum_i f_i u_i^T,   u_i = x_i - c, 0 for pinned particles        [J]
//
//   unbalanced = |E - F| / (|E| + |F| + sum_i m_i |g| |u_i|)
//   stretch    = |E - F| / K,   K = sum_j (grad C_j . u) alpha_j^-1 (grad C_j . u)
//
// K is the stiffness against a uniform stretch of the object. `stretch` is the strain that restores the balance along
// that motion, by a step of Newton's method. In equilibrium both are 0, at rest and in motion, however soft the
// material. Sums are estimated from about 1,000 particles of an object and as many constraints of each kind. Each
// object is measured every sixteenth step, so this takes at most about a hundredth of a step's time.
//
// An object has not converged if the material does not explain its shape and the difference is visible. The limits are
// `unbalanced` above 0.25 and `stretch` above 0.3 % in two successive measurements. Soft bodies have the limit 0.01 %,
// because bending amplifies the strain. An impact is over before the second.

namespace souple {

class Balance {
 public:
  /// Chooses particles and constraints. Call after constraints changed.
  void choose(const ObjectsView& objects, std::span<Projector* const> constraints);
  /// Call before the last solve of a step. The substep must then record external moves.
  void begin(std::uint64_t step, const ParticleView& view);
  ExternalMoves& external() { return external_; }
  /// Call after that solve: brings Object::imbalance of some objects up to date. `gravity`: its magnitude [m/s^2].
  void measure(const ObjectsView& objects, double gravity, const Substep& substep);
  std::size_t object_count() const { return objects_.size(); }
  /// Index of the k-th object that is measured.
  std::uint32_t object(std::size_t k) const { return objects_[k].index; }
  /// The most stretched object that has not converged: k of `object`; none if all have converged.
  std::optional<std::size_t> worst(const ObjectsView& objects) const;

 private:
  /// Elements of an object, from a list.
  struct Samples {
    std::uint32_t object = 0;          ///< index in objects_
    std::uint32_t begin = 0, end = 0;  ///< range in the list
    double weight = 0;                 ///< number of elements that each of them represents
  };
  /// Constraints of a projector.
  struct Set {
    const LinearFacet* linear = nullptr;
    std::vector<std::uint32_t> constraints;
    std::vector<Samples> samples;
  };
  /// Particles and constraints that one of `period` steps measures.
  struct Part {
    std::vector<std::uint32_t> particles;
    std::vector<Samples> samples;  ///< of the particles
    std::vector<Set> sets;
  };
  struct Measured {
    std::uint32_t index = 0;         ///< in ObjectsView::objects
    Mat3d elastic, carried;          ///< E, F [J]
    double stiffness = 0, load = 0;  ///< K, sum_i m_i |g| |u_i| [J]
    Vec3d center;                    ///< c [m]
  };

  void choose_constraints(const ObjectsView& objects, Projector& projector);
  Vec3d center_of(const ObjectsView& objects, const Samples& samples) const;
  void add_carried(const ObjectsView& objects, double gravity, double h);
  void add_elastic(const ParticleView& view, const Substep& substep, const Set& set);

  static constexpr std::size_t period = 16;  // steps
  std::array<Part, period> parts_;
  std::size_t part_ = 0;  // of this step
  std::vector<Measured> objects_;
  std::vector<const Projector*> elastic_;
  std::vector<Vec3f> start_;  // of the particles of the part, before the solve [m]
  ExternalMoves external_;
};

}  // namespace souple
