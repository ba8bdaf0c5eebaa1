#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/fluid_view.h"
#include "souple/fluid/local_boundary.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/solver/projector.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Bodies below the resolution of a fluid. They are no walls: fluid particles cannot resolve a surface
/// smaller than themselves. Instead these bodies receive the forces on the fluid around them. By Archimedes'
/// principle, pressure pushes a body as it would push the fluid in the body's place. From the push m_i dx_i
/// of pressure on each nearby particle i in this substep, a body of volume V_b takes
///
///   T_ib = c_b phi_b V_b / V s_ib m_i dx_i / (1 + B_i),   s_ib = w_ib / sum_j w_jb
///   w = 1 - |x_i - x_b|^2 / R^2,   B_i = sum_b phi_b V_b / V s_ib
///
/// and i loses it, so momentum is conserved. i keeps dx_i / (1 + B_i), which in a fluid at rest supports its
/// own weight. So buoyancy equals the weight of the displaced fluid, whatever the arrangement and number of
/// particles around the body. phi_b, the submerged fraction of a body, is sum_i V w_ib over the integral of
/// w, including mirror images of particles behind walls. c_b limits the push on a light body to
/// max_push_ratio times the push on the fluid; in nature the added mass has this effect.
///
/// Drag is that of a ball or a cylinder, with u the mean velocity of the fluid around it relative to the
/// body:
///
///   ball      F = phi (6 pi mu r + rho / 2 C pi r^2 |u|) u,          C = 0.47
///   cylinder  across F = phi (4 pi mu l + rho C r l |u|) u, C = 1.2;
///             along C = 0.03 and half the viscous part
///
/// The reaction acts on nearby particles by s_ib, with the stability bound of body_friction.h.
///
/// Bodies leave a fluid the rest of the space, whatever its density there. So
///
///   e_i = sum_b V_b w_ib / integral of w over the space that walls leave
///
/// is added to the density C, but for what a sum over particles so far apart exceeds 1 - e_i by. Then the fluid's level
/// rises by the displaced volume.
class SubResolutionBodies {
 public:
  void set_bodies(std::vector<SubResolutionBody> bodies) { bodies_ = std::move(bodies); }
  bool none() const { return bodies_.empty(); }
  /// collides[fluid * objects + o]: whether a fluid collides with an object. `fluid`: the fluid of each
  /// particle.
  void begin_step(std::span<const std::uint8_t> collides, std::size_t objects,
                  std::span<const std::uint16_t> fluid, const Vec3d& origin) {
    collides_ = collides, objects_ = objects, fluid_ = fluid, origin_ = origin;
  }
  /// Finds nearby particles and submerged fractions: `x` by sorted index, `order` the particle of each sorted
  /// index.
  void find(std::span<const Vec4f> x, std::span<const std::uint32_t> order,
            const LocalBoundary& local_boundary, const Smoothing& smoothing, const ParticleView& particles,
            Threads& threads);
  /// The part of V sum W that bodies take from a particle.
  float displaced_density(std::size_t index) const;
  /// Transfers pressure pushes to bodies, after `moved` displaced the fluid; moves the world's particles.
  /// Returns, by sorted index, the push that each fluid particle loses [kg m].
  std::span<const Vec3f> apply_pressure(std::span<const Vec4f> x, std::span<const Vec3f> moved,
                                        const ParticleView& particles);
  /// Applies drag over h seconds, with the data of the last `find`; `viscosity` of each fluid [Pa s].
  /// `velocity` [m/s] and `inverse_mass` (w, [1/kg]) belong to the world's particles.
  void drag(const FluidView& fluid, std::span<const std::uint32_t> order, std::span<const float> viscosity,
            float h, std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass, Threads& threads);

 private:
  struct Near {
    std::uint32_t index;
    float share;  // s_ib
  };
  /// State of a body in this substep.
  struct State {
    std::uint32_t begin = 0, end = 0;  // range in its block's `near`
    float submerged = 0;               // submerged fraction phi
    float near_sum = 0, sum = 0;       // sum of w over particles; mirror images included
    Vec3f at{}, axis{};                // position from the origin [m]; unit axis, zero for a ball
    Vec3f pull{};                      // drag impulse [kg m/s]
    float across = 0, along = 0;       // drag coefficients [kg]
  };
  struct Block {
    std::vector<Near> near;
  };
  static constexpr std::size_t block_size = 64;
  static constexpr float max_solid = 0.7f;  // largest e_i: denser than any packing of balls

  std::span<const Near> near(std::size_t b) const {
    const State& state = states_[b];
    return {blocks_[b / block_size].near.data() + state.begin, state.end - state.begin};
  }
  template <class Function>
  void for_bodies(Threads& threads, const Function& f);
  void update_states(const ParticleView& particles);
  void find_near(std::size_t body, std::span<const Vec4f> x, std::span<const std::uint32_t> order,
                 const LocalBoundary& local_boundary, const Smoothing& smoothing);
  void find_drag(std::size_t body, const FluidView& fluid, std::span<const std::uint32_t> order,
                 std::span<const float> viscosity, float h, std::span<const Vec4f> velocity);

  std::vector<SubResolutionBody> bodies_;
  std::vector<State> states_;
  std::vector<Block> blocks_;
  std::span<const std::uint8_t> collides_;
  std::size_t objects_ = 0;
  std::span<const std::uint16_t> fluid_;
  Vec3d origin_{};
  CellOrder order_;
  float inverse_volume_ = 0;     // 1/V [1/m^3]
  std::vector<float> solid_;     // by sorted index: e_i
  std::vector<float> burden_;    // by sorted index: B_i
  std::vector<Vec3f> given_;     // by sorted index: push lost to bodies [kg m]
  std::vector<float> coupling_;  // per particle of the world; and by sorted index [kg]
  std::vector<float> fluid_coupling_;
};

}  // namespace souple
