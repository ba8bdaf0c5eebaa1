#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/fluid_view.h"
#include "souple/fluid/local_boundary.h"
#include "souple/solver/projector.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A grain, or a piece of one or of a rope, about as large as a fluid's particles are apart or less.
struct SubResolutionBody {
  std::array<std::uint32_t, 2> particles{};  ///< of the world, that it hangs on
  std::array<float, 2> weights{};            ///< they sum to 1
  Vec3f offset{};                            ///< from there: things do not turn [m]
  float volume = 0;                          ///< m^3
  float mass = 0;                            ///< kg
  float radius = 0;                          ///< m
  float length = 0;                          ///< of a piece of rope; 0: a ball [m]
  std::uint32_t object = 0;                  ///< which of those that fluids may feel
};

/// Small things in fluids. They are no walls: no particle of a fluid could be in the right index before a
/// surface that is smaller than itself. Instead they feel what the fluid around them feels. Archimedes'
/// argument: the pressure pushes a thing as it would push the fluid that were there in its place. So from the
/// push m_i dx_i that pressure gave each particle i near it in this substep, a thing of volume V_b takes
///
///   T_ib = c_b phi_b V_b / V s_ib m_i dx_i / (1 + e_i),   s_ib = w_ib / sum_j w_jb
///   w = 1 - |x_i - x_b|^2 / R^2,   e_i = sum_b phi_b V_b / V s_ib
///
/// and i loses it: momentum is kept. i keeps dx_i / (1 + e_i), which in a fluid at rest carries its own
/// weight: so things are lifted with the weight of the fluid in their volume, wherever its particles happen
/// to lie, be there many or few of them. phi_b, the part of a thing that is in the fluid, is sum_i V w_ib
/// over the integral of w, the mirror images of particles behind walls included. c_b limits what a light
/// thing gets to max_push_ratio what moves the fluid (in nature the mass that it takes along does that).
///
/// Drag is that of a ball or a cylinder, with u = the mean velocity around it less its own:
///
///   ball      F = phi (6 pi mu r + rho / 2 C pi r^2 |u|) u,          C = 0.47
///   cylinder  across F = phi (4 pi mu l + rho C r l |u|) u, C = 1.2;
///             along C = 0.03 and half the viscous part
///
/// taken from the particles around by s_ib, with the bound of body_friction.h for stability. e_i is added to
/// the density C, so the fluid's level rises by what is in it.
class SubResolutionBodies {
 public:
  void set_bodies(std::vector<SubResolutionBody> bodies) { bodies_ = std::move(bodies); }
  bool none() const { return bodies_.empty(); }
  /// collides[fluid * objects + o]: whether a fluid feels an object; `fluid` of its particles by number.
  void begin_step(std::span<const std::uint8_t> collides, std::size_t objects,
                  std::span<const std::uint16_t> fluid, const Vec3d& origin) {
    collides_ = collides, objects_ = objects, fluid_ = fluid, origin_ = origin;
  }
  /// Where they are in the fluid: `x` by index, `order` of each index the particle's number.
  void find(std::span<const Vec4f> x, std::span<const std::uint32_t> order,
            const LocalBoundary& local_boundary, const Smoothing& smoothing, const ParticleView& particles,
            Threads& threads);
  /// What they take of the room around a index: belongs to V sum W.
  float displaced_fraction(std::size_t index) const { return std::min(displaced_[index], max_displaced); }
  /// After pressures moved the fluid's places: what these have given, times the substep [kg m]. Moves the
  /// world's particles.
  std::span<const Vec3f> apply_pressure(std::span<const Vec4f> x, std::span<const Vec3f> moved,
                                        const ParticleView& particles);
  /// Drag over h seconds, on what the last apply_pressure found; `viscosity` of each fluid [Pa s]. `velocity` [m/s]
  /// and `inverse_mass` (w, [1/kg]) of the world's particles.
  void drag(const FluidView& fluid, std::span<const std::uint32_t> order, std::span<const float> viscosity,
            float h, std::span<Vec4f> velocity, std::span<const Vec4f> inverse_mass, Threads& threads);

 private:
  struct Near {
    std::uint32_t index;
    float share;  // s_ib
  };
  /// Of a body in this substep.
  struct State {
    std::uint32_t begin = 0, end = 0;  // in its block's `near`
    float submerged = 0;               // phi
    float near_sum = 0, sum = 0;       // of w over particles; and their mirror images
    Vec3f at{}, axis{};                // from the origin [m]; unit, zero of a ball
    Vec3f pull{};                      // impulse of the drag [kg m/s]
    float across = 0, along = 0;       // of the drag [kg]
  };
  struct Block {
    std::vector<Near> near;
  };
  static constexpr std::size_t block_size = 64;
  static constexpr float max_displaced = 0.6f;  // of the room around a particle

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
  float inverse_volume_ = 0;      // 1/V [1/m^3]
  std::vector<float> filled_;     // by index: what things fill around it, submerged or not
  std::vector<float> displaced_;  // by index: sum_b phi V_b / V s_ib
  std::vector<Vec3f> given_;      // by index
  std::vector<float> coupling_;   // of the world's particles, and of places [kg]
  std::vector<float> fluid_coupling_;
};

}  // namespace souple
