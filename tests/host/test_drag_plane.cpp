#include "souple/host/drag_plane.h"
#include "tests/expect_error.h"

#include <limits>

#include <gtest/gtest.h>

namespace souple::host::test_host_drag_plane {

constexpr Vec3f eye{0, 0, 5}, ahead{0, 0, -1};

/// Through (x, y) at the depth of the origin.
Ray through(float x, float y) {
  return {eye, Vec3f(x, y, 0) - eye};
}

TEST(DragPlane, ThePointStaysUnderTheMouseAndAtItsDepth) {
  DragPlane drag({0.5f, 0.25f, 0}, through(0.5f, 0.25f), ahead);
  EXPECT_EQ(drag.point(), Vec3f(0.5f, 0.25f, 0));
  EXPECT_LT(length(drag.drag(through(0.5f, 0.25f)) - Vec3f(0.5f, 0.25f, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(-2, 1)) - Vec3f(-2, 1, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(0.5f, 0.25f)) - Vec3f(0.5f, 0.25f, 0)), 1e-6f);  // and back
}

/// A picked vertex lies beside the ray: taking hold of it moves nothing, and dragging moves it as the mouse.
TEST(DragPlane, APointBesideTheRayStaysBesideTheMouse) {
  DragPlane drag({0.6f, 0.1f, 0}, through(0.5f, 0), ahead);
  EXPECT_LT(length(drag.drag(through(0.5f, 0)) - Vec3f(0.6f, 0.1f, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(1.5f, 0)) - Vec3f(1.6f, 0.1f, 0)), 1e-6f);
}

TEST(DragPlane, WithoutAViewThePlaneIsAcrossTheRay) {
  const Vec3f point{3, 0, 1};
  const Ray pick{eye, point - eye};
  DragPlane drag(point, pick);
  const Vec3f moved = drag.drag({eye, point + Vec3f(0.1f, 0.4f, 0) - eye});
  EXPECT_NEAR(dot(moved - point, normalized(pick.direction)), 0, 1e-5f);
  EXPECT_GT(length(moved - point), 0.3f);
}

TEST(DragPlane, RaysThatMissThePlaneLeaveThePointWhereItWas) {
  DragPlane drag({0, 0, 0}, through(0, 0), ahead);
  const Vec3f last = drag.drag(through(1, 1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& direction :
       {Vec3f(1, 0, 0), Vec3f(1, 0, -0.001f), Vec3f(0, 0, 1), Vec3f(), Vec3f(nan, 0, -1)})
    EXPECT_EQ(drag.drag({eye, direction}), last);
  EXPECT_EQ(drag.drag({{nan, 0, 0}, ahead}), last);
}

TEST(DragPlane, RefusesWhatIsNoRay) {
  const float infinite = std::numeric_limits<float>::infinity();
  expect_error([] { DragPlane({}, {eye, {}}); }, {"direction"});
  expect_error([&] { DragPlane({infinite, 0, 0}, through(0, 0)); }, {"not finite"});
  expect_error([&] { DragPlane({}, {{0, infinite, 0}, ahead}); }, {"not finite"});
}

}  // namespace souple::host::test_host_drag_plane
