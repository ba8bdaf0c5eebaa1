#include "souple/math/vec3.h"

#include <gtest/gtest.h>

namespace souple::test_math_rounding {

// The rounding remainder of a double as a float. g++ 12 gives 0 here when it vectorizes straight-line code,
// which the build turns off: positions would lose the remainder that offsets keep.
Vec3f remainder_of(const Vec3d& x) {
  return Vec3f(x - Vec3d(Vec3f(x)));
}

TEST(Rounding, TheRemainderOfAFloatSurvivesTheOptimizer) {
  volatile double x = -0.2, y = 0.6, z = 1000.1;
  const Vec3f lost = remainder_of({x, y, z});
  EXPECT_EQ(lost.x, static_cast<float>(-0.2 - static_cast<double>(-0.2f)));
  EXPECT_EQ(lost.y, static_cast<float>(0.6 - static_cast<double>(0.6f)));
  EXPECT_EQ(lost.z, static_cast<float>(1000.1 - static_cast<double>(1000.1f)));
  EXPECT_NE(lost.x, 0);
}

}  // namespace souple::test_math_rounding
