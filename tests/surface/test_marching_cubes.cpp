#include "souple/surface/marching_cubes.h"

#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace souple::test_surface_marching_cubes {

using Side = std::pair<unsigned, unsigned>;

/// The two nodes of an edge of the cube, in the numbering of CubeCase.
std::pair<unsigned, unsigned> nodes_of(unsigned edge) {
  const unsigned axis = edge / 4, start = (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
  return {start, start | 1u << axis};
}

/// Outer sides of a case's polygons, without diagonals: lines on the faces of the cube.
std::set<Side> outline(const CubeCase& found) {
  std::set<Side> sides;
  for (std::size_t t = 0; t < found.triangle_count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Side side{found.triangles[t][k], found.triangles[t][(k + 1) % 3]};
      EXPECT_TRUE(sides.insert(side).second);
    }
  }
  std::set<Side> open;
  for (const Side& side : sides)
    if (!sides.contains({side.second, side.first})) open.insert(side);
  return open;
}

bool share_face(const Side& side) {
  const auto [a, b] = nodes_of(side.first);
  const auto [c, d] = nodes_of(side.second);
  for (unsigned axis = 0; axis < 3; ++axis)
    if (((a ^ b) >> axis & 1) == 0 && ((c ^ d) >> axis & 1) == 0 && (a >> axis & 1) == (c >> axis & 1))
      return true;
  return false;
}

TEST(MarchingCubes, CutsEachEdgeWhereSidesDifferOnceInEveryCase) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    const CubeCase& found = cube_cases()[inside];
    std::set<unsigned> used;
    for (std::size_t t = 0; t < found.triangle_count; ++t)
      used.insert(found.triangles[t].begin(), found.triangles[t].end());
    for (unsigned edge = 0; edge < 12; ++edge) {
      const auto [a, b] = nodes_of(edge);
      EXPECT_EQ(used.contains(edge), (inside >> a & 1) != (inside >> b & 1)) << inside << " " << edge;
    }
    std::map<unsigned, int> begins;
    for (const Side& side : outline(found)) {
      EXPECT_TRUE(share_face(side)) << inside;  // the outline lies on the cube's faces
      ++begins[side.first];
    }
    for (const auto& [edge, count] : begins) EXPECT_EQ(count, 1) << inside;
    EXPECT_EQ(begins.size(), used.size());
  }
}

// Two neighboring cubes with the same four shared nodes have the same lines on their face, in opposite
// directions.
TEST(MarchingCubes, NeighborsDrawTheSameLinesOnTheirFace) {
  const auto on_face = [](unsigned inside, unsigned axis, unsigned side) {
    std::set<Side> lines;
    for (const Side& line : outline(cube_cases()[inside])) {
      const auto [a, b] = nodes_of(line.first);
      const auto [c, d] = nodes_of(line.second);
      const bool here = (a >> axis & 1) == side && (b >> axis & 1) == side && (c >> axis & 1) == side &&
                        (d >> axis & 1) == side;
      if (!here) continue;
      // Numbered as in the other cube: 4 axis + bits without this axis.
      const auto number = [&](unsigned p, unsigned q) {
        return (p & ~(1u << axis)) * 8 + (q & ~(1u << axis));
      };
      lines.insert({number(a, b), number(c, d)});
    }
    return lines;
  };
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (unsigned left = 0; left < 256; ++left) {
      for (unsigned right = 0; right < 256; ++right) {
        bool agree = true;
        for (unsigned node = 0; node < 8; ++node)
          if ((node >> axis & 1) == 0 && (right >> node & 1) != (left >> (node | 1u << axis) & 1))
            agree = false;
        if (!agree) continue;
        std::set<Side> turned;
        for (const Side& line : on_face(right, axis, 0)) turned.insert({line.second, line.first});
        ASSERT_EQ(on_face(left, axis, 1), turned) << left << " " << right;
      }
    }
  }
}

// A diagonal within a face could occur in both of its cubes, as a side of four triangles.
TEST(MarchingCubes, NoDiagonalLiesInAFace) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    const CubeCase& found = cube_cases()[inside];
    const std::set<Side> lines = outline(found);
    for (std::size_t t = 0; t < found.triangle_count; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Side side{found.triangles[t][k], found.triangles[t][(k + 1) % 3]};
        EXPECT_NE(lines.contains(side), !share_face(side)) << inside;
      }
    }
  }
}

}  // namespace souple::test_surface_marching_cubes
