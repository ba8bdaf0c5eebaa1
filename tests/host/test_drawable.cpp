#include "souple/geometry/builders.h"
#include "souple/host/drawable.h"
#include "tests/expect_error.h"
#include "tests/host/triangle_soups.h"
#include "tests/paths.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace souple::host::test_host_drawable {

using Sides = Drawable::Sides;

Vec3f at(const std::vector<float>& values, std::size_t v) {
  return {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
}

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
      const Vec3f front = at(cloth.positions(), v), back = at(cloth.positions(), count + v);
      const Vec3f normal = at(cloth.normals(), v);
      EXPECT_NEAR(length(normal), 1, 1e-5f);
      EXPECT_EQ(at(cloth.normals(), count + v), -normal);
      EXPECT_NEAR(dot(front - at(middle, v), normal), half, 1e-6f);
      EXPECT_NEAR(dot(back - at(middle, v), normal), -half, 1e-6f);
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
    const Vec3f a = at(cloth.positions(), both[t]), b = at(cloth.positions(), both[t + 1]),
                c = at(cloth.positions(), both[t + 2]);
    const Vec3f across = cross(b - a, c - a);
    for (std::size_t corner = t; corner < t + 3; ++corner)
      EXPECT_GT(dot(across, at(cloth.normals(), both[corner])), 0) << "triangle " << t / 3;
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
    const Vec3f x = at(cloth.positions(), v);
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
    const Vec3f a = at(cloth.positions(), triangles[t]), b = at(cloth.positions(), triangles[t + 1]),
                c = at(cloth.positions(), triangles[t + 2]), normal = at(cloth.normals(), triangles[t]);
    EXPECT_GT(dot(cross(b - a, c - a), normal), 0);
    for (std::size_t corner = t; corner < t + 3; ++corner) {
      const std::uint32_t v = triangles[corner];
      EXPECT_NEAR(length(at(cloth.positions(), v) - at(middle, cloth.vertex_of(v))), 0.001f, 1e-5f);
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
  EXPECT_EQ(at(rope.positions(), 0), at(particles_now, segments.front()));
  EXPECT_EQ(rope.vertex_of(0), segments.front());
  std::vector<std::vector<float>> along(segments.size() / 2, {0, 1});
  for (std::uint32_t ball = 0; ball < rope.vertex_count(); ++ball) {
    const Vec3f x = at(rope.positions(), ball);
    float off = 1;
    for (std::size_t s = 0; s < along.size(); ++s) {
      const std::uint32_t a = segments[2 * s], b = segments[2 * s + 1];
      const Vec3f from = at(particles_now, a), way = at(particles_now, b) - from;
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
    const float way = length(at(particles_now, segments[2 * s]) - at(particles_now, segments[2 * s + 1]));
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

}  // namespace souple::host::test_host_drawable
