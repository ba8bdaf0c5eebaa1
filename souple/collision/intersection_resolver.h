#pragma once

#include "souple/collision/contact.h"
#include "souple/collision/intersection_finder.h"
#include "souple/collision/layers.h"

#include <cstdint>
#include <span>
#include <vector>

namespace souple {

/// Two objects, or one twice, that are tangled.
struct IntersectingPair {
  std::uint32_t edge_surface = 0, surface = 0;  ///< edges of the one pass through triangles of the other
  std::size_t edges = 0;                        ///< so many
  bool held = false;                            ///< nothing of them can move
};

/// Pulls apart what is tangled: slowly, with forces that keep momentum.
///
/// Edges through triangles that hang together are a knot. Each knot of two objects has a direction: the one
/// along which the first must be displaced least, as it is, until no edge near the knot passes through a
/// triangle any more and no corner of the knot lies inside of a closed surface. Several directions and
/// distances are tried when the knot is first seen, and again when it is not undone in time. Where none
/// helps, and where an object is tangled with itself, edges go where their part of the contour gets shorter:
/// Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
/// minimization". Their contour alone finds no way out where it keeps its length, such as that of
/// a sheet that goes right through a box, or through another sheet from side to side.
///
/// What pulls is a bound on velocities: the point of the edge and the point of the triangle where they cross
/// part by at least
///
///   n . sum_k c_k (p_k - x_k) >= u h,   u <= ContactStep::depenetration_speed,
///
/// and likewise a vertex inside a closed surface and the point where the direction leaves it. Corrections are
/// w_k c_k n: equal, opposite and in one line. So there is no depth that could make it violent.
///
/// Two layers have no knots to look at from all sides: it is known where they belong (layers.h). Edges
/// through triangles are pulled along the normal of the lower one, each by itself, and so are points of the
/// upper one that are under it, whether anything is tangled or not.
///
/// Until it is undone, contacts must not hold what belongs to it: `exempts`.
class IntersectionResolver {
 public:
  /// As SurfaceContacts.
  void set_surfaces(std::span<const ContactSurface> surfaces);
  void exclude(std::vector<std::array<std::uint32_t, 2>> pairs) { finder_.exclude(std::move(pairs)); }

  /// Looks for tangles and layers that lie wrong where the caller says so, and as long as there are some.
  void begin_step(const ParticleView& particles, const ContactStep& step, bool look, Threads& threads);
  /// After prediction, before contacts are refreshed.
  void pull(const ParticleView& particles, const Substep& substep) const;

  /// Whether contacts must let the pair pass.
  bool exempts(const NearPair& pair, bool edges) const;
  /// What `begin_step` found, by surfaces.
  std::span<const IntersectingPair> pairs() const { return pairs_; }
  /// Points of layers that lie wrong.
  std::span<const Misplaced> misplaced() const { return layers_.found(); }
  std::size_t bytes() const;

 private:
  /// How a knot is pulled; what it leaves to the knots of the next step.
  struct Course {
    bool known = false;                  // it has been looked for
    Vec3f direction{};                   // of a relative to b; zero: by the contour
    float speed = 0;                     // m/s
    std::size_t fewest = 0;              // edges that it had
    double deadline = 0;                 // by when it should be undone, or have fewer [s]
    int doublings = 0;                   // of the speed
    int attempt = 0;                     // directions so far
    std::uint32_t tried = 0, which = 0;  // bits of those, and the one it has
  };
  /// Of surfaces a <= b.
  struct Knot : Course {
    std::uint32_t a = 0, b = 0;
    std::size_t first = 0, count = 0;  // of order_
    Bounds bounds{};
  };
  struct Pull {
    std::array<std::uint32_t, 5> particle;
    std::array<float, 5> c;
    Vec3f direction;
    float speed;
  };

  const EdgeIntersection& crossing(std::size_t k) const { return finder_.intersections()[order_[k]]; }
  void sort_by_pairs();
  void count_pairs(const ParticleView& particles);
  void find_knots(const ParticleView& particles);
  std::uint32_t root(std::uint32_t k);
  void join_crossings();
  void number_knots(const ParticleView& particles);
  void sort_by_knots();
  void inherit(Knot& knot) const;
  void remember();
  void collect_edges(const Knot& knot, const ParticleView& particles, const Bounds& region);
  float find_way(Knot& knot, const ParticleView& particles, float farthest);
  void take_turns(Knot& knot, const ParticleView& particles, double time, float most_speed);
  void choose_direction(Knot& knot, const ParticleView& particles, double time, float most_speed);
  void attend(Knot& knot, const ParticleView& particles, double time, float most_speed, int& searches);
  bool is_parted(const Knot& knot, const ParticleView& particles, const Bounds& region,
                 const Vec3f& shift) const;
  bool is_outside(const Knot& knot, const ParticleView& particles, const Vec3f& shift) const;
  Vec3f contour_pull(const EdgeIntersection& crossing, const ParticleView& particles) const;
  void touch();
  void pull_knot(const Knot& knot, const ParticleView& particles);
  void pull_inside(const Knot& knot, const ParticleView& particles, bool turned, Threads& threads);
  void pull_layers(const ContactStep& step, const ParticleView& particles);
  void find(const ParticleView& particles, bool look, Threads& threads);
  void add(const Pull& pull, const ParticleView& particles);

  IntersectionFinder finder_;
  Layers layers_;
  std::vector<std::uint32_t> order_;  // of finder_.intersections(): by pair, then knot
  std::vector<IntersectingPair> pairs_;
  std::vector<Knot> knots_, old_knots_;
  std::vector<std::uint32_t> root_, last_of_, knot_of_;  // of crossings; of particles
  std::vector<std::uint32_t> old_knot_of_;               // of particles
  std::vector<std::uint8_t> touched_;                    // of particles
  std::vector<std::uint32_t> inside_;                    // of particles: which surface, or none
  std::vector<std::uint32_t> edges_a_, edges_b_;         // near the knot whose direction is looked for
  std::vector<SurfaceHit> hits_;                         // of the vertices that are looked from
  std::vector<Pull> pulls_;
  ObjectMatrix intersecting_pairs_, watched_;  // watched: also those whose layers lie wrong
  std::size_t fewest_misplaced_ = 0;
  double hurry_at_ = 0;   // by when there should be fewer of them [s]
  int hurries_ = 0;       // doublings of the speed at which they are pulled
  double last_time_ = 0;  // when the last step began [s]: earlier after a snapshot was restored
  int idle_ = 0;          // steps since a tangle that is held was looked at
};

}  // namespace souple
