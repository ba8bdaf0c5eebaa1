#include "souple/collision/intersection_resolver.h"

#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace souple {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Along the axes, upward first, and along the diagonals between them; the last two are the contour's.
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
constexpr int distances = 10;           // that are tried, each
constexpr float distance_ratio = 1.5f;  // times as long as the one before it
constexpr float time_to_part = 0.4f;    // s: how long a way may take, as far as the speed allows
constexpr float least_speed = 0.1f;     // m/s
constexpr double patience = 1.5;        // times as long as it should take, and
constexpr double stall_time = 0.3;      // s: more, and as long as that once it has come off here and there
constexpr int most_doublings = 3;       // of the speed before another direction is tried
constexpr int most_attempts = 6;        // each looks twice as far as the one before it
constexpr int searches_per_step = 4;    // others wait
constexpr int held_interval = 16;       // steps between two looks at what nothing can part
constexpr std::size_t samples = 16;     // corners of a knot that are asked whether they are inside
constexpr std::size_t vertex_grain = 64;

Bounds around(const Vec3f& x) {
  return {x, x};
}

Bounds widened(const Bounds& box, float by) {
  const Vec3f all{by, by, by};
  return {box.lo - all, box.hi + all};
}

bool is_odd(int n) {
  return n % 2 != 0;
}

/// Surfaces of an edge and a triangle, the lower one first.
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

void IntersectionResolver::set_surfaces(std::span<const ContactSurface> surfaces) {
  IntersectionFinder tangles = std::move(finder_);
  *this = {};
  finder_ = std::move(tangles);
  finder_.set_surfaces(surfaces);
  layers_.set_surfaces(surfaces);
  if (!finder_.any_pair()) return;
  std::uint32_t end = 0;
  for (const ContactSurface& surface : surfaces) end = std::max(end, surface.end);
  touched_.assign(end, 0);
  inside_.assign(end, none);
  last_of_.assign(end, none);
  old_knot_of_.assign(end, none);
  intersecting_pairs_ = watched_ = ObjectMatrix(surfaces.size());
}

// --- knots

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
  if (intersecting_pairs_.size() != finder_.surface_count())
    intersecting_pairs_ = ObjectMatrix(finder_.surface_count());
  intersecting_pairs_.clear();
  for (const EdgeIntersection& edge : finder_.intersections()) {
    const bool movable = any_movable(particles, edge.particle, 5);
    intersecting_pairs_.set(edge.edge_surface, edge.surface, true);
    auto pair = std::find_if(pairs_.begin(), pairs_.end(), [&](const IntersectingPair& p) {
      return p.edge_surface == edge.edge_surface && p.surface == edge.surface;
    });
    if (pair == pairs_.end()) pair = pairs_.insert(pair, {edge.edge_surface, edge.surface, 0, true});
    ++pair->edges;
    if (movable) pair->held = false;
  }
  // An edge through several triangles is one edge.
  const std::span<const EdgeIntersection> edges = finder_.intersections();
  for (std::size_t k = 1; k < edges.size(); ++k)
    for (std::size_t j = k; j-- > 0 && edges[j].edge == edges[k].edge;)
      if (edges[j].surface == edges[k].surface) {
        for (IntersectingPair& pair : pairs_)
          if (pair.edge_surface == edges[k].edge_surface && pair.surface == edges[k].surface) --pair.edges;
        break;
      }
}

// Crossings of one pair of surfaces that share a particle, and so on, are a knot.
void IntersectionResolver::find_knots(const ParticleView& particles) {
  join_crossings();
  number_knots(particles);
  sort_by_knots();
}

std::uint32_t IntersectionResolver::root(std::uint32_t k) {
  while (root_[k] != k) {
    root_[k] = root_[root_[k]];
    k = root_[k];
  }
  return k;
}

// root_ is a forest of crossings, one tree for each knot, the first crossing its root.
void IntersectionResolver::join_crossings() {
  root_.resize(order_.size());
  std::uint32_t first_of_pair = 0;
  const auto forget = [&](std::uint32_t begin, std::uint32_t end) {
    for (; begin < end; ++begin)
      for (const std::uint32_t i : crossing(begin).particle) last_of_[i] = none;
  };
  const auto count = static_cast<std::uint32_t>(order_.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    if (pair_of(crossing(k)) != pair_of(crossing(first_of_pair))) {
      forget(first_of_pair, k);
      first_of_pair = k;
    }
    root_[k] = k;
    for (const std::uint32_t i : crossing(k).particle) {
      if (last_of_[i] != none) {
        const std::uint32_t p = root(k), q = root(last_of_[i]);
        root_[std::max(p, q)] = std::min(p, q);
      }
      last_of_[i] = k;
    }
  }
  forget(first_of_pair, count);
}

// By their first crossings.
void IntersectionResolver::number_knots(const ParticleView& particles) {
  knots_.clear();
  knot_of_.assign(order_.size(), none);
  for (std::uint32_t k = 0; k < order_.size(); ++k) {
    const std::uint32_t first = root(k);
    if (first == k) {
      const auto pair = pair_of(crossing(k));
      knot_of_[k] = static_cast<std::uint32_t>(knots_.size());
      Knot knot;
      knot.a = pair[0], knot.b = pair[1];
      knot.bounds = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
      knots_.push_back(knot);
    }
    knot_of_[k] = knot_of_[first];
    Knot& knot = knots_[knot_of_[k]];
    ++knot.count;
    for (const std::uint32_t i : crossing(k).particle)
      knot.bounds = united(knot.bounds, around(particles.relative(i, {})));
  }
}

void IntersectionResolver::sort_by_knots() {
  std::size_t place = 0;
  for (Knot& knot : knots_) knot.first = place, place += knot.count, knot.count = 0;
  std::swap(root_, order_);  // root_ is what order_ was
  for (std::size_t k = 0; k < root_.size(); ++k) {
    Knot& knot = knots_[knot_of_[k]];
    order_[knot.first + knot.count++] = root_[k];
  }
}

// A knot goes on being pulled where it was pulled before.
void IntersectionResolver::inherit(Knot& knot) const {
  for (std::size_t k = knot.first; k < knot.first + knot.count; ++k)
    for (const std::uint32_t i : crossing(k).particle) {
      if (old_knot_of_[i] == none) continue;
      const Knot& old = old_knots_[old_knot_of_[i]];
      if (old.a != knot.a || old.b != knot.b) continue;
      static_cast<Course&>(knot) = old;
      return;
    }
}

void IntersectionResolver::remember() {
  std::fill(old_knot_of_.begin(), old_knot_of_.end(), none);
  for (std::uint32_t n = 0; n < knots_.size(); ++n)
    for (std::size_t k = knots_[n].first; k < knots_[n].first + knots_[n].count; ++k)
      for (const std::uint32_t i : crossing(k).particle)
        if (old_knot_of_[i] == none) old_knot_of_[i] = n;
  old_knots_ = knots_;
}

// --- directions

// Whether nothing near the knot would be tangled any more, were a displaced.
bool IntersectionResolver::is_parted(const Knot& knot, const ParticleView& particles, const Bounds& region,
                                     const Vec3f& shift) const {
  for (const std::uint32_t e : edges_a_)
    if (finder_.would_intersect(particles, e, shift, knot.b, region)) return false;
  for (const std::uint32_t e : edges_b_)
    if (finder_.would_intersect(particles, e, -shift, knot.a, region)) return false;
  return is_outside(knot, particles, shift);
}

// Out of the other one, and not altogether inside.
bool IntersectionResolver::is_outside(const Knot& knot, const ParticleView& particles,
                                      const Vec3f& shift) const {
  const std::size_t stride = std::max<std::size_t>(knot.count / samples, 1);
  const Vec3f ahead = normalized(shift);
  for (std::size_t k = knot.first; k < knot.first + knot.count; k += stride)
    for (const std::uint32_t i : crossing(k).particle) {
      const bool of_a = finder_.surface_of(i) == knot.a;
      const std::uint32_t other = of_a ? knot.b : knot.a;
      if (!finder_.is_closed(other)) continue;
      const Vec3f own = of_a ? shift : -shift, along = of_a ? ahead : -ahead;
      for (const float side : {1.0f, -1.0f})
        if (is_odd(finder_.cast_ray(particles, i, own, along, other, side).count)) return false;
    }
  return true;
}

// The edges of both that reach into the region.
void IntersectionResolver::collect_edges(const Knot& knot, const ParticleView& particles,
                                         const Bounds& region) {
  edges_a_.clear(), edges_b_.clear();
  const SurfaceElements& elements = finder_.elements();
  for (std::uint32_t e = 0; e < elements.edges().size(); ++e) {
    const std::uint32_t surface = elements.edge_objects()[e];
    if (surface != knot.a && surface != knot.b) continue;
    const auto& [i, j] = elements.edges()[e];
    const Bounds box = united(around(particles.relative(i, {})), around(particles.relative(j, {})));
    if (overlap(box, region)) (surface == knot.a ? edges_a_ : edges_b_).push_back(e);
  }
}

// The shortest way out, of those that are tried: its direction is given to the knot, its length returned; 0
// where none leads out. No way is longer than the region is wide around the knot: what is beyond is not seen.
float IntersectionResolver::find_way(Knot& knot, const ParticleView& particles, float farthest) {
  const Bounds region = widened(knot.bounds, farthest);
  collect_edges(knot, particles, region);
  Vec3f contour;
  for (std::size_t k = knot.first; k < knot.first + knot.count; ++k)
    contour += contour_pull(crossing(k), particles) * (crossing(k).edge_surface == knot.a ? 1.0f : -1.0f);
  contour = normalized(contour);
  float way = farthest;
  for (int step = 1; step < distances; ++step) way /= distance_ratio;
  for (int step = 0; step < distances; ++step) {
    for (std::uint32_t d = 0; d < all_directions; ++d) {
      const Vec3f n = d < fixed_directions ? directions[d] : d == fixed_directions ? contour : -contour;
      if ((knot.tried >> d & 1u) != 0 || !(length_squared(n) > 0)) continue;
      if (!is_parted(knot, particles, region, n * way)) continue;
      knot.direction = n, knot.which = d;
      return way;
    }
    way *= distance_ratio;
  }
  return 0;
}

// A knot of two layers goes outward, and where that stalls by its contour, in turns: a fold of the lower one
// that reaches through the upper one is pulled to both sides by its normals.
void IntersectionResolver::take_turns(Knot& knot, const ParticleView& particles, double time,
                                      float most_speed) {
  if (knot.known) ++knot.attempt;
  knot.known = true;
  float longest = 0;
  for (std::size_t k = knot.first; k < knot.first + knot.count; ++k) {
    const auto& i = crossing(k).particle;
    longest = max(longest, length(particles.difference(i[1], i[0])));
  }
  const auto hurry = static_cast<float>(1 << std::min(knot.attempt / 2, most_doublings));
  knot.speed = min(most_speed, max(least_speed, longest / time_to_part) * hurry);
  knot.deadline = time + stall_time;
  knot.fewest = knot.count;
}

void IntersectionResolver::choose_direction(Knot& knot, const ParticleView& particles, double time,
                                            float most_speed) {
  if (knot.known) {
    ++knot.attempt;
    if (length_squared(knot.direction) > 0) knot.tried |= 1u << knot.which;
    if (knot.tried == (1u << all_directions) - 1) knot.tried = 0;
  }
  knot.known = true;
  knot.direction = {};
  const float size = length(knot.bounds.hi - knot.bounds.lo);
  const float farthest = size * static_cast<float>(1 << std::min(knot.attempt, most_attempts));
  const float way = knot.a != knot.b ? find_way(knot, particles, farthest) : 0.0f;
  const float distance = way > 0 ? way : size;
  knot.speed = min(most_speed, max(least_speed, distance / time_to_part));
  knot.deadline = time + patience * static_cast<double>(distance / knot.speed) + stall_time;
  knot.fewest = knot.count;
  knot.doublings = 0;
}

// What does not get smaller is pulled harder, then another way.
void IntersectionResolver::attend(Knot& knot, const ParticleView& particles, double time, float most_speed,
                                  int& searches) {
  if (knot.count < knot.fewest) {
    knot.fewest = knot.count;
    knot.deadline = time + stall_time;
  }
  if (knot.known && time <= knot.deadline) return;
  if (layers_.ordered(knot.a, knot.b)) return take_turns(knot, particles, time, most_speed);
  if (knot.known && knot.doublings < most_doublings && knot.speed < most_speed) {
    ++knot.doublings;
    knot.speed = min(most_speed, 2 * knot.speed);
    knot.deadline = time + stall_time;
  } else if (searches++ < searches_per_step) {
    choose_direction(knot, particles, time, most_speed);
  }
}

// Where an edge must go, against the triangle that it passes through, for the contour to become shorter. The
// contour leaves the point x where they cross along r_1 and r_2, unit vectors in the planes of the triangle
// (of normal n) and of the two triangles beside the edge (of direction e). An edge displaced by d crosses at
// x + d - e (d . n) / (e . n), so the contour's length L changes by
//
//   dL = -(r_1 + r_2) . (d - e (d . n) / (e . n)) = -G . d,   G = R - (e . R) / (e . n) n,  R = r_1 + r_2.
//
// Volino and Magnenat-Thalmann 2006 subtract twice the second part. An edge at a border has one r. G is at
// most of length 1 here: it grows without bound where the edge grazes the triangle.
Vec3f IntersectionResolver::contour_pull(const EdgeIntersection& crossing,
                                         const ParticleView& particles) const {
  const auto& i = crossing.particle;
  const Vec3f e = particles.difference(i[1], i[0]);
  const Vec3f n = normalized(cross(particles.difference(i[3], i[2]), particles.difference(i[4], i[2])));
  const float e_n = dot(e, n);
  if (!(abs(e_n) > 0)) return {};
  Vec3f R;
  for (const std::uint32_t corner : finder_.opposite(crossing.edge)) {
    if (corner == none) continue;
    const Vec3f side = particles.difference(corner, i[0]);
    const Vec3f r = cross(cross(e, side), n);
    // Into the triangle: away from the edge, towards the opposite corner.
    const Vec3f inward = side - e * (dot(side, e) / dot(e, e));
    R += normalized(r) * (dot(r, inward) < 0 ? -1.0f : 1.0f);
  }
  const Vec3f G = R - n * (dot(e, R) / e_n);
  const float size = length(G);
  return size > 1 ? G / size : G;
}

// --- pulls

void IntersectionResolver::add(const Pull& pull, const ParticleView& particles) {
  if (any_movable(particles, pull.particle, 5)) pulls_.push_back(pull);
}

void IntersectionResolver::touch() {
  std::fill(touched_.begin(), touched_.end(), 0);
  std::fill(inside_.begin(), inside_.end(), none);
  for (const EdgeIntersection& edge : finder_.intersections())
    for (const std::uint32_t i : edge.particle) touched_[i] = 1;
}

void IntersectionResolver::pull_knot(const Knot& knot, const ParticleView& particles) {
  const bool along = length_squared(knot.direction) > 0;
  const bool outward = layers_.ordered(knot.a, knot.b) && knot.attempt % 2 == 0;
  for (std::size_t k = knot.first; k < knot.first + knot.count; ++k) {
    const EdgeIntersection& edge = crossing(k);
    if (outward) {
      const Vec3f n = layers_.outward(edge, particles, finder_);
      if (length_squared(n) > 0) add({edge.particle, edge.c, n, knot.speed}, particles);
    } else if (along) {
      const Vec3f n = edge.edge_surface == knot.a ? knot.direction : -knot.direction;
      add({edge.particle, edge.c, n, knot.speed}, particles);
    } else {
      const Vec3f G = contour_pull(edge, particles);
      const float size = length(G);
      if (size > 0) add({edge.particle, edge.c, G / size, knot.speed * size}, particles);
    }
  }
}

// Vertices of one object that are inside the other: they may pass its surface, and the way out pulls them.
void IntersectionResolver::pull_inside(const Knot& knot, const ParticleView& particles, bool turned,
                                       Threads& threads) {
  const std::uint32_t own = turned ? knot.b : knot.a, other = turned ? knot.a : knot.b;
  if (own == other || !finder_.is_closed(other)) return;
  const bool along = length_squared(knot.direction) > 0;
  const Vec3f n = !along ? Vec3f{0, 1, 0} : turned ? -knot.direction : knot.direction;
  const SurfaceElements& elements = finder_.elements();
  const Bounds bounds = finder_.bounds(other);
  hits_.assign(elements.vertices().size(), {});
  threads.for_each(hits_.size(), vertex_grain, [&](std::size_t v, std::size_t end) {
    for (; v < end; ++v) {
      const std::uint32_t i = elements.vertices()[v];
      if (elements.vertex_objects()[v] != own || inside_[i] != none) continue;
      if (!overlap(around(particles.relative(i, {})), bounds)) continue;
      hits_[v] = finder_.cast_ray(particles, i, {}, n, other, 1);
      if (!is_odd(hits_[v].count)) hits_[v] = finder_.cast_ray(particles, i, {}, n, other, -1);
    }
  });
  for (std::size_t v = 0; v < hits_.size(); ++v) {
    const SurfaceHit& hit = hits_[v];
    if (!is_odd(hit.count)) continue;
    const std::uint32_t i = elements.vertices()[v];
    inside_[i] = other;
    if (!along) continue;
    const auto& corner = elements.triangles()[hit.triangle].particle;
    add({{i, i, corner[0], corner[1], corner[2]},
         {1, 0, -hit.weight[0], -hit.weight[1], -hit.weight[2]},
         n,
         knot.speed},
        particles);
  }
}

// Points of layers that lie wrong go outward, the deeper the faster, and all of them faster where they do not
// get fewer.
void IntersectionResolver::pull_layers(const ContactStep& step, const ParticleView& particles) {
  const std::size_t count = layers_.found().size();
  if (count == 0 || fewest_misplaced_ == 0) hurries_ = 0;
  if (count < fewest_misplaced_ || fewest_misplaced_ == 0) {
    fewest_misplaced_ = count;
    hurry_at_ = step.time + stall_time;
  } else if (step.time > hurry_at_) {
    hurries_ = std::min(hurries_ + 1, most_doublings);
    hurry_at_ = step.time + stall_time;
  }
  for (const Misplaced& point : layers_.found()) {
    const auto& i = point.particle;
    const float speed = max(least_speed, point.depth / time_to_part) * static_cast<float>(1 << hurries_);
    add({{i[0], i[0], i[1], i[2], i[3]},
         {point.c[0], 0, point.c[1], point.c[2], point.c[3]},
         point.direction,
         min(step.depenetration_speed, speed)},
        particles);
  }
}

// Between objects that are not tangled contacts see to it that they do not become so, nor do layers come to
// lie wrong.
void IntersectionResolver::find(const ParticleView& particles, bool look, Threads& threads) {
  if (look) {
    for (std::uint32_t a = 0; a < watched_.size(); ++a)
      for (std::uint32_t b = 0; b < a; ++b) watched_.set(a, b, layers_.ordered(a, b));
    finder_.find(particles, threads);
  } else {
    finder_.find(particles, watched_, threads);
  }
  layers_.find(particles, finder_, watched_, threads);
  count_pairs(particles);
  watched_ = intersecting_pairs_;
  for (const Misplaced& point : layers_.found())
    watched_.set(finder_.surface_of(point.vertex), point.surface, true);
}

void IntersectionResolver::begin_step(const ParticleView& particles, const ContactStep& step, bool look,
                                      Threads& threads) {
  const bool was_intersecting = !pairs_.empty(), was_wrong = !layers_.found().empty();
  if (!finder_.any_pair() || (!look && !was_intersecting && !was_wrong)) return;
  if (!look && pulls_.empty() && ++idle_ < held_interval) return;
  if (step.time < last_time_) std::fill(old_knot_of_.begin(), old_knot_of_.end(), none);
  last_time_ = step.time;
  idle_ = 0;
  pulls_.clear();
  knots_.clear();
  find(particles, look, threads);
  pull_layers(step, particles);
  if (pairs_.empty()) {
    if (was_intersecting) remember();
    return;
  }
  sort_by_pairs();
  find_knots(particles);
  touch();
  int searches = 0;
  for (Knot& knot : knots_) {
    inherit(knot);
    attend(knot, particles, step.time, step.depenetration_speed, searches);
    pull_knot(knot, particles);
    pull_inside(knot, particles, false, threads);
    pull_inside(knot, particles, true, threads);
  }
  remember();
}

void IntersectionResolver::pull(const ParticleView& particles, const Substep& substep) const {
  for (const Pull& pull : pulls_) {
    Vec3f moved;
    float inverse_mass = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      moved += particles.moved(pull.particle[k]) * pull.c[k];
      inverse_mass += particles.inverse_mass(pull.particle[k]) * pull.c[k] * pull.c[k];
    }
    const float missing = pull.speed * substep.h - dot(pull.direction, moved);
    if (!(missing > 0) || !(inverse_mass > 0)) continue;
    const Vec3f dx = pull.direction * (missing / inverse_mass);
    for (std::size_t k = 0; k < 5; ++k) {
      const float w = particles.inverse_mass(pull.particle[k]);
      if (w > 0) particles.correct(pull.particle[k], dx * (w * pull.c[k]));
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
      if (layers_.may_pass(p, other) || layers_.may_pass(q, one)) return true;
      if (pairs_.empty()) continue;
      if (inside_[p] == other || inside_[q] == one) return true;
      if (touched_[p] != 0 && touched_[q] != 0 && intersecting_pairs_.at(one, other)) return true;
    }
  return false;
}

std::size_t IntersectionResolver::bytes() const {
  return finder_.bytes() + layers_.bytes() +
         bytes_of(order_, pairs_, knots_, old_knots_, root_, last_of_, knot_of_, old_knot_of_, touched_,
                  inside_, edges_a_, edges_b_, hits_, pulls_);
}

}  // namespace souple
