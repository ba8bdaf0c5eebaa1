#include "souple/error.h"
#include "souple/rigid/convex_shape.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::test_rigid_convex_shape {

/// Volume of the polyhedron by the pyramids from the origin to its faces.
double volume(const ConvexShape& shape) {
  double sum = 0;
  for (const ConvexFace& f : shape.faces) {
    const Vec3d a = shape.vertices[shape.corners[f.begin].vertex];
    for (std::uint32_t c = f.begin + 1; c + 1 < f.end; ++c) {
      sum += dot(a, cross(shape.vertices[shape.corners[c].vertex],
                          shape.vertices[shape.corners[c + 1].vertex])) /
             6;
    }
  }
  return sum;
}

TEST(ConvexShape, ABoxHasSixFacesTwelveEdgesAndItsVolume) {
  const ConvexShape box = convex_box({0.5, 1, 2});
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.faces.size(), 6u);
  EXPECT_EQ(box.edges.size(), 12u);
  EXPECT_NEAR(volume(box), 8, 1e-12);
  EXPECT_NEAR(box.inner_radius, 0.5, 1e-12);
  EXPECT_NEAR(box.outer_radius, std::sqrt(0.25 + 1 + 4), 1e-12);
  EXPECT_EQ(box.bounds.hi, (Vec3d{0.5, 1, 2}));
}

TEST(ConvexShape, ACylinderIsAPrismWithItsVerticesOnTheRims) {
  const ConvexShape cylinder = convex_cylinder(0.5, 1, 24);
  EXPECT_EQ(cylinder.faces.size(), 26u);
  EXPECT_EQ(cylinder.edges.size(), 72u);
  EXPECT_NEAR(volume(cylinder), 2 * 0.5 * 0.5 * 12 * std::sin(2 * 3.14159265358979 / 24), 1e-9);
  for (const Vec3d& v : cylinder.vertices) EXPECT_NEAR(std::hypot(v.x, v.z), 0.5, 1e-12);
}

TEST(ConvexShape, NormalsEdgesAndSidePlanesFitTogether) {
  for (const ConvexShape& s : {convex_box({1, 2, 3}), convex_cylinder(1, 2, 7), convex_cylinder(1, 1, 200)}) {
    for (const ConvexFace& f : s.faces) {
      EXPECT_NEAR(length(f.normal), 1, 1e-12);
      EXPECT_LE(f.end - f.begin, max_face_corners);
      for (std::uint32_t c = f.begin; c < f.end; ++c) {
        EXPECT_NEAR(dot(f.normal, s.corners[c].side_normal), 0, 1e-12);
        // The face lies on the inner side of its side planes.
        for (std::uint32_t d = f.begin; d < f.end; ++d) {
          EXPECT_LE(dot(s.corners[c].side_normal, s.vertices[s.corners[d].vertex]),
                    s.corners[c].side_offset + 1e-12);
        }
      }
    }
    for (const ConvexEdge& e : s.edges) {
      EXPECT_NEAR(dot(s.faces[e.left].normal, s.vertices[e.from]), s.faces[e.left].offset, 1e-12);
      EXPECT_NEAR(dot(s.faces[e.right].normal, s.vertices[e.to]), s.faces[e.right].offset, 1e-12);
      const Vec3d around = cross(s.faces[e.left].normal, s.faces[e.right].normal);
      EXPECT_GT(dot(around, s.vertices[e.to] - s.vertices[e.from]), 0);
    }
  }
}

TEST(ConvexShape, TheHullOfABoxesCornersEdgesAndInsideIsTheBox) {
  std::vector<Vec3d> points;
  for (const double x : {-1, 0, 1}) {
    for (const double y : {-1, 0, 1}) points.insert(points.end(), {{x, y, -2}, {x, y, 0}, {x, y, 2}});
  }
  const ConvexShape hull = convex_hull_shape(points, 0.1);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_EQ(hull.edges.size(), 12u);
  EXPECT_NEAR(volume(hull), 16, 1e-9);
  EXPECT_NEAR(hull.inner_radius, 1, 1e-9);
  EXPECT_LT(length(hull.bounds.hi - Vec3d{1.1, 1.1, 2.1}), 1e-9);
  EXPECT_THROW(convex_hull_shape(std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}), Error);
}

TEST(ConvexShape, MovesAsAWhole) {
  const BodyPose pose{{1, -2, 3}, normalized(Quatd{0.1, 0.7, -0.3, 0.5})};
  const ConvexShape shape = convex_cylinder(0.5, 1, 12), there = moved(shape, pose);
  EXPECT_NEAR(there.inner_radius, shape.inner_radius, 1e-12);
  for (const ConvexFace& f : there.faces) {
    for (std::uint32_t c = f.begin; c < f.end; ++c) {
      EXPECT_NEAR(dot(f.normal, there.vertices[there.corners[c].vertex]), f.offset, 1e-12);
      EXPECT_NEAR(dot(there.corners[c].side_normal, there.vertices[there.corners[c].vertex]),
                  there.corners[c].side_offset, 1e-12);
    }
  }
}

TEST(ConvexShape, OfACollidersShapeHasItsPlace) {
  const std::optional<ConvexShape> box =
      convex_shape_of(Box{.center = {1, 2, 3}, .half_extents = {0.5f, 1, 2}});
  ASSERT_TRUE(box.has_value());
  EXPECT_LT(length(box->bounds.lo - Vec3d{0.5, 1, 1}), 1e-6);
  EXPECT_TRUE(convex_shape_of(Capsule{}).has_value());
  EXPECT_FALSE(convex_shape_of(Plane{}).has_value());
}

TEST(ConvexShape, RefusesSizesAndFacesThatMakeNoBody) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(convex_sphere(0), Error);
  EXPECT_THROW(convex_sphere(nan), Error);
  EXPECT_THROW(convex_capsule(1, -1), Error);
  EXPECT_THROW(convex_box({1, 0, 1}), Error);
  EXPECT_THROW(convex_cylinder(1, 1, 2), Error);
  const ConvexShape box = convex_box({1, 1, 1});
  std::vector<FaceLoop> faces{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}};
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // open
  faces.push_back({4, 5, 7, 8});
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // no such vertex
  faces.back() = {4, 6, 7, 5};
  EXPECT_THROW(convex_polyhedron(box.vertices, faces), Error);  // wound the wrong way
  faces.back() = {4, 5, 7, 6};
  EXPECT_NO_THROW(convex_polyhedron(box.vertices, faces));
  std::vector<Vec3d> dented = box.vertices;
  dented[7] = {0.1, 0.1, 0.1};
  EXPECT_THROW(convex_polyhedron(dented, faces), Error);
}

}  // namespace souple::test_rigid_convex_shape
