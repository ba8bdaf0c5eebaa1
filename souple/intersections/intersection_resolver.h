#pragma once

#include "souple/collision/contact_step.h"
#include "souple/intersections/intersecting_pair.h"
#include "souple/intersections/intersection_finder.h"
#include "souple/intersections/layers.h"
#include "souple/math/disjoint_sets.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace souple {

/// Resolves intersections slowly, with corrections that conserve momentum.
///
/// Connected intersections of two objects form a component. Each component has a direction: the one along
/// which the first object needs the least displacement. After this displacement no edge near the component
/// passes through a triangle, and no corner of the component lies inside a closed surface. Several directions
/// and distances are tested when a component is new, and again when it is not resolved in time.
///
/// Self-intersections, and components that no direction resolves, move edges such that the intersection contour becomes
/// shorter. Source: Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
/// minimization". The contour alone finds no direction if its length would not change. Examples are a sheet that passes
/// through a box, or through another sheet from side to side.
///
/// The correction is a bound on velocities: the points of the edge and of the triangle at their intersection
/// separate by at least
///
///   n . sum_k c_k (p_k - x_k) >= u h,   u <= ContactStep::depenetration_speed of the smaller object.
///
/// This bound also applies to a vertex inside a closed surface and the point where the direction leaves the surface.
/// Corrections are w_k c_k n: equal, opposite and along one line. So no depth makes them violent.
///
/// Layers define where two objects belong (layers.h), so their components need no search for a direction.
/// Each edge through a triangle moves along the normal of the lower object. So does each point of the upper
/// object under the lower one, with or without intersections.
///
/// Until a component is resolved, contacts must ignore its elements: `exempts`.
class IntersectionResolver {
 public:
  /// As SurfaceContacts.
  IntersectionResolver() = default;
  explicit IntersectionResolver(std::span<const ContactSurface> surfaces, ParticlePairs joined = {});

  /// Searches for intersections and layer violations: in all objects if `search_all`; else only between the
  /// objects that had some at the last search.
  void begin_step(const ParticleView& particles, const ContactStep& step, bool search_all, Threads& threads);
  /// Applies the velocity constraints. Call after prediction and before contacts are refreshed.
  void separate(const ParticleView& particles, const Substep& substep) const;

  /// Whether contacts must ignore the pair. `edges`: it is a pair of edges, not a vertex and a triangle.
  bool exempts(const NearPair& pair, bool edges) const;
  /// Whether `exempts` may hold for a particle and elements of a surface.
  bool may_exempt(std::uint32_t particle, std::uint32_t surface) const;
  /// Calls f(particle) for the particles that `separate` moves in this step.
  void visit_separated(const std::function<void(std::uint32_t)>& f) const;
  /// Intersecting pairs of objects that `begin_step` found.
  std::span<const IntersectingPair> pairs() const { return pairs_; }
  /// Layer violations that `begin_step` found.
  std::span<const LayerViolation> layer_violations() const { return layers_.found(); }
  std::size_t bytes() const;

 private:
  /// How a component is resolved. The components of the next step inherit it.
  struct Strategy {
    bool chosen = false;                   // the members below are set
    Vec3f direction{};                     // unit: motion of object a relative to b; zero: follow the contour
    float speed = 0;                       // of separation [m/s]
    std::size_t min_count = 0;             // lowest number of intersections since it was chosen
    double deadline = 0;                   // time by which min_count must fall, else escalate [s]
    int escalations = 0;                   // how often the speed was doubled for this direction
    int attempt = 0;                       // number of directions (or of alternations) so far
    std::uint32_t tried = 0, current = 0;  // bits of failed directions; index of the current direction
  };
  /// Connected intersections of surfaces a <= b.
  struct Component : Strategy {
    std::uint32_t a = 0, b = 0;
    std::size_t first = 0, count = 0;  // order_[first, first + count)
    Bounds bounds{};                   // of all their particles
  };
  /// Action of a component in a step.
  enum class Action : std::uint8_t {
    keep,              ///< its strategy
    alternate,         ///< between outward motion and the contour, for layers
    escalate,          ///< double its speed
    choose_direction,  ///< search for another one
  };
  /// How fast two objects may be separated.
  struct Pace {
    float fastest = 0;     // m/s
    double fall_time = 0;  // s
    float speed(float distance) const;
  };
  /// direction . sum_k c_k (p_k - x_k) >= speed h.
  struct VelocityConstraint {
    std::array<std::uint32_t, 5> particle;
    std::array<float, 5> c;
    Vec3f direction;
    float speed;
  };

  const EdgeIntersection& intersection(std::size_t k) const { return finder_.intersections()[order_[k]]; }
  Pace pace_of(std::uint32_t a, std::uint32_t b, const ContactStep& step) const;
  void sort_by_pairs();
  void count_pairs(const ParticleView& particles);
  void find_components(const ParticleView& particles);
  void join_intersections();
  void number_components(const ParticleView& particles);
  void sort_by_components();
  void inherit_strategy(Component& component) const;
  void save_components();
  void collect_edges(const Component& component, const ParticleView& particles, const Bounds& region);
  float find_direction(Component& component, const ParticleView& particles, float range);
  void alternate_strategies(Component& component, const ParticleView& particles, double time,
                            const Pace& pace);
  void choose_direction(Component& component, const ParticleView& particles, double time, const Pace& pace);
  Action action_of(const Component& component, double time, const Pace& pace, int searches) const;
  void update_strategy(Component& component, const ParticleView& particles, double time, const Pace& pace,
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
  std::vector<float> radius_;  // per surface, at rest [m]
  std::vector<std::uint32_t> order_,
      old_order_;  // indices of finder_.intersections(), by pair, then component
  std::vector<IntersectingPair> pairs_;
  std::vector<Component> components_, old_components_;  // of this step, of the last search
  DisjointSets connected_;                       // intersections; the root of a component is its first one
  std::vector<std::uint32_t> component_of_;      // per intersection
  std::vector<std::uint32_t> last_of_;           // per particle: last intersection, in join_intersections
  std::vector<std::uint32_t> old_component_of_;  // per particle: index in old_components_, or none
  std::vector<std::uint8_t> is_intersecting_;    // per particle: part of an intersecting edge or triangle
  std::vector<std::uint32_t> inside_;            // per particle: the closed surface that contains it, or none
  std::vector<std::uint32_t> edges_a_, edges_b_;  // near the component whose direction is searched
  std::vector<SurfaceHit> hits_;                  // per vertex, in constrain_inside
  std::vector<VelocityConstraint> constraints_;
  ObjectPairs intersecting_pairs_;
  ObjectPairs searched_pairs_;  // intersecting_pairs_ and pairs with layer violations
  std::size_t min_layer_violations_ = 0;
  double layer_escalation_time_ = 0;  // time by which layer violations must become fewer, else escalate [s]
  int layer_escalations_ = 0;         // how often the speed against layer violations was doubled
  double last_time_ = 0;  // start of the last step [s]; a restored snapshot makes step.time earlier
  int idle_ = 0;          // steps since the last search, while no found particle can move
};

}  // namespace souple
