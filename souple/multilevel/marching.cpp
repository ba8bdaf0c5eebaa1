#include "souple/multilevel/marching.h"

#include "souple/assert.h"
#include "souple/math/bit_cast.h"
#include "souple/math/sentinels.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace souple {
namespace {

/// Minimum number of particles per thread.
constexpr std::size_t seed_grain = 1024;
/// Relative difference of lengths that is not worth another entry of the queue. The paths across two triangles to one
/// particle often differ by rounding alone.
constexpr float indifferent = 1e-5f;
/// Square of the length in Triangle's coordinates; infinite if the line does not cross the edge. du2, dw2: squares of
/// the distances to u and w.
float unfolded_squared(float du2, float dw2, const LinkTriangles::Triangle& t) {
  const float s_x = (du2 - dw2) * t.inverse_2c + t.half_c, s_y2 = du2 - s_x * s_x;
  const float s_y = std::sqrt(s_y2 > 0 ? s_y2 : 0);
  // The line from s to v crosses the edge at x = (s_x v_y + v_x s_y) / (s_y + v_y).
  const float across = s_x * t.v_y + t.v_x * s_y;
  const bool crosses = (s_y2 > 0) & (across >= 0) & (across <= 2 * t.half_c * (s_y + t.v_y));
  const float squared = (t.v_x - s_x) * (t.v_x - s_x) + (t.v_y + s_y) * (t.v_y + s_y);
  return crosses ? squared : infinity;
}

/// False if no line from one side of the edge u w reaches a corner v on the other.
bool set_corner(float c, float a, float b, LinkTriangles::Triangle& t) {
  t.half_c = c / 2, t.inverse_2c = 1 / (2 * c);
  t.v_x = (a * a - b * b) * t.inverse_2c + t.half_c;
  const float v_y2 = a * a - t.v_x * t.v_x;
  if (!(v_y2 > 0)) return false;
  t.v_y = std::sqrt(v_y2);
  return true;
}

}  // namespace

float unfolded_length(float d_u, float d_w, float c, float a, float b) {
  LinkTriangles::Triangle t;
  return set_corner(c, a, b, t) ? std::sqrt(unfolded_squared(d_u * d_u, d_w * d_w, t)) : infinity;
}

LinkEnds::LinkEnds(std::span<const Link> links, std::size_t particles, Threads& threads)
    : ends_(particles, [&](const auto& add) {
        for (std::uint32_t e = 0; e < links.size(); ++e)
          add(links[e].a, {links[e].b, links[e].length, e}),
              add(links[e].b, {links[e].a, links[e].length, e});
      }) {
  threads.for_each(particles, seed_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<End> ends = ends_[i];
      if (ends.size() > max_shortest)
        std::nth_element(
            ends.begin(), ends.begin() + max_shortest, ends.end(),
            [](const End& p, const End& q) { return std::pair(p.length, p.to) < std::pair(q.length, q.to); });
    }
  });
}

LinkTriangles::LinkTriangles(std::span<const Link> links, const LinkEnds& ends, Threads& threads)
    : triangles_((ends.size() + chunk - 1) / chunk) {
  std::vector<char> kept(links.size());
  for (std::uint32_t i = 0; i < ends.size(); ++i)
    for (const LinkEnds::End& end : ends.shortest(i)) kept[end.link] = 1;
  neighbors_.fill(ends.size(), [&](const auto& add) {
    for (std::uint32_t e = 0; e < links.size(); ++e) {
      if (kept[e] == 0) continue;
      const Link& link = links[e];
      add(link.a, {link.b, link.length, e}), add(link.b, {link.a, link.length, e});
    }
  });
  threads.each(triangles_.size(), 1, [&](std::size_t c) {
    find_triangles(static_cast<std::uint32_t>(c * chunk),
                   static_cast<std::uint32_t>(std::min((c + 1) * chunk, size())), triangles_[c]);
  });
}

void LinkTriangles::find_triangles(std::uint32_t first, std::uint32_t last,
                                   std::vector<Triangle>& triangles) {
  constexpr std::size_t few_neighbors = 64;
  const auto is_before = [](const Neighbor& n, std::uint32_t to) { return n.to < to; };
  std::vector<std::pair<std::uint32_t, float>> to_w(size(), {no_index, 0});  // per w: u, |u w|
  triangles.reserve(std::size_t{24} * (last - first));
  for (std::uint32_t u = first; u < last; ++u) {
    SOUPLE_ASSERT(of(u).size() <= few_neighbors ||
                      std::is_sorted(of(u).begin(), of(u).end(),
                                     [](const Neighbor& n, const Neighbor& m) { return n.to < m.to; }),
                  "links of a particle with many are sorted");
    for (const Neighbor& n : of(u)) to_w[n.to] = {u, n.length};
    for (Neighbor& n : neighbors_[u]) {
      n.triangle_begin = static_cast<std::uint32_t>(triangles.size());
      const auto add = [&](const Neighbor& m) {
        Triangle t{m.to};
        if (to_w[m.to].first == u && set_corner(to_w[m.to].second, n.length, m.length, t))
          triangles.push_back(t);
      };
      // The search of the longer list costs less than to go through it for each of its thousands of neighbors.
      const std::span<const Neighbor> others = of(n.to);
      if (others.size() > std::max(few_neighbors, of(u).size())) {
        for (const Neighbor& w : of(u))
          if (const auto m = std::lower_bound(others.begin(), others.end(), w.to, is_before);
              m != others.end() && m->to == w.to)
            add(*m);
      } else {
        for (const Neighbor& m : others) add(m);
      }
      n.triangle_end = static_cast<std::uint32_t>(triangles.size());
    }
  }
}

Marcher::Marcher(const LinkTriangles& triangles)
    : triangles_(triangles), seen_(triangles.size()), squared_(triangles.size(), infinity) {}

std::span<const Marcher::Reached> Marcher::march(std::uint32_t source, float radius) {
  begin(source, radius);
  while (next_length() <= radius) reach_next();
  return reached_;
}

void Marcher::begin(std::uint32_t source, float radius) {
  for (const Reached& r : reached_) squared_[r.particle] = infinity;
  reached_.clear(), heap_.clear(), offered_.clear();
  radius_ = radius;
  ++march_;
  offer(source, 0);
}

// Length to the nearest particle that is not reached; infinite if there is none.
float Marcher::next_length() {
  while (!heap_.empty() && squared_[static_cast<std::uint32_t>(heap_.front())] < infinity) pop();
  return heap_.empty() ? infinity : bit_cast<float>(static_cast<std::uint32_t>(heap_.front() >> 32));
}

std::uint32_t Marcher::reach_next() {
  const auto u = static_cast<std::uint32_t>(heap_.front());
  const float length = seen_[u].length;
  pop();
  squared_[u] = length * length;
  reached_.push_back({u, length});
  relax_neighbors(u, length);
  return u;
}

void Marcher::pop() {
  std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
  heap_.pop_back();
}

std::span<const Marcher::Reached> Marcher::beyond() {
  beyond_.clear();
  for (const std::uint32_t v : offered_)
    if (!(squared_[v] < infinity)) beyond_.push_back({v, seen_[v].length});
  return beyond_;
}

void Marcher::offer(std::uint32_t v, float length) {
  Seen& seen = seen_[v];
  if (seen.march != march_) {
    seen.march = march_;
    offered_.push_back(v);
  } else if (seen.length <= length * (1 + indifferent)) {
    return;
  }
  seen.length = length;
  if (length > radius_) return;
  heap_.push_back(std::uint64_t{bit_cast<std::uint32_t>(length)} << 32 | v);
  std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
}

void Marcher::relax_neighbors(std::uint32_t u, float du) {
  const float du2 = squared_[u];
  const LinkTriangles::Triangle* const triangles = triangles_.triangles_of(u);
  for (const LinkTriangles::Neighbor& n : triangles_.of(u)) {
    if (squared_[n.to] < infinity) continue;
    float best2 = infinity;
    for (std::uint32_t k = n.triangle_begin; k < n.triangle_end; ++k)
      if (const float dw2 = squared_[triangles[k].w]; dw2 < infinity)
        best2 = std::min(best2, unfolded_squared(du2, dw2, triangles[k]));
    offer(n.to, std::min(du + n.length, std::sqrt(best2)));
  }
}

}  // namespace souple
