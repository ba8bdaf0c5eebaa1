#include "souple/intersections/intersection_resolver.h"

#include "souple/math/sentinels.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <iterator>

namespace souple {
namespace {

// Directions along the axes, upward first, then along the diagonals. Two more follow the contour.
constexpr float third = 0.57735027f;
constexpr Vec3f directions[] = {{0, 1, 0},
                                {0, -1, 0},
                                {1, 0, 0},
                                {-1, 0, 0},
                                {0, 0, 1},
                                {0, 0, -1},
                                {third, third, third},
                                {-third, -third, -third},
                                {-third, third, third},
                                {third, -third, -third},
                                {third, -third, third},
                                {-third, third, -third},
                                {third, third, -third},
                                {-third, -third, third}};
constexpr std::uint32_t fixed_directions = 14, all_directions = 16;
// Number of distances tested for each direction, and the ratio of each to the one before. They range from a 38th of the
// search range to all of it, so none is more than half again as far as needed.
constexpr int distances = 10;
constexpr float distance_ratio = 1.5f;
// Target duration of a separation if the speed limit allows, in times of a fall by the smaller object's radius.
constexpr float separation_falls = 1.3f;
// Lower limit of speeds, as a part of the upper limit: a separation by a small distance ends within 30 such falls.
constexpr float slowest_part = 1.0f / 30;
// A new direction may take deadline_factor times its expected time plus the time of such a fall. After each
// improvement and each escalation the deadline is the time of a fall.
constexpr double deadline_factor = 1.5;
// Doublings of the speed before another direction is chosen. A direction that does not resolve a component at eight
// times the speed is blocked rather than slow.
constexpr int max_escalations = 3;
// Each attempt doubles the search range of the one before: at 64 times the component's size, its objects are apart.
constexpr int max_range_doublings = 6;
// A search tests 160 displacements of a component. Further components wait for the next step, so that a step with many
// of them takes no longer.
constexpr int max_searches_per_step = 4;
// Steps between two searches while no intersecting particle can move: only the user's changes end such intersections.
constexpr int immovable_interval = 16;
// Intersections of a component whose corners is_outside tests: each test casts rays, and neighbors agree.
constexpr std::size_t samples = 16;
constexpr std::size_t vertex_grain = 64;

bool is_odd(int n) {
  return n % 2 != 0;
}

/// Surfaces of an edge and a triangle, the lower index first.
std::array<std::uint32_t, 2> pair_of(const EdgeIntersection& edge) {
  return {std::min(edge.edge_surface, edge.surface), std::max(edge.edge_surface, edge.surface)};
}

template <class Function>
bool any_movable(const ParticleView& particles, const Function& particle, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    if (particles.inverse_mass(particle[k]) > 0) return true;
  return false;
}

}  // namespace

IntersectionResolver::IntersectionResolver(std::span<const ContactSurface> surfaces, ParticlePairs joined)
    : finder_(surfaces, std::move(joined)), layers_(surfaces) {
  if (!finder_.any_pair()) return;
  for (const ContactSurface& surface : surfaces) radius_.push_back(surface.radius);
  std::uint32_t end = 0;
  for (const ContactSurface& surface : surfaces) end = std::max({end, surface.end, surface.reserved_end});
  is_intersecting_.assign(end, 0);
  inside_.assign(end, no_index);
  last_of_.assign(end, no_index);
  old_component_of_.assign(end, no_index);
}

// How fast two objects may be separated.
IntersectionResolver::Pace IntersectionResolver::pace_of(std::uint32_t a, std::uint32_t b,
                                                         const ContactStep& step) const {
  const float R = min(radius_[a], radius_[b]);
  return {step.depenetration_speed(R), static_cast<double>(step.fall_time(R))};
}

// As long as `separation_falls` falls for the whole distance, between slowest and fastest.
float IntersectionResolver::Pace::speed(float distance) const {
  return min(fastest,
             max(fastest * slowest_part, distance / (separation_falls * static_cast<float>(fall_time))));
}

// --- components

void IntersectionResolver::sort_by_pairs() {
  const std::span<const EdgeIntersection> edges = finder_.intersections();
  order_.resize(edges.size());
  for (std::uint32_t k = 0; k < order_.size(); ++k) order_[k] = k;
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t p, std::uint32_t q) {
    const auto a = pair_of(edges[p]), b = pair_of(edges[q]);
    return a != b ? a < b : p < q;
  });
}

void IntersectionResolver::count_pairs(const ParticleView& particles) {
  pairs_.clear();
  intersecting_pairs_.clear();
  for (const EdgeIntersection& edge : finder_.intersections()) {
    const bool movable = any_movable(particles, edge.particle, 5);
    intersecting_pairs_.add(edge.edge_surface, edge.surface);
    auto pair = std::find_if(pairs_.begin(), pairs_.end(), [&](const IntersectingPair& p) {
      return p.edge_surface == edge.edge_surface && p.surface == edge.surface;
    });
    if (pair == pairs_.end()) pair = pairs_.insert(pair, {edge.edge_surface, edge.surface, 0, true});
    ++pair->edges;
    if (movable) pair->immovable = false;
  }
  // Count an edge through several triangles of a surface once.
  const std::span<const EdgeIntersection> edges = finder_.intersections();
  for (std::size_t k = 1; k < edges.size(); ++k)
    for (std::size_t j = k; j-- > 0 && edges[j].edge == edges[k].edge;)
      if (edges[j].surface == edges[k].surface) {
        for (IntersectingPair& pair : pairs_)
          if (pair.edge_surface == edges[k].edge_surface && pair.surface == edges[k].surface) --pair.edges;
        break;
      }
}

// A component: intersections of one pair of surfaces, connected by shared particles.
void IntersectionResolver::find_components(const ParticleView& particles) {
  join_intersections();
  number_components(particles);
  sort_by_components();
}

void IntersectionResolver::join_intersections() {
  connected_.reset(order_.size());
  std::uint32_t first_of_pair = 0;
  const auto reset = [&](std::uint32_t begin, std::uint32_t end) {
    for (; begin < end; ++begin)
      for (const std::uint32_t i : intersection(begin).particle) last_of_[i] = no_index;
  };
  const auto count = static_cast<std::uint32_t>(order_.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    if (pair_of(intersection(k)) != pair_of(intersection(first_of_pair))) {
      reset(first_of_pair, k);
      first_of_pair = k;
    }
    for (const std::uint32_t i : intersection(k).particle) {
      if (last_of_[i] != no_index) connected_.join(k, last_of_[i]);
      last_of_[i] = k;
    }
  }
  reset(first_of_pair, count);
}

// In the order of their first intersections.
void IntersectionResolver::number_components(const ParticleView& particles) {
  components_.clear();
  component_of_.assign(order_.size(), no_index);
  for (std::uint32_t k = 0; k < order_.size(); ++k) {
    const std::uint32_t first = connected_.root(k);
    if (first == k) {
      const auto pair = pair_of(intersection(k));
      component_of_[k] = static_cast<std::uint32_t>(components_.size());
      Component component;
      component.a = pair[0], component.b = pair[1];
      component.bounds = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
      components_.push_back(component);
    }
    component_of_[k] = component_of_[first];
    Component& component = components_[component_of_[k]];
    ++component.count;
    for (const std::uint32_t i : intersection(k).particle)
      component.bounds =
          united(component.bounds, around(particles.relative(i, {}), particles.relative(i, {}), 0));
  }
}

void IntersectionResolver::sort_by_components() {
  std::size_t begin = 0;
  for (Component& component : components_)
    component.first = begin, begin += component.count, component.count = 0;
  old_order_ = order_;
  for (std::size_t k = 0; k < old_order_.size(); ++k) {
    Component& component = components_[component_of_[k]];
    order_[component.first + component.count++] = old_order_[k];
  }
}

// Takes the strategy of the first old component of the same surfaces that shares a particle.
void IntersectionResolver::inherit_strategy(Component& component) const {
  for (std::size_t k = component.first; k < component.first + component.count; ++k)
    for (const std::uint32_t i : intersection(k).particle) {
      if (old_component_of_[i] == no_index) continue;
      const Component& old = old_components_[old_component_of_[i]];
      if (old.a != component.a || old.b != component.b) continue;
      static_cast<Strategy&>(component) = old;
      return;
    }
}

void IntersectionResolver::save_components() {
  std::fill(old_component_of_.begin(), old_component_of_.end(), no_index);
  for (std::uint32_t n = 0; n < components_.size(); ++n)
    for (std::size_t k = components_[n].first; k < components_[n].first + components_[n].count; ++k)
      for (const std::uint32_t i : intersection(k).particle)
        if (old_component_of_[i] == no_index) old_component_of_[i] = n;
  old_components_ = components_;
}

// --- directions

// Whether a displacement of surface a by `shift` would remove all intersections near the component.
bool IntersectionResolver::is_separated(const Component& component, const ParticleView& particles,
                                        const Bounds& region, const Vec3f& shift) const {
  for (const std::uint32_t e : edges_a_)
    if (finder_.would_intersect(particles, e, shift, component.b, region)) return false;
  for (const std::uint32_t e : edges_b_)
    if (finder_.would_intersect(particles, e, -shift, component.a, region)) return false;
  return is_outside(component, particles, shift);
}

// Whether `shift` would leave no sampled corner inside the other surface, if that is closed.
bool IntersectionResolver::is_outside(const Component& component, const ParticleView& particles,
                                      const Vec3f& shift) const {
  const std::size_t stride = std::max<std::size_t>(component.count / samples, 1);
  const Vec3f ahead = normalized(shift);
  for (std::size_t k = component.first; k < component.first + component.count; k += stride)
    for (const std::uint32_t i : intersection(k).particle) {
      const bool of_a = finder_.surface_of(i) == component.a;
      const std::uint32_t other = of_a ? component.b : component.a;
      if (!finder_.is_closed(other)) continue;
      const Vec3f own = of_a ? shift : -shift, along = of_a ? ahead : -ahead;
      for (const float side : {1.0f, -1.0f})
        if (is_odd(finder_.cast_ray(particles, i, own, along, other, side).count)) return false;
    }
  return true;
}

// Collects the edges of both surfaces that overlap the region.
void IntersectionResolver::collect_edges(const Component& component, const ParticleView& particles,
                                         const Bounds& region) {
  edges_a_.clear(), edges_b_.clear();
  const SurfaceElements& elements = finder_.elements();
  for (std::uint32_t e = 0; e < elements.edges().size(); ++e) {
    const std::uint32_t surface = elements.edge_objects()[e];
    if (surface != component.a && surface != component.b) continue;
    const auto& [i, j] = elements.edges()[e];
    const Bounds box = around(particles.relative(i, {}), particles.relative(j, {}), 0);
    if (overlap(box, region)) (surface == component.a ? edges_a_ : edges_b_).push_back(e);
  }
}

// Sets the direction of the shortest separating displacement among those tested, and returns its length; 0 if
// none separates. Displacements are at most as long as the region around the component is wide, `range`:
// nothing beyond is tested.
float IntersectionResolver::find_direction(Component& component, const ParticleView& particles, float range) {
  const Bounds region = widened(component.bounds, range);
  collect_edges(component, particles, region);
  Vec3f contour;
  for (std::size_t k = component.first; k < component.first + component.count; ++k)
    contour += contour_descent(intersection(k), particles) *
               (intersection(k).edge_surface == component.a ? 1.0f : -1.0f);
  contour = normalized(contour);
  float distance = range;
  for (int step = 1; step < distances; ++step) distance /= distance_ratio;
  for (int step = 0; step < distances; ++step) {
    for (std::uint32_t d = 0; d < all_directions; ++d) {
      const Vec3f n = d < fixed_directions ? directions[d] : d == fixed_directions ? contour : -contour;
      if ((component.tried >> d & 1u) != 0 || !(length_squared(n) > 0)) continue;
      if (!is_separated(component, particles, region, n * distance)) continue;
      component.direction = n, component.current = d;
      return distance;
    }
    distance *= distance_ratio;
  }
  return 0;
}

// A component of two layers moves outward; where that stalls, it alternates with the contour. The lower object's
// normals would move a fold that passes through the upper object to both sides.
void IntersectionResolver::alternate_strategies(Component& component, const ParticleView& particles,
                                                double time, const Pace& pace) {
  if (component.chosen) ++component.attempt;
  component.chosen = true;
  float longest = 0;
  for (std::size_t k = component.first; k < component.first + component.count; ++k) {
    const auto& i = intersection(k).particle;
    longest = max(longest, length(particles.difference(i[1], i[0])));
  }
  const auto escalation = static_cast<float>(1 << std::min(component.attempt / 2, max_escalations));
  component.speed = min(pace.fastest, pace.speed(longest) * escalation);
  component.deadline = time + pace.fall_time;
  component.min_count = component.count;
}

void IntersectionResolver::choose_direction(Component& component, const ParticleView& particles, double time,
                                            const Pace& pace) {
  if (component.chosen) {
    ++component.attempt;
    if (length_squared(component.direction) > 0) component.tried |= 1u << component.current;
    if (component.tried == (1u << all_directions) - 1) component.tried = 0;
  }
  component.chosen = true;
  component.direction = {};
  const float size = length(component.bounds.hi - component.bounds.lo);
  const float range = size * static_cast<float>(1 << std::min(component.attempt, max_range_doublings));
  const float found = component.a != component.b ? find_direction(component, particles, range) : 0.0f;
  const float distance = found > 0 ? found : size;
  component.speed = pace.speed(distance);
  component.deadline =
      time + deadline_factor * static_cast<double>(distance / component.speed) + pace.fall_time;
  component.min_count = component.count;
  component.escalations = 0;
}

// A component that does not become smaller in time gets a higher speed, then another direction. The first row that
// applies decides.
IntersectionResolver::Action IntersectionResolver::action_of(const Component& component, double time,
                                                             const Pace& pace, int searches) const {
  struct Row {
    bool applies;
    Action action;
  };
  const bool escalates = component.escalations < max_escalations && component.speed < pace.fastest;
  const Row rows[] = {
      {component.chosen && time <= component.deadline, Action::keep},
      {layers_.ordered(component.a, component.b), Action::alternate},
      {component.chosen && escalates, Action::escalate},
      {searches < max_searches_per_step, Action::choose_direction},
      {true, Action::keep},  // until the next step
  };
  return std::find_if(std::begin(rows), std::end(rows), [](const Row& row) { return row.applies; })->action;
}

void IntersectionResolver::update_strategy(Component& component, const ParticleView& particles, double time,
                                           const Pace& pace, int& searches) {
  if (component.count < component.min_count) {
    component.min_count = component.count;
    component.deadline = time + pace.fall_time;
  }
  switch (action_of(component, time, pace, searches)) {
    case Action::keep:
      return;
    case Action::alternate:
      return alternate_strategies(component, particles, time, pace);
    case Action::escalate:
      ++component.escalations;
      component.speed = min(pace.fastest, 2 * component.speed);
      component.deadline = time + pace.fall_time;
      return;
    case Action::choose_direction:
      ++searches;
      return choose_direction(component, particles, time, pace);
  }
}

// Direction in which an edge must move, relative to the triangle it passes through, to shorten the contour.
// The contour leaves the intersection point x along r_1 and r_2. These are unit vectors in the planes of the
// triangle (normal n) and of the two triangles beside the edge (direction e). An edge displaced by d
// intersects at x + d - e (d . n) / (e . n), so the contour's length L changes by
//
//   dL = -(r_1 + r_2) . (d - e (d . n) / (e . n)) = -G . d,   G = R - (e . R) / (e . n) n,  R = r_1 + r_2.
//
// Volino and Magnenat-Thalmann 2006 subtract twice the second part. A border edge has one r. The length of G
// is limited to 1 here: it grows without bound where the edge is nearly parallel to the triangle.
Vec3f IntersectionResolver::contour_descent(const EdgeIntersection& intersection,
                                            const ParticleView& particles) const {
  const auto& i = intersection.particle;
  const Vec3f e = particles.difference(i[1], i[0]);
  const Vec3f n = normalized(cross(particles.difference(i[3], i[2]), particles.difference(i[4], i[2])));
  const float e_n = dot(e, n);
  if (!(abs(e_n) > 0)) return {};
  Vec3f R;
  for (const std::uint32_t corner : finder_.opposite(intersection.edge)) {
    if (corner == no_index) continue;
    const Vec3f side = particles.difference(corner, i[0]);
    const Vec3f r = cross(cross(e, side), n);
    // Points into the triangle: from the edge to the opposite corner.
    const Vec3f inward = side - e * (dot(side, e) / dot(e, e));
    R += normalized(r) * (dot(r, inward) < 0 ? -1.0f : 1.0f);
  }
  const Vec3f G = R - n * (dot(e, R) / e_n);
  const float size = length(G);
  return size > 1 ? G / size : G;
}

// --- velocity constraints

void IntersectionResolver::visit_separated(const std::function<void(std::uint32_t)>& f) const {
  for (const VelocityConstraint& constraint : constraints_)
    for (const std::uint32_t i : constraint.particle) f(i);
}

void IntersectionResolver::add_constraint(const VelocityConstraint& constraint,
                                          const ParticleView& particles) {
  if (any_movable(particles, constraint.particle, 5)) constraints_.push_back(constraint);
}

void IntersectionResolver::mark_intersecting() {
  std::fill(is_intersecting_.begin(), is_intersecting_.end(), 0);
  std::fill(inside_.begin(), inside_.end(), no_index);
  for (const EdgeIntersection& edge : finder_.intersections())
    for (const std::uint32_t i : edge.particle) is_intersecting_[i] = 1;
}

void IntersectionResolver::constrain_component(const Component& component, const ParticleView& particles) {
  const bool along = length_squared(component.direction) > 0;
  const bool outward = layers_.ordered(component.a, component.b) && component.attempt % 2 == 0;
  for (std::size_t k = component.first; k < component.first + component.count; ++k) {
    const EdgeIntersection& edge = intersection(k);
    if (outward) {
      const Vec3f n = layers_.outward(edge, particles, finder_);
      if (length_squared(n) > 0) add_constraint({edge.particle, edge.c, n, component.speed}, particles);
    } else if (along) {
      const Vec3f n = edge.edge_surface == component.a ? component.direction : -component.direction;
      add_constraint({edge.particle, edge.c, n, component.speed}, particles);
    } else {
      const Vec3f G = contour_descent(edge, particles);
      const float size = length(G);
      if (size > 0) add_constraint({edge.particle, edge.c, G / size, component.speed * size}, particles);
    }
  }
}

// Marks the vertices of one object inside the other, so that they may pass its surface, and constrains them
// to leave along the component's direction.
void IntersectionResolver::constrain_inside(const Component& component, const ParticleView& particles,
                                            bool swapped, Threads& threads) {
  const std::uint32_t own = swapped ? component.b : component.a, other = swapped ? component.a : component.b;
  if (own == other || !finder_.is_closed(other)) return;
  const bool along = length_squared(component.direction) > 0;
  const Vec3f n = !along ? Vec3f{0, 1, 0} : swapped ? -component.direction : component.direction;
  const SurfaceElements& elements = finder_.elements();
  const Bounds bounds = finder_.bounds(other);
  hits_.assign(elements.vertices().size(), {});
  threads.each(hits_.size(), vertex_grain, [&](std::size_t v) {
    const std::uint32_t i = elements.vertices()[v];
    if (elements.vertex_objects()[v] != own || inside_[i] != no_index) return;
    if (!overlap(around(particles.relative(i, {}), particles.relative(i, {}), 0), bounds)) return;
    hits_[v] = finder_.cast_ray(particles, i, {}, n, other, 1);
    if (!is_odd(hits_[v].count)) hits_[v] = finder_.cast_ray(particles, i, {}, n, other, -1);
  });
  for (std::size_t v = 0; v < hits_.size(); ++v) {
    const SurfaceHit& hit = hits_[v];
    if (!is_odd(hit.count)) continue;
    const std::uint32_t i = elements.vertices()[v];
    inside_[i] = other;
    if (!along) continue;
    const auto& corner = elements.triangles()[hit.triangle].particle;
    add_constraint({{i, i, corner[0], corner[1], corner[2]},
                    {1, 0, -hit.weight[0], -hit.weight[1], -hit.weight[2]},
                    n,
                    component.speed},
                   particles);
  }
}

// Constrains violating points to move outward: faster where they are deeper. The speed doubles while their
// number does not fall.
void IntersectionResolver::constrain_layers(const ContactStep& step, const ParticleView& particles) {
  const std::size_t count = layers_.found().size();
  double stall_time = 0;
  for (const LayerViolation& violation : layers_.found())
    stall_time =
        max(stall_time, pace_of(finder_.surface_of(violation.vertex), violation.surface, step).fall_time);
  if (count == 0 || min_layer_violations_ == 0) layer_escalations_ = 0;
  if (count < min_layer_violations_ || min_layer_violations_ == 0) {
    min_layer_violations_ = count;
    layer_escalation_time_ = step.time + stall_time;
  } else if (step.time > layer_escalation_time_) {
    layer_escalations_ = std::min(layer_escalations_ + 1, max_escalations);
    layer_escalation_time_ = step.time + stall_time;
  }
  for (const LayerViolation& violation : layers_.found()) {
    const auto& i = violation.particle;
    const Pace pace = pace_of(finder_.surface_of(violation.vertex), violation.surface, step);
    const float speed = pace.speed(violation.depth) * static_cast<float>(1 << layer_escalations_);
    add_constraint({{i[0], i[0], i[1], i[2], i[3]},
                    {violation.c[0], 0, violation.c[1], violation.c[2], violation.c[3]},
                    violation.direction,
                    min(pace.fastest, speed)},
                   particles);
  }
}

// Without `search_all` only searched_pairs_ are tested: contacts prevent new intersections and layer
// violations between other objects.
void IntersectionResolver::find(const ParticleView& particles, bool search_all, Threads& threads) {
  if (search_all) {
    searched_pairs_ = layers_.ordered();
    finder_.find(particles, threads);
  } else {
    finder_.find(particles, searched_pairs_, threads);
  }
  layers_.find(particles, finder_, searched_pairs_, threads);
  count_pairs(particles);
  searched_pairs_ = intersecting_pairs_;
  for (const LayerViolation& violation : layers_.found())
    searched_pairs_.add(finder_.surface_of(violation.vertex), violation.surface);
}

void IntersectionResolver::begin_step(const ParticleView& particles, const ContactStep& step, bool search_all,
                                      Threads& threads) {
  const bool was_intersecting = !pairs_.empty(), had_violations = !layers_.found().empty();
  if (!finder_.any_pair() || (!search_all && !was_intersecting && !had_violations)) return;
  if (!search_all && constraints_.empty() && ++idle_ < immovable_interval) return;
  if (step.time < last_time_) std::fill(old_component_of_.begin(), old_component_of_.end(), no_index);
  last_time_ = step.time;
  idle_ = 0;
  constraints_.clear();
  components_.clear();
  find(particles, search_all, threads);
  constrain_layers(step, particles);
  if (pairs_.empty()) {
    if (was_intersecting) save_components();
    return;
  }
  sort_by_pairs();
  find_components(particles);
  mark_intersecting();
  int searches = 0;
  for (Component& component : components_) {
    inherit_strategy(component);
    update_strategy(component, particles, step.time, pace_of(component.a, component.b, step), searches);
    constrain_component(component, particles);
    constrain_inside(component, particles, false, threads);
    constrain_inside(component, particles, true, threads);
  }
  save_components();
}

void IntersectionResolver::separate(const ParticleView& particles, const Substep& substep) const {
  for (const VelocityConstraint& constraint : constraints_) {
    Vec3f moved;
    float inverse_mass = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      moved += particles.moved(constraint.particle[k]) * constraint.c[k];
      inverse_mass += particles.inverse_mass(constraint.particle[k]) * constraint.c[k] * constraint.c[k];
    }
    const float missing = constraint.speed * substep.h - dot(constraint.direction, moved);
    if (!(missing > 0) || !(inverse_mass > 0)) continue;
    const Vec3f dx = constraint.direction * (missing / inverse_mass);
    for (std::size_t k = 0; k < 5; ++k) {
      const float w = particles.inverse_mass(constraint.particle[k]);
      if (w > 0) particles.correct(constraint.particle[k], dx * (w * constraint.c[k]));
    }
  }
}

bool IntersectionResolver::exempts(const NearPair& pair, bool edges) const {
  if (pairs_.empty() && layers_.found().empty()) return false;
  const std::size_t first = edges ? 2 : 1;
  for (std::size_t a = 0; a < first; ++a)
    for (std::size_t b = first; b < 4; ++b) {
      const std::uint32_t p = pair.particle[a], q = pair.particle[b];
      const std::uint32_t one = finder_.surface_of(p), other = finder_.surface_of(q);
      if (layers_.is_exempt(p, other) || layers_.is_exempt(q, one)) return true;
      if (pairs_.empty()) continue;
      if (inside_[p] == other || inside_[q] == one) return true;
      if (is_intersecting_[p] != 0 && is_intersecting_[q] != 0 && intersecting_pairs_.contains(one, other))
        return true;
    }
  return false;
}

bool IntersectionResolver::may_exempt(std::uint32_t particle, std::uint32_t surface) const {
  if (!layers_.found().empty() && layers_.is_exempt(particle, surface)) return true;
  return !pairs_.empty() && (inside_[particle] == surface ||
                             (is_intersecting_[particle] != 0 &&
                              intersecting_pairs_.contains(finder_.surface_of(particle), surface)));
}

std::size_t IntersectionResolver::bytes() const {
  return finder_.bytes() + layers_.bytes() +
         bytes_of(radius_, order_, pairs_, components_, old_components_, old_order_, last_of_, component_of_,
                  old_component_of_, is_intersecting_, inside_, edges_a_, edges_b_, hits_, constraints_);
}

}  // namespace souple
