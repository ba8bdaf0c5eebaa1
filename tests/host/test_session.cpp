#include "souple/host/session.h"
#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/soups.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

namespace souple::host {
namespace {

constexpr double dt = 1.0 / 60;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
const std::string scenes = std::string(SOUPLE_SOURCE_DIR) + "/scenes/";

/// A host that plays: its clock goes by twice the frame's length, as Radium's.
struct Player {
  Session session;
  double now = 0;

  void play(int frames) {
    for (int i = 0; i < frames; ++i) ASSERT_EQ(session.advance(now += 2 * dt, dt), Tick::step) << i;
  }
  std::vector<std::string> paused_frame() {
    session.advance(now, dt);
    return session.take_messages();
  }
};

std::vector<float> drawn(Session& session, Handle object) {
  std::vector<float> positions(3 * session.object(object).vertex_count);
  session.write(object, {positions.data(), nullptr}, positions.size() / 3);
  return positions;
}

Vec3f vertex(const std::vector<float>& positions, std::size_t v) {
  return {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
}

bool same_bits(const std::vector<float>& a, std::span<const Vec3f> b) {
  return a.size() == 3 * b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

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
  const float above[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.125f, 1, 0, 1};
  Player host;
  MeshOptions options;
  options.transform = above;
  options.preset = "silk";
  const Handle cloth = host.session.add_cloth(sheet.soup(), options);
  MeshOptions soft;
  soft.lattice_tets = 300;
  const Handle body = host.session.add_soft_body(ball.soup(), soft);
  host.session.add_obstacle(post.soup());
  host.play(40);

  World world;
  TriangleMesh placed = SoupWeld(sheet.soup()).mesh();
  for (Vec3d& x : placed.positions) x += Vec3d(0.125, 1, 0);
  const ObjectId pure = world.add_cloth(placed, material::silk);
  const ObjectId pure_body = world.add_soft_body(SoupWeld(ball.soup()).mesh(), {}, {.cells = 300});
  world.add_obstacle(SoupWeld(post.soup()).mesh());
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_EQ(host.session.hash(), world.hash());

  // What is drawn: each corner where its particle is, in the mesh's own coordinates.
  const SoupWeld weld(sheet.soup());
  const std::vector<float> x = drawn(host.session, cloth);
  for (std::size_t v = 0; v < sheet.count(); ++v) {
    const Vec3f& p = world.positions(pure)[weld.particle_of()[v]];
    EXPECT_EQ(vertex(x, v), Vec3f(Vec3d(p) - Vec3d(0.125, 1, 0)));
  }
  const SoupWeld ball_weld(ball.soup());
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
  const std::uint64_t seven = s.hash();

  EXPECT_EQ(s.advance(host.now = 0, dt), Tick::reset);
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

TEST(Session, AResetKeepsWhatTheUserChanged) {
  const Corners sheet(grid(7, 7, 1.0));
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "flag.json");
  const Handle flag = s.objects()[0].handle;
  const float above[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 9, 0, 1};
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

TEST(Session, AStepThatGoesBadPausesAndSaysSo) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  host.session.add_cloth(sheet.soup());
  host.session.set_gravity(0, -3e38f, 0);
  for (int i = 0; i < 120; ++i) host.session.advance(host.now += dt, dt);
  EXPECT_FALSE(host.session.playing());
  const std::vector<std::string> messages = host.session.take_messages();
  ASSERT_FALSE(messages.empty());
  EXPECT_NE(messages.back().find("cloth"), std::string::npos) << messages.back();
  EXPECT_TRUE(host.session.take_messages().empty());
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

// --- what goes, and what fails to come

/// Wherever it goes, what is left moves on, and a reset brings back nothing that was removed.
TEST(Session, ObjectsAreRemovedDuringPlay) {
  const Corners sheet(grid(7, 7, 1.0)), ball(sphere(1, 0.2)), block(box({1, 1, 1}, {1, 1, 1}));
  const float above[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.8f, 0, 1};
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "flag.json");
  const Handle flag = s.objects()[0].handle;
  const Handle table = s.add_obstacle(block.soup());
  MeshOptions options;
  options.transform = above;
  const Handle pinned = s.add_cloth(sheet.soup(), options);
  options.lattice_tets = 100;
  const Handle soft = s.add_soft_body(ball.soup(), options);
  s.set_pinned(pinned, 0, true);
  s.set_pinned(soft, 0, true);
  host.play(5);
  std::size_t left = 4;
  for (const Handle gone : {pinned, flag, table, soft}) {
    const std::uint64_t version = s.version();
    s.remove(gone);
    EXPECT_GT(s.version(), version);
    EXPECT_FALSE(s.contains(gone));
    EXPECT_EQ(s.objects().size(), --left);
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
  const float above[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.8f, 0, 1};
  MeshOptions options;
  options.transform = above;
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

TEST(Session, RemovingWhatIsHeldLetsGoAndRemovingAnotherDoesNot) {
  const Corners sheet(grid(7, 7, 1.0));
  const float aside[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1};
  Player host;
  Session& s = host.session;
  s.set_gravity(0, 0, 0);
  const Handle other = s.add_cloth(sheet.soup());
  MeshOptions options;
  options.transform = aside;
  const Handle held = s.add_cloth(sheet.soup(), options);
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
  s.drag({eye, start - eye});
  s.release();
  host.play(2);
  s.reset();
  EXPECT_TRUE(s.objects().empty());
  host.play(2);
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

// --- the mouse

TEST(Session, AVertexIsDraggedAlongThePlaneAcrossTheView) {
  const Corners sheet(grid(9, 9, 1.0));
  Player host;
  Session& s = host.session;
  s.set_gravity(0, 0, 0);
  const Handle cloth = s.add_cloth(sheet.soup());
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
  s.drag({eye, goal - eye});
  host.play(1);
}

TEST(Session, ATriangleIsTakenWhereTheRayMeetsIt) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const Vec3f centre = (sheet.at(9) + sheet.at(10) + sheet.at(11)) / 3.0f, eye = centre + Vec3f(1, 2, 0);
  ASSERT_TRUE(s.grab_triangle(cloth, 3, {eye, centre - eye}));
  EXPECT_LT(length(s.grabbed_point() - centre), 1e-5f);
  // Edge-on: no point in the plane, so a corner.
  ASSERT_TRUE(s.grab_triangle(cloth, 3, {centre + Vec3f(5, 0, 0), {-1, 0, 0}}));
  EXPECT_LT(length(s.grabbed_point() - centre), 0.3f);
  expect_error([&] { s.grab_triangle(cloth, 32, {eye, centre - eye}); }, {"cloth", "triangle 32", "32"});
  expect_error([&] { s.grab_vertex(cloth, 96, {eye, centre - eye}); }, {"cloth", "vertex 96", "96"});
  expect_error([&] { s.grab_vertex(cloth, 0, {eye, {}}); }, {"direction"});
  expect_error([&] { s.grab_vertex(cloth, 0, {eye, {nan, 0, 0}}); }, {"not finite"});
}

TEST(Session, AHostThatCannotPickGrabsByARay) {
  const Corners sheet(grid(5, 5, 1.0)), block(box({1, 1, 1}, {1, 1, 1}));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  MeshOptions aside;
  const float matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 0, 0, 1};
  aside.transform = matrix;
  const Handle post = s.add_obstacle(block.soup(), aside);
  EXPECT_TRUE(s.grab({{0.1f, 2, 0.1f}, {0, -1, 0}}));
  EXPECT_LT(length(s.grabbed_point() - Vec3f(0.1f, 0, 0.1f)), 1e-5f);
  EXPECT_FALSE(s.grab({{5, 2, 0}, {0, -1, 0}}));
  EXPECT_FALSE(s.grab({{9, 2, 0}, {0, -1, 0}}));
  EXPECT_FALSE(s.grab_vertex(post, 0, {{9, 2, 0}, {0, -1, 0}}));
  s.set_pinned(cloth, 0, true);
  EXPECT_FALSE(s.grab_vertex(cloth, 0, {{0, 2, 0}, {0, -1, 0}}));
}

// --- where the host has its meshes

TEST(Session, AnObstacleThatTheHostMovesCarriesWhatLiesOnIt) {
  const Corners sheet(grid(9, 9, 0.5)), block(box({2, 0.2, 2}, {4, 1, 4}));
  const float above[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.12f, 0, 1};
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
}

// --- panels

TEST(Session, ParametersAreThoseOfTheMaterial) {
  const Corners sheet(grid(9, 9, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  const std::vector<Parameter> parameters = s.parameters(cloth);
  ASSERT_FALSE(parameters.empty());
  for (const Parameter& p : parameters) {
    EXPECT_LT(p.least, p.most) << p.name;
    EXPECT_TRUE(!p.logarithmic || p.least > 0) << p.name;
    EXPECT_TRUE(p.value == 0 || (p.value >= p.least * 0.999 && p.value <= p.most)) << p.name;
    s.set_parameter(cloth, p.name, std::sqrt(std::max(p.least, 1e-6) * p.most));
  }
  EXPECT_EQ(parameters[0].name, "areal_density");
  EXPECT_EQ(parameters[0].unit, "kg/m\xc2\xb2");
  const auto has = [&](const char* name) {
    const std::vector<Parameter> now = s.parameters(cloth);
    return std::any_of(now.begin(), now.end(), [&](const Parameter& p) { return p.name == name; });
  };
  EXPECT_FALSE(has("pbd_stretch"));
  s.set_mode("pbd");
  EXPECT_TRUE(has("pbd_stretch"));
  s.set_preset(cloth, "denim");
  EXPECT_FLOAT_EQ(static_cast<float>(s.parameters(cloth)[0].value), material::denim.areal_density);
  const std::vector<std::string> presets = s.presets(cloth);
  EXPECT_NE(std::find(presets.begin(), presets.end(), "cotton"), presets.end());
  EXPECT_EQ(std::find(presets.begin(), presets.end(), "jelly"), presets.end());
  expect_error([&] { s.set_parameter(cloth, "areal_densty", 1); }, {"areal_densty", "areal_density"});
  expect_error([&] { s.set_parameter(cloth, "areal_density", -1); }, {"cloth", "areal_density"});
  expect_error([&] { s.set_parameter(cloth, "friction", std::nan("")); }, {"cloth", "friction"});
  expect_error([&] { s.set_preset(cloth, "jelly"); }, {"jelly", "cloth"});
  expect_error([&] { s.set_mode("xpdb"); }, {"xpdb", "xpbd"});
  expect_error([&] { s.set_substeps(0); }, {"substeps"});
  EXPECT_EQ(s.substeps(), 10);
}

TEST(Session, StatisticsAreOfTheLastStep) {
  Player host;
  host.session.open_scene(scenes + "sand_pile.json");
  host.play(2);
  const Statistics statistics = host.session.statistics();
  EXPECT_EQ(statistics.steps, 2u);
  EXPECT_NEAR(statistics.time, 2 * dt, 1e-12);
  EXPECT_GT(statistics.particles, 100u);
  EXPECT_GT(statistics.milliseconds, 0);
  EXPECT_EQ(statistics.stages.size(), stage_count);
  EXPECT_NE(statistics.text().find("step 2"), std::string::npos);
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
TEST(Session, ColoursAreThoseOfTheSceneFile) {
  Player host;
  Session& s = host.session;
  s.open_scene(scenes + "everything_together.json");
  const std::array<float, 3> crimson{184 / 255.0f, 50 / 255.0f, 74 / 255.0f};
  const std::array<float, 3> wood{169 / 255.0f, 133 / 255.0f, 95 / 255.0f};
  std::size_t coloured = 0;
  for (const ObjectInfo& info : s.objects()) {
    EXPECT_EQ(info.has_colour, info.kind == Kind::cloth || info.kind == Kind::soft_body) << info.name;
    if (info.name == "flag") {
      EXPECT_EQ(info.colour, crimson);
      ++coloured;
    }
  }
  for (const ColliderShape& shape : s.colliders()) {
    EXPECT_EQ(shape.has_colour, shape.name == "table") << shape.name;
    if (shape.name == "table") {
      EXPECT_EQ(shape.colour, wood);
      ++coloured;
    }
  }
  EXPECT_EQ(coloured, 2u);
  EXPECT_FALSE(s.object(s.add_cloth(Corners(grid(3, 3, 1.0)).soup())).has_colour);
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
  host.session.open_scene(scenes + "everything_together.json");
  World world = build_world(load_scene(scenes + "everything_together.json"));
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
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"tolerance"});
  float matrix[16] = {};
  options = {};
  options.transform = matrix;
  expect_error([&] { s.add_cloth(sheet.soup(), options); }, {"cloth: transform"});
  expect_error([&] { s.set_transform(cloth, matrix); }, {"cloth: transform"});
  std::vector<float> buffer(3 * sheet.count());
  expect_error([&] { s.write(cloth, {buffer.data(), nullptr}, sheet.count() - 1); }, {"cloth", "95", "96"});
  sheet.positions[7] = nan;
  expect_error([&] { s.add_cloth(sheet.soup()); }, {"cloth", "vertex 2", "not finite"});
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

}  // namespace
}  // namespace souple::host
