#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <cmath>

#include <gtest/gtest.h>

namespace souple::host::test_host_session_drawing {

TEST(Session, AnObstacleThatTheHostMovesCarriesWhatLiesOnIt) {
  const Corners sheet(grid(9, 9, 0.5)), block(box({2, 0.2, 2}, {4, 1, 4}));
  const At above(0, 0.12f, 0);
  Player host;
  Session& s = host.session;
  const Handle table = s.add_obstacle(block.soup());
  MeshOptions options;
  options.transform = above;
  const Handle cloth = s.add_cloth(sheet.soup(), options);
  host.play(30);
  float moved[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  for (int i = 1; i <= 60; ++i) {
    moved[13] = 0.01f * static_cast<float>(i);  // 60 cm upwards in a second
    s.set_transform(table, moved);
    host.play(1);
  }
  const std::vector<float> x = drawn(s, cloth), y = drawn(s, table);
  for (std::size_t v = 0; v < sheet.count(); ++v) EXPECT_NEAR(x[3 * v + 1] + 0.12f, 0.7, 0.02);
  EXPECT_EQ(y, block.positions);  // the host's own mesh stays as it is
  // A reset begins where the host has it now.
  s.reset();
  host.play(30);
  EXPECT_LT(drawn(s, cloth)[1] + 0.12f, 0.2f);
  moved[13] = -0.3f;
  s.set_transform(table, moved);
  s.reset();
  host.play(60);
  for (std::size_t v = 0; v < sheet.count(); ++v) EXPECT_NEAR(drawn(s, cloth)[3 * v + 1] + 0.12f, -0.2, 0.02);
  for (int i = 1; i <= 30; ++i) {  // and goes on from there
    moved[13] += 0.01f;
    s.set_transform(table, moved);
    host.play(1);
  }
  for (std::size_t v = 0; v < sheet.count(); ++v) EXPECT_NEAR(drawn(s, cloth)[3 * v + 1] + 0.12f, 0.1, 0.02);
  moved[0] = 2;
  expect_error([&] { s.set_transform(table, moved); }, {"obstacle", "scaled"});
}

TEST(Session, AMeshThatTheHostMovesIsDrawnWhereItsParticlesAre) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const float aside[16] = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 3, 0, 0, 1};
  const std::uint64_t version = s.version();
  s.set_transform(cloth, aside);
  EXPECT_NE(s.version(), version);
  const std::vector<float> x = drawn(s, cloth);
  const Placement placement = Placement::of(aside);
  for (std::size_t v = 0; v < sheet.count(); ++v) {
    const Vec3d world = placement.to_world({x[3 * v], x[3 * v + 1], x[3 * v + 2]});
    EXPECT_LT(length(world - Vec3d(sheet.at(v))), 1e-6);
  }
  s.reset();  // begins where the host has it
  const std::vector<float> y = drawn(s, cloth);
  for (std::size_t v = 0; v < sheet.count(); ++v) EXPECT_LT(length(vertex(y, v) - sheet.at(v)), 1e-6f);
}

/// The host's own triangles, also where the world would have others; of a scene's objects those of its mesh.
TEST(Session, TrianglesAreOverTheVerticesThatAreWritten) {
  const Corners sheet(grid(5, 5, 1.0));
  Session s;
  s.open_scene(scenes + "one_room.json");
  EXPECT_EQ(s.triangles(s.add_cloth(sheet.soup())), sheet.indices);
  for (const ObjectInfo& info : s.objects()) {
    const std::vector<std::uint32_t> triangles = s.triangles(info.handle);
    EXPECT_EQ(triangles.size(), 3 * info.triangle_count) << info.name;
    EXPECT_EQ(triangles.empty(), info.kind == Kind::rope || info.kind == Kind::grains) << info.name;
    for (const std::uint32_t v : triangles) ASSERT_LT(v, info.vertex_count) << info.name;
  }
}

TEST(Session, ObjectsOfASceneAreWrittenIntoInterleavedBuffersToo) {
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "flag.json");
  host.play(2);
  const ObjectInfo flag = s.objects()[0];
  const std::vector<float> positions = drawn(s, flag.handle);
  std::vector<float> buffer(8 * flag.vertex_count, -7);
  s.write(flag.handle, {buffer.data(), buffer.data() + 3, 8}, flag.vertex_count);
  for (std::size_t v = 0; v < flag.vertex_count; ++v) {
    const float* at = &buffer[8 * v];
    EXPECT_EQ(Vec3f(at[0], at[1], at[2]), vertex(positions, v));
    EXPECT_NEAR(length(Vec3f(at[3], at[4], at[5])), 1, 1e-5);
    EXPECT_EQ(at[6], -7);
    EXPECT_EQ(at[7], -7);
  }
  expect_error(
      [&] {
        s.write(flag.handle, {buffer.data(), nullptr, 2}, flag.vertex_count);
      },
      {"flag", "stride"});
  expect_error([&] { s.write(flag.handle, {buffer.data(), nullptr}, 1); }, {"flag", "1", "792"});
}

TEST(Session, GrainsAreDrawnAsBallsWithTheirRadius) {
  Player host;
  host.session.open_scene(scenes + "sand_pile.json");
  bool grains = false;
  for (const ObjectInfo& info : host.session.objects()) {
    if (info.kind != Kind::grains) continue;
    grains = true;
    EXPECT_GT(info.radius, 0);
    EXPECT_GT(info.vertex_count, 100u);
    EXPECT_EQ(info.triangle_count, 0u);
    EXPECT_TRUE(info.from_scene);
    for (const float x : drawn(host.session, info.handle)) EXPECT_TRUE(std::isfinite(x));
  }
  EXPECT_TRUE(grains);
}

/// As the file has them: "#b8324a" is 0xb8 of red.
TEST(Session, ColorsAreThoseOfTheSceneFile) {
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "one_room.json");
  const std::array<float, 3> crimson{184 / 255.0f, 50 / 255.0f, 74 / 255.0f};
  const std::array<float, 3> wood{169 / 255.0f, 133 / 255.0f, 95 / 255.0f};
  std::size_t colored = 0;
  for (const ObjectInfo& info : s.objects()) {
    EXPECT_EQ(info.has_color, info.kind == Kind::cloth || info.kind == Kind::soft_body) << info.name;
    if (info.name == "flag") {
      EXPECT_EQ(info.color, crimson);
      ++colored;
    }
  }
  for (const ColliderShape& shape : s.colliders()) {
    EXPECT_EQ(shape.has_color, shape.name == "table") << shape.name;
    if (shape.name == "table") {
      EXPECT_EQ(shape.color, wood);
      ++colored;
    }
  }
  EXPECT_EQ(colored, 2u);
  EXPECT_FALSE(s.object(s.add_cloth(Corners(grid(3, 3, 1.0)).soup())).has_color);
}

TEST(Session, SegmentsLeadAlongARopeFromEndToEnd) {
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "rope_bridge.json");
  host.play(5);
  std::size_t ropes = 0;
  for (const ObjectInfo& info : s.objects()) {
    const std::vector<std::uint32_t> segments = s.segments(info.handle);
    if (info.kind != Kind::rope) {
      EXPECT_TRUE(segments.empty()) << info.name;
      continue;
    }
    ++ropes;
    EXPECT_EQ(info.vertex_count, 41u);
    ASSERT_EQ(segments.size(), 2 * 40u);
    const std::vector<float> x = drawn(s, info.handle);
    for (std::size_t i = 0; i < 40; ++i) {
      EXPECT_EQ(segments[2 * i], i);
      ASSERT_EQ(segments[2 * i + 1], i + 1);
      EXPECT_NEAR(length(vertex(x, i + 1) - vertex(x, i)), 0.102, 0.01);
    }
  }
  EXPECT_EQ(ropes, 2u);
}

/// Also those that move.
TEST(Session, CollidersAreDrawnWhereTheyAre) {
  Player host;
  host.session.open_scene(scenes + "one_room.json");
  World world = build_world(load_scene(scenes + "one_room.json"));
  const std::vector<ColliderShape> shapes = host.session.colliders(3);
  ASSERT_EQ(shapes.size(), world.colliders().size());
  ASSERT_FALSE(shapes.empty());
  for (int i = 0; i < 10; ++i) world.step(dt);
  host.play(10);
  const auto matrices = host.session.collider_transforms();
  ASSERT_EQ(matrices.size(), shapes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ColliderId id = world.colliders()[i];
    const ColliderShape& shape = shapes[i];
    EXPECT_EQ(shape.name, world.collider_options(id).name);
    ASSERT_EQ(shape.positions.size(), shape.normals.size());
    ASSERT_FALSE(shape.indices.empty());
    const Placement placement = Placement::of(matrices[i].data());
    for (std::size_t v = 0; v < shape.positions.size(); v += 3) {
      const Vec3d local(shape.positions[v], shape.positions[v + 1], shape.positions[v + 2]);
      EXPECT_LT(length(placement.to_world(local) - world.collider_pose(id).point(local)), 1e-5);
    }
  }
  expect_error([&] { host.session.colliders(0); }, {"extent"});
}

}  // namespace souple::host::test_host_session_drawing
