#include "souple/geometry/builders.h"
#include "souple/io/split_mesh.h"

#include <gtest/gtest.h>

namespace souple::test::test_io_split_mesh {

/// A roof of two quads with a seam of UVs at its ridge 1-4, and two materials.
TriangleMesh roof() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {0, 0, 1}, {1, 1, 1}, {2, 0, 1}};
  mesh.faces = {{0, 3, 4, 1}, {1, 4, 5, 2}};
  mesh.triangles = {{0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.face_uvs = {{0, 1, 2, 3}, {0, 1, 2, 3}};
  mesh.appearance.materials = {"red", "blue"};
  mesh.appearance.face_materials = {1, 0};
  mesh.groups["left"] = {0, 1, 3, 4};
  return mesh;
}

TEST(SplitMesh, CopiesVerticesAtSeamsOnly) {
  const TriangleMesh mesh = roof();
  const SplitMesh split = split_mesh(mesh);
  EXPECT_EQ(split.source_vertices, 6u);
  EXPECT_EQ(split.copies, (std::vector<std::uint32_t>{1, 4}));
  ASSERT_EQ(split.parts.size(), 2u);
  EXPECT_EQ(split.parts[0].material, 1u);
  EXPECT_EQ(split.parts[1].material, 0u);
  std::size_t next = 0;
  for (const SplitMesh::Part& part : split.parts) {
    for (const Triangle& t : part.triangles) {
      Triangle source{};
      for (std::size_t i = 0; i < 3; ++i) source[i] = split.source(t[i]);
      EXPECT_EQ(source, mesh.triangles[next]) << next;
      ++next;
    }
  }
  EXPECT_EQ(next, 4u);
  // The corner of the second face at vertex 1 has the UV of its first corner.
  EXPECT_EQ(split.uvs[1], (std::array<float, 2>{1, 0}));
  EXPECT_EQ(split.uvs[6], (std::array<float, 2>{0, 0}));
  const std::vector<Vec3f> spread =
      split.spread(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}});
  EXPECT_EQ(spread.back().x, 4);
}

TEST(SplitMesh, AMeshWithoutSeamsKeepsItsVertices) {
  const TriangleMesh mesh = grid(5, 4, 1);
  const SplitMesh split = split_mesh(mesh);
  EXPECT_TRUE(split.copies.empty());
  ASSERT_EQ(split.parts.size(), 1u);
  EXPECT_EQ(split.parts[0].material, FaceAppearance::no_material);
  EXPECT_EQ(split.parts[0].triangles, mesh.triangles);
}

TEST(SplitMesh, AGroupHoldsTheFacesInsideIt) {
  const TriangleMesh mesh = roof();
  EXPECT_EQ(faces_of_group(mesh, mesh.groups.at("left")), (std::vector<std::uint32_t>{0}));
}

TEST(SplitMesh, SharpEdgesAreNotSmooth) {
  const TriangleMesh ball = sphere(2, 0.5), crate = box({1, 1, 1}, 2);
  EXPECT_TRUE(is_smooth(ball.positions, ball.triangles));
  EXPECT_FALSE(is_smooth(crate.positions, crate.triangles));
}

}  // namespace souple::test::test_io_split_mesh
