#include "souple/geometry/builders.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <gtest/gtest.h>

namespace souple::host::test_host_session_mouse {

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
  EXPECT_EQ(s.drag_target(), Vec3f());
  s.drag({eye, goal - eye});
  host.play(1);
}

TEST(Session, ATriangleIsTakenWhereTheRayMeetsIt) {
  const Corners sheet(grid(5, 5, 1.0));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
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

TEST(Session, AHostThatCannotPickGrabsByARay) {
  const Corners sheet(grid(5, 5, 1.0)), block(box({1, 1, 1}, {1, 1, 1}));
  Player host;
  Session& s = host.session;
  const Handle cloth = s.add_cloth(sheet.soup());
  MeshOptions aside;
  const At matrix(9, 0, 0);
  aside.transform = matrix;
  const Handle post = s.add_obstacle(block.soup(), aside);
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

}  // namespace souple::host::test_host_session_mouse
