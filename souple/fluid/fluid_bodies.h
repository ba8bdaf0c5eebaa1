#pragma once

#include "souple/fluid/cell_order.h"
#include "souple/fluid/coarse_pressure.h"
#include "souple/fluid/local_boundary.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/solver/projector.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// How a body gives way while a fluid's pressure is being solved for.
enum class BodyCompliance {
  per_vertex,  ///< every vertex by itself, as cloth does
  rigid        ///< as a whole: pressure deforms it only afterwards
};

/// The surface of a body as a fluid feels it: triangles over vertices, each of which hangs on up to four of
/// the world's particles.
struct BoundaryMesh {
  std::uint32_t begin = 0, end = 0;  ///< all particles of the body
  std::vector<std::array<std::uint32_t, 4>> particles{};
  std::vector<std::array<float, 4>> weights{};  ///< of each vertex; they sum to 1
  std::vector<Triangle> triangles{};            ///< over vertices, counter-clockwise from outside
  float half_thickness = 0;                     ///< m
  bool closed = false;                          ///< it has an inside, where no fluid belongs
  BodyCompliance compliance = BodyCompliance::per_vertex;
};

/// Bodies in fluids. A particle near a body's surface feels it as a wall at the nearest point; what pushes
/// the particle pushes that point back, so momentum is conserved.
///
/// While pressures are solved for, bodies give way: those that are stiff as a whole, by W = diag(1/m, I^-1);
/// those that are not, each vertex by itself, of which the solver is told a bound (the sum of its row in the
/// matrix of what the pressures of particles do to each other through the body). Without that a light body
/// would be thrown about by pressures that were meant for one that does not move.
class FluidBodies {
 public:
  /// collides[fluid * meshes + s]: whether a fluid feels a mesh.
  void set_meshes(std::vector<BoundaryMesh> meshes) { meshes_ = std::move(meshes); }
  std::span<const BoundaryMesh> meshes() const { return meshes_; }
  std::size_t mesh_count() const { return meshes_.size(); }

  void begin_step(std::span<const std::uint8_t> collides, const Vec3d& origin) {
    collides_ = collides, origin_ = origin;
    listed_.clear();
  }
  /// Where bodies are predicted to be. `positions` of the fluid's particles, by number; `mass` of the world's
  /// particles [kg]. Lists which particles may be near which triangles.
  void begin_substep(const ParticleView& particles, std::span<const float> mass,
                     std::span<const Vec4f> positions, float search_radius, Threads& threads);
  /// Appends what is nearer than `search_radius` to particle i of a fluid: one plane of each mesh. It is at x and was
  /// at `start` when the substep began. Several threads may call it at a time.
  void find(std::size_t i, std::size_t fluid, const Vec3f& x, const Vec3f& start, float search_radius,
            std::vector<BoundaryPlane>& planes) const;

  /// A plane goes where its body has gone.
  void follow(BoundaryPlane& plane) const;
  /// When all planes' slopes are known: how far bodies give way.
  void find_response(const LocalBoundary& local_boundary, std::span<const Vec4f> x, CoarsePressure& coarse);
  /// What giving way adds to w |grad C|^2 of a particle: the sum of its row.
  void add_response(std::span<const BoundaryPlane> planes, BoundarySums& sums) const;
  /// Bodies give way to a push of the planes by slope times `change` [kg m].
  void displace(const LocalBoundary& local_boundary, std::span<const float> change);
  /// What all planes have pushed goes to the world's particles.
  void apply(const LocalBoundary& local_boundary, const ParticleView& particles) const;

  /// A particle i of a fluid, at x when planes were last looked at, that is nearer to a plane's body than
  /// `radius` leaves it, and the body what it weighs less: pressure, which acts at a distance, does not stop
  /// what comes fast. Momentum is conserved. Call it after `apply`.
  void keep_apart(const BoundaryPlane& plane, std::uint32_t i, const Vec3f& x, float radius,
                  const ParticleView& particles) const;

  /// Whether a plane is of a body that something can move.
  bool is_movable(const BoundaryPlane& plane) const {
    return plane.mesh != BoundaryPlane::none && states_[plane.mesh].movable;
  }
  /// f(particle of the world, share) for those that carry the point a plane touches; shares sum to 1.
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
  /// Of a mesh in this substep.
  struct State {
    std::vector<Vec3f> start, now;           // of vertices, from the origin [m]
    std::vector<float> vertex_inverse_mass;  // of a vertex: how much a unit of push moves it [1/kg]
    std::vector<float> slopes;               // compliance locally: sum of |slope| that pushes it [1/m]
    float slope_sum = 0;                     // compliance rigidly: of all [1/m]
    bool movable = false;
    double inverse_mass = 0;  // of the whole
    Mat3d inverse_inertia{};
    Vec3d center{};  // of mass, from the origin [m]
  };

  /// Of a fluid on a rigid body [kg m], [kg m^2].
  struct Push {
    Vec3d force{}, torque{};
  };

  void update_state(const BoundaryMesh& mesh, State& state, const ParticleView& particles,
                    std::span<const float> mass) const;
  bool lists_are_valid(std::span<const Vec4f> positions) const;
  void find_candidates(std::span<const Vec4f> positions, float search_radius, Threads& threads);
  void find_candidates_of(std::uint32_t mesh, std::uint32_t triangle, std::span<const Vec4f> positions,
                          float search_radius);
  Vec3f point(const BoundaryPlane& plane, const std::vector<Vec3f>& vertices) const;

  /// Particles of the world that carry the point a plane touches, each once; shares sum to 1.
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
  /// A particle and a triangle that it may be near.
  struct Candidate {
    std::uint32_t particle, mesh, triangle;
  };
  std::vector<Candidate> found_, candidates_;  // as found; by particle, then as found
  std::vector<std::uint32_t> first_;           // of each particle
  std::vector<Vec4f> listed_;                  // where particles were when they were listed
  float listed_margin_ = 0;                    // how far things may go before they are listed anew [m]
  std::vector<std::vector<Vec3f>> listed_vertices_;
};

}  // namespace souple
