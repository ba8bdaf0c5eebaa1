#pragma once

#include "souple/fluid/fluid_view.h"

#include <cstdint>
#include <vector>

namespace souple {

/// By how much fluid is around a foam particle.
enum class FoamKind : std::uint8_t { spray, foam, bubble };

struct FoamParameters {
  /// What is below the first counts nothing, what is above the second counts in full.
  struct Range {
    float low, high;
  };
  Range trapped_air{5, 20};       ///< sum over neighbours of how fast they come closer [m/s]
  Range wave_crest{1, 4};         ///< sum over neighbours of 1 - cos of the angle between normals [-]
  Range energy{0.125f, 3};        ///< v^2 / 2 [m^2/s^2]: speeds of 0.5 to 2.4 m/s
  float trapped_air_rate = 2000;  ///< particles a fluid's particle makes at most, by trapping air [1/s]
  float wave_crest_rate = 2000;   ///< and at a wave's crest [1/s]
  Range life{1, 4};               ///< of foam: of what little made it, and of what much did [s]
  float longest_life = 20;        ///< of spray and bubbles too [s]
  float buoyancy = 2;             ///< of bubbles, over gravity
  float drag = 60;                ///< of bubbles: how quickly they take the fluid's velocity [1/s]
  int spray_neighbours = 6;       ///< fewer fluid particles than these around: spray
  int bubble_neighbours = 20;     ///< more than these: a bubble
  std::size_t most = 200000;      ///< particles; above, what is new is thinned out
  std::uint64_t seed = 0;
};

/// Spray, foam and bubbles: particles that a fluid makes and carries, and that do nothing to it (Ihmsen,
/// Akinci, Akinci and Teschner 2012, "Unified spray, foam and air bubbles for particle-based fluids").
///
/// Where they come from, with hat(r) = 1 - r / 2d and Phi(I) = (min(I, high) - min(I, low)) / (high - low):
///
///   I_ta = Phi(sum_j |v_ij| (1 - cos(v_ij, x_ij)) hat(r))                                        (eq. 2)
///   I_wc = Phi(sum_j (1 - n_i . n_j) hat(r)  over surface particles j behind the surface at i), 0 where
///          the flow is not along n_i                                                              (eq. 5, 6)
///   I_k  = Phi(v^2 / 2)                                                                           (eq. 7)
///   new  = I_k (k_ta I_ta + k_wc I_wc) dt                                                         (eq. 8)
///
/// They begin in the cylinder that the fluid particle, as wide as d, has swept in the step. Then spray flies,
/// foam goes with the fluid, and bubbles rise through it; foam dissolves. Chance is a function of the seed,
/// the step and the fluid particle: the same for any number of threads.
class Foam {
 public:
  struct Report {
    std::size_t spray = 0, foam = 0, bubbles = 0;
    std::size_t made = 0, thinned = 0, dissolved = 0;  ///< in this step
  };

  explicit Foam(SmoothingShape shape = SmoothingShape::wendland)
      : kernels_(&kernels::find_density_kernels(instruction_set(), shape)),
        velocity_(&kernels::find_velocity_kernels(instruction_set(), shape)) {}

  /// One step of dt seconds, after the fluid's: `particle` says of each place which particle is there.
  /// `wall_slopes` by place, or empty: BoundarySums::slope, which keeps walls from looking like a surface
  /// [1/m]. `boundary(x, v)`, called on all threads, puts what is in a wall before it and lets it not move
  /// into it.
  template <class Boundary>
  Report step(const FluidView& fluid, std::span<const std::uint32_t> particle,
              std::span<const Vec3f> wall_slopes, const FoamParameters& parameters, const Vec3f& gravity,
              float dt, const Boundary& boundary, Threads& threads) {
    report_ = {};
    find_cells(fluid, threads);
    move(fluid, parameters, gravity, dt, threads);
    for_places(size(), threads, [&](std::size_t k) { boundary(x_[k], v_[k]); });
    dissolve();
    const std::size_t old = size();
    find_normals(fluid, wall_slopes, threads);
    make(fluid, particle, parameters, dt, threads);
    for_places(size() - old, threads, [&](std::size_t k) { boundary(x_[old + k], v_[old + k]); });
    ++step_;
    return count();
  }

  std::size_t size() const { return x_.size(); }
  std::span<const Vec3f> positions() const { return x_; }   ///< [m]
  std::span<const Vec3f> velocities() const { return v_; }  ///< [m/s]
  std::span<const FoamKind> kinds() const { return kind_; }
  std::span<const float> life() const { return life_; }  ///< left of each, as foam [s]
  /// One more, beside what the fluid makes [m], [m/s], [s].
  void add(const Vec3f& x, const Vec3f& v, float life);
  void clear();

 private:
  struct Around {
    Vec3f velocity{};
    int neighbours = 0;
  };
  struct Potential {
    float made;   // expected number in the step
    float share;  // of the largest
  };
  /// A fluid particle that makes some, and what of all it makes.
  struct Maker {
    std::uint32_t place, first;
    float share;
  };

  void find_cells(const FluidView& fluid, Threads& threads);
  static FoamKind kind_of(const Around& around, const FoamParameters& parameters);
  Around around(const FluidView& fluid, const Vec3f& at) const;
  void move(const FluidView& fluid, const FoamParameters& parameters, const Vec3f& gravity, float dt,
            Threads& threads);
  void dissolve();
  void find_normals(const FluidView& fluid, std::span<const Vec3f> wall_slopes, Threads& threads);
  float bend(const FluidView& fluid, std::uint32_t place, std::span<const std::uint32_t> list) const;
  Potential potential(const FluidView& fluid, std::uint32_t place, std::span<const std::uint32_t> list,
                      const FoamParameters& parameters, float dt) const;
  void make(const FluidView& fluid, std::span<const std::uint32_t> particle, const FoamParameters& parameters,
            float dt, Threads& threads);
  void begin(const FluidView& fluid, const Maker& maker, std::uint32_t count, std::uint64_t key,
             const FoamParameters& parameters, float dt);
  Report count() const;

  const kernels::DensityKernels* kernels_;
  const kernels::VelocityKernels* velocity_;
  std::vector<Vec3f> x_, v_;
  std::vector<float> life_, age_;
  std::vector<FoamKind> kind_;
  CellOrder order_;  // of the fluid
  float cell_size_ = 0;
  std::vector<Vec3f> normals_;  // of the fluid's surface, by place; zero within
  std::vector<float> made_, share_;
  std::vector<Maker> makers_;
  std::uint64_t step_ = 0;
  Report report_;
};

}  // namespace souple
