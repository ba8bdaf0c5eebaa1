#pragma once

#include <cstddef>
#include <cstdint>

// Vertices against triangles and edges against edges, a register's worth of pairs at a time. One lane serves
// processors without registers of ours, and to compare with: all give the same bits.

namespace souple::kernels {

/// Arrays of 16-byte records, one per particle (see solver/projector.h).
struct ParticleRecords {
  const float* position = nullptr;  ///< w = inverse mass [1/kg]
  float* moving = nullptr;          ///< plain form: the same as position
  float* corrected = nullptr;       ///< what project adds to: `moving`, unless the solver is Jacobi's
  const float* start = nullptr;     ///< `moving` when the substep began; read by project
  const float* moved = nullptr;     ///< moving - start; read by reaches, near, judge and describe
  /// How much earlier contacts of a particle begin [m]; read by reaches and judge.
  const float* contact_margin = nullptr;
};

/// Pairs of a vertex and a triangle, or of two edges, column by column.
struct ElementPairColumns {
  const std::uint32_t (*particle)[4] = nullptr;
  const float* thickness = nullptr;  ///< m
  float* distance_bound = nullptr;   ///< at least so far apart when the substep began [m]
};

/// What particles keep between them, and how far they may leave their ways. [m]
struct PredictionMargins {
  const float* radius = nullptr;  ///< half the thickness of each particle
  const float* margin = nullptr;  ///< of particle i: room[i * stride]
  std::size_t stride = 1;
  float min_thickness = 0, speculative_part = 0;
};

/// Pairs are passed over while their way, how far a point of one moves relative to one of the other, is below
/// known_part known - thickness_part thickness - pressed.
struct NearRule {
  float bound_part, thickness_part;
  float contact_margin;  ///< the most of all their particles, m
};

/// Of some pairs, after one look at them.
struct NearPairStatistics {
  std::size_t found = 0;
  float min_distance_bound;  ///< of all, m
  float min_gap_bound;       ///< of known - (1 + early) thickness, m
};

/// What judge() says of a pair.
struct Classification {
  /// It will be as near as (1 + early) thickness + the most that its particles are pressed, and can move.
  static constexpr unsigned touches = 1;
  static constexpr unsigned fast = 2;  ///< it may pass through itself on the way
  /// The nearest point of the triangle has no weight on corner k: it lies on a side or in another corner. For
  /// edges only `on_border << 0`: the nearest point of one of them is its end.
  static constexpr unsigned on_border = 4;
};

/// Contacts column by column; what is not const is written in a substep.
struct ContactColumns {
  std::uint32_t* particle[4];
  float* c[4];          ///< weights: the distance is between points whose difference is sum_k c_k x_k
  float* normal[3];     ///< unit, from the second point to the first
  float* thickness;     ///< m
  float* slop;          ///< C may stay this negative: an old overlap leaves slowly [m]
  float* inverse_mass;  ///< sum_k w_k c_k^2 [1/kg]
  float* approach;      ///< along the normal, what prediction moved the two towards each other [m]
  float* static_friction;
  float* kinetic_friction;
  float* restitution;
  float* normal_sum;            ///< sum of normal corrections of the distance [m]
  float* tangent_sum[3];        ///< sum of tangential corrections of the distance [m]
  float* restitution_velocity;  ///< relative normal velocity added by apply_restitution [m/s]
  float* depth;                 ///< what is left of the overlap of one that pushed [m]
};

/// What all contacts of a substep share.
struct ContactLimits {
  float inverse_h;              ///< 1/s
  float restitution_threshold;  ///< approach below it does not bounce [m/s]
  float depenetration;          ///< how far an old overlap may leave in this substep [m]
};

/// Each for pairs [begin, end). Index 0: a vertex and a triangle; 1: two edges.
struct ElementPairKernels {
  /// How far they are apart now [m].
  void (*distances[2])(const ParticleRecords&, const std::uint32_t (*pairs)[4], std::size_t begin,
                       std::size_t end, float* out);
  /// What both are thick together, and from how far they can come within (1 + early) of that, and what the
  /// most pressed of them adds, in `dt`, with `moved` the velocities of particles [m].
  void (*ranges[2])(const ParticleRecords&, const PredictionMargins&, float dt,
                    const std::uint32_t (*pairs)[4], std::size_t begin, std::size_t end, float* thickness,
                    float* range);
  /// Takes `owed` off what is known: what they may have moved in earlier substeps. Pairs that the rule does
  /// not pass over, as soon as their distance is known, go to `found`, ascending.
  NearPairStatistics (*find_near[2])(const ParticleRecords&, const ElementPairColumns&, const NearRule&,
                                     float motion_since, float speculative_part, std::size_t begin,
                                     std::size_t end, std::uint32_t* found);
  /// A Verdict for each of the pairs `found[begin, end)`, as a number.
  void (*classify[2])(const ParticleRecords&, const ElementPairColumns&, float speculative_part,
                      const std::uint32_t* found, std::size_t begin, std::size_t end, float* classification);
  /// Contacts [begin, end): of the pairs `found[begin, end)`, where `part` of their way has led them.
  void (*describe[2])(const ParticleRecords&, const ElementPairColumns&, const ContactLimits&,
                      const std::uint32_t* found, const float* part, std::size_t begin, std::size_t end,
                      const ContactColumns&);
  /// Contacts [begin, end), no two of which share a particle that can move.
  void (*project)(const ParticleRecords&, const ContactColumns&, std::size_t begin, std::size_t end);
  void (*apply_restitution)(const ParticleRecords&, const ContactColumns&, const ContactLimits&,
                            float* velocity, std::size_t begin, std::size_t end);
};

/// Compiled in one translation unit per instruction set (compile_element_pairs.h).
template <class Isa>
const ElementPairKernels& element_pair_kernels();

}  // namespace souple::kernels
