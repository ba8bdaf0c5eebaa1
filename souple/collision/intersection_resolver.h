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
  bool immovable = false;                       ///< nothing of them can move
};

/// Pulls apart what is tangled: slowly, with forces that keep momentum.
///
/// Edges through triangles that hang together are a component. Each component of two objects has a direction: the one
/// along which the first must be displaced least, as it is, until no edge near the component passes through a
/// triangle any more and no corner of the component lies inside of a closed surface. Several directions and
/// distances are tried when the component is first seen, and again when it is not undone in time. Where none
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
  void begin_step(const ParticleView& particles, const ContactStep& step, bool search_all, Threads& threads);
  /// After prediction, before contacts are refreshed.
  void separate(const ParticleView& particles, const Substep& substep) const;

  /// Whether contacts must let the pair pass.
  bool exempts(const NearPair& pair, bool edges) const;
  /// What `begin_step` found, by surfaces.
  std::span<const IntersectingPair> pairs() const { return pairs_; }
  /// Points of layers that lie wrong.
  std::span<const LayerViolation> layer_violations() const { return layers_.found(); }
  std::size_t bytes() const;

 private:
  /// How a component is pulled; what it leaves to the knots of the next step.
  struct Strategy {
    bool chosen = false;                   // it has been looked for
    Vec3f direction{};                     // of a relative to b; zero: by the contour
    float speed = 0;                       // m/s
    std::size_t min_count = 0;             // edges that it had
    double deadline = 0;                   // by when it should be undone, or have fewer [s]
    int escalations = 0;                   // of the speed
    int attempt = 0;                       // directions so far
    std::uint32_t tried = 0, current = 0;  // bits of those, and the one it has
  };
  /// Of surfaces a <= b.
  struct Component : Strategy {
    std::uint32_t a = 0, b = 0;
    std::size_t first = 0, count = 0;  // of order_
    Bounds bounds{};
  };
  struct VelocityConstraint {
    std::array<std::uint32_t, 5> particle;
    std::array<float, 5> c;
    Vec3f direction;
    float speed;
  };

  const EdgeIntersection& intersection(std::size_t k) const { return finder_.intersections()[order_[k]]; }
  void sort_by_pairs();
  void count_pairs(const ParticleView& particles);
  void find_components(const ParticleView& particles);
  std::uint32_t root(std::uint32_t k);
  void join_intersections();
  void number_components(const ParticleView& particles);
  void sort_by_components();
  void inherit_strategy(Component& component) const;
  void save_components();
  void collect_edges(const Component& component, const ParticleView& particles, const Bounds& region);
  float find_direction(Component& component, const ParticleView& particles, float range);
  void alternate_strategies(Component& component, const ParticleView& particles, double time,
                            float max_speed);
  void choose_direction(Component& component, const ParticleView& particles, double time, float max_speed);
  void update_strategy(Component& component, const ParticleView& particles, double time, float max_speed,
                       int& searches);
  bool is_separated(const Component& component, const ParticleView& particles, const Bounds& region,
                    const Vec3f& shift) const;
  bool is_outside(const Component& component, const ParticleView& particles, const Vec3f& shift) const;
  Vec3f contour_descent(const EdgeIntersection& intersection, const ParticleView& particles) const;
  void mark_intersecting();
  void constrain_component(const Component& component, const ParticleView& particles);
  void constrain_inside(const Component& component, const ParticleView& particles, bool swapped,
                        Threads& threads);
  void constrain_layers(const ContactStep& step, const ParticleView& particles);
  void find(const ParticleView& particles, bool search_all, Threads& threads);
  void add_constraint(const VelocityConstraint& constraint, const ParticleView& particles);

  IntersectionFinder finder_;
  Layers layers_;
  std::vector<std::uint32_t> order_;  // of finder_.intersections(): by pair, then component
  std::vector<IntersectingPair> pairs_;
  std::vector<Component> components_, old_components_;
  std::vector<std::uint32_t> root_, last_of_, component_of_;  // of crossings; of particles
  std::vector<std::uint32_t> old_component_of_;               // of particles
  std::vector<std::uint8_t> is_intersecting_;                 // of particles
  std::vector<std::uint32_t> inside_;                         // of particles: which surface, or none
  std::vector<std::uint32_t> edges_a_, edges_b_;  // near the component whose direction is looked for
  std::vector<SurfaceHit> hits_;                  // of the vertices that are looked from
  std::vector<VelocityConstraint> constraints_;
  ObjectMatrix intersecting_pairs_, searched_pairs_;  // watched: also those whose layers lie wrong
  std::size_t min_layer_violations_ = 0;
  double layer_escalation_time_ = 0;  // by when there should be fewer of them [s]
  int layer_escalations_ = 0;         // escalations of the speed at which they are pulled
  double last_time_ = 0;              // when the last step began [s]: earlier after a snapshot was restored
  int idle_ = 0;                      // steps since a tangle that is held was looked at
};

}  // namespace souple
