#include "render/rope_strain.h"

#include "souple/objects/kind_traits.h"
#include "souple/world/debug_draw.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <tuple>

namespace souple::render {
namespace {

/// A point of a rope, identified by its position: constraints do not store more about their particles.
struct RopePoint {
  std::array<float, 3> at;
  std::uint32_t body, point;

  friend bool operator<(const RopePoint& a, const RopePoint& b) {
    return std::tie(a.at, a.body, a.point) < std::tie(b.at, b.body, b.point);
  }
};

std::array<float, 3> key(const Vec3f& x) {
  return {x.x, x.y, x.z};
}

std::vector<RopePoint> points_of_ropes(const Subject& subject) {
  std::vector<RopePoint> points;
  for (std::uint32_t b = 0; b < subject.bodies.size(); ++b) {
    const Body& body = subject.bodies[b];
    if (traits_of(body.kind).shape != ObjectShape::line) continue;
    for (std::uint32_t i = 0; i < body.positions.size(); ++i)
      points.push_back({key(body.positions[i]), b, i});
  }
  std::sort(points.begin(), points.end());
  return points;
}

std::span<const RopePoint> found_at(const std::vector<RopePoint>& points, const Vec3f& x) {
  const auto before = [](const RopePoint& p, const std::array<float, 3>& at) { return p.at < at; };
  const auto first = std::lower_bound(points.begin(), points.end(), key(x), before);
  auto last = first;
  while (last != points.end() && last->at == key(x)) ++last;
  return {points.data() + (first - points.begin()), static_cast<std::size_t>(last - first)};
}

}  // namespace

std::vector<std::vector<float>> rope_strains(const Subject& subject) {
  std::vector<std::vector<float>> strains(subject.bodies.size());
  const std::vector<RopePoint> points = points_of_ropes(subject);
  if (points.empty() || !subject.world) return strains;
  for (const RopePoint& p : points) strains[p.body].resize(subject.bodies[p.body].positions.size());

  DebugDraw draw;
  draw.constraint = [&](const DebugConstraint& c) {
    if (c.points.size() != 2 || c.kind != "distance") return;
    for (const RopePoint& a : found_at(points, c.points[0]))
      for (const RopePoint& b : found_at(points, c.points[1])) {
        const bool segment = a.body == b.body && (a.point + 1 == b.point || b.point + 1 == a.point);
        if (!segment) continue;
        for (const std::uint32_t i : {a.point, b.point})
          strains[a.body][i] = std::max(strains[a.body][i], c.strain);
      }
  };
  subject.world->debug_draw(draw);
  return strains;
}

}  // namespace souple::render
