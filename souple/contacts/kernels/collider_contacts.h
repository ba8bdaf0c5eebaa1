#pragma once

#include <cstddef>
#include <cstdint>

// Particles against one collider, a register of particles at a time. The version with one lane serves processors
// without these instruction sets, and tests. All versions return the same bits.
//
// Positions are relative to the collider, in its frame: w = R^T ((x - o) - o' + q). Here o + o' is its origin in
// double; x and q are the two parts of a particle's position. A float's relative error of 6e-8 then is a part of the
// distance from the collider, wherever both are in the world.

namespace souple::kernels {

enum class ColliderForm { plane, sphere, box, capsule, cylinder, field };

/// A grid of signed distances: see signed_distance_grid.h. Lengths in m.
struct ColliderGrid {
  float origin[3] = {}, spacing = 1;
  std::int32_t blocks[3] = {};
  const float* corners = nullptr;  ///< at the corners of blocks, x fastest
  const std::int32_t* slot =
      nullptr;                    ///< per block: its number in `points`; negative: only its corners are known
  const float* points = nullptr;  ///< of blocks, each x fastest
};

/// Distances and outward unit normals of `count` points; planes of x, y and z. [m]
using SampleField = void (*)(const void* field, int count, const float* const (&point)[3], float* distance,
                             float* const (&normal)[3]);

/// A surface around the origin of the frame. A plane contains the origin, and its normal is the y axis. A capsule's
/// and a cylinder's axis is the y axis.
struct ColliderShape {
  ColliderForm form = ColliderForm::plane;
  float radius = 0;              ///< sphere, capsule, cylinder [m]
  float half_extents[3] = {};    ///< box; y: capsule (its segment) and cylinder [m]
  ColliderGrid grid{};           ///< field
  SampleField sample = nullptr;  ///< field, outside of its grid; null: a lower bound
  const void* field = nullptr;
};

/// A pose. axis[k]: the k-th axis of the frame in the world.
struct ColliderFrame {
  float axis[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  float origin[3] = {}, origin_rest[3] = {};  ///< its float, and what that leaves of the double [m]
};

/// A collider during a substep.
struct ColliderBody {
  ColliderShape shape;
  ColliderFrame before, after;  ///< at the substep's start and end
  /// Displacement of the surface point s (in the frame): turn s + shift. Columns of a matrix; m.
  float turn[3][3] = {};
  float shift[3] = {};
  float rotation[3] = {};  ///< rotation vector of the substep, in the world
  bool moves = false;
};

/// Arrays with one 16-byte record per particle.
struct ColliderParticles {
  const float* position = nullptr;  ///< w = inverse mass [1/kg]
  const float* moving = nullptr;    ///< displacements
  const float* start = nullptr;     ///< `moving` at the substep's start
  float* corrected = nullptr;       ///< project adds to it
  float* velocity = nullptr;        ///< apply_restitution changes it [m/s]
  float* turn = nullptr;            ///< see Particles::turn; null: no particle rolls
};

/// Contacts of one body as columns.
struct ColliderContactColumns {
  std::uint32_t* particle;
  float* distance;  ///< that the particle keeps from the surface [m]
  float* static_friction;
  float* kinetic_friction;
  float* restitution;
  float* end_distance;  ///< from the surface at the end of the predicted motion [m]
  /// Not 0: the plane below serves for the whole substep.
  float* fixed_plane;
  float* start_normal[3];  ///< of the surface at the substep's start, or at the first touch; in the frame
  float* plane_offset;     ///< of the plane with that normal [m]
  /// Target of C, at most 0 [m]: old overlaps are removed slowly. Before `describe`: by how much at most.
  float* slop;
  float* predicted[3];          ///< motion relative to the surface before any projection, in the world [m]
  float* normal_sum;            ///< sum of normal corrections [m]
  float* tangent_sum[3];        ///< sum of tangential corrections [m]
  float* normal[3];             ///< of the last projection, in the world
  float* surface_motion[3];     ///< displacement of the surface at the contact in the substep [m]
  float* restitution_velocity;  ///< normal velocity that apply_restitution added [m/s]
  float* depth;                 ///< remaining overlap, of contacts with a normal impulse [m]
  float* plane_gap;             ///< C - normal . motion in the last projection [m]
  // Only where particles roll (contact_law.h).
  float* share;  ///< 5/2 of a ball that rotates, else 0
  float* radius;
  float* rolling_friction;
  float* moment_sum[3];  ///< G [m]
};

struct ColliderContactLimits {
  float inverse_h = 0;              ///< 1/s
  float restitution_threshold = 0;  ///< contacts that approach slower do not bounce [m/s]
};

struct ColliderContactKernels {
  /// Distances of particles from the surface at the substep's end [m].
  void (*distances)(const ColliderParticles&, const ColliderBody&, const std::uint32_t* particle,
                    std::size_t begin, std::size_t end, float* distance);
  /// Distance of each particle from the surface at the end of its motion [m]. It is infinity if the particle did not
  /// touch the surface in the substep and other constraints are unlikely to push it in. keeps[i]: distance that
  /// particle[i] keeps from the surface [m].
  void (*find)(const ColliderParticles&, const ColliderBody&, const std::uint32_t* particle,
               const float* keeps, std::size_t begin, std::size_t end, float* distance);
  /// Fills contacts [begin, end) from particle, distance, end_distance and slop.
  void (*describe)(const ColliderParticles&, const ColliderBody&, const ColliderContactColumns&,
                   std::size_t begin, std::size_t end);
  /// No two contacts may have the same particle.
  void (*project)(const ColliderParticles&, const ColliderBody&, const ColliderContactColumns&,
                  std::size_t begin, std::size_t end);
  /// With the planes of the last projection, after small motions. A contact that touches for the first time now takes
  /// the surface motion of a plane that has not been projected, 0. On a moving collider the exact projections that
  /// follow correct its friction.
  void (*project_again)(const ColliderParticles&, const ColliderContactColumns&, std::size_t begin,
                        std::size_t end);
  void (*apply_restitution)(const ColliderParticles&, const ColliderBody&, const ColliderContactLimits&,
                            const ColliderContactColumns&, std::size_t begin, std::size_t end);
  /// C of contacts: distance beyond the one to keep [m]. Null or per contact: the surface point, in the frame.
  void (*gaps)(const ColliderParticles&, const ColliderBody&, const ColliderContactColumns&,
               std::size_t begin, std::size_t end, float* C, float* const* surface);
  /// Whether any particle moved farther from `at` (three columns) than its margin.
  bool (*left)(const ColliderParticles&, const std::uint32_t* particle, const float* const (&at)[3],
               const float* margin, std::size_t begin, std::size_t end);
};

/// Compiled in one translation unit per instruction set (compile_collider_contacts.h).
template <class Isa>
const ColliderContactKernels& collider_contact_kernels();

}  // namespace souple::kernels
