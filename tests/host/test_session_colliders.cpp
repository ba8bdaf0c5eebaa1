#include "souple/geometry/builders.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <gtest/gtest.h>

namespace souple::host::test_host_session_colliders {

float lowest(Session& session, Handle object) {
  const std::vector<float> drawn_now = drawn(session, object);
  float y = drawn_now[1];
  for (std::size_t k = 1; k < drawn_now.size(); k += 3) y = std::min(y, drawn_now[k]);
  return y;
}

TEST(Session, HasCollidersOfTheHost) {
  const Corners sheet(grid(9, 9, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
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

TEST(Session, ACapsuleThatMovesTakesTheClothAlong) {
  const Corners sheet(grid(9, 9, 1.0));
  Player host;
  Session& s = host.session;
  s.set_gravity(0, 0, 0);
  const Handle cloth = s.add_cloth(sheet.soup());
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

TEST(Session, ConnectionsAndPinsMoveVertices) {
  const Corners sheet(grid(5, 5, 1.0)), block(box({0.2, 0.2, 0.2}, {1, 1, 1}));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  MeshOptions options;
  const At above(0.5f, 0.3f, 0.5f);
  options.transform = above;
  const Handle post = s.add_obstacle(block.soup(), options);
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

TEST(Session, WindReachesObjectsByTheirExposure) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  s.set_gravity(0, 0, 0);
  MeshOptions beside;
  const At apart(3, 0, 0);
  beside.transform = apart;
  const Handle open = s.add_cloth(sheet.soup()), sheltered = s.add_cloth(sheet.soup(), beside);
  s.set_wind(0, 5, 0);
  EXPECT_EQ(s.wind()[1], 5);
  s.set_wind_exposure(sheltered, 0);
  for (int run = 0; run < 2; ++run) {
    host.play(3);
    EXPECT_GT(lowest(s, open), 1e-3f);
    EXPECT_EQ(lowest(s, sheltered), 0);
    s.reset();
  }
}

}  // namespace souple::host::test_host_session_colliders
