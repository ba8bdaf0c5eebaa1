#include "souple/geometry/builders.h"
#include "souple/host/session/drive.h"
#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::host::test_host_session_objects {

TEST_F(HostedSession, AnObstacleThatTheHostMovesCarriesWhatLiesOnIt) {
  const Corners sheet(grid(9, 9, 0.5)), block(box({2, 0.2, 2}, {4, 1, 4}));
  const Handle table = s.add_obstacle(block.soup());
  const Handle cloth = s.add_cloth(sheet.soup(), Placed(0, 0.12f, 0));
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

TEST_F(SmallCloth, AMeshThatTheHostMovesIsDrawnWhereItsParticlesAre) {
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

TEST_F(HostedSession, ObjectsOfASceneAreWrittenIntoInterleavedBuffersToo) {
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
TEST_F(HostedSession, ColorsAreThoseOfTheSceneFile) {
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

TEST_F(HostedSession, SegmentsLeadAlongARopeFromEndToEnd) {
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

TEST_F(LargeCloth, AVertexIsDraggedAlongThePlaneAcrossTheView) {
  s.set_gravity(0, 0, 0);
  const std::size_t v = 17;
  const Vec3f start = sheet.at(v), eye{0, 3, 0};
  ASSERT_TRUE(s.grab_vertex(cloth, v, {eye, start - eye}, {0, -1, 0}));
  EXPECT_TRUE(s.grabbing());
  EXPECT_LT(length(s.grabbed_point() - start), 1e-6f);
  const Vec3f goal = start + Vec3f(0.2f, 0, 0.1f);
  s.drag({eye, goal - eye});
  EXPECT_LT(length(s.drag_target() - goal), 1e-5f);
  host.play(120);
  const std::vector<float> x = drawn(s, cloth);
  EXPECT_LT(length(vertex(x, v) - goal), 0.05f);
  s.release();
  EXPECT_FALSE(s.grabbing());
  ASSERT_TRUE(s.grab_vertex(cloth, v, {eye, goal - eye}));
  s.reset();
  EXPECT_FALSE(s.grabbing());
  EXPECT_EQ(s.drag_target(), Vec3f());
  s.drag({eye, goal - eye});
  host.play(1);
}

TEST_F(SmallCloth, ATriangleIsTakenWhereTheRayMeetsIt) {
  const Vec3f center = (sheet.at(9) + sheet.at(10) + sheet.at(11)) / 3.0f, eye = center + Vec3f(1, 2, 0);
  ASSERT_TRUE(s.grab_triangle(cloth, 3, {eye, center - eye}));
  EXPECT_LT(length(s.grabbed_point() - center), 1e-5f);
  // Edge-on: no point in the plane, so a corner.
  ASSERT_TRUE(s.grab_triangle(cloth, 3, {center + Vec3f(5, 0, 0), {-1, 0, 0}}));
  EXPECT_LT(length(s.grabbed_point() - center), 0.3f);
  expect_error([&] { s.grab_triangle(cloth, 32, {eye, center - eye}); }, {"cloth", "triangle 32", "32"});
  expect_error([&] { s.grab_vertex(cloth, 96, {eye, center - eye}); }, {"cloth", "vertex 96", "96"});
  expect_error([&] { s.grab_vertex(cloth, 0, {eye, {}}); }, {"direction"});
  expect_error([&] { s.grab_vertex(cloth, 0, {eye, {nan, 0, 0}}); }, {"not finite"});
}

/// Its nearest vertex is what is held: nothing, where that one is pinned.
TEST(Session, ATriangleIsHeldAtItsNearestVertex) {
  const Corners sheet(grid(5, 5, 1.0));
  const Vec3f center = (sheet.at(9) + sheet.at(10) + sheet.at(11)) / 3.0f;
  for (const std::uint32_t pinned : {9u, 10u, 11u}) {
    Session s;
    const Handle cloth = s.add_cloth(sheet.soup());
    s.set_pinned(cloth, pinned, true);
    for (const std::uint32_t near : {9u, 10u, 11u}) {
      const Vec3f point = center * 0.2f + sheet.at(near) * 0.8f;
      EXPECT_EQ(s.grab_triangle(cloth, 3, {point + Vec3f(0, 2, 0), {0, -1, 0}}), near != pinned);
    }
  }
}

TEST_F(SmallCloth, AHostThatCannotPickGrabsByARay) {
  const Corners block(box({1, 1, 1}, {1, 1, 1}));
  const Handle post = s.add_obstacle(block.soup(), Placed(9, 0, 0));
  EXPECT_TRUE(s.grab({{0.1f, 2, 0.1f}, {0, -1, 0}}));
  EXPECT_LT(length(s.grabbed_point() - Vec3f(0.1f, 0, 0.1f)), 1e-5f);
  EXPECT_FALSE(s.grab({{5, 2, 0}, {0, -1, 0}}));
  EXPECT_FALSE(s.grabbing());  // what was held before is let go
  expect_error([&] { s.grab({{0, 2, 0}, {}}); }, {"direction"});
  EXPECT_FALSE(s.grab({{9, 2, 0}, {0, -1, 0}}));
  EXPECT_FALSE(s.grab_vertex(post, 0, {{9, 2, 0}, {0, -1, 0}}));
  s.set_pinned(cloth, 0, true);
  EXPECT_FALSE(s.grab_vertex(cloth, 0, {{0, 2, 0}, {0, -1, 0}}));
}

float lowest(Session& session, Handle object) {
  const std::vector<float> drawn_now = drawn(session, object);
  float y = drawn_now[1];
  for (std::size_t k = 1; k < drawn_now.size(); k += 3) y = std::min(y, drawn_now[k]);
  return y;
}

TEST_F(LargeCloth, HasCollidersOfTheHost) {
  const Handle ground = s.add_plane(At(0, -0.5f, 0));
  EXPECT_EQ(s.colliders().size(), 1u);
  for (int run = 0; run < 2; ++run) {  // the second time after a reset
    host.play(60);
    EXPECT_GT(lowest(s, cloth), -0.51f);
    EXPECT_LT(lowest(s, cloth), -0.45f);
    s.reset();
  }
  s.remove_collider(ground);
  host.play(60);
  EXPECT_LT(lowest(s, cloth), -1);
  expect_error([&] { s.remove_collider(ground); }, {"there is no collider"});
  expect_error([&] { s.add_sphere(-1); }, {"radius"});
}

TEST_F(LargeCloth, ACapsuleThatMovesTakesTheClothAlong) {
  s.set_gravity(0, 0, 0);
  const Handle capsule = s.add_capsule(0.2f, 0.3f, At(0, -0.6f, 0));
  for (int frame = 1; frame <= 20; ++frame) {
    s.move_collider(capsule, At(0, -0.6f + 0.05f * static_cast<float>(frame), 0));
    host.play(1);
  }
  EXPECT_EQ(s.collider_transforms()[0][13], -0.6f + 0.05f * 20);
  std::vector<float> positions = drawn(s, cloth);
  float highest = 0;
  for (std::size_t k = 1; k < positions.size(); k += 3) highest = std::max(highest, positions[k]);
  EXPECT_GT(highest, 0.4f + 0.5f - 0.01f);  // on top of the capsule
}

TEST_F(SmallCloth, ConnectionsAndPinsMoveVertices) {
  const Corners block(box({0.2, 0.2, 0.2}, {1, 1, 1}));
  const Handle post = s.add_obstacle(block.soup(), Placed(0.5f, 0.3f, 0.5f));
  s.set_pinned(cloth, 0, true);
  const Handle tie = s.connect(cloth, 7, post, 0, -1);
  const Vec3f corner = block.at(0) + Vec3f{0.5f, 0.3f, 0.5f};
  const float apart = length(sheet.at(7) - corner);
  for (int run = 0; run < 2; ++run) {  // the second time after a reset
    host.play(60);
    EXPECT_NEAR(length(vertex(drawn(s, cloth), 7) - corner), apart, 0.02f * apart);
    s.reset();
  }
  s.move_pin(cloth, 0, -0.5f, 0.25f, -0.5f);
  host.play(1);
  EXPECT_NEAR(drawn(s, cloth)[1], 0.25f, 1e-6f);
  expect_error([&] { s.move_pin(cloth, 10, 0, 0, 0); }, {"is not pinned"});
  s.remove(post);  // takes the connection with it
  expect_error([&] { s.disconnect(tie); }, {"there is no connection"});
  s.reset();
  host.play(2);
}

TEST_F(SmallCloth, WindReachesObjectsByTheirExposure) {
  s.set_gravity(0, 0, 0);
  const Handle sheltered = s.add_cloth(sheet.soup(), Placed(3, 0, 0));
  s.set_wind(0, 5, 0);
  EXPECT_EQ(s.wind()[1], 5);
  s.set_wind_exposure(sheltered, 0);
  for (int run = 0; run < 2; ++run) {
    host.play(3);
    EXPECT_GT(lowest(s, cloth), 1e-3f);
    EXPECT_EQ(lowest(s, sheltered), 0);
    s.reset();
  }
}

// Rigid bodies of a host program.

TEST(SessionRigidBodies, MoveAsInAPureRunToTheBit) {
  const Corners crate(box({0.3, 0.2, 0.3}, {2, 2, 2}));
  Player host;
  const Handle body = host.session.add_rigid_body(crate.soup(), Placed(0.125f, 0.5f, 0));
  host.session.add_plane();
  EXPECT_EQ(host.session.object(body).kind, Kind::rigid_body);
  EXPECT_STREQ(kind_name(Kind::rigid_body), "rigid_body");
  host.play(60);

  World world;
  TriangleMesh placed = VertexWelder(crate.soup()).mesh();
  for (Vec3d& x : placed.positions) x += Vec3d(0.125, 0.5, 0);
  const ObjectId pure = world.add_rigid_body(placed);
  world.add_collider(Plane{});
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_EQ(host.session.hash(), world.hash());
  EXPECT_NEAR(world.rigid_body(pure).pose.translation.y, 0.1, 2e-3);
  EXPECT_GT(host.session.statistics().contacts, 0u);
  const std::vector<float> x = drawn(host.session, body);
  const VertexWelder weld(crate.soup());
  for (std::size_t v = 0; v < crate.count(); ++v)
    EXPECT_EQ(vertex(x, v),
              Vec3f(Vec3d(world.positions(pure)[weld.particle_of()[v]]) - Vec3d(0.125, 0.5, 0)));
}

TEST(SessionRigidBodies, AreGrabbedAndReset) {
  Player host;
  const Corners crate(box({0.3, 0.3, 0.3}, {1, 1, 1}));
  const Handle body = host.session.add_rigid_body(crate.soup());
  host.session.set_gravity(0, 0, 0);
  const std::vector<float> before = drawn(host.session, body);
  ASSERT_TRUE(host.session.grab_vertex(body, 0, {{0, 0, 5}, {0, 0, -1}}));
  host.session.drag({{1, 1, 5}, {0, 0, -1}});
  host.play(30);
  EXPECT_GT(vertex(drawn(host.session, body), 0).x, vertex(before, 0).x + 0.2f);
  host.session.release();
  host.session.reset();
  EXPECT_EQ(drawn(host.session, body), before);
}

TEST(SessionRigidBodies, HaveTunablesAndRefusePinsInWords) {
  Player host;
  const Corners crate(box({0.3, 0.3, 0.3}, {1, 1, 1}));
  const Handle body = host.session.add_rigid_body(crate.soup());
  const std::vector<Parameter> parameters = host.session.parameters(body);
  EXPECT_TRUE(std::any_of(parameters.begin(), parameters.end(),
                          [](const Parameter& p) { return p.name == "friction"; }));
  host.session.set_parameter(body, "friction", 0.25);
  EXPECT_TRUE(host.session.presets(body).empty());
  expect_error([&] { host.session.set_pinned(body, 0, true); }, {"rigid body"});
}

/// A host's matrix: of a mesh that is twice as long in x, then turned about an axis, then moved.
Placement placed(const Vec3d& axis, double degrees, const Vec3d& at) {
  constexpr double radians = 3.14159265358979323846 / 180;
  const Mat3d turn = rotation_matrix(Quatd::from_axis_angle(normalized(axis), degrees * radians));
  float matrix[16] = {};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      matrix[4 * column + row] = static_cast<float>(turn(row, column) * (column == 0 ? 2 : 1));
  for (int row = 0; row < 3; ++row) matrix[12 + row] = static_cast<float>(at[row]);
  matrix[15] = 1;
  return Placement::of(matrix);
}

/// However far it is turned, also by 180 degrees about each axis, where a part of the quaternion is 0.
TEST(Drive, LeadsTheMeshFromWhereItWasToWhereItIs) {
  const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -2, 0.5}};
  const Vec3d points[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.3, 0.2, 1}};
  for (const double begin : {0.0, 20.0}) {
    const Placement from = placed({1, 1, 0}, begin, {1, 0, 2});
    for (const Vec3d& axis : axes)
      for (const double degrees : {0.0, 1.0, 90.0, 179.0, 180.0, 200.0, 359.0}) {
        const Placement to = placed(axis, degrees, {0, 3, -1});
        const Transform motion = rigid_motion(from, to, "table");
        for (const Vec3d& x : points)
          EXPECT_LT(length(motion.point(from.to_world(x)) - to.to_world(x)), 1e-5)
              << axis.y << ' ' << degrees;
      }
  }
}

TEST(Drive, GoesTheShorterWayDuringAStepAndStaysThere) {
  const Placement added = placed({0, 1, 0}, 0, {});
  const Vec3d corner{1, 0, 0};
  for (const double degrees : {-90.0, -20.0, 20.0, 90.0, 180.0}) {
    Drive drive;
    drive.from = rigid_motion(added, placed({0, 1, 0}, degrees - 10, {}), "table");
    drive.to = rigid_motion(added, placed({0, 1, 0}, degrees + 10, {0, 0, 1}), "table");
    EXPECT_LT(length(drive.at(7).point(corner) - drive.from.point(corner)), 1e-12);  // no step runs
    drive.begin_step(7, 0.1);
    EXPECT_LT(length(drive.at(7).point(corner) - drive.from.point(corner)), 1e-12);
    const Transform half = rigid_motion(added, placed({0, 1, 0}, degrees, {0, 0, 0.5}), "table");
    EXPECT_LT(length(drive.at(7.05).point(corner) - half.point(corner)), 1e-5) << degrees;
    EXPECT_LT(length(drive.at(7.1).point(corner) - drive.to.point(corner)), 1e-12);
    drive.end_step(true);
    EXPECT_LT(length(drive.at(9).point(corner) - drive.to.point(corner)), 1e-12);
  }
}

TEST(Drive, RefusesWhatIsNotRigid) {
  const Placement from = placed({0, 1, 0}, 30, {});
  float mirrored[16] = {2, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  expect_error([&] { rigid_motion(from, Placement::of(mirrored), "table"); }, {"table", "mirrored"});
  mirrored[5] = 1.01f;
  expect_error([&] { rigid_motion(from, Placement::of(mirrored), "table"); }, {"table", "scaled"});
}

}  // namespace souple::host::test_host_session_objects
