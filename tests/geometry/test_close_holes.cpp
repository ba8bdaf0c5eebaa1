#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/close_holes.h"
#include "souple/geometry/lattice.h"
#include "souple/geometry/measures.h"
#include "souple/geometry/mesh_report.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_geometry_close_holes {

/// A ball without its triangles above a height.
TriangleMesh open_ball(double height) {
  TriangleMesh ball = sphere(4, 1);
  std::erase_if(ball.triangles, [&](const Triangle& t) {
    return (ball.positions[t[0]].y + ball.positions[t[1]].y + ball.positions[t[2]].y) / 3 > height;
  });
  return ball;
}

TEST(Holes, AreFoundWhereTheyAre) {
  const TriangleMesh ball = open_ball(0.8);
  const std::vector<Hole> holes = find_holes(ball.positions, ball.triangles);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_NEAR(length(holes[0].center - Vec3d{0, 0.8, 0}), 0, 0.05);
  EXPECT_NEAR(holes[0].width, 1.2, 0.12);
  EXPECT_NEAR(holes[0].area, std::acos(-1.0) * 0.36, 0.2);
  EXPECT_TRUE(find_holes(sphere(3, 1).positions, sphere(3, 1).triangles).empty());
}

// Volume of a unit ball below y = h: pi (2/3 + h - h^3 / 3).
TEST(Holes, ClosedTheyBoundTheVolume) {
  TriangleMesh ball = open_ball(0.8);
  close_holes(find_holes(ball.positions, ball.triangles), ball.positions, ball.triangles);
  const MeshReport report = inspect(ball, 0);
  EXPECT_TRUE(report.is_closed);
  EXPECT_TRUE(report.inconsistent_edges.empty());
  const double expected = std::acos(-1.0) * (2.0 / 3 + 0.8 - 0.8 * 0.8 * 0.8 / 3);
  EXPECT_NEAR(report.signed_volume, expected, 0.03 * expected);
}

// Two holes that touch at a vertex are two loops.
TEST(Holes, ThatShareAVertexAreTwo) {
  TriangleMesh sheet = grid(6, 6, 1);
  const std::uint32_t middle = 2 * 6 + 2;
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    Vec3d c{};
    for (const std::uint32_t v : t) c += sheet.positions[v] / 3;
    const Vec3d d = c - sheet.positions[middle];
    return std::abs(d.x) < 0.2 && std::abs(d.z) < 0.2 && d.x * d.z > 0;
  });
  const std::vector<Hole> holes = find_holes(sheet.positions, sheet.triangles);
  EXPECT_EQ(holes.size(), 3u);  // and the rim of the sheet
  for (const Hole& hole : holes) EXPECT_GE(hole.loop.size(), 4u);
}

TEST(Lattice, FillsASurfaceWithSmallHoles) {
  // 0.13 of a ball's area, and turned inside out: open pieces have no outside until they are closed.
  TriangleMesh ball = open_ball(0.8);
  for (Triangle& t : ball.triangles) std::swap(t[1], t[2]);
  const Lattice lattice = build_lattice(ball, {.cell_size = 0.2}, "head");
  const double expected = std::acos(-1.0) * (2.0 / 3 + 0.8 - 0.8 * 0.8 * 0.8 / 3);
  EXPECT_NEAR(lattice.surface_volume, expected, 0.03 * expected);
  ASSERT_EQ(lattice.sentences.size(), 1u);
  EXPECT_EQ(lattice.sentences[0].find("Closed 1 hole (1."), 0u) << lattice.sentences[0];
  // The tets reach no further through the hole than through the surface.
  for (const Vec3d& x : lattice.mesh.positions) EXPECT_LT(x.y, 0.8 + 0.25);
  EXPECT_GT(lattice.inner, 0u);
}

TEST(Lattice, NamesTheHolesOfABowlAndWhatClosesThem) {
  try {
    build_lattice(open_ball(0), {.cell_size = 0.2}, "bowl");
    FAIL() << "a bowl is no solid";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("1 hole ("), std::string::npos) << text;
    EXPECT_NE(text.find("m wide at ("), std::string::npos) << text;
    EXPECT_NE(text.find("Remesh"), std::string::npos) << text;
  }
}

}  // namespace souple::test_geometry_close_holes
