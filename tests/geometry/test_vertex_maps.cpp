#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/vertex_maps.h"

#include <limits>

#include <gtest/gtest.h>

namespace souple::test_geometry_vertex_maps {

TEST(VertexMaps, FromGroups) {
  TriangleMesh mesh = grid(3, 2, 1);
  mesh.groups = {{"collar", {0, 2}}, {"sleeve", {2, 3}}};
  EXPECT_EQ(map_from_group(mesh, "collar"), (std::vector<float>{1, 0, 1, 0, 0, 0}));
  EXPECT_EQ(map_from_groups(mesh, {{"collar", 2.0f}, {"sleeve", 3.0f}}, 0.5f),
            (std::vector<float>{2, 0.5f, 3, 3, 0.5f, 0.5f}));
  try {
    map_from_group(mesh, "coller");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "the mesh has no group 'coller'; its groups are: collar, sleeve");
  }
  mesh.groups["sleeve"].push_back(6);
  EXPECT_THROW(map_from_group(mesh, "sleeve"), Error);
}

TEST(VertexMaps, FromColors) {
  TriangleMesh mesh = grid(2, 2, 1);
  EXPECT_THROW(map_from_colors(mesh, ColorChannel::red), Error);
  mesh.colors = {{0, 0.25f, 1}, {1, 0.5f, 0}, {2, -1, 0.5f}, {0, 0, 0}};
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::red), (std::vector<float>{0, 1, 1, 0}));
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::green, 2, 4), (std::vector<float>{2.5f, 3, 2, 2}));
  EXPECT_EQ(map_from_colors(mesh, ColorChannel::blue, 1, 0), (std::vector<float>{0, 1, 0.5f, 1}));
  mesh.colors[3].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(map_from_colors(mesh, ColorChannel::red), Error);
}

}  // namespace souple::test_geometry_vertex_maps
