#include "souple/geometry/builders.h"
#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <cmath>
#include <cstdio>
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
  Player host;
  Placed options(0.125f, 1, 0);
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

TEST_F(SmallCloth, PlayPauseStepAndResetMakeExactlyTheirSteps) {
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

TEST_F(HostedSession, AResetKeepsWhatTheUserChanged) {
  const Corners sheet(grid(7, 7, 1.0));
  s.open_scene(scenes + "flag.json");
  const Handle flag = s.objects()[0].handle;
  const Handle cloth = s.add_cloth(sheet.soup(), Placed(0, 9, 0));
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
  const At higher(0, 0.02f, 0);
  Player host{Session({1000})}, undisturbed;
  Handle table = 0;
  for (Player* player : {&host, &undisturbed}) {
    table = player->session.add_obstacle(block.soup());
    player->session.add_cloth(sheet.soup(), Placed(0, 0.12f, 0));
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
TEST_F(HostedSession, AStepThatCannotBeginPausesAndSaysSo) {
  const std::string file = testing::TempDir() + "host_dense.json";
  std::ofstream(file) << R"({"souple": 1, "solver": "dense", "objects": [
      {"kind": "cloth", "mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}}}]})";
  const Corners sheet(grid(60, 60, 1.0));
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

TEST_F(SmallCloth, PostedActionsWaitForTheNextFrame) {
  std::thread user([&] {
    s.post("substeps", [](Session& session) { session.set_substeps(3); });
    s.post("substeps", [](Session& session) { session.set_substeps(5); });
    s.post("remove", [this](Session& session) { session.remove(cloth); });
    s.post("pin", [this](Session& session) { session.set_pinned(cloth, 0, true); });
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
TEST_F(LargeCloth, AWarningThatLastsIsOneMessage) {
  s.set_parameter(cloth, "membrane_stiffness", 3);
  s.set_pinned(cloth, 0, true);
  host.play(60);
  EXPECT_NE(s.statistics().warnings.find("stretched"), std::string::npos) << s.statistics().warnings;
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0], s.statistics().warnings);
}

TEST_F(SmallCloth, EverythingAboutAnObjectThatIsGoneIsSaidInWords) {
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

TEST_F(SmallCloth, WhatCannotBeDoneIsOneSentenceAndChangesNothing) {
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

/// Wherever it goes, what is left moves on, and a reset brings back nothing that was removed.
TEST_F(HostedSession, ObjectsAreRemovedDuringPlay) {
  const Corners sheet(grid(7, 7, 1.0)), ball(sphere(1, 0.2)), block(box({1, 1, 1}, {1, 1, 1}));
  s.open_scene(scenes + "flag.json");
  const Handle flag = s.objects()[0].handle;
  const Handle table = s.add_obstacle(block.soup());
  Placed options(0, 0.8f, 0);
  const Handle pinned = s.add_cloth(sheet.soup(), options);
  options.lattice_tets = 100;
  const Handle soft = s.add_soft_body(ball.soup(), options);
  s.set_pinned(pinned, 0, true);
  s.set_pinned(soft, 0, true);
  host.play(5);
  std::size_t left = 4;
  EXPECT_EQ(s.statistics().objects, left);
  for (const Handle gone : {pinned, flag, table, soft}) {
    const std::uint64_t version = s.version();
    s.remove(gone);
    EXPECT_GT(s.version(), version);
    EXPECT_FALSE(s.contains(gone));
    EXPECT_EQ(s.objects().size(), --left);
    EXPECT_EQ(s.statistics().objects, left);
    host.play(3);
    s.reset();
    EXPECT_EQ(s.objects().size(), left);
    EXPECT_EQ(s.statistics().objects, left);
    host.play(3);
    EXPECT_TRUE(s.playing());
    for (const ObjectInfo& info : s.objects())
      for (const float x : drawn(s, info.handle)) ASSERT_TRUE(std::isfinite(x)) << info.name;
  }
  EXPECT_TRUE(s.take_messages().empty());
  const Handle again = s.add_cloth(sheet.soup(), options);  // into a world without objects
  host.play(3);
  EXPECT_LT(drawn(s, again)[1], 0);
}

/// An object that comes after one is removed is as if that one had never been.
TEST(Session, AResetAfterARemovalIsTheWorldWithoutIt) {
  const Corners sheet(grid(7, 7, 1.0));
  Placed options(0, 0.8f, 0);
  options.name = "kept";
  Player with, without;
  const Handle gone = with.session.add_cloth(sheet.soup());
  with.session.set_pinned(with.session.add_cloth(sheet.soup(), options), 0, true);
  without.session.set_pinned(without.session.add_cloth(sheet.soup(), options), 0, true);
  with.play(5);
  with.session.remove(gone);
  with.session.reset();
  with.play(20);
  without.play(20);
  EXPECT_EQ(with.session.hash(), without.session.hash());
}

TEST_F(HostedSession, RemovingWhatIsHeldLetsGoAndRemovingAnotherDoesNot) {
  const Corners sheet(grid(7, 7, 1.0));
  s.set_gravity(0, 0, 0);
  const Handle other = s.add_cloth(sheet.soup());
  const Handle held = s.add_cloth(sheet.soup(), Placed(3, 0, 0));
  const Vec3f start = sheet.at(0) + Vec3f(3, 0, 0), goal = start + Vec3f(0, 0.3f, 0),
              eye = start + Vec3f(0, 0, 4);
  ASSERT_TRUE(s.grab_vertex(held, 0, {eye, start - eye}));
  s.drag({eye, goal - eye});
  host.play(2);
  s.remove(other);
  EXPECT_TRUE(s.grabbing());
  host.play(120);
  EXPECT_LT(length(s.grabbed_point() - goal), 0.05f);
  s.remove(held);
  EXPECT_FALSE(s.grabbing());
  EXPECT_EQ(s.drag_target(), Vec3f());
  s.drag({eye, start - eye});
  s.release();
  host.play(2);
  s.reset();
  EXPECT_TRUE(s.objects().empty());
  host.play(2);
}

/// Vertices of a soft body share the tets that carry them: of two that share one, the last word counts.
TEST(Session, PinsComeBackInTheOrderInWhichTheyWereSaid) {
  const Corners ball(sphere(2, 0.3));
  MeshOptions options;
  options.lattice_tets = 40;  // so coarse that neighbors share
  std::uint32_t near = 1;
  while (ball.at(near) == ball.at(0)) ++near;
  for (const bool freed_first : {false, true}) {
    Player host, again;
    for (Player* player : {&host, &again}) {
      Session& s = player->session;
      const Handle soft = s.add_soft_body(ball.soup(), options);
      s.set_pinned(soft, 0, true);
      s.set_pinned(soft, near, freed_first);
      s.set_pinned(soft, 0, !freed_first);
    }
    again.session.reset();
    for (Player* player : {&host, &again}) player->play(20);
    EXPECT_EQ(again.session.hash(), host.session.hash()) << freed_first;
  }
}

/// Writes a scene of one cloth; `mesh` and `end` are where the tests break it.
std::string written_scene(const std::string& name, const std::string& mesh, const std::string& end) {
  std::string file = testing::TempDir() + name;
  std::ofstream(file) << R"({"souple": 1, "objects": [{"kind": "cloth", "mesh": )" << mesh << "}]" << end;
  return file;
}

TEST(Session, ASceneThatFailsToOpenLeavesTheSessionAsItWas) {
  const std::string whole = R"({"grid": {"columns": 4, "rows": 4, "size": 1}})";
  std::ofstream(testing::TempDir() + "host_broken.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n";
  const struct {
    std::string file;
    std::initializer_list<std::string> words;
  } failures[] = {
      {"no/such_scene.json", {"no/such_scene.json"}},
      {testing::TempDir(), {"folder"}},
      {written_scene("host_text.json", whole, ""), {"host_text.json"}},
      {written_scene("host_key.json", whole, R"(, "substps": 3})"), {"substps", "substeps"}},
      {written_scene("host_mesh.json", R"({"file": "no_such_mesh.obj"})", "}"), {"no_such_mesh.obj"}},
      {written_scene("host_obj.json", R"({"file": "host_broken.obj"})", "}"), {"host_broken.obj"}},
      {written_scene("host_pin.json", whole + R"(, "pins": [{"vertices": [99]}])", "}"), {"pins[0]", "99"}}};
  const Corners sheet(grid(7, 7, 1.0));
  Player host, undisturbed;
  for (Player* player : {&host, &undisturbed}) {
    player->session.open_scene(scenes + "flag.json");
    player->session.set_pinned(player->session.add_cloth(sheet.soup()), 0, true);
    player->session.set_substeps(4);
    player->play(3);
  }
  Session& s = host.session;
  const std::vector<ObjectInfo> before = s.objects();
  const Vec3f corner = sheet.at(9);
  ASSERT_TRUE(s.grab_vertex(before[1].handle, 9, {corner + Vec3f(0, 1, 0), {0, -1, 0}}));
  for (const auto& [file, words] : failures) {
    SCOPED_TRACE(file);
    const std::uint64_t hash = s.hash(), version = s.version();
    expect_error([&, &file = file] { s.open_scene(file); }, words);
    EXPECT_EQ(s.hash(), hash);
    EXPECT_EQ(s.version(), version);
    EXPECT_EQ(s.steps(), 3u);
    EXPECT_TRUE(s.playing());
    EXPECT_TRUE(s.grabbing());
    EXPECT_EQ(s.substeps(), 4);
    ASSERT_EQ(s.objects().size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(s.objects()[i].handle, before[i].handle);
    EXPECT_EQ(s.colliders().size(), 2u);
  }
  s.release();
  for (Player* player : {&host, &undisturbed}) player->play(5);
  EXPECT_EQ(s.hash(), undisturbed.session.hash());
  for (Player* player : {&host, &undisturbed}) player->session.reset(), player->play(5);
  EXPECT_EQ(s.hash(), undisturbed.session.hash());
}

TEST_F(HostedSession, ARefusedStepPausesAndSaysWhy) {
  const std::string file = testing::TempDir() + "souple_refused.json";
  std::ofstream(file) << R"({"souple": 1, "solver": "dense", "objects": [
    {"name": "sheet", "kind": "cloth", "mesh": {"grid": {"columns": 30, "rows": 30, "size": 1}}}]})";
  s.open_scene(file);
  std::remove(file.c_str());
  s.set_playing(true);
  EXPECT_EQ(s.advance(host.now += dt, dt), Tick::nothing);
  const std::vector<std::string> messages = s.take_messages();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("the solver dense takes at most"), std::string::npos) << messages[0];
  EXPECT_FALSE(s.playing());
  EXPECT_EQ(s.time(), 0);
  EXPECT_EQ(s.steps(), 0u);
  EXPECT_NE(s.statistics().text().find("the solver dense"), std::string::npos) << s.statistics().text();
}

}  // namespace souple::host::test_host_session
