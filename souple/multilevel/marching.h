#pragma once

#include "souple/math/lists.h"
#include "souple/multilevel/hierarchical_levels.h"
#include "souple/threads/threads.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// The ends of the links of each particle; the shortest come first.
class LinkEnds {
 public:
  struct End {
    std::uint32_t to = 0;
    float length = 0;  ///< [m]
    std::uint32_t link = 0;
  };
  /// Longer links than a particle's eight shortest add no information about lengths along the material.
  static constexpr std::size_t max_shortest = 8;

  LinkEnds(std::span<const Link> links, std::size_t particles, Threads& threads);

  std::size_t size() const { return ends_.size(); }
  std::span<const End> of(std::uint32_t i) const { return ends_[i]; }
  std::span<const End> shortest(std::uint32_t i) const {
    return of(i).first(std::min(max_shortest, of(i).size()));
  }

 private:
  Lists<End> ends_;
};

/// Graph for lengths along the material: the shortest links of each particle, and the triangles of these.
class LinkTriangles {
 public:
  /// A neighbor v of a particle u, and the triangles u v w: triangles[k], k in [triangle_begin, triangle_end).
  struct Neighbor {
    std::uint32_t to = 0;
    float length = 0;        ///< [m]
    std::uint32_t link = 0;  ///< index of the link
    std::uint32_t triangle_begin = 0, triangle_end = 0;
  };
  /// A triangle u v w in the plane, u in the origin and w on the x-axis. [m]
  struct Triangle {
    std::uint32_t w = 0;
    float half_c = 0, inverse_2c = 0;  ///< c = |u w|
    float v_x = 0, v_y = 0;
  };

  LinkTriangles(std::span<const Link> links, const LinkEnds& ends, Threads& threads);

  std::size_t size() const { return neighbors_.size(); }
  std::span<const Neighbor> of(std::uint32_t u) const { return neighbors_[u]; }
  /// The triangles that the neighbors of u refer to.
  const Triangle* triangles_of(std::uint32_t u) const { return triangles_[u / chunk].data(); }

 private:
  static constexpr std::size_t chunk = 1024;  // particles

  void find_triangles(std::uint32_t first, std::uint32_t last, std::vector<Triangle>& triangles);

  Lists<Neighbor> neighbors_;
  std::vector<std::vector<Triangle>> triangles_;  // per chunk of particles
};

/// Lengths of the shortest paths along the material, from rest lengths alone. Paths cross triangles of links and do not
/// only follow links, so lengths do not depend on the triangulation. This is fast marching (Kimmel and Sethian 1998),
/// with the unfolding of a triangle's known edge.
class Marcher {
 public:
  struct Reached {
    std::uint32_t particle = 0;
    float length = 0;  ///< from the source [m]
  };

  explicit Marcher(const LinkTriangles& triangles);

  /// Particles no farther than `radius` from `source`, nearest first; valid until the next march.
  std::span<const Reached> march(std::uint32_t source, float radius);
  /// Marches at least to `min_radius`, then up to `max_radius` until enough(particle) is true of a particle reached.
  template <class Enough>
  std::span<const Reached> march(std::uint32_t source, float min_radius, float max_radius,
                                 const Enough& enough) {
    begin(source, max_radius);
    bool is_enough = false;
    while (next_length() <= (is_enough ? min_radius : max_radius)) is_enough = enough(reach_next());
    return reached_;
  }
  /// Neighbors of these particles that were not reached. Their lengths are those across triangles of particles
  /// reached: a longer march might find shorter ones.
  std::span<const Reached> beyond();

 private:
  struct Seen {
    std::uint32_t march = 0;  // number of the last march that offered a length
    float length = 0;         // the shortest offered
  };

  void begin(std::uint32_t source, float radius);
  float next_length();
  std::uint32_t reach_next();
  void pop();
  void offer(std::uint32_t v, float length);
  void relax_neighbors(std::uint32_t u, float du);

  const LinkTriangles& triangles_;
  std::uint32_t march_ = 0;
  float radius_ = 0;
  std::vector<Seen> seen_;
  std::vector<float> squared_;       // per particle: square of its length; infinite if not reached
  std::vector<std::uint64_t> heap_;  // bits of the length, particle
  std::vector<std::uint32_t> offered_;
  std::vector<Reached> reached_, beyond_;
};

/// Length straight across the edge u w to v. The line starts on the other side, at the distances d_u and d_w from u and
/// w. The length is infinite if the line does not cross the edge. |u w| = c, |u v| = a, |w v| = b.
float unfolded_length(float d_u, float d_w, float c, float a, float b);

}  // namespace souple
