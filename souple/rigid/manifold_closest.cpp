#include "souple/rigid/manifold_closest.h"

#include "souple/collision/nearest.h"

#include <algorithm>
#include <array>

namespace souple::manifold {
namespace {

/// A vertex of the difference b - a.
struct Difference {
  Vec3d on_a, on_b, point;
  std::uint32_t a = 0, b = 0;
};

/// The vertices of the difference whose hull contains its point nearest to the origin, with that point's weights.
struct Simplex {
  std::array<Difference, 4> vertex;
  std::array<double, 4> weight{};
  std::size_t count = 0;

  Vec3d nearest() const {
    Vec3d sum{};
    for (std::size_t i = 0; i < count; ++i) sum += vertex[i].point * weight[i];
    return sum;
  }
  void drop_unused() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (!(weight[i] > 0)) continue;
      vertex[kept] = vertex[i], weight[kept] = weight[i], ++kept;
    }
    count = kept;
  }
  bool contains(const Difference& d) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (vertex[i].a == d.a && vertex[i].b == d.b) return true;
    }
    return false;
  }
};

Difference farthest(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a, const Vec3d& axis) {
  Difference d;
  d.a = lowest_vertex(a.vertices, -axis).vertex;
  d.b = lowest_vertex(b.vertices, b_to_a.back(axis)).vertex;
  d.on_a = a.vertices[d.a];
  d.on_b = b_to_a.point(b.vertices[d.b]);
  d.point = d.on_b - d.on_a;
  return d;
}

void weigh_triangle(const Simplex& s, std::size_t i, std::size_t j, std::size_t k,
                    std::array<double, 4>& weight) {
  double w[3];
  nearest_on_triangle(Vec3d{}, s.vertex[i].point, s.vertex[j].point, s.vertex[k].point, w);
  weight = {};
  weight[i] = w[0], weight[j] = w[1], weight[k] = w[2];
}

/// The origin is outside the tetrahedron: its nearest point is on one of the four triangles.
void weigh_tetrahedron(Simplex& s) {
  static constexpr std::size_t triangles[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  std::array<double, 4> best{};
  double least = -1;
  for (const auto& t : triangles) {
    weigh_triangle(s, t[0], t[1], t[2], s.weight);
    const double squared = length_squared(s.nearest());
    if (least < 0 || squared < least) least = squared, best = s.weight;
  }
  s.weight = best;
}

void weigh(Simplex& s) {
  if (s.count == 1) s.weight = {1, 0, 0, 0};
  if (s.count == 2) {
    const double t = nearest_on_edge(Vec3d{}, s.vertex[0].point, s.vertex[1].point);
    s.weight = {1 - t, t, 0, 0};
  }
  if (s.count == 3) weigh_triangle(s, 0, 1, 2, s.weight);
  if (s.count == 4) weigh_tetrahedron(s);
}

/// Depends on the sets of vertices, not on their order.
std::uint32_t feature_of(const Simplex& s) {
  std::uint32_t low_a = ~0u, high_a = 0, low_b = ~0u, high_b = 0;
  for (std::size_t i = 0; i < s.count; ++i) {
    low_a = std::min(low_a, s.vertex[i].a), high_a = std::max(high_a, s.vertex[i].a);
    low_b = std::min(low_b, s.vertex[i].b), high_b = std::max(high_b, s.vertex[i].b);
  }
  return feature_id(FeatureKind::other, low_a + 257 * high_a, low_b + 257 * high_b);
}

ClosestPoints result_of(const Simplex& s) {
  ClosestPoints out;
  for (std::size_t i = 0; i < s.count; ++i) {
    out.on_a += s.vertex[i].on_a * s.weight[i];
    out.on_b += s.vertex[i].on_b * s.weight[i];
  }
  const Vec3d between = s.nearest();
  out.distance = length(between);
  out.axis = normalized(between);
  out.feature = feature_of(s);
  return out;
}

}  // namespace

ClosestPoints closest_points(const ConvexView& a, const ConvexView& b, const FrameChange& b_to_a,
                             const Vec3d& axis) {
  constexpr double relative_error = 1e-14;  // of the squared distance
  constexpr int max_iterations = 64;
  Simplex simplex;
  simplex.vertex[0] = farthest(a, b, b_to_a, axis);
  simplex.count = 1;
  weigh(simplex);
  for (int i = 0; i < max_iterations; ++i) {
    const Vec3d nearest = simplex.nearest();
    const double squared = length_squared(nearest);
    if (!(squared > 0)) break;
    const Difference next = farthest(a, b, b_to_a, nearest);
    if (squared - dot(nearest, next.point) <= relative_error * squared || simplex.contains(next)) break;
    Simplex larger = simplex;
    larger.vertex[larger.count++] = next;
    weigh(larger);
    if (!(length_squared(larger.nearest()) < squared)) break;
    larger.drop_unused();
    simplex = larger;
  }
  return result_of(simplex);
}

}  // namespace souple::manifold
