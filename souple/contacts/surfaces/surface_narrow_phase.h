#pragma once

#include "souple/contacts/anchor.h"
#include "souple/contacts/contact_material.h"
#include "souple/contacts/surfaces/element_pairs.h"
#include "souple/contacts/surfaces/feature_owners.h"

#include <cstdint>
#include <vector>

namespace souple {

/// Crossing of a vertex' path and a triangle.
struct PathCrossing {
  bool found = false;
  Vec3f weight;  ///< barycentric coordinates of the crossing for the three corners
  Vec3f normal;  ///< unit normal of the triangle, to the side that the vertex comes from
};

/// Nearest point of a contact's first element relative to that of the second.
Anchor<4> anchor_of(const kernels::ContactColumns& contacts, std::size_t c);
/// By how much a contact has moved that point [m].
Vec3f correction_of(const kernels::ContactColumns& contacts, std::size_t c);

/// Finds which candidate pairs touch, and describes their contacts: weights, normal, friction.
class SurfaceNarrowPhase {
 public:
  void build(const ElementSurfaces& surfaces) { owners_.build(surfaces); }
  /// Throws Error if the table has fewer materials than there are surfaces. It must live until the step ends.
  void begin_step(const ElementSurfaces& surfaces, const ContactMaterialTable& materials,
                  const ContactStep& step);
  void begin_substep(float h);
  const kernels::ContactLimits& limits() const { return limits_; }
  const FeatureOwners& owners() const { return owners_; }
  /// Material of two surfaces whose sides move by `moved` relative to each other in the substep [m].
  ContactMaterialPair material(std::uint32_t one, std::uint32_t other, const Vec3f& moved) const;
  /// By how much an old overlap of two surfaces shrinks in the substep [m].
  float release(std::uint32_t one, std::uint32_t other) const;
  bool is_discrete() const { return step_.detection == Detection::discrete; }

  /// Finds the contacts of the substep, in order of pairs.
  void find_contacts(ElementPairs& candidates, const ParticleView& particles, std::vector<PairToi>& found,
                     Threads& threads);
  /// Finds the pairs that would touch along their motions, in order of pairs: all of them, or those of the particles that
  /// candidates.measure measured last.
  void find_violations(ElementPairs& candidates, const ParticleView& particles, bool all,
                       std::vector<PairToi>& found, Threads& threads);
  /// Describes contacts [begin, end) of one kind at their times of impact.
  void describe(ElementPairs& candidates, bool edges, std::size_t begin, std::size_t end,
                const ParticleView& particles, const std::vector<std::uint32_t>& pairs,
                const std::vector<float>& tois, const kernels::ContactColumns& out) const;
  /// Discrete detection: replaces the nearest points and the normal between them by the crossing and the triangle's
  /// normal.
  void describe_crossing(ElementPairs& candidates, std::uint32_t pair, std::size_t contact,
                         const ParticleView& particles, const kernels::ContactColumns& out) const;
  std::size_t bytes() const;

 private:
  bool is_placed_at_one_place(const ElementPairs& candidates, std::uint32_t pair) const;
  static void describe_coincident(const ElementPairs& candidates, std::size_t contact,
                                  const ParticleView& particles, const kernels::ContactColumns& out);
  /// Contacts or violations in a chunk of pairs.
  struct ChunkResult {
    std::vector<PairToi> pairs;
    std::size_t offset = 0;  // in the list of all chunks
  };
  template <class Function>
  void find(std::size_t chunks, std::vector<PairToi>& found, Threads& threads, const Function& of_chunk);
  void find_chunk_contacts(ElementPairs& candidates, std::size_t chunk, const ParticleView& particles,
                           std::vector<PairToi>& found) const;
  void find_chunk_crossings(ElementPairs& candidates, std::size_t chunk, const ParticleView& particles,
                            std::vector<PairToi>& found) const;
  PathCrossing path_crossing_of(ElementPairs& candidates, std::uint32_t pair,
                                const ParticleView& particles) const;
  bool is_contact(const ElementPairs& candidates, std::uint32_t pair, unsigned classification,
                  const ParticleView& particles, float& toi) const;

  FeatureOwners owners_;
  const ContactMaterialTable* materials_ = nullptr;
  ContactStep step_;
  kernels::ContactLimits limits_{};
  std::vector<ChunkResult> chunk_results_;  // per chunk
};

}  // namespace souple
