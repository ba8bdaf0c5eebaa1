#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/rest_frames.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_geometry_rest_frames {

void expect_orthonormal(const RestFrame& f) {
  EXPECT_NEAR(length(f.warp), 1, 1e-12);
  EXPECT_NEAR(length(f.weft), 1, 1e-12);
  EXPECT_NEAR(dot(f.warp, f.weft), 0, 1e-12);
}

TEST(RestFrames, FollowTheUvsRound) {
  TriangleMesh mesh = grid(6, 5, 1);
  for (const RestFrame& f : rest_frames(mesh)) {
    expect_orthonormal(f);
    EXPECT_NEAR(length(f.warp - Vec3d{1, 0, 0}), 0, 1e-6);
  }
  // The pattern rotated by 30 degrees, and mirrored: warp follows U in space.
  const double c = std::cos(0.5), s = std::sin(0.5);
  for (const float mirror : {1.0f, -1.0f}) {
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
      const Vec3d& p = mesh.positions[v];
      mesh.uvs[v] = {float(c * p.x + s * p.z), mirror * float(-s * p.x + c * p.z)};
    }
    for (const RestFrame& f : rest_frames(mesh)) {
      expect_orthonormal(f);
      EXPECT_NEAR(length(f.warp - Vec3d{c, 0, s}), 0, 1e-6);
      EXPECT_NEAR(length(cross(f.warp, f.weft) - Vec3d{0, 1, 0}), 0, 1e-6);
    }
  }
}

TEST(RestFrames, UvsOfQuadFaces) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2, 3}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uvs = {{9, 9}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.face_uvs = {{1, 2, 3, 4}};  // U grows along +Z
  for (const RestFrame& f : rest_frames(mesh)) EXPECT_NEAR(length(f.warp - Vec3d{0, 0, 1}), 0, 1e-12);
  mesh.face_uvs = {{1, 2, 3}};
  EXPECT_THROW(rest_frames(mesh), Error);
  mesh.face_uvs = {{1, 2, 3, 5}};
  EXPECT_THROW(rest_frames(mesh), Error);
}

TEST(RestFrames, WithoutUvsTheGrainIsOneAllOver) {
  const TriangleMesh ball = sphere(3, 1);
  for (const RestFrame& f : rest_frames(ball)) {
    expect_orthonormal(f);
    EXPECT_GT(f.warp.x, 0);
  }
  // Perpendicular to the fallback: the first edge.
  TriangleMesh wall;
  wall.positions = {{0, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  wall.triangles = {{0, 1, 2}, {0, 1, 1}};
  const auto frames = rest_frames(wall);
  EXPECT_EQ(frames[0].warp, (Vec3d{0, 1, 0}));
  EXPECT_EQ(frames[1].warp, Vec3d{});
  const FlatTriangle flat = flatten(frames[0], wall.positions[0], wall.positions[1], wall.positions[2]);
  EXPECT_EQ(flat.b, (std::array<double, 2>{2, 0}));
  EXPECT_EQ(flat.c, (std::array<double, 2>{0, 3}));
}

}  // namespace souple::test_geometry_rest_frames
