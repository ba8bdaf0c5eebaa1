#pragma once

#include "souple/collision/spatial_hash.h"
#include "souple/collision/surface_elements.h"
#include "souple/solver/threads.h"
#include "souple/state/particles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// A vertex near a triangle (particles v; a, b, c), or an edge near an edge (a, b; c, d). A loose vertex near
/// a loose edge is an edge from it to itself (v, v; a, b).
struct NearPair {
  std::uint32_t particle[4];
};

struct NearPairs {
  std::vector<NearPair> vertex_triangle, edge_edge;
};

/// Which objects' surfaces are compared; symmetric. at(a, a): an object with itself.
class ObjectMatrix {
 public:
  ObjectMatrix() = default;
  /// `meet`: what all pairs begin with.
  explicit ObjectMatrix(std::size_t objects, bool collide = false)
      : objects_(objects), collide_(objects * objects, collide) {}
  void set(std::size_t a, std::size_t b, bool collide) {
    collide_[a * objects_ + b] = collide_[b * objects_ + a] = collide;
  }
  void clear() { std::fill(collide_.begin(), collide_.end(), std::uint8_t{0}); }
  bool at(std::size_t a, std::size_t b) const { return collide_[a * objects_ + b] != 0; }
  std::size_t size() const { return objects_; }

 private:
  std::size_t objects_ = 0;
  std::vector<std::uint8_t> collide_;
};

/// Finds what may touch within a step: vertices whose box overlaps that of a triangle, edges whose box
/// overlaps that of an edge, and loose vertices (grains) whose box overlaps that of a loose edge (a rope's).
///
/// Patches of up to 15 neighboring triangles (see SurfaceElements) are entered in the spatial hash, each
/// with what it owns; two patches whose boxes overlap are compared item by item, a register's worth at a
/// time. The first version, a hash of single triangles and another of single edges that were compared one by
/// one, took seven times as long (100 k triangles): every edge overlaps some twenty others, and most are its
/// neighbors. Patches of at most 6, 8, 12 and 15 triangles took 1.33, 1.12, 1.06 and 1 of the time.
class NearPairFinder {
 public:
  /// Replaces `out`. `boxes`: of each particle, swept over the step and thickened [m]; that of an edge or a
  /// triangle is the smallest around its corners'. Compared where meets.at(object, object). Left out: pairs
  /// that share a particle, pairs of which nothing can move (inverse mass 0 everywhere) and whatever has a
  /// box that is not finite. Two loose vertices are never a pair. The order depends on elements and boxes
  /// alone: it is the same for any number of threads. `position_w`: particles, w = inverse mass. Throws Error
  /// when `boxes`, `position_w` or `meets` are too small. Allocates nothing when warm.
  void find(const SurfaceElements& elements, std::span<const Bounds> boxes, const ObjectMatrix& matrix,
            std::span<const Vec4f> position_w, NearPairs& out, Threads& threads);

  /// After a find: boxes of some particles are larger or elsewhere. Replaces `out` by all pairs, with nothing
  /// but boxes as they are now, that have one of these (SurfaceElements::index_particles must have been
  /// called). Pairs of theirs that were found before are found again. Costs little where few have moved.
  /// Elements, matrix and masses must be those of the find.
  void find_moved(std::span<const std::uint32_t> particles, std::span<const Bounds> boxes,
                  std::span<const Vec4f> position_w, NearPairs& out, Threads& threads);

  /// Of the last find: vertices, edges and triangles left out because a box was not finite.
  std::size_t left_out() const { return left_out_; }
  /// Of the last find, wall clock [ms].
  struct Milliseconds {
    double boxes = 0, build = 0, pairs = 0;
  };
  const Milliseconds& milliseconds() const { return milliseconds_; }
  std::size_t bytes() const;

 private:
  /// Pairs one after the other, with room behind them.
  struct List {
    std::vector<NearPair> pairs;
    std::size_t count = 0;
    kernels::Quad* grow_capacity(std::size_t more);
  };
  /// What one thread finds.
  struct Part {
    List vertex_triangle, edge_edge;
    std::vector<std::uint32_t> found;
  };
  /// Of a fixed number of patches: where its pairs are in its part, and where they go.
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
  /// Which items of a patch are looked for: all, or those that have a particle that moved.
  struct Marks {
    std::uint32_t vertices = 0, edges = 0, triangles = 0;
  };
  enum class Moves : std::uint8_t { nothing, some, all };  ///< of a patch's vertices, edges and triangles

  void make_boxes(std::span<const Bounds> boxes, std::span<const Vec4f> position_w, Threads& threads);
  std::size_t make_boxes_of(std::size_t patch, std::span<const Vec4f> position_w);
  template <class Function>
  void find_in_chunks(std::size_t count, std::size_t per_chunk, NearPairs& out, Threads& threads,
                      const Function& find_one);
  void mark(std::span<const std::uint32_t> particles);
  void unmark(std::span<const std::uint32_t> particles);
  void find_near(std::uint32_t patch, std::span<const Vec4f> position_w, Part& part) const;
  void find_between(std::uint32_t a, const Marks& of_a, std::uint32_t b, const Marks& of_b,
                    std::span<const Vec4f> position_w, Part& part) const;
  void join(Piece Chunk::*piece, List Part::*list, std::vector<NearPair>& out, std::size_t parts,
            Threads& threads);

  // Of the find that runs.
  const SurfaceElements* elements_ = nullptr;
  const ObjectMatrix* matrix_ = nullptr;
  const kernels::PatchKernels* kernels_ = nullptr;
  kernels::BoxColumns vertices_{}, edges_{}, triangles_{};

  std::vector<Bounds> clean_boxes_;  // of each particle: endless where it was not finite
  Boxes vertex_boxes_, edge_boxes_, triangle_boxes_;
  std::vector<Bounds> patch_boxes_;
  std::vector<Moves> moves_;  // of each patch
  SpatialHash hash_;
  std::vector<Part> parts_;
  std::vector<Chunk> chunks_;
  std::vector<std::size_t> left_out_of_;      // each chunk
  std::vector<Marks> marks_;                  // of each patch, in find_moved
  std::vector<std::uint8_t> is_moving_;       // of each particle
  std::vector<std::uint32_t> moved_patches_;  // patches that name a particle that moved
  std::size_t left_out_ = 0;
  Milliseconds milliseconds_;
};

}  // namespace souple
