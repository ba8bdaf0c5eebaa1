#pragma once

#include "souple/broad_phase/near_pair.h"
#include "souple/broad_phase/object_pairs.h"
#include "souple/broad_phase/spatial_hash.h"
#include "souple/broad_phase/surface_elements.h"
#include "souple/state/particles.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

struct NearPairs {
  std::vector<NearPair> vertex_triangle, edge_edge;
};

/// Finds pairs of elements with overlapping boxes, which may come into contact within a step. The pairs are vertices
/// and triangles, edges and edges, and grains and edges of ropes.
///
/// The spatial hash contains patches of up to 15 neighboring triangles (see SurfaceElements), with the edges
/// and vertices that they own. Two patches with overlapping boxes are compared item by item, a register at a
/// time. The first version had a hash of single triangles and another one of single edges, compared one by
/// one. It took seven times as long (100 k triangles): every edge overlaps some twenty others, and most are
/// its neighbors. Patches of at most 6, 8, 12 and 15 triangles took 1.33, 1.12, 1.06 and 1 of the time.
class NearPairFinder {
 public:
  /// Replaces `out`. `boxes`: per particle, swept over the step and thickened [m]. The box of an edge or a
  /// triangle is the smallest one around the boxes of its corners. Two elements are compared if
  /// compares(object, object). Skipped: elements that share a particle, pairs whose particles all have
  /// inverse mass 0, and elements with a box that is not finite. Two grains are never a pair. The order of
  /// pairs depends on elements and boxes alone, not on the number of threads. `position_w`: per particle, w =
  /// inverse mass. Throws Error when `boxes` or `position_w` are too small. Allocates nothing when
  /// warm. Returns false, with `out` empty, if there are more than `most` pairs. Memory and time are then bounded by
  /// `most` and the number of patches, however large the boxes are.
  bool find(const SurfaceElements& elements, std::span<const Bounds> boxes, const ObjectFilter& compares,
            std::span<const Vec4f> position_w, NearPairs& out, Threads& threads,
            std::size_t most = unlimited);
  static constexpr std::size_t unlimited = ~std::size_t{0};

  /// Takes over elements and boxes for find_moved, as a find does, without a search.
  void begin(const SurfaceElements& elements, std::span<const Bounds> boxes,
             std::span<const Vec4f> position_w, Threads& threads);

  /// Call after a find or `begin`, when the boxes of `particles` have changed. Replaces `out` by all pairs that contain such a
  /// particle, from the present boxes alone, including pairs that the find returned. Call
  /// SurfaceElements::index_particles before. Costs little for few particles. Elements, filter and masses must be those
  /// of the find. `most`: as in `find`.
  bool find_moved(std::span<const std::uint32_t> particles, std::span<const Bounds> boxes,
                  const ObjectFilter& compares, std::span<const Vec4f> position_w, NearPairs& out,
                  Threads& threads, std::size_t most = unlimited);

  /// Vertices, edges and triangles that the last find skipped because their box was not finite.
  std::size_t left_out() const { return left_out_; }
  /// Wall-clock time of the last find [ms].
  struct Milliseconds {
    double boxes = 0, build = 0, pairs = 0;
  };
  const Milliseconds& milliseconds() const { return milliseconds_; }
  std::size_t bytes() const;

 private:
  /// Pairs [0, count), and spare capacity after them.
  struct List {
    std::vector<NearPair> pairs;
    std::size_t count = 0;
    /// Ensures capacity for `more` pairs; returns a pointer to the next one.
    kernels::Quad* grow_capacity(std::size_t more);
  };
  /// Pairs that one thread finds.
  struct Part {
    List vertex_triangle, edge_edge;
    std::vector<std::uint32_t> found;
  };
  /// Pairs of a fixed number of patches: [begin, begin + count) of their part; `offset` in the result.
  struct Piece {
    std::size_t begin = 0, count = 0, offset = 0;
  };
  struct Chunk {
    Piece vertex_triangle, edge_edge;
  };
  /// The boxes of all vertices, edges or triangles.
  struct Boxes {
    std::array<std::vector<float>, 3> lo, hi;
    void resize(std::size_t count);
    void set(std::size_t i, const Bounds& box);
    kernels::BoxColumns columns() const;
  };
  /// Items of a patch whose pairs are searched: bit k for item k, all or those with a moved particle.
  struct Marks {
    std::uint32_t vertices = 0, edges = 0, triangles = 0;
  };
  enum class Moves : std::uint8_t { nothing, some, all };  ///< items of a patch that can move

  void make_boxes(std::span<const Bounds> boxes, std::span<const Vec4f> position_w, Threads& threads);
  std::size_t make_boxes_of(std::size_t patch, std::span<const Vec4f> position_w);
  template <class Function>
  bool find_in_chunks(std::size_t count, std::size_t per_chunk, std::size_t most, NearPairs& out,
                      Threads& threads, const Function& find_one);
  void find_own_patches();
  void find_partners(const ObjectFilter& compares, Threads& threads);
  SpatialHash::Skip skipped(std::uint32_t patch, const ObjectFilter& compares) const;
  void mark(std::span<const std::uint32_t> particles);
  void unmark(std::span<const std::uint32_t> particles);
  void find_near(std::uint32_t patch, const ObjectFilter& compares, std::span<const Vec4f> position_w,
                 Part& part) const;
  void find_between(std::uint32_t a, const Marks& of_a, std::uint32_t b, const Marks& of_b,
                    const ObjectFilter& compares, std::span<const Vec4f> position_w, Part& part) const;
  void join(Piece Chunk::*piece, List Part::*list, std::vector<NearPair>& out, std::size_t parts,
            Threads& threads);

  // Input of the current find.
  const SurfaceElements* elements_ = nullptr;
  const kernels::PatchKernels* kernels_ = nullptr;
  kernels::BoxColumns vertices_{}, edges_{}, triangles_{};

  std::vector<Bounds> clean_boxes_;  // per particle: its box; infinite where it was not finite
  Boxes vertex_boxes_, edge_boxes_, triangle_boxes_;
  std::vector<Bounds> patch_boxes_;
  std::vector<Moves> moves_;                    // per patch
  std::vector<SpatialHash::Skip> own_patches_;  // per patch: it and its neighbors in order, of its object
  SpatialHash hash_;
  std::vector<Part> parts_;
  std::vector<Chunk> chunks_;
  /// Patches that overlap, of a number of patches.
  struct Overlaps {
    std::vector<std::uint32_t> found;
    std::vector<std::array<std::uint32_t, 2>> pairs;
  };
  std::vector<Overlaps> overlaps_;                            // per chunk
  std::vector<std::uint32_t> partners_begin_, next_partner_;  // per patch
  std::vector<std::uint32_t> partners_;       // those with a higher number that a patch overlaps, ascending
  std::vector<std::size_t> left_out_of_;      // per chunk
  std::vector<Marks> marks_;                  // per patch, in find_moved
  std::vector<std::uint8_t> is_moving_;       // per particle, in find_moved
  std::vector<std::uint32_t> moved_patches_;  // patches with a particle of find_moved
  std::size_t left_out_ = 0;
  Milliseconds milliseconds_;
};

}  // namespace souple
