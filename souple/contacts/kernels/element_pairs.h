#pragma once

#include <cstddef>
#include <cstdint>

// Vertices against triangles and edges against edges, a register of pairs at a time. The version with one
// lane serves tests, and processors without these instruction sets. All versions return the same bits.

namespace souple::kernels {

/// Arrays with one 16-byte record per particle (see solver/projector.h).
struct ParticleRecords {
  const float* position = nullptr;  ///< w = inverse mass [1/kg]
  float* moving = nullptr;          ///< displacements
  float* corrected = nullptr;       ///< project adds to it: `moving`, unless the solver is Jacobi's
  const float* start = nullptr;     ///< `moving` at the substep's start; read by project
  const float* moved = nullptr;     ///< moving - start; read by ranges, find_near, classify and describe
  /// Per particle: additional distance at which its contacts begin [m]; read by ranges and classify.
  const float* contact_margin = nullptr;
  /// See Particles::turn; read and written by project and apply_restitution. Null: no particle rolls.
  float* turn = nullptr;
};

/// Pairs of a vertex and a triangle, or of two edges, as columns.
struct ElementPairColumns {
  const std::uint32_t (*particle)[4] = nullptr;
  const float* thickness = nullptr;  ///< m
  float* distance_bound = nullptr;   ///< lower bound of the distance at the substep's start [m]
};

/// Thickness of particles, and margins of their predicted paths [m].
struct PredictionMargins {
  const float* radius = nullptr;  ///< half the thickness of each particle
  const float* margin = nullptr;  ///< of particle i: margin[i * stride]
  std::size_t stride = 1;
  float min_thickness = 0, speculative_part = 0;
};

/// Pairs are skipped while their relative motion is below bound_part distance_bound - thickness_part thickness -
/// contact_margin. It is the motion of a point of one element relative to a point of the other.
struct NearRule {
  float bound_part, thickness_part;
  float contact_margin;  ///< largest of all their particles [m]
};

/// Result of find_near.
struct NearPairStatistics {
  std::size_t found = 0;     ///< number of pairs that come near
  float min_distance_bound;  ///< smallest distance_bound of all pairs [m]
  float min_gap_bound;       ///< smallest distance_bound - (1 + speculative_part) thickness of all pairs [m]
};

/// Bits of the result of `classify` for a pair.
struct Classification {
  /// The pair can move, and its distance at the end of its motion is not 0. It is at most (1 + speculative_part)
  /// thickness + the largest contact margin of its particles.
  static constexpr unsigned touches = 1;
  static constexpr unsigned fast = 2;  ///< its elements may pass through each other during the motion
  /// on_border << k: the nearest point of the triangle has no weight on corner k; it lies on a side or in
  /// another corner. Edges use `on_border << 0` alone: the nearest point of one of them is its end.
  static constexpr unsigned on_border = 4;
};

/// Contacts as columns.
struct ContactColumns {
  std::uint32_t* particle[4];
  float* c[4];       ///< weights: the distance is between points whose difference is sum_k c_k x_k
  float* normal[3];  ///< unit, from the second point to the first
  float* thickness;  ///< m
  /// Target of C, at most 0 [m]: old overlaps are removed slowly. Before `describe`: by how much at most.
  float* slop;
  float* inverse_mass;  ///< sum_k w_k c_k^2 [1/kg]
  float* approach;      ///< predicted motion of the two points towards each other, along the normal [m]
  float* static_friction;
  float* kinetic_friction;
  float* restitution;
  float* normal_sum;            ///< sum of normal corrections of the distance [m]
  float* tangent_sum[3];        ///< sum of tangential corrections of the distance [m]
  float* restitution_velocity;  ///< relative normal velocity added by apply_restitution [m/s]
  float* depth;                 ///< remaining overlap, of contacts with a normal impulse [m]
  // Only where particles roll (contact_law.h). Such a particle is the first one.
  float* share;  ///< 5/2 w_0 / inverse_mass of a ball that rotates, else 0
  float* rolling_friction;
  float* moment_sum[3];  ///< G [m]
};

/// Parameters of all contacts of a substep.
struct ContactLimits {
  float inverse_h;              ///< 1/s
  float restitution_threshold;  ///< contacts that approach slower do not bounce [m/s]
};

/// Each function processes [begin, end). Index 0: vertex and triangle; 1: edge and edge.
struct ElementPairKernels {
  /// Current distances of pairs [m].
  void (*distances[2])(const ParticleRecords&, const std::uint32_t (*pairs)[4], std::size_t begin,
                       std::size_t end, float* out);
  /// Thickness of both elements together, and their range: the greatest distance from which they can come
  /// within (1 + speculative_part) thickness + their largest contact margin in `dt` [m]. `moved` holds
  /// velocities.
  void (*ranges[2])(const ParticleRecords&, const PredictionMargins&, float dt,
                    const std::uint32_t (*pairs)[4], std::size_t begin, std::size_t end, float* thickness,
                    float* range);
  /// Subtracts `motion_since`, the motion bound of earlier substeps, from the distance bounds. Computes the
  /// distance at the substep's start of each pair that the rule does not skip. Pairs that it then still does
  /// not skip go to `found`, ascending.
  NearPairStatistics (*find_near[2])(const ParticleRecords&, const ElementPairColumns&, const NearRule&,
                                     float motion_since, float speculative_part, std::size_t begin,
                                     std::size_t end, std::uint32_t* found);
  /// The Classification of each pair of found[begin, end), as a number.
  void (*classify[2])(const ParticleRecords&, const ElementPairColumns&, float speculative_part,
                      const std::uint32_t* found, std::size_t begin, std::size_t end, float* classification);
  /// Contacts [begin, end) of the pairs found[begin, end), at `part` of their motion.
  void (*describe[2])(const ParticleRecords&, const ElementPairColumns&, const std::uint32_t* found,
                      const float* part, std::size_t begin, std::size_t end, const ContactColumns&);
  /// Contacts [begin, end); they share no particle that can move.
  void (*project)(const ParticleRecords&, const ContactColumns&, std::size_t begin, std::size_t end);
  void (*apply_restitution)(const ParticleRecords&, const ContactColumns&, const ContactLimits&,
                            float* velocity, std::size_t begin, std::size_t end);
};

/// Compiled in one translation unit per instruction set (compile_element_pairs.h).
template <class Isa>
const ElementPairKernels& element_pair_kernels();

}  // namespace souple::kernels
