#pragma once

#include "souple/math/mat3.h"
#include "souple/solver/facets.h"
#include "souple/solver/particle_groups.h"
#include "souple/solver/scalar_projection.h"
#include "souple/solver/stacks.h"

namespace souple {

struct ShapeMatchingOptions {
  /// Beta in [0, 1]: 0 rigid; towards 1 the best-fit linear map, scaled to the rest volume.
  float linear = 0;
  float compliance = 0;    ///< of the whole region [m/N], see ShapeMatching
  float damping_time = 0;  ///< s
  float stiffness = 1;     ///< PBD mode only: k in [0, 1]
};

/// Pulls regions of particles towards their best-fit rest shape. Müller et al. 2005, "Meshless deformations
/// based on shape matching", sections 3.3 to 4.2.
///
///   c = sum m x / M,  A_pq = sum m (x - c) q^T,  A_qq = sum m q q^T  (q: rest positions about their center)
///   R = polar(A_pq),  A = A_pq A_qq^-1,  T = beta A / det(A)^(1/3) + (1 - beta) R,  g = c + T q
///   C = sqrt(sum m |x - g|^2 / M)  [m]
///
/// C is the mass-weighted root mean square distance from the goals g. So the energy C^2 / (2 alpha) gives alpha the
/// unit m/N, and 1/alpha is the stiffness of the region as a whole. As T is optimal,
///   grad_i C = m_i (x_i - g_i) / (M C) and sum w |grad C|^2 = 1/M:
/// with alpha = 0 a projection moves the particles onto their goals. Linear and angular momentum are kept,
/// for any beta and compliance.
///
/// Deviations for robustness: a flat or straight rest shape has no A in the directions that it lacks. There A
/// is R, and its area (or length) is kept instead of its volume. When det A falls below 0.1 (crushed or
/// inverted), beta fades to 0 with it: the region recovers as a rigid one.
///
/// A pinned particle (inverse mass 0) counts as ten thousand times the mass of the free particles, so that
/// the region follows its pins. C and M include the free particles only.
///
/// Sums are in double and relative to the region's first particle. Regions may overlap.
class ShapeMatching final : public GroupProjector, public MemoryFacet {
 public:
  /// `rest` holds the rest positions of `particles`, in the same order, anywhere in space [m]. Throws Error
  /// when the counts differ, a particle appears twice, or a number is out of range. `prepare` must follow
  /// before the next substep.
  void add(std::span<const std::uint32_t> particles, std::span<const Vec3d> rest,
           const ShapeMatchingOptions& options = {});

  std::string_view kind() const override { return "shape_matching"; }
  Facets facets() override { return {.elastic = this, .memory = this}; }
  void prepare_sweeps(const ParticleView& particles, bool masses_changed) override;
  int sweeps_needed(const Substep& substep) const override;
  int sweeps_needed(const Substep& substep, std::span<const IndexRange> particles) const override;
  /// Must run before `project`: it updates changed masses.
  void begin_substep(const ParticleView& particles, const Substep& substep) override;
  Residual residual(const ParticleView& particles, Threads* = nullptr) const override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  std::size_t bytes() const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  struct Region {
    std::vector<Vec3d> rest;          // per particle: rest position relative to the first particle [m]
    std::vector<float> inverse_mass;  // per particle: input of the masses below [1/kg]
    std::vector<double> mass;         // per particle: pinned ones are heavy [kg]
    double total_mass = 0, free_mass = 0;
    Vec3d center;        // center of mass of `rest`
    Mat3d rest_inverse;  // pseudo-inverse of A_qq
    Mat3d missing;       // projection onto the directions the rest shape lacks
    int dimensions = 0;  // number of directions with extent
    double linear = 0;
    ScalarSettings settings;
    double multiplier = 0;
  };
  struct Pose {
    Vec3d center;  // relative to the region's first particle
    Mat3d transform;
  };

  struct RigidMotion {
    Vec3d center;  // relative to the region's first particle, in the middle of the substep
    Vec3d velocity, spin;
  };

  void find_stacks(const ParticleView& particles);
  static void update_masses(Region& region, std::span<const std::uint32_t> group,
                            const ParticleView& particles);
  static Pose fit(const Region& region, std::span<const std::uint32_t> group, const ParticleView& particles);
  static Vec3d to_goal(const Region& region, std::span<const std::uint32_t> group,
                       const ParticleView& particles, const Pose& pose, std::size_t k);
  static double distance_squared(const Region& region, std::span<const std::uint32_t> group,
                                 const ParticleView& particles, const Pose& pose);
  /// C of region i, 0 when all its particles are pinned. [m]
  double distance(std::size_t i, const ParticleView& particles) const;
  void project_one(std::size_t i, const ParticleView& particles, const Substep& substep) override;
  static RigidMotion rigid_motion(const Region& region, std::span<const std::uint32_t> group,
                                  const ParticleView& particles, std::span<const Vec4f> velocity, double h);
  void damp_one(std::size_t i, const ParticleView& particles, std::span<Vec4f> velocity,
                const Substep& substep) override;

  /// `for_each(f)` calls f(i) for the regions that count.
  template <class ForEach>
  int sweeps_of(const Substep& substep, const ForEach& for_each) const;

  std::vector<std::uint32_t> by_particle_;  // regions, by their first particle
  mutable Stacks stacks_;
  mutable std::vector<Region> regions_;  // `residual` updates values that depend on the masses
};

}  // namespace souple
