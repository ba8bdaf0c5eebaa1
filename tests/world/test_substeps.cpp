#include "souple/souple.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_world_substeps {

/// Advances by one substep of `settings`, like a viewer: a step of dt / substeps with one substep.
void advance_one_substep(World& world, double dt) {
  const Settings settings = world.settings();
  Settings one = settings;
  one.substeps = 1;
  world.set_settings(one);
  world.step(dt / settings.substeps);
  world.set_settings(settings);
}

double largest_difference(const World& a, const World& b) {
  double largest = 0;
  for (const ObjectId object : a.objects())
    for (std::size_t i = 0; i < a.positions(object).size(); ++i)
      largest = std::max(largest, length(Vec3d(a.positions(object)[i]) - Vec3d(b.positions(object)[i])));
  return largest;
}

/// Without contacts a step does not depend on its division. Ten steps of one substep equal one step of ten bitwise,
/// including pins and attachments with targets.
TEST(Substeps, OneByOneEqualAStepToTheBit) {
  const auto build = [] {
    World world({.wind = {.velocity = {1, 0, 0}, .gust = 0.5f}});
    const ObjectId cloth = world.add_cloth(grid(12, 12, 1));
    world.pin(cloth, vertices({0}), [](std::uint32_t, double t) { return Vec3d(-0.5, std::sin(t), -0.5); });
    world.attach(cloth, vertices({143}), {}, 1e-3f);
    world.add_soft_body(sphere(2, 0.2), {}, {.cells = 60}, {.transform = {.translation = {3, 0, 0}}});
    return world;
  };
  World whole = build(), cut = build();
  for (int frame = 0; frame < 30; ++frame) {
    whole.step(1.0 / 60);
    for (int i = 0; i < 10; ++i) advance_one_substep(cut, 1.0 / 60);
    EXPECT_EQ(cut.settings().substeps, 10);
  }
  EXPECT_EQ(largest_difference(whole, cut), 0);
  EXPECT_NEAR(whole.time(), cut.time(), 1e-12);
}

/// With contacts the same holds unless the broad phase, which then runs ten times instead of once, finds
/// other candidates.
TEST(Substeps, OneByOneAreCloseWithContacts) {
  const auto build = [] {
    World world;
    world.add_cloth(grid(12, 12, 1), {}, {.transform = {.translation = {0, 0.6, 0}}});
    world.add_collider(Sphere{.radius = 0.4f});
    world.add_collider(Plane{.offset = -0.4f});
    return world;
  };
  World whole = build(), cut = build();
  for (int frame = 0; frame < 30; ++frame) {
    whole.step(1.0 / 60);
    for (int i = 0; i < 10; ++i) advance_one_substep(cut, 1.0 / 60);
  }
  EXPECT_GT(whole.report().contacts, 10u);
  EXPECT_LT(largest_difference(whole, cut), 1e-4);
}

}  // namespace souple::test_world_substeps
