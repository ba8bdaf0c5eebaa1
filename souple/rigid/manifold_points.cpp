#include "souple/rigid/manifold_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace souple::manifold {
namespace {

/// A point as seen along the normal.
struct Point2 {
  double x, y;
};
using Points2 = StackList<Point2, ContactPoints::capacity>;

Points2 project(const ContactPoints& points, const Vec3d& normal) {
  const Vec3d other = std::abs(normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = normalized(cross(other, normal)), v = cross(normal, u);
  Points2 out;
  for (int i = 0; i < points.size(); ++i) {
    out.push_back({dot(points[i].point, u), dot(points[i].point, v)});
  }
  return out;
}

/// Twice the area of a triangle, positive if it is counterclockwise.
double area(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// A measure must exceed that of an earlier point by this part of itself.
constexpr double noise = 1e-6;

/// The index with the largest positive measure, or 0.
template <class Measure>
int largest(const Points2& points, const Measure& measure) {
  int best = 0;
  double value = 0;
  for (int i = 0; i < points.size(); ++i) {
    const double other = measure(points[i]);
    if (other > value) best = i, value = other * (1 + noise);
  }
  return best;
}

double squared_distance(const Point2& a, const Point2& b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

/// The point farthest from the middle of all points, among the deepest ones.
int outermost_of_deepest(const ContactPoints& points, const Points2& flat, double tolerance) {
  Point2 middle{0, 0};
  double lowest = points[0].height;
  for (int i = 0; i < points.size(); ++i) {
    middle.x += flat[i].x / points.size(), middle.y += flat[i].y / points.size();
    lowest = std::min(lowest, points[i].height);
  }
  int best = 0;
  double farthest = -1;
  for (int i = 0; i < points.size(); ++i) {
    const double distance = squared_distance(middle, flat[i]);
    if (points[i].height > lowest + tolerance || distance <= farthest) continue;
    best = i, farthest = distance * (1 + noise);
  }
  return best;
}

/// Four indices, some of them equal where points coincide.
std::array<int, 4> choose_four(const ContactPoints& points, const Vec3d& normal, double tolerance) {
  const Points2 flat = project(points, normal);
  std::array<int, 4> chosen{};
  chosen[0] = outermost_of_deepest(points, flat, tolerance);
  const Point2 a = flat[chosen[0]];
  chosen[1] = largest(flat, [&](const Point2& p) { return squared_distance(a, p); });
  Point2 b = flat[chosen[1]];
  chosen[2] = largest(flat, [&](const Point2& p) { return std::abs(area(a, b, p)); });
  Point2 c = flat[chosen[2]];
  if (area(a, b, c) < 0) std::swap(b, c);
  // The area that a point adds to the triangle lies outside one of its sides.
  chosen[3] = largest(flat, [&](const Point2& p) {
    return -std::min({area(a, b, p), area(b, c, p), area(c, a, p)});
  });
  return chosen;
}

/// In ascending order.
void keep_only(ContactPoints& points, const std::array<int, 4>& ascending) {
  int count = 0, last = -1;
  for (const int i : ascending) {
    if (i == last) continue;
    points[count++] = points[i];  // to its own place or one before it
    last = i;
  }
  points.shrink(count);
}

/// The area of a convex quadrilateral of four points in any order: half the largest product of two diagonals.
double area_of(const ContactPoints& points, const std::array<int, 4>& chosen, const Vec3d& normal) {
  const auto at = [&](std::size_t k) { return points[chosen[k]].point; };
  const Vec3d ab = at(1) - at(0), cd = at(3) - at(2), ac = at(2) - at(0), bd = at(3) - at(1),
              ad = at(3) - at(0), bc = at(2) - at(1);
  return 0.5 * std::max({std::abs(dot(normal, cross(ab, cd))), std::abs(dot(normal, cross(ac, bd))),
                         std::abs(dot(normal, cross(ad, bc)))});
}

/// The indices of the last choice, if it is still a good one.
bool find_last(const ContactPoints& points, const Vec3d& normal, double slack, const LastPoints& last,
               std::array<int, 4>& chosen) {
  std::size_t found = 0;
  double lowest = points[0].height, lowest_chosen = std::numeric_limits<double>::infinity();
  for (int i = 0; i < points.size(); ++i) {
    lowest = std::min(lowest, points[i].height);
    if (std::find(last.features.begin(), last.features.end(), points[i].feature) == last.features.end())
      continue;
    if (found == 4) return false;
    chosen[found++] = i;
    lowest_chosen = std::min(lowest_chosen, points[i].height);
  }
  constexpr double least_part = 0.9;
  return found == 4 && lowest_chosen <= lowest + slack &&
         area_of(points, chosen, normal) >= least_part * last.area;
}

}  // namespace

void reduce_to_four(ContactPoints& points, const Vec3d& normal, double tolerance) {
  if (points.size() <= 4) return;
  std::array<int, 4> chosen = choose_four(points, normal, tolerance);
  std::sort(chosen.begin(), chosen.end());
  keep_only(points, chosen);
}

void reduce_to_four(ContactPoints& points, const Vec3d& normal, double slack, LastPoints& last) {
  if (points.size() <= 4) {
    last.count = 0;
    return;
  }
  std::array<int, 4> chosen{};
  if (last.count == 4 && find_last(points, normal, slack, last, chosen)) return keep_only(points, chosen);
  reduce_to_four(points, normal, 0.1 * slack);
  last.count = points.size() == 4 ? 4 : 0;
  if (last.count == 0) return;
  for (std::size_t k = 0; k < 4; ++k) last.features[k] = points[static_cast<int>(k)].feature;
  last.area = area_of(points, {0, 1, 2, 3}, normal);
}

}  // namespace souple::manifold
