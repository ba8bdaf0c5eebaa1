#include "souple/rigid/manifold_points.h"

#include <algorithm>
#include <array>

namespace souple::manifold {
namespace {

/// The index with the largest measure; a later one must exceed the first by a part of itself.
template <class Measure>
int largest(const ContactPoints& points, const Measure& measure) {
  constexpr double noise = 1e-6;
  int best = 0;
  double value = measure(points[0]);
  for (int i = 1; i < points.size(); ++i) {
    const double other = measure(points[i]);
    if (other > value + noise * std::max(other, -other)) best = i, value = other;
  }
  return best;
}

int deepest(const ContactPoints& points, double tolerance) {
  int best = 0;
  for (int i = 1; i < points.size(); ++i) {
    if (points[i].height < points[best].height - tolerance) best = i;
  }
  return best;
}

}  // namespace

void reduce_to_four(ContactPoints& points, const Vec3d& normal, double tolerance) {
  if (points.size() <= 4) return;
  std::array<int, 4> kept{};
  kept[0] = deepest(points, tolerance);
  const Vec3d a = points[kept[0]].point;
  kept[1] = largest(points, [&](const ContactPoint& p) {
    const Vec3d d = p.point - a;
    return length_squared(d) - dot(d, normal) * dot(d, normal);
  });
  Vec3d b = points[kept[1]].point;
  const auto area = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    return dot(normal, cross(q - p, r - p));
  };
  kept[2] = largest(points, [&](const ContactPoint& p) { return std::abs(area(a, b, p.point)); });
  Vec3d c = points[kept[2]].point;
  if (area(a, b, c) < 0) std::swap(b, c);
  // What a point adds to the triangle is outside one of its sides.
  kept[3] = largest(points, [&](const ContactPoint& p) {
    return std::max({-area(a, b, p.point), -area(b, c, p.point), -area(c, a, p.point)});
  });
  std::sort(kept.begin(), kept.end());
  ContactPoints out;
  for (int k = 0; k < 4; ++k) {
    if (k == 0 || kept[static_cast<std::size_t>(k)] != kept[static_cast<std::size_t>(k - 1)]) {
      out.push_back(points[kept[static_cast<std::size_t>(k)]]);
    }
  }
  points.clear();
  for (int i = 0; i < out.size(); ++i) points.push_back(out[i]);
}

}  // namespace souple::manifold
