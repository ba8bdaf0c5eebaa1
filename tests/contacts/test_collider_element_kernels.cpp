// Searches for the deepest point of elements, compared with sampling in double.
#include "souple/contacts/kernels/find_kernels.h"
#include "souple/contacts/packed_collider.h"
#include "souple/geometry/builders.h"
#include "souple/simd/instruction_set.h"
#include "tests/collision/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_collider_element_kernels {

constexpr float radius = 0.001f;  // m, of particles
constexpr float part = 0.25f;     // of it: clearance

/// Triangles in a frame, and the results of a search.
struct Triangles {
  std::vector<Vec4f> from, to;
  std::vector<std::uint32_t> corner[3];
  std::vector<float> radii;
  std::vector<float> out[9], search[4];
  std::vector<std::uint32_t> list;

  void add(const Vec3d (&x)[3], const Vec3d& motion) {
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k].push_back(static_cast<std::uint32_t>(4 * from.size()));
      const Vec3d end = x[k] + motion;
      from.push_back({float(x[k].x), float(x[k].y), float(x[k].z), 0});
      to.push_back({float(end.x), float(end.y), float(end.z), 0});
    }
    radii.push_back(radius);
  }
  std::size_t size() const { return radii.size(); }
  Vec3d at(std::size_t t, std::size_t k, double time) const {
    const std::size_t i = corner[k][t] / 4;
    return Vec3d(from[i].xyz()) * (1 - time) + Vec3d(to[i].xyz()) * time;
  }
  kernels::ColliderFrameRecords records() { return {&from[0].x, &to[0].x}; }
  kernels::ColliderElements elements(std::size_t a = 0, std::size_t b = 1, std::size_t c = 2) const {
    return {{corner[a].data(), corner[b].data(), corner[c].data()}, radii.data(), part};
  }
  kernels::ColliderElementTouches touches() {
    for (auto& column : out) column.assign(size(), 0);
    return {out[0].data(),
            {out[1].data(), out[2].data(), out[3].data()},
            out[4].data(),
            {out[5].data(), out[6].data(), out[7].data()},
            out[8].data()};
  }
  kernels::ColliderFieldSearch field_search() {
    for (auto& column : search) column.assign(size(), 1);
    list.resize(size());
    std::iota(list.begin(), list.end(), 0u);
    return {search[0].data(), search[1].data(), search[2].data(), search[3].data(), 8, 0.01f};
  }
};

/// Triangles near a surface, of edges of `size`.
Triangles near_surface(const Shape& shape, double size, std::size_t count, double motion) {
  test::Random random(7);
  Triangles result;
  const BoundingBall ball = bounding_ball(shape);
  while (result.size() < count) {
    Vec3d middle = ball.center + random.point(-ball.radius, ball.radius);
    const SurfaceDistance below = surface_distance(shape, middle);
    middle = middle - below.normal * (below.distance - random.uniform(0, 0.3 * size));
    Vec3d x[3];
    for (Vec3d& corner : x) corner = middle + random.point(-0.6 * size, 0.6 * size);
    result.add(x, random.point(-motion, motion));
  }
  return result;
}

double lowest_of(const Shape& shape, const Triangles& triangles, std::size_t t, double time, bool inside) {
  constexpr int n = 60;
  double lowest = 1e9;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      if (!inside && i != 0 && j != 0 && i + j != n) continue;
      const double u = double(i) / n, v = double(j) / n;
      const Vec3d p = triangles.at(t, 0, time) * (1 - u - v) + triangles.at(t, 1, time) * u +
                      triangles.at(t, 2, time) * v;
      lowest = std::min(lowest, surface_distance(shape, p).distance);
    }
  return lowest;
}

kernels::ColliderBody body_of(const Shape& shape) {
  kernels::ColliderBody body;
  body.shape = packed_shape(shape);
  return body;
}

const Shape convex_shapes[] = {Sphere{{}, 0.1f}, Box{{}, {0.1f, 0.05f, 0.2f}}, Capsule{{}, 0.05f, 0.1f},
                               Cylinder{{}, 0.1f, 0.06f}};

/// Per triangle: the smallest start distance that its three edges and its inside found.
std::vector<double> start_distances(const kernels::ColliderElementKernels& kernels, const Shape& shape,
                                    Triangles& triangles) {
  const kernels::ColliderBody body = body_of(shape);
  std::vector<double> found(triangles.size(), 1e9);
  const auto add = [&](const kernels::ColliderElements& elements, auto kernel) {
    const auto out = triangles.touches();
    kernel(body, triangles.records(), elements, 0, triangles.size(), out);
    for (std::size_t t = 0; t < found.size(); ++t)
      found[t] = std::min(found[t], double(out.start_distance[t]));
  };
  add(triangles.elements(0, 1, 1), kernels.find_edges);
  add(triangles.elements(1, 2, 2), kernels.find_edges);
  add(triangles.elements(2, 0, 0), kernels.find_edges);
  for (std::size_t t = 0; t < found.size(); ++t) found[t] = std::max(found[t], double(-1e9));
  const auto out = triangles.touches();
  kernels.find_triangles(body, triangles.records(), triangles.elements(), 0, triangles.size(), out);
  for (std::size_t t = 0; t < found.size(); ++t)  // radius where nothing is inside
    if (double(out.start_distance[t]) != double(radius))
      found[t] = std::min(found[t], double(out.start_distance[t]));
  return found;
}

// Outside of a shape, edges and insides together find the deepest point of a triangle to a tenth of the radius.
TEST(ColliderElementKernels, FindTheDeepestPointOfATriangle) {
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  for (const Shape& shape : convex_shapes) {
    Triangles triangles = near_surface(shape, 0.08, 600, 0);
    const std::vector<double> found = start_distances(kernels, shape, triangles);
    int touching = 0;
    for (std::size_t t = 0; t < found.size(); ++t) {
      const double lowest = lowest_of(shape, triangles, t, 0, true);
      if (lowest > double(radius)) {
        EXPECT_GT(found[t], 0.9 * double(radius)) << shape_name(shape) << ' ' << t;
      } else if (lowest > 0) {
        ++touching;
        EXPECT_LT(found[t], lowest + 0.11 * double(radius)) << shape_name(shape) << ' ' << t;
        EXPECT_GT(found[t], lowest - 0.001) << shape_name(shape) << ' ' << t;  // samples are 1.3 mm apart
      } else {
        EXPECT_LT(found[t], 0.11 * double(radius)) << shape_name(shape) << ' ' << t;
      }
    }
    EXPECT_GT(touching, 5) << shape_name(shape);
  }
}

// A triangle that ends up inside has touched: with the plane of the touch, its deepest point would stay outside.
TEST(ColliderElementKernels, NoFastElementPasses) {
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  for (const Shape& shape : convex_shapes) {
    const kernels::ColliderBody body = body_of(shape);
    Triangles all = near_surface(shape, 0.08, 2000, 0.06), moving;
    for (std::size_t t = 0; t < all.size(); ++t) {
      if (lowest_of(shape, all, t, 0, true) < 2 * double(radius)) continue;
      const Vec3d x[3] = {all.at(t, 0, 0), all.at(t, 1, 0), all.at(t, 2, 0)};
      moving.add(x, all.at(t, 0, 1) - x[0]);
    }
    std::vector<float> touched(moving.size());
    const auto search = [&](const kernels::ColliderElements& elements, auto kernel) {
      const auto out = moving.touches();
      kernel(body, moving.records(), elements, 0, moving.size(), out);
      for (std::size_t t = 0; t < touched.size(); ++t) touched[t] = std::max(touched[t], out.touches[t]);
    };
    search(moving.elements(0, 1, 1), kernels.find_edges);
    search(moving.elements(1, 2, 2), kernels.find_edges);
    search(moving.elements(2, 0, 0), kernels.find_edges);
    search(moving.elements(), kernels.find_triangles);
    int passed = 0, entered = 0;
    for (std::size_t t = 0; t < moving.size(); ++t) {
      double lowest = 1e9, corners = 1e9;
      for (int s = 0; s <= 40; ++s) {
        lowest = std::min(lowest, lowest_of(shape, moving, t, s / 40.0, true));
        for (std::size_t k = 0; k < 3; ++k)
          corners = std::min(corners, surface_distance(shape, moving.at(t, k, s / 40.0)).distance);
      }
      if (!(lowest < -0.002) || corners < lowest + 0.002) continue;  // corners have contacts of their own
      ++entered;
      if (corners > double(radius) && touched[t] == 0) ++passed;
    }
    EXPECT_GT(entered, 50) << shape_name(shape);
    EXPECT_EQ(passed, 0) << shape_name(shape);
  }
}

TEST(ColliderElementKernels, FindDipsOfAField) {
  TriangleMesh mesh = sphere(4, 0.2);
  for (Vec3d& x : mesh.positions)
    x = x * (1 + 0.1 * std::sin(20 * x.x) * std::sin(20 * x.y) * std::sin(20 * x.z));
  const Shape shape = SignedDistanceField(mesh, 0.01);
  const auto& kernels = kernels::find_collider_element_kernels(instruction_set());
  Triangles triangles = near_surface(shape, 0.06, 500, 0);
  const auto out = triangles.touches();
  const auto search = triangles.field_search();
  kernels.sample_field_elements(body_of(shape), triangles.records(), triangles.elements(), search,
                                triangles.list.data(), 0, triangles.size());
  kernels.find_in_field(body_of(shape), triangles.records(), triangles.elements(), search,
                        triangles.list.data(), 0, triangles.size(), out);
  int near = 0, wrong = 0;
  double worst = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double lowest = lowest_of(shape, triangles, t, 0, true);
    if (lowest > 0.5 * double(radius)) continue;
    ++near;
    const double above = double(out.start_distance[t]) - lowest;
    worst = std::max(worst, above);
    if (above > double(radius)) ++wrong;
  }
  EXPECT_GT(near, 100);
  EXPECT_LT(worst, 0.005);  // half a cell
  EXPECT_LE(wrong, near / 50);
}

}  // namespace souple::test_contacts_collider_element_kernels
