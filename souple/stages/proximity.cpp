#include "souple/stages/proximity.h"

#include "souple/collision/nearest.h"
#include "souple/contacts/contact_projector.h"
#include "souple/math/sentinels.h"
#include "souple/objects/contact_geometry.h"
#include "souple/objects/object.h"
#include "souple/objects/objects_view.h"
#include "souple/state/bytes.h"

#include <algorithm>

namespace souple {
namespace {

bool is_candidate_pair(const ProximityQuery& t, std::uint32_t a, std::uint32_t b) {
  return (t.active[a] != 0 && t.passive[b] != 0) || (t.active[b] != 0 && t.passive[a] != 0);
}

// The bounds of an object that is only active contain its active particles.
void find_bounds(const ObjectsView& objects, ProximityQuery& t) {
  t.bounds.assign(objects.objects.size(),
                  {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}});
  for (std::size_t a = 0; a < objects.objects.size(); ++a) {
    if (t.active[a] == 0 && t.passive[a] == 0) continue;
    for (std::uint32_t i = objects.objects[a]->begin; i < objects.objects[a]->end; ++i)
      if (t.passive[a] != 0 || t.active_particles[i].w != 0) t.bounds[a] = united(t.bounds[a], t.boxes[i]);
  }
}

void list_objects(const ObjectsView& objects, const ContactTables& tables, ProximityQuery& t) {
  t.is_candidate.clear(), t.is_found.clear();
  t.candidates.clear(), t.listed.clear();
  t.has_candidate.assign(objects.objects.size(), 0);
  for (const auto& [a, b] : t.sweep.find(t.bounds)) {
    if (!is_candidate_pair(t, a, b) || !tables.against_objects.collide(a, b)) continue;
    t.candidates.push_back({a, b});
    t.is_candidate.add(a, b);
    t.has_candidate[a] = t.has_candidate[b] = 1;
  }
  std::sort(t.candidates.begin(), t.candidates.end());
  for (std::uint32_t a = 0; a < t.has_candidate.size(); ++a)
    if (t.has_candidate[a] != 0) t.listed.push_back(a);
}

void build_elements(const ObjectsView& objects, const ContactTables& tables, ProximityQuery& t) {
  if (t.listed == t.in_elements) return;
  t.in_elements = t.listed;
  t.elements.clear();
  for (const std::uint32_t a : t.in_elements) {
    const Object& object = *objects.objects[a];
    t.elements.add_triangles(object.surface, object.begin, a);
    t.elements.add_edges(tables.rope_edges[a], object.begin, a);
    if (is_particle_only(object)) t.elements.add_particles(object.begin, object.end, a);
  }
}

void add_found(ProximityQuery& t, std::uint32_t a, std::uint32_t b) {
  if (t.is_found.contains(a, b)) return;
  t.is_found.add(a, b);
  t.found.push_back({std::min(a, b), std::max(a, b)});
}

float distance(const ParticleView& particles, const NearPair& pair, bool edges) {
  Vec3f x[4];
  for (std::size_t k = 0; k < 4; ++k) x[k] = particles.difference(pair.particle[k], pair.particle[0]);
  if (edges) {
    float s = 0, u = 0;
    nearest_on_edges(x[0], x[1], x[2], x[3], s, u);
    return length(x[0] + (x[1] - x[0]) * s - x[2] - (x[3] - x[2]) * u);
  }
  float weight[3];
  nearest_on_triangle(x[0], x[1], x[2], x[3], weight);
  return length(x[1] * weight[0] + x[2] * weight[1] + x[3] * weight[2]);
}

// Sum of margin and motion bound: the maximum over an element's particles.
float margin_of(const ProximityQuery& t, const NearPair& pair, std::size_t begin, std::size_t end) {
  float margin = 0;
  for (std::size_t k = begin; k < end; ++k)
    margin = max(margin, t.margin[pair.particle[k]] + t.motion_bound[pair.particle[k]]);
  return margin;
}

void check_pairs(const ObjectsView& objects, ProximityQuery& t, const std::vector<NearPair>& pairs,
                 bool edges) {
  const ParticleView view = objects.view();
  const std::size_t second = edges ? 2 : 1;
  for (const NearPair& pair : pairs) {
    const std::uint32_t a = objects.object_of[pair.particle[0]], b = objects.object_of[pair.particle[3]];
    if (t.is_found.contains(a, b)) continue;
    const float margin = margin_of(t, pair, 0, second) + margin_of(t, pair, second, 4);
    if (distance(view, pair, edges) <= margin) add_found(t, a, b);
  }
}

// --- balls against balls, which have no surface

void list_balls(const ObjectsView& objects, const ProximityQuery& t, std::uint32_t object,
                const Bounds& within, std::vector<std::uint32_t>& balls) {
  balls.clear();
  for (std::uint32_t i = objects.objects[object]->begin; i < objects.objects[object]->end; ++i)
    if (overlap(t.boxes[i], within)) balls.push_back(i);
  std::sort(balls.begin(), balls.end(), [&](std::uint32_t i, std::uint32_t j) {
    return t.boxes[i].lo.x < t.boxes[j].lo.x || (t.boxes[i].lo.x == t.boxes[j].lo.x && i < j);
  });
}

// Tests each of `balls` against those of `others` whose boxes begin within its own box along x.
bool any_touch(const ParticleView& particles, const ProximityQuery& t,
               const std::vector<std::uint32_t>& balls, const std::vector<std::uint32_t>& others) {
  std::size_t first = 0;
  for (const std::uint32_t i : balls) {
    const Bounds& box = t.boxes[i];
    while (first < others.size() && t.boxes[others[first]].lo.x < box.lo.x) ++first;
    for (std::size_t k = first; k < others.size() && t.boxes[others[k]].lo.x <= box.hi.x; ++k) {
      const std::uint32_t j = others[k];
      if ((t.active_particles[i].w == 0 && t.active_particles[j].w == 0) || !overlap(box, t.boxes[j]))
        continue;
      if (length(particles.difference(i, j)) <=
          t.margin[i] + t.margin[j] + t.motion_bound[i] + t.motion_bound[j])
        return true;
    }
  }
  return false;
}

void check_balls(const ObjectsView& objects, const ContactTables& tables, ProximityQuery& t) {
  const ParticleView view = objects.view();
  for (const auto& [a, b] : t.candidates) {
    if (t.is_found.contains(a, b) || !tables.objects[a].are_balls || !tables.objects[b].are_balls) continue;
    list_balls(objects, t, a, t.bounds[b], t.balls_a);
    list_balls(objects, t, b, t.bounds[a], t.balls_b);
    if (any_touch(view, t, t.balls_a, t.balls_b) || any_touch(view, t, t.balls_b, t.balls_a))
      add_found(t, a, b);
  }
}

}  // namespace

void ProximityQuery::reset(const ObjectsView& objects) {
  const std::size_t particles = objects.particles.size();
  active.assign(objects.objects.size(), 0), passive.assign(objects.objects.size(), 0);
  boxes.resize(particles), margin.resize(particles), motion_bound.resize(particles),
      active_particles.resize(particles);
}

std::size_t ProximityQuery::bytes() const {
  return bytes_of(active, passive, boxes, margin, motion_bound, active_particles, found, bounds, candidates,
                  has_candidate, listed, in_elements, balls_a, balls_b, pairs.vertex_triangle,
                  pairs.edge_edge) +
         elements.bytes() + finder.bytes() + sweep.bytes() + is_candidate.bytes() + is_found.bytes();
}

void find_close_objects(const ObjectsView& objects, const ContactTables& tables, ProximityQuery& query,
                        Threads& threads) {
  query.found.clear();
  find_bounds(objects, query);
  list_objects(objects, tables, query);
  if (query.listed.empty()) return;
  build_elements(objects, tables, query);
  query.finder.find(query.elements, query.boxes, query.is_candidate, query.active_particles, query.pairs,
                    threads);
  check_pairs(objects, query, query.pairs.vertex_triangle, false);
  check_pairs(objects, query, query.pairs.edge_edge, true);
  check_balls(objects, tables, query);
}

}  // namespace souple
