#pragma once

#include "souple/broad_phase/near_pairs.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

struct ContactTables;
struct ObjectsView;
class Threads;

/// Finds the objects that come within their thickness of each other, given the motion of their particles.
struct ProximityQuery {
  // Input. Active objects are compared with passive ones.
  std::vector<std::uint8_t> active, passive;  ///< per object
  std::vector<Bounds> boxes;                  ///< per particle: box of its motion, enlarged by its margin
  std::vector<float> margin;        ///< per particle: its part of the distance that counts as contact [m]
  std::vector<float> motion_bound;  ///< per particle: upper limit of its motion [m]
  /// Per particle: w != 0 if it is active; others serve only as corners of triangles.
  std::vector<Vec4f> active_particles;

  /// Pairs of objects in contact, each once, lower index first; their order has no meaning.
  std::vector<std::array<std::uint32_t, 2>> found;

  // Temporary data.
  std::vector<Bounds> bounds;  ///< per object
  BoxSweep sweep;
  std::vector<std::array<std::uint32_t, 2>> candidates;  ///< object pairs with overlapping bounds, ascending
  ObjectPairs is_candidate, is_found;                    ///< the same; pairs found
  std::vector<std::uint8_t> has_candidate;               ///< per object
  /// Objects in candidate pairs; objects whose elements are in `elements`.
  std::vector<std::uint32_t> listed, in_elements;
  SurfaceElements elements;
  NearPairFinder finder;
  NearPairs pairs;
  std::vector<std::uint32_t> balls_a, balls_b;  ///< balls, ordered by their boxes along x

  /// Clears the input.
  void reset(const ObjectsView& objects);
  /// To be called after objects are added, removed or changed.
  void invalidate() { in_elements.clear(), elements.clear(); }
  std::size_t bytes() const;
};

/// Fills `found` of the query. Pairs that the pair table or the groups exclude are not in contact.
void find_close_objects(const ObjectsView& objects, const ContactTables& tables, ProximityQuery& query,
                        Threads& threads);

}  // namespace souple
