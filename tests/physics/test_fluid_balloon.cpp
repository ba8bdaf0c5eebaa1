#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/paths.h"

#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_balloon {

/// Winding number of a surface around a point: 1 inside, 0 outside; hair-thin seams change little. Computed from the
/// solid angles of its triangles (Van Oosterom and Strackee 1983).
double winding(const World& world, ObjectId surface, const Vec3f& point) {
  const auto x = world.positions(surface);
  double sum = 0;
  for (const Triangle& t : world.triangles(surface)) {
    const Vec3d a(x[t[0]] - point), b(x[t[1]] - point), c(x[t[2]] - point);
    const double la = length(a), lb = length(b), lc = length(c);
    sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(a, c) * lb);
  }
  return sum / 6.283185307179586;
}

std::size_t outside(const World& world, ObjectId water, ObjectId balloon) {
  std::size_t count = 0;
  for (const Vec3f& point : world.positions(water))
    if (!(std::fabs(winding(world, balloon, point)) > 0.5)) ++count;
  return count;
}

// The shipped scene: the seams hold all water for 0.8 s, and none of it half a second later.
TEST(FluidBalloon, HoldsWaterUntilItsSeamsOpenSlow) {
  const std::filesystem::path file = source_path("scenes/water_balloon.json");
  World world = build_world(load_scene(file));
  const ObjectId water = world.find_object("water"), balloon = world.find_object("balloon");
  const std::size_t particles = world.positions(water).size();
  for (int frame = 1; frame <= 48; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    if (frame % 12 != 0) continue;
    EXPECT_EQ(outside(world, water, balloon), 0u) << "frame " << frame;
  }
  for (int frame = 49; frame <= 78; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_GT(outside(world, water, balloon), particles * 9 / 10);
}

}  // namespace souple::test_physics_fluid_balloon
