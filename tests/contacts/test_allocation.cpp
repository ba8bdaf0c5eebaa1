#include "tests/collision/random.h"
#include "tests/contacts/mini_world.h"
#include "tests/count_allocations.h"

#include <gtest/gtest.h>

namespace souple::test_contacts_allocation {

TEST(Contacts, AWarmStepAllocatesNothing) {
  test::MiniWorld world;
  test::Random random(2);
  for (int k = 0; k < 500; ++k) {
    const int layer = k / 100;
    const Vec3d cell{double(k % 10), double(layer), double(k / 10 % 10)};
    world.add(cell * 0.0201 + Vec3d{0, 0.01, 0} + random.point(-1e-4, 1e-4), 0.01f);
  }
  world.end_object({0.5f, std::nullopt, 0}).self_collision = true;
  world.add_collider(Plane{}, {});
  world.add_collider(Sphere{{0.1f, 0, 0.1f}, 0.02f}, {}, ColliderMotion::callback([](double t) {
                       return Transform{{0, 0.01 * std::sin(20 * t), 0}, {}, 1};
                     }));
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);

  const Substep substep{1.0f / 600, 1, Mode::small_steps};
  world.start = world.offset;
  const long before = test::allocations();
  world.begin_step(ContactStep{world.time, 1.0f / 60, 9.81f});
  for (int k = 0; k < 10; ++k) world.substep(substep);
  EXPECT_GT(world.on_particles.report().count + world.on_colliders.report().count, 300u);

  EXPECT_EQ(test::allocations() - before, 0);
}

}  // namespace souple::test_contacts_allocation
