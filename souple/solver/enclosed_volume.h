#pragma once

#include "souple/math/vec3.h"
#include "souple/solver/facets.h"
#include "souple/solver/particle_groups.h"
#include "souple/solver/scalar_projection.h"

#include <array>

namespace souple {

struct EnclosedVolumeOptions {
  float pressure = 0;        ///< relative to the surroundings [Pa]; negative: inward
  bool keep_volume = false;  ///< whether the volume constraint is active too
  /// The "pressure" p of Müller's C = V - p V0: target volume over rest volume.
  float volume_factor = 1;
  float compliance = 0;  ///< alpha = dV / dP [m^3/Pa = m^6/J]; for a gas or liquid of bulk modulus K, V0 / K
  float damping_time = 0;  ///< s
  float stiffness = 1;     ///< PBD mode only: k in [0, 1]
};

/// Closed triangle surfaces with a volume constraint, a pressure, or both.
///
/// The volume, Müller et al. 2007, section 4.4, with the 1/6 that makes V a volume:
///   C = V - p V0  [m^3],   V = 1/6 sum x0 . (x1 x x2) over the triangles,
///   grad_i V = 1/6 sum (x1 - x0) x (x2 - x0) over the triangles at i.
/// Energy C^2 / (2 alpha). One projection moves no particle farther than a quarter of the radius of a ball of volume p
/// V0. A collapsed surface has almost no gradient, and unlimited corrections would make it explode.
///
/// The pressure is the linear energy -P V, that is C = V with a known multiplier, lambda = P h^2:
///   dx_i = w_i h^2 P grad_i V
/// This is the force P times a third of the area on each corner of each triangle. `begin_substep` applies it
/// once per substep to the predicted positions. So the number of iterations, mode, compliance and stiffness
/// do not affect it.
class EnclosedVolume final : public GroupProjector, public MemoryFacet {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// A vertex that is no particle, but the mean of those around a hole: a fan of triangles about it closes the hole. Its
  /// number is of no vertex else. The hole's cover passes the pressure on to its rim.
  struct Mean {
    std::uint32_t vertex;
    std::vector<std::uint32_t> of;
  };

  /// Adds a surface over particles and `means` of them. `rest_volume` in m^3, signed by the winding: a negative volume
  /// flips all triangles. Throws Error when the surface is not closed or not consistently wound, or a number is out of
  /// range. `prepare` must follow before the next substep.
  void add(std::span<const Triangle> triangles, double rest_volume, const EnclosedVolumeOptions& options = {},
           std::span<const Mean> means = {});

  std::string_view kind() const override { return "enclosed_volume"; }
  Facets facets() override { return {.elastic = this, .memory = this}; }
  /// Applies the pressure. Must run after positions have been predicted.
  void begin_substep(const ParticleView& particles, const Substep& substep) override;
  /// Residual of the surfaces with an active volume constraint [m^3].
  Residual residual(const ParticleView& particles, Threads* = nullptr) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

  /// The volume of surface i, in the order in which surfaces were added [m^3].
  double volume(std::size_t i, const ParticleView& particles) const;

 private:
  struct Surface {
    std::vector<Triangle>
        triangles;            // counter-clockwise from outside; indices into the group, then the means
    std::vector<Mean> means;  // indices likewise
    double target_volume = 0;
    double pressure = 0;
    bool keep_volume = false;
    ScalarSettings settings;
    double multiplier = 0;
    std::vector<Vec3d> position, gradient;  // scratch, per vertex
  };

  static double measure(Surface& surface, std::span<const std::uint32_t> group,
                        const ParticleView& particles);
  double limit_of(std::size_t i, double factor, const ParticleView& particles) const;
  void move(std::size_t i, double factor, const ParticleView& particles) const;
  void project_one(std::size_t i, const ParticleView& particles, const Substep& substep) override;
  void damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                const Substep& substep) override;

  mutable std::vector<Surface> surfaces_;  // `residual` and `volume` write the scratch arrays
};

}  // namespace souple
