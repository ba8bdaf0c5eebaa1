#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/fluid_view.h"
#include "souple/fluid/foam_parameters.h"
#include "souple/fluid/kernels/find_kernels.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace souple {

/// The particles of a Foam.
struct FoamState {
  std::vector<Vec3f> position, velocity;  ///< [m], [m/s]
  std::vector<float> life;                ///< remaining life as foam [s]
  std::vector<float> age;                 ///< [s]
  std::vector<FoamKind> kind;

  std::size_t size() const { return position.size(); }
  void resize(std::size_t count);
  void reserve(std::size_t count);
};

/// Input of a foam step: the fluid's state and parameters of the step.
struct FoamStep {
  const FluidView& fluid;
  std::span<const std::uint32_t> particle;  ///< by sorted index: particle number, part of the random key
  /// By sorted index, or empty: BoundarySums::slope, so that walls do not count as a free surface [1/m].
  std::span<const Vec3f> wall_slopes{};
  std::span<const float> share{};  ///< by sorted index, or empty: factor of the rates [-]
  Vec3f gravity{};                 ///< m/s^2
  float dt = 0;                    ///< s
  std::uint64_t seed = 0;          ///< random seed; must differ in each step
};

/// Spray, foam and bubbles: particles that the fluid emits and advects, without effect on the fluid. Source: Ihmsen,
/// Akinci, Akinci and Teschner 2012, "Unified spray, foam and air bubbles for particle-based fluids".
///
/// Emission, with hat(r) = 1 - r / h, h the support, and Phi(I) = (min(I, high) - min(I, low)) / (high -
/// low):
///
///   I_ta = Phi(sum_j |v_ij| (1 - cos(v_ij, x_ij)) hat(r))                                        (eq. 2)
///   I_wc = Phi(sum_j (1 - n_i . n_j) hat(r)  over surface particles j behind the surface at i), 0 where
///          the flow is not along n_i                                                              (eq. 5, 6)
///   I_k  = Phi(v^2 / 2)                                                                           (eq. 7)
///   new  = I_k (k_ta I_ta + k_wc I_wc) dt                                                         (eq. 8)
///
/// New particles start in the cylinder of diameter d that the fluid particle has swept in the step. Spray
/// then moves ballistically, foam moves with the fluid until it dissolves, and bubbles rise through the
/// fluid. Random numbers depend only on the seed and the fluid particle, so results do not depend on the
/// number of threads.
class Foam {
 public:
  struct Report {
    std::size_t spray = 0, foam = 0, bubbles = 0;
    std::size_t made = 0, thinned = 0, dissolved = 0;  ///< in this step
  };

  explicit Foam(SmoothingShape shape = SmoothingShape::wendland)
      : kernels_(&kernels::find_density_kernels(instruction_set(), shape)),
        velocity_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}

  /// One foam step, after the fluid's step. `keep_out(starts, positions, velocities)` takes spans of equal
  /// size. It moves each particle whose path enters a wall in front of this wall and removes its velocity
  /// into the wall.
  template <class KeepOut>
  Report step(const FoamStep& step, const FoamParameters& parameters, const KeepOut& keep_out,
              Threads& threads) {
    report_ = {};
    find_cells(step.fluid, threads);
    move(step, parameters, threads);
    keep_out(std::span<const Vec3f>(start_), std::span(state_.position), std::span(state_.velocity));
    dissolve();
    const std::size_t old = size();
    find_normals(step, threads);
    make(step, parameters, threads);
    keep_out(std::span<const Vec3f>(start_), std::span(state_.position).subspan(old),
             std::span(state_.velocity).subspan(old));
    find_kinds(step.fluid, parameters, old, threads);
    return count();
  }
  /// Reserves capacity: growth up to `count` particles then allocates nothing.
  void reserve(std::size_t count);

  std::size_t size() const { return state_.size(); }
  std::span<const Vec3f> positions() const { return state_.position; }   ///< [m]
  std::span<const Vec3f> velocities() const { return state_.velocity; }  ///< [m/s]
  std::span<const FoamKind> kinds() const { return state_.kind; }
  /// Adds a particle besides those that the fluid emits [m], [m/s], [s].
  void add(const Vec3f& x, const Vec3f& v, float life);
  void clear() { state_.resize(0); }
  /// The complete state: a Foam with an equal state continues identically.
  const FoamState& state() const { return state_; }
  void set_state(FoamState state) { state_ = std::move(state); }
  void shift(const Vec3f& by);  ///< translates all positions [m]
  std::size_t bytes() const;

 private:
  struct Neighborhood {
    Vec3f velocity{};
    int neighbors = 0;
  };
  struct Potential {
    float made;   // expected number in the step
    float share;  // emission rate over its maximum
  };
  /// A fluid particle that emits foam; `first` is the number of its first new particle.
  struct Spawner {
    std::uint32_t index;
    std::uint64_t first;
    float share;
  };

  void find_cells(const FluidView& fluid, Threads& threads);
  static FoamKind kind_of(const Neighborhood& neighborhood, const FoamParameters& parameters);
  Neighborhood neighborhood(const FluidView& fluid, const Vec3f& at) const;
  void move(const FoamStep& step, const FoamParameters& parameters, Threads& threads);
  void dissolve();
  void find_normals(const FoamStep& step, Threads& threads);
  float bend(const FluidView& fluid, std::uint32_t index, std::span<const std::uint32_t> list) const;
  Potential potential(const FoamStep& step, std::uint32_t index, std::span<const std::uint32_t> list,
                      const FoamParameters& parameters) const;
  void make(const FoamStep& step, const FoamParameters& parameters, Threads& threads);
  void begin(const FoamStep& step, const Spawner& spawner, std::uint32_t count, std::uint64_t key,
             const FoamParameters& parameters);
  void find_kinds(const FluidView& fluid, const FoamParameters& parameters, std::size_t first,
                  Threads& threads);
  Report count() const;

  const kernels::DensityKernels* kernels_;
  const kernels::VelocityKernels* velocity_;
  FoamState state_;
  std::vector<Vec3f> start_;  // path start of each particle that moves or is new
  CellOrder order_;           // cells of the fluid
  float cell_size_ = 0;
  std::vector<Vec3f> normals_;  // fluid surface normals by sorted index; zero inside the fluid
  std::vector<float> made_, share_;
  std::vector<Spawner> spawners_;
  Report report_;
};

}  // namespace souple
