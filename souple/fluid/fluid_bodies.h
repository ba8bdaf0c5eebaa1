#pragma once

#include "souple/broad_phase/largest_motion.h"
#include "souple/fluid/cell_order.h"
#include "souple/fluid/coarse_pressure.h"
#include "souple/fluid/local_boundary.h"
#include "souple/fluid/surface_planes.h"
#include "souple/math/lists.h"
#include "souple/objects/fluid_boundary.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Two-way coupling of fluids and bodies. A particle near a body treats the body's surface as a wall at the
/// nearest point. Each push on the particle acts on this point in the opposite direction, so momentum is
/// conserved.
///
/// Bodies move during the pressure solve. Rigid bodies respond as a whole, by W = diag(1/m, I^-1). Bodies move during
/// the pressure solve. Rigid bodies respond as a whole, by W = diag(1/m, I^-1). Per-vertex bodies respond vertex by
/// vertex. The solver bounds this response by the row sums of the matrix by which pressures of particles act on one
/// another through the body. Without this response, pressures would be those against a fixed body and would throw a
/// light body about.
class FluidBodies {
 public:
  /// collides[fluid * meshes + s]: whether a fluid collides with mesh s.
  void set_meshes(std::vector<BoundaryMesh> meshes) { meshes_ = std::move(meshes); }
  std::span<const BoundaryMesh> meshes() const { return meshes_; }
  std::size_t mesh_count() const { return meshes_.size(); }

  void begin_step(std::span<const std::uint8_t> collides, const Vec3d& origin) {
    collides_ = collides, origin_ = origin;
    listed_.clear();
  }
  /// Takes the predicted positions of bodies and finds which particles may be near which triangles.
  /// `positions` of the fluid's particles, by particle index; `mass` of the world's particles [kg].
  void begin_substep(const ParticleView& particles, std::span<const float> mass,
                     std::span<const Vec4f> positions, float search_radius, Threads& threads);
  /// Appends the boundary planes within `search_radius` of particle i of a fluid: at most one plane per mesh.
  /// The particle is at x and was at `start` when the substep began. Threads may call it concurrently.
  void find(std::size_t i, std::size_t fluid, const Vec3f& x, const Vec3f& start, float search_radius,
            std::vector<BoundaryPlane>& planes) const;

  /// Updates a plane's offset to its body's current position.
  void follow(BoundaryPlane& plane) const;
  /// Computes the response of bodies; call after the slopes of all planes are sampled.
  void find_response(const LocalBoundary& local_boundary, std::span<const Vec4f> x, CoarsePressure& coarse);
  /// Adds the response of bodies to w |grad C|^2 of a particle: the sum of its row.
  void add_response(std::span<const BoundaryPlane> planes, BoundarySums& sums) const;
  /// Displaces bodies by the reaction to pushes of slope times `change` [kg m].
  void displace(const LocalBoundary& local_boundary, std::span<const float> change);
  /// Applies the accumulated reactions of all planes to the world's particles.
  void apply(const LocalBoundary& local_boundary, const ParticleView& particles) const;

  /// Separates particle i of a fluid from a plane's body if it is closer than `radius`; both move, by their
  /// inverse masses. x is the particle's position at the last sampling. Needed because pressure acts over a
  /// distance and does not stop fast particles. Conserves momentum. Call it after `apply`.
  void keep_apart(const BoundaryPlane& plane, std::uint32_t i, const Vec3f& x, float radius,
                  const ParticleView& particles) const;

  /// Whether a plane belongs to a body with a movable particle.
  bool is_movable(const BoundaryPlane& plane) const {
    return plane.mesh != BoundaryPlane::none && states_[plane.mesh].movable;
  }
  /// f(particle of the world, share) for the particles that carry a plane's nearest point; shares sum to 1.
  template <class Function>
  void for_carriers(const BoundaryPlane& plane, const Function& f) const {
    const BoundaryMesh& mesh = meshes_[plane.mesh];
    const Triangle& t = mesh.triangles[plane.triangle];
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t p = 0; p < 4; ++p) {
        const float share = plane.weights[static_cast<int>(c)] * mesh.weights[t[c]][p];
        if (share != 0) f(mesh.particles[t[c]][p], share);
      }
    }
  }

 private:
  /// State of a mesh in this substep.
  struct State {
    std::vector<Vec3f> start, now;  // vertex positions from the origin, at the substep's start and now [m]
    std::vector<float> vertex_inverse_mass;  // per vertex: displacement per unit of push [1/kg]
    std::vector<float> slopes;               // per-vertex bodies: sum of |slope| that acts on a vertex [1/m]
    float slope_sum = 0;                     // rigid bodies: sum of all |slope| [1/m]
    bool movable = false;
    double inverse_mass = 0;  // of the rigid body [1/kg]; 0: it does not move as a whole
    Mat3d inverse_inertia{};
    Vec3d center{};  // of mass, from the origin [m]
  };

  /// Push of a fluid on a rigid body [kg m], [kg m^2].
  struct Push {
    Vec3d force{}, torque{};
  };

  void add_triangle(std::uint32_t mesh, std::uint32_t triangle, const Vec3f& x, const Vec3f& start,
                    SurfacePlanes& surface) const;
  void add_plane(std::uint32_t mesh, const SurfacePlane& found, const Vec3f& x, float search_radius,
                 std::vector<BoundaryPlane>& planes) const;
  void update_state(const BoundaryMesh& mesh, State& state, const ParticleView& particles,
                    std::span<const float> mass) const;
  bool lists_are_valid(std::span<const Vec4f> positions, Threads& threads);
  void find_candidates(std::span<const Vec4f> positions, float search_radius, Threads& threads);
  void find_candidates_of(std::uint32_t mesh, std::uint32_t triangle, std::span<const Vec4f> positions,
                          float search_radius);
  Vec3f point(const BoundaryPlane& plane, const std::vector<Vec3f>& vertices) const;

  /// Particles of the world that carry a plane's nearest point, without duplicates; shares sum to 1.
  struct Carriers {
    std::size_t count = 0;
    std::array<std::uint32_t, 12> particle{};
    std::array<float, 12> share{};
  };
  Carriers carriers_of(const BoundaryPlane& plane) const;

  std::vector<BoundaryMesh> meshes_;
  std::vector<State> states_;
  std::vector<Push> pushes_;
  std::span<const std::uint8_t> collides_;
  Vec3d origin_{};
  CellOrder order_;
  /// A particle and a triangle that may be near it.
  struct Candidate {
    std::uint32_t particle, mesh, triangle;
  };
  std::vector<Candidate> found_;  // in order of search
  Lists<Candidate> candidates_;   // per particle
  std::vector<Vec4f> listed_;     // particle positions at the last search
  float listed_margin_ = 0;       // motion of particles and vertices that requires a new search [m]
  std::vector<std::vector<Vec3f>> listed_vertices_;
  LargestMotion largest_motion_;  // since the last search
};

}  // namespace souple
