#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <fstream>
#include <thread>

#include <gtest/gtest.h>

namespace souple::host::test_host_session {

// --- the same as a pure run

TEST(Session, ASceneMovesAsInAPureRunToTheBit) {
  Player host;
  host.session.open_scene(scenes + "flag.json");
  World world = build_world(load_scene(scenes + "flag.json"));
  host.play(30);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_EQ(host.session.hash(), world.hash());
  EXPECT_EQ(host.session.time(), world.time());
  ASSERT_EQ(host.session.objects().size(), world.objects().size());
  for (const ObjectInfo& info : host.session.objects())
    EXPECT_TRUE(same_bits(drawn(host.session, info.handle), world.positions(world.find_object(info.name))));
}

TEST(Session, MeshesOfTheHostMoveAsInAPureRunToTheBit) {
  const Corners sheet(grid(13, 13, 1.0)), ball(sphere(2, 0.2)), post(box({0.3, 0.3, 0.3}, {1, 1, 1}));
  const At above(0.125f, 1, 0);
  Player host;
  MeshOptions options;
  options.transform = above;
  options.preset = "silk";
  options.self_collision = true;
  const Handle cloth = host.session.add_cloth(sheet.soup(), options);
  MeshOptions soft;
  soft.lattice_tets = 300;
  const Handle body = host.session.add_soft_body(ball.soup(), soft);
  host.session.add_obstacle(post.soup());
  host.play(40);

  World world;
  TriangleMesh placed = VertexWelder(sheet.soup()).mesh();
  for (Vec3d& x : placed.positions) x += Vec3d(0.125, 1, 0);
  const ObjectId pure = world.add_cloth(placed, material::silk, {.self_collision = SelfCollision::surfaces});
  const ObjectId pure_body = world.add_soft_body(VertexWelder(ball.soup()).mesh(), {}, {.cells = 300});
  world.add_obstacle(VertexWelder(post.soup()).mesh());
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_EQ(host.session.hash(), world.hash());

  // Each drawn corner is where its particle is, in the mesh's own coordinates.
  const VertexWelder weld(sheet.soup());
  const std::vector<float> x = drawn(host.session, cloth);
  for (std::size_t v = 0; v < sheet.count(); ++v) {
    const Vec3f& p = world.positions(pure)[weld.particle_of()[v]];
    EXPECT_EQ(vertex(x, v), Vec3f(Vec3d(p) - Vec3d(0.125, 1, 0)));
  }
  const VertexWelder ball_weld(ball.soup());
  const std::vector<float> y = drawn(host.session, body);
  for (std::size_t v = 0; v < ball.count(); ++v)
    EXPECT_EQ(y[3 * v + 1], world.positions(pure_body)[ball_weld.particle_of()[v]].y);
}

// --- time

TEST(Session, PlayPauseStepAndResetMakeExactlyTheirSteps) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const std::uint64_t start = s.hash();
  EXPECT_EQ(s.advance(0, dt), Tick::step);  // the first frame
  for (int i = 0; i < 3; ++i) EXPECT_EQ(s.advance(0, dt), Tick::nothing);
  host.play(4);
  EXPECT_EQ(s.steps(), 5u);
  EXPECT_NEAR(s.time(), 5 * dt, 1e-12);

  s.set_playing(false);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(s.advance(host.now += dt, dt), Tick::nothing);
  s.request_step();
  EXPECT_EQ(s.advance(host.now, dt), Tick::step);  // its time stands
  EXPECT_EQ(s.advance(host.now, dt), Tick::nothing);
  EXPECT_EQ(s.steps(), 6u);
  s.set_playing(true);
  s.request_step();
  EXPECT_EQ(s.advance(host.now += dt, dt), Tick::step);  // one, not two
  EXPECT_FALSE(s.playing());
  EXPECT_EQ(s.steps(), 7u);
  const std::uint64_t seven = s.hash(), version = s.version();

  EXPECT_EQ(s.advance(host.now = 0, dt), Tick::reset);
  EXPECT_GT(s.version(), version);
  EXPECT_EQ(s.steps(), 0u);
  EXPECT_EQ(s.time(), 0);
  EXPECT_EQ(s.hash(), start);
  EXPECT_TRUE(s.contains(cloth));
  s.set_playing(true);
  host.play(7);
  EXPECT_EQ(s.hash(), seven);
  s.reset();
  EXPECT_EQ(s.hash(), start);
  EXPECT_EQ(s.statistics().steps, 0u);
}

TEST(Session, MayBeginInTheMiddleOfTheHostsTime) {
  Session s;
  s.start_at(5);
  EXPECT_EQ(s.advance(5, dt), Tick::nothing);
  EXPECT_EQ(s.advance(5 + dt, dt), Tick::step);
  expect_error([&] { s.start_at(static_cast<double>(nan)); }, {"not finite"});
}

TEST(Session, AResetKeepsWhatTheUserChanged) {
  const Corners sheet(grid(7, 7, 1.0));
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "flag.json");
  const Handle flag = s.objects()[0].handle;
  const At above(0, 9, 0);
  MeshOptions options;
  options.transform = above;
  const Handle cloth = s.add_cloth(sheet.soup(), options);
  const Handle other = s.add_cloth(sheet.soup());
  host.play(3);
  s.set_pinned(cloth, 0, true);
  s.set_parameter(cloth, "areal_density", 0.5);
  s.set_parameter(flag, "bending_stiffness", 2e-4);
  s.set_substeps(4);
  s.remove(other);
  s.reset();
  const std::vector<float> before = drawn(s, cloth);
  host.play(20);
  const std::vector<float> after = drawn(s, cloth);
  EXPECT_EQ(after[1], before[1]);
  EXPECT_LT(after[after.size() - 2], before[before.size() - 2] - 0.1f);
  EXPECT_EQ(s.substeps(), 4);
  EXPECT_FALSE(s.contains(other));
  const std::uint64_t first = s.hash();
  s.reset();
  host.play(20);
  EXPECT_EQ(s.hash(), first);
  for (const Parameter& p : s.parameters(flag))
    if (p.name == "bending_stiffness") {
      EXPECT_FLOAT_EQ(static_cast<float>(p.value), 2e-4f);
    }
}

/// Not only what panels read: the world is made from it.
TEST(Session, AResetMakesTheSceneFromTheMaterialsOfNow) {
  Player before, after, never;
  for (Player* player : {&before, &after, &never}) player->session.open_scene(scenes + "flag.json");
  const auto change = [](Session& s) {
    s.set_parameter(s.objects()[0].handle, "bending_stiffness", 0.05);
    s.set_gravity(0, -3, 0);
  };
  change(before.session);
  after.play(3);
  change(after.session);
  after.session.reset();
  for (Player* player : {&before, &after, &never}) player->play(20);
  EXPECT_EQ(after.session.hash(), before.session.hash());
  never.session.reset();
  never.session.set_gravity(0, -3, 0);
  never.play(20);
  EXPECT_NE(never.session.hash(), before.session.hash());  // the bending too
}

TEST(Session, AStepThatGoesBadPausesSaysSoAndLeavesTheWorldAsItWas) {
  const Corners sheet(grid(5, 5, 1.0)), block(box({2, 0.2, 2}, {4, 1, 4}));
  const At above(0, 0.12f, 0);
  const At higher(0, 0.02f, 0);
  Player host{Session({1000})}, undisturbed;
  MeshOptions options;
  options.transform = above;
  Handle table = 0;
  for (Player* player : {&host, &undisturbed}) {
    table = player->session.add_obstacle(block.soup());
    player->session.add_cloth(sheet.soup(), options);
    player->play(20);
  }
  Session& s = host.session;
  const double time = s.time();
  const std::uint64_t hash = s.hash();
  s.set_gravity(0, -3e38f, 0);
  s.set_transform(table, higher);
  EXPECT_EQ(s.advance(host.now += dt, 1000), Tick::nothing);  // at once beyond what a float holds
  EXPECT_FALSE(s.playing());
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("cloth"), std::string::npos) << messages[0];
  EXPECT_TRUE(s.take_messages().empty());
  EXPECT_EQ(s.steps(), 20u);
  EXPECT_EQ(s.time(), time);
  EXPECT_EQ(s.hash(), hash);
  s.set_gravity(0, -9.81f, 0);
  s.set_playing(true);
  undisturbed.session.set_transform(table, higher);  // it goes up in the next step, as if nothing had been
  for (Player* player : {&host, &undisturbed}) player->play(5);
  EXPECT_EQ(s.hash(), undisturbed.session.hash());
}

/// Its solver takes no more than a few constraints; a mesh of the host has more.
TEST(Session, AStepThatCannotBeginPausesAndSaysSo) {
  const std::string file = testing::TempDir() + "host_dense.json";
  std::ofstream(file) << R"({"souple": 1, "solver": "dense", "objects": [
      {"kind": "cloth", "mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}}}]})";
  const Corners sheet(grid(60, 60, 1.0));
  Player host;
  Session& s = host.session;
  s.open_scene(file);
  host.play(2);
  const Handle large = s.add_cloth(sheet.soup());
  EXPECT_EQ(s.advance(host.now += dt, dt), Tick::nothing);
  EXPECT_FALSE(s.playing());
  EXPECT_EQ(s.steps(), 2u);
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("dense"), std::string::npos) << messages[0];
  s.remove(large);
  s.set_playing(true);
  host.play(2);
}

// --- the user's actions

TEST(Session, PostedActionsWaitForTheNextFrame) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  std::thread user([&] {
    s.post("substeps", [](Session& session) { session.set_substeps(3); });
    s.post("substeps", [](Session& session) { session.set_substeps(5); });
    s.post("remove", [cloth](Session& session) { session.remove(cloth); });
    s.post("pin", [cloth](Session& session) { session.set_pinned(cloth, 0, true); });
    s.post("mode", [](Session& session) { session.set_mode("xpbd"); });
  });
  user.join();
  EXPECT_TRUE(s.contains(cloth));
  const std::vector<std::string> messages = host.paused_frame();
  EXPECT_EQ(s.substeps(), 5);
  EXPECT_EQ(s.mode(), "xpbd");
  EXPECT_FALSE(s.contains(cloth));
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0], "pin: \"cloth\" (object 1) is no longer there");
  EXPECT_NO_THROW(host.play(3));  // an empty world
}

TEST(Session, OnlyTheLatestMessagesAreKept) {
  Player host;
  for (Handle handle = 1; handle <= 150; ++handle)
    host.session.post("remove", [handle](Session& s) { s.remove(handle); });
  const std::vector<std::string> messages = host.paused_frame();
  ASSERT_EQ(messages.size(), 100u);
  EXPECT_EQ(messages.front(), "remove: there is no object 51");
  EXPECT_EQ(messages.back(), "remove: there is no object 150");
}

TEST(Session, WhatWasMendedInAMeshIsTold) {
  Corners sheet(grid(3, 3, 1.0));
  const std::vector<std::uint32_t> first(sheet.indices.begin(), sheet.indices.begin() + 3);
  sheet.indices.insert(sheet.indices.end(), first.begin(), first.end());  // a triangle twice
  Session s;
  s.add_cloth(sheet.soup());
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].rfind("cloth: ", 0), 0u) << messages[0];
}

/// A sheet of rubber that hangs on a corner: too long in every step, and it is said once.
TEST(Session, AWarningThatLastsIsOneMessage) {
  const Corners sheet(grid(9, 9, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  s.set_parameter(cloth, "membrane_stiffness", 3);
  s.set_pinned(cloth, 0, true);
  host.play(60);
  EXPECT_NE(s.statistics().warnings.find("stretched"), std::string::npos) << s.statistics().warnings;
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0], s.statistics().warnings);
}

TEST(Session, EverythingAboutAnObjectThatIsGoneIsSaidInWords) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const Ray ray{{0, 1, 0}, {0, -1, 0}};
  ASSERT_TRUE(s.grab_vertex(cloth, 0, ray));
  s.remove(cloth);
  EXPECT_FALSE(s.grabbing());
  s.drag(ray);
  s.release();
  std::vector<float> buffer(3 * sheet.count());
  const std::function<void()> calls[] = {[&] { s.remove(cloth); },
                                         [&] { s.object(cloth); },
                                         [&] {
                                           s.write(cloth, {buffer.data(), nullptr}, sheet.count());
                                         },
                                         [&] { s.triangles(cloth); },
                                         [&] { s.segments(cloth); },
                                         [&] { s.grab_vertex(cloth, 0, ray); },
                                         [&] { s.grab_triangle(cloth, 0, ray); },
                                         [&] { s.set_transform(cloth, nullptr); },
                                         [&] { s.set_pinned(cloth, 0, true); },
                                         [&] { s.parameters(cloth); },
                                         [&] { s.set_parameter(cloth, "friction", 1); },
                                         [&] { s.set_preset(cloth, "silk"); }};
  for (const auto& call : calls) expect_error(call, {"\"cloth\" (object 1) is no longer there"});
  expect_error([&] { s.object(77); }, {"no object 77"});
  const Handle again = s.add_cloth(sheet.soup());
  EXPECT_NE(again, cloth);  // no handle means two objects
  s.open_scene(scenes + "flag.json");
  expect_error([&] { s.object(again); }, {"no longer there"});
  s.clear();
  EXPECT_TRUE(s.objects().empty());
}

// --- what cannot be done

TEST(Session, WhatCannotBeDoneIsOneSentenceAndChangesNothing) {
  Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const std::uint64_t before = s.hash();
  expect_error([&] { s.open_scene(scenes + "no_such_scene.json"); }, {"no_such_scene.json"});
  MeshOptions options;
  options.preset = "cottn";
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"cottn", "cotton"});
  options = {};
  options.name = "cloth";
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"cloth"});
  expect_error([&] { s.add_soft_body(sheet.soup()); }, {"soft_body"});  // open
  options = {};
  options.weld_tolerance = -1;
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"cloth", "tolerance", "-1"});
  float matrix[16] = {};
  options = {};
  options.transform = matrix;
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"cloth: transform"});
  expect_error([&] { s.set_transform(cloth, matrix); }, {"cloth: transform"});
  std::vector<float> buffer(3 * sheet.count());
  expect_error([&] { s.write(cloth, {buffer.data(), nullptr}, sheet.count() - 1); }, {"cloth", "95", "96"});
  sheet.positions[7] = nan;
  expect_error([&] { s.add_cloth(sheet.soup()); }, {"cloth", "vertex 2", "not finite"});
  const Corners block(box({1, 1, 1}, {1, 1, 1}));
  const Handle post = s.add_obstacle(block.soup());
  expect_error([&] { s.set_pinned(post, 0, true); }, {"obstacle", "pins"});
  s.remove(post);
  EXPECT_EQ(s.objects().size(), 1u);
  EXPECT_EQ(s.hash(), before);
}

TEST(Session, TwoSessionsAndClosingWhileSomethingIsHeld) {
  const Corners sheet(grid(5, 5, 1.0));
  Session a;
  {
    Session b;
    const Handle cloth = b.add_cloth(sheet.soup());
    b.grab_vertex(cloth, 0, {{0, 1, 0}, {0, -1, 0}});
    a.add_cloth(sheet.soup());
    for (int i = 0; i < 3; ++i) a.advance(i, dt), b.advance(i, dt);
    b.post("pin", [cloth](Session& s) { s.set_pinned(cloth, 0, true); });
    EXPECT_NE(a.hash(), 0u);
  }
  EXPECT_EQ(a.advance(9, dt), Tick::step);
}

}  // namespace souple::host::test_host_session
