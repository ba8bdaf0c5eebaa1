#include "souple/geometry/builders.h"
#include "souple/host/drawable.h"
#include "souple/host/vertex_welder.h"
#include "souple/world/world.h"
#include "tests/count_allocations.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"
#include "tests/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace souple::host::test_host_drawable {

using Sides = Drawable::Sides;

/// A scene with an object of each kind, some frames after its start.
class DrawableOfAScene : public testing::Test {
 protected:
  DrawableOfAScene() {
    session.open_scene(source_path("scenes/one_room.json"));
    for (int frame = 1; frame <= 10; ++frame) session.advance(frame, 1.0 / 60);
  }

  ObjectInfo object(const std::string& name) const {
    for (ObjectInfo& info : session.objects())
      if (info.name == name) return info;
    throw Error("the scene has no " + name);
  }
  Drawable drawn(const std::string& name, Sides sides = Sides::one) {
    Drawable drawable(session, object(name).handle, sides);
    drawable.update(session);
    return drawable;
  }
  std::vector<float> particles(const std::string& name) {
    const ObjectInfo info = object(name);
    std::vector<float> positions(3 * info.vertex_count);
    session.write(info.handle, {positions.data()}, info.vertex_count);
    return positions;
  }

  Session session;
};

TEST_F(DrawableOfAScene, ASideIsTheObjectsOwnVerticesAndTriangles) {
  for (const char* name : {"flag", "duck", "block"}) {
    const Drawable drawable = drawn(name);
    EXPECT_FALSE(drawable.balls());
    EXPECT_EQ(drawable.positions(), particles(name));
    EXPECT_EQ(drawable.triangles(), session.triangles(object(name).handle));
    EXPECT_EQ(drawable.normals().size(), drawable.positions().size());
    EXPECT_EQ(drawable.vertex_of(3), 3u);
  }
  // Only a cloth has another side.
  EXPECT_EQ(drawn("duck", Sides::two).positions(), drawn("duck").positions());
}

TEST_F(DrawableOfAScene, TheSidesOfAClothLieHalfItsThicknessAwayAndLookAwayFromEachOther) {
  EXPECT_LT(object("flag").radius, 0.001f);  // what is thinner is drawn 2 mm thick
  for (const auto& [name, half] : {std::pair("flag", 0.001f), {"tablecloth", object("tablecloth").radius}}) {
    const Drawable cloth = drawn(name, Sides::two);
    const std::vector<float> middle = particles(name);
    const std::size_t count = middle.size() / 3;
    ASSERT_GE(cloth.vertex_count(), 2 * count);
    for (std::size_t v = 0; v < count; ++v) {
      const Vec3f front = vertex(cloth.positions(), v), back = vertex(cloth.positions(), count + v);
      const Vec3f normal = vertex(cloth.normals(), v);
      EXPECT_NEAR(length(normal), 1, 1e-5f);
      EXPECT_EQ(vertex(cloth.normals(), count + v), -normal);
      EXPECT_NEAR(dot(front - vertex(middle, v), normal), half, 1e-6f);
      EXPECT_NEAR(dot(back - vertex(middle, v), normal), -half, 1e-6f);
      EXPECT_NEAR(length(front - back), 2 * half, 1e-6f);
    }
  }
}

TEST_F(DrawableOfAScene, BothSidesHaveTheTrianglesEachSeenFromItsOwn) {
  const Drawable cloth = drawn("flag", Sides::two);
  const std::vector<std::uint32_t> own = session.triangles(object("flag").handle);
  const std::vector<std::uint32_t>& both = cloth.triangles();
  const auto count = static_cast<std::uint32_t>(object("flag").vertex_count);
  ASSERT_GE(both.size(), 2 * own.size());
  EXPECT_TRUE(std::equal(own.begin(), own.end(), both.begin()));
  for (std::size_t t = 0; t < both.size(); t += 3) {
    const Vec3f a = vertex(cloth.positions(), both[t]), b = vertex(cloth.positions(), both[t + 1]),
                c = vertex(cloth.positions(), both[t + 2]);
    const Vec3f across = cross(b - a, c - a);
    for (std::size_t corner = t; corner < t + 3; ++corner)
      EXPECT_GT(dot(across, vertex(cloth.normals(), both[corner])), 0) << "triangle " << t / 3;
  }
  // The other side's are the same vertices, some way round.
  for (std::size_t t = 0; t < own.size(); t += 3) {
    std::vector<std::uint32_t> one(&own[t], &own[t] + 3), other;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = both[own.size() + t + corner];
      EXPECT_GE(vertex, count);
      other.push_back(cloth.vertex_of(vertex));
    }
    EXPECT_TRUE(std::is_permutation(one.begin(), one.end(), other.begin()));
  }
}

/// Each edge of a triangle has a twin in the opposite direction: the surface is closed.
TEST_F(DrawableOfAScene, ARimClosesTheSides) {
  const Drawable cloth = drawn("flag", Sides::two);
  using Place = std::array<float, 3>;
  std::map<std::pair<Place, Place>, int> open;
  const auto place = [&](std::uint32_t v) {
    const Vec3f x = vertex(cloth.positions(), v);
    return Place{x.x, x.y, x.z};
  };
  const std::vector<std::uint32_t>& triangles = cloth.triangles();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Place from = place(triangles[i]), to = place(triangles[i - i % 3 + (i + 1) % 3]);
    ++open[{from, to}];
    --open[{to, from}];
  }
  for (const auto& [edge, count] : open) ASSERT_EQ(count, 0);
  // Its triangles, too, look to where their normals do, and name the vertices that they are drawn at.
  const std::vector<float> middle = particles("flag");
  for (std::size_t t = 2 * session.triangles(object("flag").handle).size(); t < triangles.size(); t += 3) {
    const Vec3f a = vertex(cloth.positions(), triangles[t]), b = vertex(cloth.positions(), triangles[t + 1]),
                c = vertex(cloth.positions(), triangles[t + 2]),
                normal = vertex(cloth.normals(), triangles[t]);
    EXPECT_GT(dot(cross(b - a, c - a), normal), 0);
    for (std::size_t corner = t; corner < t + 3; ++corner) {
      const std::uint32_t v = triangles[corner];
      EXPECT_NEAR(length(vertex(cloth.positions(), v) - vertex(middle, cloth.vertex_of(v))), 0.001f, 1e-5f);
    }
  }
}

TEST_F(DrawableOfAScene, GrainsAreTheirParticles) {
  const Drawable grains = drawn("sand", Sides::two);
  EXPECT_TRUE(grains.balls());
  EXPECT_EQ(grains.radius(), object("sand").radius);
  EXPECT_EQ(grains.positions(), particles("sand"));
  EXPECT_TRUE(grains.normals().empty());
  EXPECT_EQ(grains.vertex_of(5), 5u);
}

TEST_F(DrawableOfAScene, TheBallsOfARopeLeaveNoGap) {
  const Drawable rope = drawn("line");
  const std::vector<float> particles_now = particles("line");
  const std::vector<std::uint32_t> segments = session.segments(object("line").handle);
  ASSERT_TRUE(rope.balls());
  ASSERT_GT(rope.vertex_count(), particles_now.size() / 3);  // its particles are further apart
  // It ends at its ends, and each ball lies on a segment, at the vertex that is named or beside it.
  EXPECT_EQ(vertex(rope.positions(), 0), vertex(particles_now, segments.front()));
  EXPECT_EQ(rope.vertex_of(0), segments.front());
  std::vector<std::vector<float>> along(segments.size() / 2, {0, 1});
  for (std::uint32_t ball = 0; ball < rope.vertex_count(); ++ball) {
    const Vec3f x = vertex(rope.positions(), ball);
    float off = 1;
    for (std::size_t s = 0; s < along.size(); ++s) {
      const std::uint32_t a = segments[2 * s], b = segments[2 * s + 1];
      const Vec3f from = vertex(particles_now, a), way = vertex(particles_now, b) - from;
      const float t = std::clamp(dot(x - from, way) / dot(way, way), 0.0f, 1.0f);
      const float distance = length(x - from - t * way);
      off = std::min(off, distance);
      if (distance > 1e-5f) continue;
      along[s].push_back(t);
      const bool at_a = t < 0.499f && t > 1e-3f, at_b = t > 0.501f && t < 1 - 1e-3f;
      if (at_a || at_b) {
        EXPECT_EQ(rope.vertex_of(ball), at_a ? a : b) << t;
      }
    }
    EXPECT_LT(off, 1e-5f) << "ball " << ball;
  }
  for (std::size_t s = 0; s < along.size(); ++s) {
    const float way =
        length(vertex(particles_now, segments[2 * s]) - vertex(particles_now, segments[2 * s + 1]));
    std::sort(along[s].begin(), along[s].end());
    for (std::size_t i = 1; i < along[s].size(); ++i)
      EXPECT_LT((along[s][i] - along[s][i - 1]) * way, 1.05f * rope.radius()) << "segment " << s;
  }
}

TEST_F(DrawableOfAScene, ItIsWhereTheObjectIsWhenItIsUpdated) {
  Drawable sand = drawn("sand"), rope = drawn("line"), cloth = drawn("flag");
  const std::vector<float> before = sand.positions(), rope_before = rope.positions();
  for (int frame = 11; frame <= 15; ++frame) session.advance(frame, 1.0 / 60);
  EXPECT_EQ(sand.positions(), before);
  for (Drawable* drawable : {&sand, &rope, &cloth}) drawable->update(session);
  EXPECT_NE(sand.positions(), before);
  EXPECT_NE(rope.positions(), rope_before);
  EXPECT_EQ(cloth.positions(), particles("flag"));
}

TEST(Drawable, AMeshOfTheHostKeepsItsVertices) {
  const Corners sheet(grid(3, 3, 1.0));
  Session session;
  const Handle cloth = session.add_cloth(sheet.soup());
  Drawable drawable(session, cloth, Sides::two);  // the host draws its own mesh
  drawable.update(session);
  EXPECT_EQ(drawable.positions(), sheet.positions);
  EXPECT_EQ(drawable.triangles(), sheet.indices);
}

TEST(Drawable, AnObjectThatIsGoneIsSaidInWords) {
  const Corners sheet(grid(3, 3, 1.0));
  Session session;
  const Handle cloth = session.add_cloth(sheet.soup());
  Drawable drawable(session, cloth);
  session.remove(cloth);
  expect_error([&] { drawable.update(session); }, {"\"cloth\" (object 1) is no longer there"});
  expect_error([&] { Drawable(session, cloth); }, {"\"cloth\" (object 1) is no longer there"});
  expect_error([&] { Drawable(session, 9); }, {"no object 9"});
}

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

}  // namespace souple::host::test_host_drawable
