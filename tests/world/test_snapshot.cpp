#include "souple/souple.h"
#include "tests/expect_error.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_world_snapshot {

World everything() {
  World world({.wind = {.velocity = {3, 0, 0}, .gust = 0.5f}});
  const ObjectId cloth = world.add_cloth(grid(9, 9, 1), {}, {.transform = {.translation = {0, 1, 0}}});
  world.pin(cloth, vertices({0, 8}));
  world.add_soft_body(sphere(2, 0.2), {}, {.cells = 200}, {.transform = {.translation = {0, 0.5, 0}}});
  std::vector<Vec3d> grains;
  grains.reserve(60);
  for (int i = 0; i < 60; ++i) {
    const int layer = i / 4;
    grains.push_back({0.3 + 0.03 * (i % 4), 0.03 * layer, 0.03 * (i % 3)});
  }
  world.add_grains(grains, {}, {.velocity = {1, 0, 0}});
  world.add_collider(Plane{});
  return world;
}

TEST(Snapshot, ContinuesBitwiseTheSame) {
  World a = everything(), b = everything();
  for (int i = 0; i < 60; ++i) a.step(1.0 / 60);
  ASSERT_GT(a.report().contacts, 20u) << "the heap has to touch, or friction is not tested";
  const Snapshot snapshot = a.snapshot();
  b.restore(snapshot);
  const auto spin_a = a.angular_velocities(a.objects()[2]), spin_b = b.angular_velocities(b.objects()[2]);
  ASSERT_EQ(spin_a.size(), 60u);
  EXPECT_TRUE(std::equal(spin_a.begin(), spin_a.end(), spin_b.begin()));
  EXPECT_TRUE(std::any_of(spin_a.begin(), spin_a.end(), [](const Vec3f& w) { return length(w) > 0; }));
  for (int i = 0; i < 20; ++i) {
    a.step(1.0 / 60);
    b.step(1.0 / 60);
    ASSERT_EQ(a.hash(), b.hash()) << "step " << i;
  }
  a.restore(snapshot);
  for (int i = 0; i < 20; ++i) a.step(1.0 / 60);
  EXPECT_EQ(a.hash(), b.hash()) << "rolled back";
}

TEST(Snapshot, ADamagedOrForeignOneChangesNothing) {
  World world = everything();
  world.step(1.0 / 60);
  const std::uint64_t before = world.hash();
  Snapshot damaged = world.snapshot();
  damaged.bytes[damaged.bytes.size() / 2] ^= std::byte{1};
  expect_error([&] { world.restore(damaged); }, {"damaged"});
  damaged.bytes.resize(10);
  expect_error([&] { world.restore(damaged); }, {"cut short"});
  World other;
  other.add_cloth(grid(3, 3, 1));
  expect_error([&] { world.restore(other.snapshot()); }, {"other objects"});
  EXPECT_EQ(world.hash(), before);
}

}  // namespace souple::test_world_snapshot
