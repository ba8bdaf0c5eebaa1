#include "souple/geometry/builders.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

namespace souple::host::test_host_session_contents {

/// Wherever it goes, what is left moves on, and a reset brings back nothing that was removed.
TEST(Session, ObjectsAreRemovedDuringPlay) {
  const Corners sheet(grid(7, 7, 1.0)), ball(sphere(1, 0.2)), block(box({1, 1, 1}, {1, 1, 1}));
  const At above(0, 0.8f, 0);
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
  const At above(0, 0.8f, 0);
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
  const At aside(3, 0, 0);
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

TEST(Session, StatisticsCountWhatIsThere) {
  const Corners sheet(grid(3, 3, 1.0));
  Session s;
  const Handle cloth = s.add_cloth(sheet.soup());
  s.add_cloth(sheet.soup());
  EXPECT_EQ(s.statistics().objects, 2u);
  s.remove(cloth);
  EXPECT_EQ(s.statistics().objects, 1u);
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

}  // namespace souple::host::test_host_session_contents
