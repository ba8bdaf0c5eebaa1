#pragma once

#include "souple/collision/near_pairs.h"
#include "souple/state/particles.h"

#include <array>
#include <cstdint>
#include <vector>

namespace souple {

struct WorldState;

/// Tells which objects come within their thickness of each other, by where their particles go.
struct ProximityQuery {
  // What is asked. Those that ask are compared with those that answer.
  std::vector<std::uint8_t> active, passive;  ///< of each object
  std::vector<Bounds> boxes;                  ///< of each particle, over its way, with its reach
  std::vector<float> margin;                  ///< how near another counts as a touch: its own share [m]
  std::vector<float> motion_bound;            ///< how far it goes at most [m]
  std::vector<Vec4f> active_particles;        ///< w != 0: one that asks; others are only there for triangles

  /// Pairs of objects that touch, each once, the lower index first, in no order of meaning.
  std::vector<std::array<std::uint32_t, 2>> found;

  // Scratch.
  std::vector<Bounds> bounds;                      ///< of each object
  ObjectMatrix is_candidate, is_found;             ///< objects whose bounds meet; those that are found
  std::vector<std::uint32_t> listed, in_elements;  ///< objects that are compared; those that `elements` has
  SurfaceElements elements;
  NearPairFinder finder;
  NearPairs pairs;
  std::vector<std::uint32_t> balls_a, balls_b;  ///< balls, in order of their boxes along x

  /// Empties what is asked.
  void reset(const WorldState& world);
  /// Objects came, went or changed.
  void invalidate() { in_elements.clear(), elements.clear(); }
  std::size_t bytes() const;
};

/// Fills `found` of the world's ProximityQuery. What the pair table and the groups keep apart does not touch.
void find_close_objects(WorldState& world);

}  // namespace souple
