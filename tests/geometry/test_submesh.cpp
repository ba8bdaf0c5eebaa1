#include "souple/geometry/submesh.h"

#include <gtest/gtest.h>

namespace souple::test_geometry_submesh {

/// A quad and a triangle beside it, and a vertex of no face.
TriangleMesh quad_and_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}};
  mesh.triangles = {{1, 2, 3}, {1, 3, 4}, {2, 5, 3}};
  mesh.faces = {{1, 2, 3, 4}, {2, 5, 3}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 0.5f}};
  mesh.face_uvs = {{0, 1, 2, 3}, {1, 4, 2}};
  mesh.colors = std::vector<Vec3f>(6, {1, 1, 1});
  mesh.groups = {{"loose", {0}}, {"right", {2, 3, 5}}};
  mesh.appearance.materials = {"red", "blue"};
  mesh.appearance.face_materials = {0, 1};
  mesh.appearance.smoothing = {1, 0};
  mesh.appearance.normals = {{0, 0, 1}, {0, 1, 0}};
  mesh.appearance.face_normals = {{0, 0, 0, 0}, {1, 1, 1}};
  return mesh;
}

TEST(Submesh, KeepsTheFacesWhollyOnItsVertices) {
  const TriangleMesh part = submesh(quad_and_triangle(), std::vector<std::uint32_t>{2, 3, 5});
  EXPECT_EQ(part.positions, (std::vector<Vec3d>{{1, 0, 0}, {1, 1, 0}, {2, 0, 0}}));
  EXPECT_EQ(part.triangles, (std::vector<Triangle>{{0, 2, 1}}));
  EXPECT_EQ(part.faces, (std::vector<std::vector<std::uint32_t>>{{0, 2, 1}}));
  EXPECT_EQ(part.uvs, (std::vector<std::array<float, 2>>{{1, 0}, {1, 1}, {0.5f, 0.5f}}));
  EXPECT_EQ(part.face_uvs, (std::vector<std::vector<std::uint32_t>>{{0, 2, 1}}));
  EXPECT_EQ(part.colors.size(), 3u);
  EXPECT_EQ(part.groups, (std::map<std::string, std::vector<std::uint32_t>>{{"right", {0, 1, 2}}}));
  EXPECT_EQ(part.appearance.face_materials, std::vector<std::uint32_t>{1});
  EXPECT_EQ(part.appearance.smoothing, std::vector<std::uint32_t>{0});
  EXPECT_EQ(part.appearance.normals, (std::vector<Vec3f>{{0, 1, 0}}));
  EXPECT_EQ(part.appearance.face_normals, (std::vector<std::vector<std::uint32_t>>{{0, 0, 0}}));
}

TEST(Submesh, OnAllVerticesIsTheMesh) {
  const TriangleMesh mesh = quad_and_triangle();
  const TriangleMesh whole = submesh(mesh, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  EXPECT_EQ(whole.positions, mesh.positions);
  EXPECT_EQ(whole.triangles, mesh.triangles);
  EXPECT_EQ(whole.uvs, mesh.uvs);
  EXPECT_EQ(whole.face_uvs, mesh.face_uvs);
  EXPECT_EQ(whole.groups, mesh.groups);
  EXPECT_EQ(whole.appearance, mesh.appearance);
}

}  // namespace souple::test_geometry_submesh
