#include "souple/collision/collider_motion.h"
#include "souple/error.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace souple::test_collision_collider_motion {

const Quatd quarter = Quatd::from_axis_angle({0, 1, 0}, pi / 2);

TEST(ColliderMotion, KeyframesMoveLinearlyTurnEvenlyAndStayAtTheEnds) {
  const ColliderMotion motion = ColliderMotion::keyframes({{1, {0, 0, 0}, {}}, {3, {4, 0, 2}, quarter}});
  EXPECT_FALSE(motion.is_static());
  EXPECT_EQ(motion.at(-5).translation, (Vec3d{0, 0, 0}));
  EXPECT_EQ(motion.at(9).translation, (Vec3d{4, 0, 2}));
  EXPECT_EQ(motion.at(2).translation, (Vec3d{2, 0, 1}));
  for (const double s : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const Vec3d turned = motion.at(1 + 2 * s).direction({1, 0, 0});
    EXPECT_NEAR(atan2(-turned.z, turned.x), s * pi / 2, 1e-12);
  }
}

TEST(ColliderMotion, RotationTakesTheShorterArc) {
  const Quatd same_turn{-quarter.x, -quarter.y, -quarter.z, -quarter.w};
  const ColliderMotion motion = ColliderMotion::keyframes({{0, {}, {}}, {1, {}, same_turn}});
  const Vec3d turned = motion.at(0.5).direction({1, 0, 0});
  EXPECT_NEAR(atan2(-turned.z, turned.x), pi / 4, 1e-12);
}

TEST(ColliderMotion, ALoopRepeats) {
  const ColliderMotion motion =
      ColliderMotion::keyframes({{1, {0, 0, 0}, {}}, {2, {1, 0, 0}, {}}, {3, {0, 0, 0}, {}}}, true);
  for (const double t : {-0.75, 1.25, 3.25, 201.25}) EXPECT_NEAR(motion.at(t).translation.x, 0.25, 1e-9) << t;
}

TEST(ColliderMotion, OnlyALoopWhoseEndsDifferJumps) {
  const std::vector<PoseKey> there{{0, {0, 0, 0}, {}}, {1, {1, 0, 0}, {}}};
  std::vector<PoseKey> and_back = there;
  and_back.push_back({2, {0, 0, 0}, {}});
  EXPECT_TRUE(ColliderMotion::keyframes(there, true).jumps(2.99, 3.01));
  EXPECT_FALSE(ColliderMotion::keyframes(there, true).jumps(2.5, 2.6));
  EXPECT_FALSE(ColliderMotion::keyframes(there).jumps(0.99, 1.01));
  EXPECT_FALSE(ColliderMotion::keyframes(and_back, true).jumps(1.99, 2.01));
}

TEST(ColliderMotion, BadKeysAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ColliderMotion::keyframes({}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{1, {}, {}}, {1, {}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{nan, {}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::keyframes({{0, {nan, 0, 0}, {}}}), Error);
  EXPECT_THROW(ColliderMotion::callback(nullptr), Error);
  EXPECT_THROW(ColliderMotion::callback([=](double) { return Transform{{nan, 0, 0}, {}, 1}; }).at(0), Error);
}

TEST(ColliderMotion, ACallbackIsAskedAndMayThrow) {
  const auto rise = ColliderMotion::callback([](double t) {
    if (t > 5) throw std::runtime_error("too late");
    return Transform{{0, t, 0}, {0, 0, 0, 2}, 3};
  });
  EXPECT_EQ(rise.at(2).point({1, 0, 0}), (Vec3d{1, 2, 0}));  // rigid: the callback's scale is ignored
  EXPECT_THROW(rise.at(6), std::runtime_error);
}

}  // namespace souple::test_collision_collider_motion
