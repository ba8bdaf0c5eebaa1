#pragma once

#include "souple/solver/set_projector.h"
#include "tests/constraints/examples.h"

#include <cmath>
#include <vector>

// A simulation loop of a dozen lines, which tests a constraint kind without a World.

namespace souple {

/// Particles with constraints of one kind, simulated as in a world (state/particles.h).
template <class Kind>
class SmallBody {
 public:
  SetProjector<Kind> projector;
  Vec3f gravity{};

  void add_particle(const Vec3d& x, double mass, bool pinned = false) {
    const Vec3f at(x);
    position_.push_back({at.x, at.y, at.z, pinned ? 0.0f : static_cast<float>(1 / mass)});
    offset_.push_back({});
    velocity_.push_back({});
    mass_.push_back(mass);
  }
  /// Adds mass to a particle. Elements add their mass to their particles.
  void add_mass(std::size_t i, double mass) {
    mass_[i] += mass;
    position_[i].w = static_cast<float>(1 / mass_[i]);
  }

  std::size_t size() const { return position_.size(); }
  double mass(std::size_t i) const { return mass_[i]; }
  Vec3d at(std::size_t i) const { return Vec3d(position_[i].xyz()) + Vec3d(offset_[i].xyz()); }
  Vec3d velocity(std::size_t i) const { return Vec3d(velocity_[i].xyz()); }
  void move_to(std::size_t i, const Vec3d& x) { position_[i].set_xyz(Vec3f(x)), offset_[i] = {}; }
  void set_velocity(std::size_t i, const Vec3d& v) { velocity_[i].set_xyz(Vec3f(v)); }
  void pin(std::size_t i) { position_[i].w = 0; }

  void step(float dt, int substeps, int iterations, Mode mode) {
    projector.prepare(size());
    const Substep substep{.h = dt / static_cast<float>(substeps), .iterations = iterations, .mode = mode};
    for (int s = 0; s < substeps; ++s) advance(substep);
  }

  double kinetic_energy() const {
    double energy = 0;
    for (std::size_t i = 0; i < size(); ++i) energy += 0.5 * mass_[i] * length_squared(velocity(i));
    return energy;
  }

 private:
  void advance(const Substep& substep) {
    start_ = offset_;
    for (std::size_t i = 0; i < size(); ++i)
      if (position_[i].w > 0)
        offset_[i].set_xyz(offset_[i].xyz() + (velocity_[i].xyz() + gravity * substep.h) * substep.h);
    const ParticleView view{position_, offset_, start_};
    projector.begin_substep(view, substep);
    for (int k = 0; k < substep.iterations; ++k)
      for (int c = 0; c < projector.color_count(); ++c) projector.project(c, view, substep);
    for (std::size_t i = 0; i < size(); ++i) {
      velocity_[i].set_xyz((offset_[i].xyz() - start_[i].xyz()) / substep.h);
      const Vec3f x = position_[i].xyz() + offset_[i].xyz();
      offset_[i].set_xyz(offset_[i].xyz() - (x - position_[i].xyz()));
      position_[i].set_xyz(x);
    }
  }

  std::vector<Vec4f> position_, offset_, start_, velocity_;
  std::vector<double> mass_;
};

/// Material of a soft body; SI units.
struct SoftMaterial {
  double young_modulus = 1e5, poisson_ratio = 0.3, density = 1000;
};

inline double tet_volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(b - a, cross(c - a, d - a)) / 6;
}

/// Connects four particles by a neo-Hookean tet at rest in their current positions; adds its mass to them.
inline void add_tet(SmallBody<NeoHookean>& body, const std::array<std::uint32_t, 4>& tet,
                    const SoftMaterial& material) {
  const Vec3d x[4] = {body.at(tet[0]), body.at(tet[1]), body.at(tet[2]), body.at(tet[3])};
  const double volume = tet_volume(x[0], x[1], x[2], x[3]);
  for (const std::uint32_t i : tet) body.add_mass(i, material.density * volume / 4);
  body.projector.add(tet, NeoHookean::from_rest(x),
                     NeoHookean::compliance(material.young_modulus, material.poisson_ratio, volume));
}

/// One tet of about this size [m].
inline SmallBody<NeoHookean> single_tet(double size, const SoftMaterial& material) {
  SmallBody<NeoHookean> body;
  for (const Vec3d& x : TetExample::points()) body.add_particle(x * size, 0);
  add_tet(body, {0, 1, 2, 3}, material);
  return body;
}

/// A bar of nx x ny x nz cubes of five tets each, mirrored from cube to cube so that faces match. Particle at
/// corner (i, j, k): (i (ny + 1) + j) (nz + 1) + k.
inline SmallBody<NeoHookean> tet_bar(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, double cell,
                                     const SoftMaterial& material) {
  SmallBody<NeoHookean> body;
  for (std::uint32_t i = 0; i <= nx; ++i)
    for (std::uint32_t j = 0; j <= ny; ++j)
      for (std::uint32_t k = 0; k <= nz; ++k) body.add_particle(Vec3d(i, j, k) * cell, 0);
  for (std::uint32_t i = 0; i < nx; ++i)
    for (std::uint32_t j = 0; j < ny; ++j)
      for (std::uint32_t k = 0; k < nz; ++k) {
        const bool odd = (i + j + k) % 2 == 1;
        const auto corner = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
          return ((i + (odd ? 1 - a : a)) * (ny + 1) + j + b) * (nz + 1) + k + c;
        };
        const std::array<std::array<std::uint32_t, 4>, 5> tets{
            {{corner(0, 0, 0), corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1)},
             {corner(1, 1, 0), corner(0, 1, 0), corner(1, 0, 0), corner(1, 1, 1)},
             {corner(1, 0, 1), corner(0, 0, 1), corner(1, 1, 1), corner(1, 0, 0)},
             {corner(0, 1, 1), corner(1, 1, 1), corner(0, 0, 1), corner(0, 1, 0)},
             {corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1), corner(1, 1, 1)}}};
        for (std::array<std::uint32_t, 4> tet : tets) {
          if (odd) std::swap(tet[2], tet[3]);
          add_tet(body, tet, material);
        }
      }
  return body;
}

/// det F of every tet: its volume over its rest volume.
inline std::vector<double> volume_ratios(const SmallBody<NeoHookean>& body) {
  std::vector<double> ratios;
  const auto& set = body.projector.set();
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto tet = set.indices(i);
    const double volume = tet_volume(body.at(tet[0]), body.at(tet[1]), body.at(tet[2]), body.at(tet[3]));
    ratios.push_back(6 * volume * determinant(Mat3d(set.params(i).rest_inverse)));
  }
  return ratios;
}

/// Largest |J - 1| of all tets.
inline double worst_volume_error(const SmallBody<NeoHookean>& body) {
  double worst = 0;
  for (const double ratio : volume_ratios(body)) {
    if (!std::isfinite(ratio)) return HUGE_VAL;
    worst = std::fmax(worst, std::fabs(ratio - 1));
  }
  return worst;
}

}  // namespace souple
