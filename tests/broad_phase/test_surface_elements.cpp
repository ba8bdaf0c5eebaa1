#include "souple/broad_phase/surface_elements.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_broad_phase_surface_elements {

// Every vertex and edge of a mesh has one owner, and the edges of the elements agree with edges().
TEST(SurfaceElements, EachVertexAndEdgeHasOneOwner) {
  const TriangleMesh mesh = grid(7, 5, 1.0);
  SurfaceElements elements;
  elements.add_triangles(mesh.triangles, 100, 0);
  elements.add_triangles(mesh.triangles, 200, 1);
  std::multiset<std::uint32_t> particles, edges;
  for (const SurfaceElement& element : elements.elements()) {
    ASSERT_EQ(element.corners, 3);
    for (unsigned k = 0; k < 3; ++k) {
      Edge side{element.particle[k], element.particle[(k + 1) % 3]},
          listed = elements.edges()[element.edge[k]];
      std::sort(side.begin(), side.end());
      std::sort(listed.begin(), listed.end());
      EXPECT_EQ(side, listed);
      EXPECT_EQ(elements.edge_objects()[element.edge[k]], element.object);
      if (element.owns_particle >> k & 1) particles.insert(element.particle[k]);
      if (element.owns_edge >> k & 1) edges.insert(element.edge[k]);
    }
  }
  EXPECT_EQ(particles.size(), 70u);
  EXPECT_EQ(std::set<std::uint32_t>(particles.begin(), particles.end()).size(), 70u);
  EXPECT_EQ(edges.size(), elements.edges().size());
  EXPECT_EQ(std::set<std::uint32_t>(edges.begin(), edges.end()).size(), edges.size());
  EXPECT_EQ(elements.vertices().size(), 70u);
  EXPECT_EQ(elements.particle_end(), 235u);
  EXPECT_EQ(elements.object_end(), 2u);
}

TEST(SurfaceElements, RopesAndGrains) {
  SurfaceElements elements;
  const Edge rope[] = {{0, 1}, {1, 2}, {2, 2}};
  elements.add_edges(rope, 10, 3);
  elements.add_particles(20, 25, 4);
  ASSERT_EQ(elements.elements().size(), 7u);
  EXPECT_EQ(elements.elements()[1].corners, 2);
  EXPECT_EQ(elements.elements()[1].particle[2], 12u);
  EXPECT_EQ(elements.elements()[1].owns_particle, 2);
  EXPECT_EQ(elements.elements()[6].corners, 1);
  EXPECT_EQ(elements.elements()[6].particle[1], 24u);
  EXPECT_EQ(elements.edges().size(), 2u);
  EXPECT_EQ(elements.vertices().size(), 8u);
  EXPECT_TRUE(elements.triangles().empty());
  elements.clear();
  EXPECT_TRUE(elements.elements().empty());
  EXPECT_EQ(elements.particle_end(), 0u);
}

TEST(SurfaceElements, ATriangleWithARepeatedCornerIsLeftOut) {
  SurfaceElements elements;
  const Triangle triangles[] = {{0, 1, 1}, {0, 1, 2}};
  elements.add_triangles(triangles, 0, 0);
  EXPECT_EQ(elements.elements().size(), 1u);
  EXPECT_EQ(elements.edges().size(), 3u);
}

}  // namespace souple::test_broad_phase_surface_elements
