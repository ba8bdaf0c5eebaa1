#include "tests/radium/radium.h"

#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <cstdint>

namespace souple::radium::test_radium_render_mesh {

using Indices = std::vector<std::uint32_t>;

TEST_F(Radium, ReadsTrianglesAndPoints) {
  const RenderMesh read =
      mesh(show("two", {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {5, 0, 3}}, {{0, 1, 2}, {2, 1, 3}}}));
  ASSERT_TRUE(read.alive());
  EXPECT_EQ(read.name(), "two mesh");
  EXPECT_EQ(&read.entity(), engine->getEntityManager()->getEntity("two"));
  EXPECT_EQ(read.vertex_count(), 4u);
  EXPECT_EQ(read.positions(), (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 2, 0, 5, 0, 3}));
  EXPECT_EQ(read.normals(), (std::vector<float>{0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}));
  EXPECT_EQ(read.triangles(), (Indices{0, 1, 2, 2, 1, 3}));
  const RenderMesh points = mesh(show_points("points", {{0, 0, 0}, {1, 2, 3}}));
  EXPECT_TRUE(points.alive());
  EXPECT_EQ(points.positions(), (std::vector<float>{0, 0, 0, 1, 2, 3}));
  EXPECT_EQ(points.triangle_count(), 0u);
}

TEST_F(Radium, CutsQuadsAndPolygonsAsTheyAreDrawn) {
  const std::vector<Vector3> ring = {{0, 0, 0}, {2, 0, 0}, {3, 0, 2}, {1, 0, 3}, {-1, 0, 2}, {5, 0, 5}};
  EXPECT_EQ(mesh(show_quads("quads", ring, {{3, 2, 1, 0}, {0, 1, 5, 4}})).triangles(),
            (Indices{3, 2, 1, 3, 1, 0, 0, 1, 5, 0, 5, 4}));
  EXPECT_EQ(mesh(show_polygons("polygons", ring, {{0, 1, 2}, {0, 1, 2, 3, 4}, {0, 1, 2, 5}})).triangles(),
            (Indices{0, 1, 2, 4, 0, 3, 0, 1, 3, 3, 1, 2, 0, 1, 5, 5, 1, 2}));
}

TEST_F(Radium, AMeshsTransformIsItsEntitysAfterItsOwn) {
  Transform turned = Transform::Identity(), shifted = Transform::Identity();
  turned.rotate(Ra::Core::AngleAxis(0.5f, Vector3::UnitY())).scale(3.0f);
  shifted.translate(Vector3(1, 2, 3));
  const Index index = show("box", box({1, 1, 1}), turned);
  engine->getRenderObjectManager()->getRenderObject(index)->setLocalTransform(shifted);
  const Ra::Core::Matrix4 expected = (turned * shifted).matrix();
  const std::array<float, 16> read = mesh(index).transform();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      EXPECT_NEAR(read[static_cast<std::size_t>(4 * column + row)], expected(row, column), 1e-6f);
}

TEST_F(Radium, WrittenVerticesTakeTheBoundingBoxAlong) {
  const Index index = show("sheet", sheet(1, 2));
  EXPECT_FLOAT_EQ(bounding_box(index).max().x(), 1);
  RenderMesh written = mesh(index);
  std::vector<float> positions = written.positions();
  positions[0] = -7;
  positions[16] = 9;
  written.set_vertices(positions, std::vector<float>(positions.size(), 0.5f));
  EXPECT_EQ(written.positions(), positions);
  EXPECT_EQ(written.normals()[4], 0.5f);
  EXPECT_FLOAT_EQ(bounding_box(index).min().x(), -7);
  EXPECT_FLOAT_EQ(bounding_box(index).max().y(), 9);
}

TEST_F(Radium, AMeshThatWasDeletedIsNotAlive) {
  const Index index = show("sheet", sheet(1, 2));
  const RenderMesh read = mesh(index);
  EXPECT_TRUE(read.alive());
  const auto held =
      engine->getRenderObjectManager()->getRenderObject(index);  // as a renderer's last frame does
  component(index).removeRenderObject(index);
  EXPECT_FALSE(read.alive());
  EXPECT_FALSE(mesh(index).alive());
  EXPECT_FALSE(mesh(Index()).alive());
  const Index other = show("other", sheet(1, 2));
  EXPECT_EQ(other.getValue(), index.getValue());  // Radium uses numbers again
  EXPECT_FALSE(read.alive());
}

TEST_F(Radium, AnObjectWhoseMeshWasReplacedLeavesTheWorld) {
  const Index index = show("sheet", sheet(1, 2));
  const host::Handle cloth = system->add(index, host::Kind::cloth);
  system->play();
  frames(2);
  const RenderMesh before = mesh(index);
  mesh(index).set_vertices(std::vector<float>(9, 0.5f), {});
  EXPECT_FALSE(before.alive());
  frames(2);
  EXPECT_FALSE(session().contains(cloth));
  EXPECT_NE(words().find("sheet mesh"), std::string::npos);
  EXPECT_EQ(mesh(index).vertex_count(), 3u);
}

}  // namespace souple::radium::test_radium_render_mesh
