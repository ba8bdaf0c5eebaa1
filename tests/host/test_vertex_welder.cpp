#include "souple/geometry/builders.h"
#include "souple/host/vertex_welder.h"
#include "souple/world/world.h"
#include "tests/count_allocations.h"
#include "tests/expect_error.h"
#include "tests/host/triangle_soups.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace souple::host::test_host_vertex_welder {

/// Two by three vertices, four triangles: 12 render vertices from an importer.
const TriangleMesh strip = grid(3, 2, 1.0);

std::vector<Vec3f> floats(const std::vector<Vec3d>& positions) {
  std::vector<Vec3f> result;
  result.reserve(positions.size());
  for (const Vec3d& x : positions) result.emplace_back(x);
  return result;
}

/// A renderer's matrix: scaled by 2 along x, turned by 90 degrees about y, moved.
constexpr float turned[16] = {0, 0, -2, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1};
constexpr float mirrored[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

TEST(VertexWelder, CornersOfOnePlaceAreOneParticle) {
  const Corners corners(strip);
  const VertexWelder weld(corners.soup());
  EXPECT_EQ(weld.vertex_count(), 12u);
  EXPECT_EQ(weld.particle_count(), 6u);
  const TriangleMesh mesh = weld.mesh();
  EXPECT_EQ(mesh.triangles.size(), 4u);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(Vec3f(mesh.positions[weld.particle_of()[v]]), corners.at(v));
}

TEST(VertexWelder, WithATolerance) {
  Corners corners(strip);
  corners.positions[0] += 1e-4f;
  EXPECT_GT(VertexWelder(corners.soup()).particle_count(), 6u);
  EXPECT_EQ(VertexWelder(corners.soup(), 1e-3).particle_count(), 6u);
}

TEST(VertexWelder, PositionsComeBackToEachRenderVertex) {
  Corners corners(strip);
  const std::vector<float> before = corners.positions;
  VertexWelder weld(corners.soup());
  std::vector<Vec3f> particles = floats(weld.mesh().positions);
  weld.write(particles.data(), {}, {corners.positions.data(), nullptr});
  EXPECT_EQ(corners.positions, before);
  for (Vec3f& x : particles) x += Vec3f(0, 1, 0);
  weld.write(particles.data(), {}, {corners.positions.data(), nullptr});
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(corners.positions[i], before[i] + (i % 3 == 1 ? 1.0f : 0.0f));
}

TEST(VertexWelder, AMatrixIsRespectedBothWays) {
  Corners corners(sphere(2, 1));
  const std::vector<float> before = corners.positions;
  for (const float* matrix : {turned, mirrored}) {
    const Placement placement = Placement::of(matrix);
    VertexWelder weld(corners.soup());
    const TriangleMesh mesh = weld.mesh(placement);
    // Wound outward in the world as in the mesh, also when it is mirrored.
    const Triangle& t = mesh.triangles[0];
    const Vec3d a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    EXPECT_GT(dot(cross(b - a, c - a), a - placement.translation()), 0);
    const std::vector<Vec3f> particles = floats(mesh.positions);
    weld.write(particles.data(), placement, {corners.positions.data(), corners.normals.data()});
    for (std::size_t v = 0; v < corners.count(); ++v) {
      EXPECT_NEAR(corners.positions[3 * v], before[3 * v], 2e-6);
      EXPECT_LT(length(corners.normal(v) - normalized(corners.at(v))), 0.1f);  // outward, of length 1
      EXPECT_NEAR(length(corners.normal(v)), 1, 1e-5);
    }
  }
  const Vec3d moved = Placement::of(turned).to_world({1, 2, 3});
  EXPECT_LT(length(moved - Vec3d(8, 8, 5)), 1e-12);
}

/// A box: smooth over its edges, or flat as the corners that the renderer doubled.
TEST(VertexWelder, NormalsAreOfTheSurfaceOrOfTheRenderVertices) {
  Corners corners(box({1, 1, 1}, {1, 1, 1}));
  VertexWelder weld(corners.soup());
  ASSERT_EQ(weld.particle_count(), 8u);
  const std::vector<Vec3f> particles = floats(weld.mesh().positions);
  weld.write(particles.data(), {}, {nullptr, corners.normals.data()}, Normals::per_vertex);
  for (std::size_t v = 0; v < corners.count(); ++v) {
    const Vec3f n = corners.normal(v);
    EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-6);
    EXPECT_GT(dot(n, corners.at(v)), 0.4f);
  }
  weld.write(particles.data(), {}, {nullptr, corners.normals.data()});
  for (std::size_t v = 0; v < corners.count(); ++v) {
    const Vec3f n = corners.normal(v);
    EXPECT_LT(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 0.9f);
    for (std::size_t w = 0; w < v; ++w)
      if (corners.at(v) == corners.at(w)) {
        EXPECT_EQ(n, corners.normal(w));
      }
  }
}

TEST(VertexWelder, BuffersMayBeInterleaved) {
  const Corners corners(strip);
  std::vector<float> interleaved(96, -7);
  for (std::size_t v = 0; v < 12; ++v)
    for (std::size_t k = 0; k < 3; ++k) interleaved[8 * v + k] = corners.positions[3 * v + k];
  const std::vector<float> before = interleaved;
  TriangleSoup soup = corners.soup();
  soup.positions = interleaved.data();
  soup.stride = 8;
  VertexWelder weld(soup);
  EXPECT_EQ(weld.particle_count(), 6u);
  const std::vector<Vec3f> particles = floats(weld.mesh().positions);
  weld.write(particles.data(), {}, {interleaved.data(), interleaved.data() + 3, 8});
  for (std::size_t v = 0; v < 12; ++v) {
    EXPECT_NEAR(std::abs(interleaved[8 * v + 4]), 1, 1e-6);  // the strip lies in XZ
    for (const std::size_t k : {0u, 1u, 2u, 6u, 7u}) EXPECT_EQ(interleaved[8 * v + k], before[8 * v + k]);
  }
}

TEST(VertexWelder, WritingAgainAllocatesNothing) {
  Corners corners(sphere(3, 1));
  VertexWelder weld(corners.soup());
  const std::vector<Vec3f> particles = floats(weld.mesh().positions);
  const VertexBuffers buffers{corners.positions.data(), corners.normals.data()};
  for (const Normals normals : {Normals::per_vertex, Normals::welded})
    weld.write(particles.data(), {}, buffers, normals);
  const long before = test::allocations();
  for (const Normals normals : {Normals::per_vertex, Normals::welded})
    weld.write(particles.data(), {}, buffers, normals);
  EXPECT_EQ(test::allocations(), before);
}

/// Three triangles on one edge, a copy of a triangle, one without area: a World takes them.
TEST(VertexWelder, WhatIsNotManifoldIsLeftToTheWorld) {
  const float x[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 5, 5, 5};
  const std::uint32_t t[] = {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 2, 0, 0, 1};
  const VertexWelder weld({x, 6, t, 5});
  World world;
  const ObjectId cloth = world.add_cloth(weld.mesh());
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_EQ(world.positions(cloth).size(), 6u);
}

TEST(VertexWelder, BadInputIsOneSentence) {
  Corners corners(strip);
  const TriangleSoup good = corners.soup();
  const auto refused = [](const TriangleSoup& soup, std::initializer_list<std::string> words) {
    expect_error([&] { VertexWelder(soup, 0, "flag"); }, words);
  };
  TriangleSoup soup = good;
  soup.triangle_count = 0;
  refused(soup, {"flag", "no triangles"});
  soup = good, soup.indices = nullptr;
  refused(soup, {"flag", "no triangles"});
  soup = good, soup.positions = nullptr;
  refused(soup, {"flag", "no positions"});
  soup = good, soup.stride = 2;
  refused(soup, {"flag", "stride", "2"});
  soup = good, soup.vertex_count = 11;
  refused(soup, {"flag", "triangle 3", "vertex 11", "11"});
  corners.indices[4] = 4000000000u;
  refused(corners.soup(), {"flag", "triangle 1", "4000000000", "12"});
  corners.indices[4] = 4;
  corners.positions[5] = std::numeric_limits<float>::quiet_NaN();
  refused(corners.soup(), {"flag", "vertex 1", "not finite"});
  expect_error([] { VertexWelder(Corners(strip).soup(), -1); }, {"tolerance"});
}

TEST(Placement, RefusesMatricesThatAreNone) {
  const auto refused = [](std::size_t entry, float value, const char* word) {
    float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    matrix[entry] = value;
    expect_error([&] { Placement::of(matrix, "flag: transform"); }, {"flag: transform", word});
  };
  refused(7, std::numeric_limits<float>::infinity(), "entry 7");
  refused(3, 0.5f, "last row");  // or row-major, with its translation there
  refused(15, 2, "last row");
  refused(5, 0, "flat");
}

}  // namespace souple::host::test_host_vertex_welder
