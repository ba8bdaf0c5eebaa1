#pragma once

#include "souple/broad_phase/near_pair.h"
#include "souple/contacts/kernels/element_pairs.h"
#include "souple/threads/threads.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Candidate pairs as columns, divided into chunks that are tested or skipped together. Pairs are appended; a later search
/// of a particle's pairs replaces its earlier ones.
class PairChunks {
 public:
  static constexpr std::size_t chunk_size = 512;  ///< greatest number of pairs in a chunk
  /// Consecutive pairs of one kind.
  struct Chunk {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t blocks = 0;  // see MotionBounds
    bool edges = false, inter_object = false;
    float min_distance_bound = 0, min_gap_bound = 0;  // of its pairs, when they were last tested [m]
    float motion_since = 0;                           // motion bound since that test [m]
  };
  /// Pairs of a part of the search, as columns.
  struct List {
    std::vector<NearPair> particle;
    std::vector<float> thickness, distance_bound;
    std::size_t count = 0, offset = 0;  // offset: in the columns of all pairs
    void resize(std::size_t size);
    void add(const NearPair& pair, float pair_thickness, float distance);
    std::size_t bytes() const;
  };
  /// Those that are near already, and the far ones, which are seldom tested.
  struct Batch {
    List near, far;
  };

  /// Drops all pairs. `particles`: number of particles that pairs may have.
  void clear(std::size_t particles);
  /// Drops all pairs of a step.
  void clear();
  /// Appends a list of all batches, and divides the new pairs into chunks.
  void append(std::span<Batch> batches, List Batch::*list, bool edges, bool inter_object, Threads& threads);
  /// Pairs of the particle so far are replaced by those that will be appended.
  void replace_pairs_of(std::uint32_t particle) {
    replaced_.push_back(particle);
    valid_from_[particle] = static_cast<std::uint32_t>(size());
  }
  /// Call when all pairs of a search are appended.
  void end_search() { lasting_ = size(); }
  /// Drops replaced pairs, and chunks that become empty, if they may be a third of all. Returns the former indices of the
  /// others, ascending, or nothing if none were dropped.
  std::span<const std::uint32_t> drop_replaced();

  std::size_t size() const { return particle_.size(); }
  const NearPair& pair(std::size_t index) const { return particle_[index]; }
  bool are_edges(std::size_t pair) const { return is_edges_[pair] != 0; }
  /// Lower bound of the distance of a pair [m].
  float distance_bound(std::size_t pair) const { return distance_bound_[pair]; }
  float thickness(std::size_t pair) const { return thickness_[pair]; }
  /// Whether pairs of a later search replace this pair.
  bool is_replaced(std::size_t pair) const {
    const auto& i = particle_[pair].particle;
    return pair < valid_from_[i[0]] || pair < valid_from_[i[1]] || pair < valid_from_[i[2]] ||
           pair < valid_from_[i[3]];
  }
  kernels::ElementPairColumns columns();
  std::span<Chunk> chunks() { return chunks_; }
  std::span<const Chunk> chunks() const { return chunks_; }
  std::size_t bytes() const;

 private:
  void replace_none();

  std::vector<NearPair> particle_;
  std::vector<float> thickness_, distance_bound_;
  std::vector<std::uint8_t> is_edges_;
  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> valid_from_;  // per particle: its pairs with a lower index are replaced
  std::vector<std::uint32_t> replaced_;    // particles with such pairs, some more than once
  std::size_t lasting_ = 0;                // pairs after the last search of all, or drop_replaced
  std::vector<std::uint32_t> kept_;        // what drop_replaced returns
};

}  // namespace souple
