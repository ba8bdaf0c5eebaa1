#include "souple/collision/collider_mesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_collision_collider_mesh {

const std::vector<Shape> shapes{
    Plane{{0.3f, 2, -0.5f}, 0.7f},  Sphere{{0.1f, 0.2f, 0.3f}, 0.8f}, Box{{1, -2, 0.5f}, {0.5f, 0.2f, 1.5f}},
    Capsule{{0, 1, 0}, 0.3f, 0.6f}, Capsule{{0, 1, 0}, 0.3f, 0},      Cylinder{{0.4f, 0, 0}, 0.25f, 0.9f}};

TEST(ColliderMesh, VerticesLieOnTheShape) {
  for (const Shape& shape : shapes) {
    const ColliderMesh mesh = collider_mesh(shape, {0.5, 0.5, 0.5}, 3);
    ASSERT_FALSE(mesh.triangles.empty());
    for (const Vec3f& x : mesh.positions)
      ASSERT_NEAR(surface_distance(shape, Vec3d(x)).distance, 0, 2e-6) << shape_name(shape);
  }
}

TEST(ColliderMesh, FacesAndNormalsPointOut) {
  for (const Shape& shape : shapes) {
    const ColliderMesh mesh = collider_mesh(shape, {0.5, 0.5, 0.5}, 3);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
      const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
      const Vec3d face = normalized(cross(b - a, c - a)), middle = (a + b + c) / 3.0;
      // A step along the face's normal leaves the solid.
      EXPECT_GT(surface_distance(shape, middle + face * 0.02).distance,
                surface_distance(shape, middle).distance + 0.015)
          << shape_name(shape);
      for (const std::uint32_t v : t) {
        ASSERT_NEAR(length(mesh.normals[v]), 1, 1e-5);
        EXPECT_GT(dot(Vec3d(mesh.normals[v]), face), 0.9) << shape_name(shape);
      }
    }
  }
}

TEST(ColliderMesh, EdgesOfBoxesAreSharpAndBallsAreSmooth) {
  const ColliderMesh solid = collider_mesh(Box{}, {}, 1);
  for (const Vec3f& n : solid.normals) {
    const float largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    EXPECT_NEAR(largest, 1, 1e-6);  // along an axis: no rounding of edges by averaged normals
  }
  const ColliderMesh ball = collider_mesh(Sphere{}, {}, 1);
  EXPECT_GE(ball.triangles.size(), 2000u);
  for (std::size_t v = 0; v < ball.positions.size(); ++v)
    EXPECT_GT(dot(normalized(ball.positions[v]), ball.normals[v]), 0.99999f);
  // A cylinder has both: normals along its axis on the caps, across it on the side, none between.
  for (const Vec3f& n : collider_mesh(Cylinder{}, {}, 1).normals)
    EXPECT_TRUE(std::abs(n.y) < 1e-5f || std::abs(n.y) > 0.99999f);
}

TEST(ColliderMesh, APlaneIsASquareAroundWhatIsThere) {
  const Plane plane{{0, 0, 2}, -3};  // z = -1.5
  const ColliderMesh mesh = collider_mesh(plane, {4, 5, 6}, 2);
  ASSERT_EQ(mesh.positions.size(), 4u);
  Vec3f middle{};
  for (const Vec3f& x : mesh.positions) middle += x / 4.0f;
  EXPECT_NEAR(length(middle - Vec3f{4, 5, -1.5f}), 0, 1e-5);
  for (const Vec3f& x : mesh.positions) EXPECT_NEAR(length(x - middle), 2 * std::sqrt(2.0f), 1e-5);
}

}  // namespace souple::test_collision_collider_mesh
