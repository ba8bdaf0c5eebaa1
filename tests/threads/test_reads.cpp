#include "tests/threads/busy_world.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_threads_reads {

/// Data that a thread of a game reads between two steps, as one number.
std::uint64_t read_everything(const World& world, std::uint64_t start) {
  const std::vector<ObjectId> objects = world.objects();
  double sum = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const ObjectId id = objects[(k + start) % objects.size()];
    for (const Vec3f& v : world.normals(id)) sum += static_cast<double>(v.x > 0 ? 1 : 0);
    for (const Vec3f& x : world.positions(id)) sum += x.y < 0.5f ? 1 : 0;
    for (const Vec3f& v : world.velocities(id)) sum += v.y < 0 ? 1 : 0;
    sum +=
        static_cast<double>(world.angular_velocities(id).size()) + (world.kinetic_energy(id) > 0.1 ? 1 : 0);
  }
  for (int k = 0; k < 20; ++k) {
    const Vec3f origin{0.1f * static_cast<float>(k) - 1, 3, 0.02f * static_cast<float>(k)};
    sum += std::min(world.ray_cast(origin, {0, -1, 0.1f}).distance, 9.0);
    sum += world.closest_point(origin).distance;
  }
  sum += static_cast<double>(world.overlap(Sphere{.radius = 1}).size() + world.contacts().size());
  return world.hash() ^ static_cast<std::uint64_t>(sum * 1e6);
}

// The first reads after a step fill caches.
TEST(Reads, OfSeveralThreadsAgree) {
  World world = test::busy_world({.threads = 2});
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 2; ++i) world.step(1.0 / 60);
    std::vector<std::uint64_t> read(4);
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < read.size(); ++k)
      threads.emplace_back([&world, &read, k] { read[k] = read_everything(world, k); });
    for (std::thread& thread : threads) thread.join();
    for (const std::uint64_t value : read) EXPECT_EQ(value, read[0]);
  }
}

}  // namespace souple::test_threads_reads
