#include "tests/collision/random.h"
#include "tests/contacts/mini_world.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace souple::test_contacts_particle_contacts {

using test::MiniWorld;
using test::Random;

Vec3d momentum(const MiniWorld& world) {
  Vec3d sum;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    sum += Vec3d(world.velocity[i].xyz()) / double(world.position[i].w);
  return sum;
}

double energy(const MiniWorld& world) {
  double sum = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    sum += 0.5 * length_squared(Vec3d(world.velocity[i].xyz())) / double(world.position[i].w);
  return sum;
}

// Newton's law: momentum is conserved, the relative velocity becomes -e times its old value, and the energy
// falls by 1/2 mu (1 - e^2) v^2.
TEST(ParticleContacts, HeadOnCollisionKeepsMomentumAndTheEnergyLaw) {
  for (const float e : {0.0f, 0.5f, 1.0f}) {
    for (const float speed : {0.5f, 3.0f, 40.0f}) {
      MiniWorld world;
      world.gravity = {};
      world.add({-0.1, 0, 0}, 0.02f, 1, {speed, 0, 0});
      world.add({0.1, 0, 0}, 0.03f, 3, {-speed, 0, 0});
      world.end_object({0.5f, std::nullopt, e}).self_collision = true;
      const Vec3d before = momentum(world);
      for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60, 10);
      EXPECT_LT(length(momentum(world) - before), 1e-5 * 4 * double(speed));
      const double v = double(world.velocity[1].x - world.velocity[0].x);
      EXPECT_NEAR(v, double(2 * speed * e), 0.01 * double(speed)) << e << " " << speed;
      const double kinetic = 0.5 * 4 * 0.25 * double(speed * speed) + 0.5 * 0.75 * v * v;
      EXPECT_NEAR(energy(world), kinetic, 0.01 * kinetic);
    }
  }
}

// Frictionless, elastic and off center: the impulse is along the line of centers at contact, sin(angle) = b /
// (2 r).
TEST(ParticleContacts, ObliqueFastCollisionLeavesAlongTheLineOfCenters) {
  MiniWorld world;
  world.gravity = {};
  world.add({-0.052, 0.01, 0}, 0.01f, 1, {6, 0, 0});
  world.add({0, 0, 0}, 0.01f, 1);
  world.end_object({0, std::nullopt, 1}).self_collision = true;
  for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60, 10);
  const Vec3d v(world.velocity[1].xyz());
  EXPECT_NEAR(std::atan2(-v.y, v.x), std::asin(0.5), 0.02);
  EXPECT_NEAR(length(v), 6 * std::cos(std::asin(0.5)), 0.06);
  EXPECT_NEAR(energy(world), 18, 0.02 * 18);
}

void drop_grains(MiniWorld& world, int columns, int layers, float radius, const Vec3d& origin) {
  Random random(1);
  const double pitch = 2.05 * double(radius);
  for (int y = 0; y < layers; ++y)
    for (int x = 0; x < columns; ++x)
      for (int z = 0; z < columns; ++z)
        world.add(origin + Vec3d{x * pitch, double(radius) + y * pitch, z * pitch} +
                      random.point(-0.02, 0.02) * double(radius),
                  radius, 0.01f);
  world.end_object({0.5f, std::nullopt, 0}, "grains").self_collision = true;
  world.add_collider(Plane{}, {0.5f, std::nullopt, 0}, ColliderMotion::fixed({origin, {}, 1}));
}

double deepest_overlap(const MiniWorld& world, double floor) {
  double deepest = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i) {
    deepest = std::max(deepest, floor + double(world.radius[i]) - world.at(i).y);
    for (std::size_t j = i + 1; j < world.position.size(); ++j)
      deepest =
          std::max(deepest, double(world.radius[i] + world.radius[j]) - length(world.at(i) - world.at(j)));
  }
  return deepest;
}

// 10 substeps of one iteration. The heap comes to rest, up to the speed that gravity adds in two substeps,
// and stays.
TEST(ParticleContacts, APileOfGrainsSettlesAndDoesNotMelt) {
  MiniWorld world;
  drop_grains(world, 6, 8, 0.01f, {});
  for (std::size_t i = 0; i < world.position.size(); ++i) world.velocity[i].x = float(i % 7) * 0.05f;
  std::vector<double> heights;
  for (int frame = 0; frame < 360; ++frame) {
    world.step(1.0 / 60, 10);
    if (frame % 180 != 179) continue;
    double highest = 0;
    for (std::size_t i = 0; i < world.position.size(); ++i) highest = std::max(highest, world.at(i).y);
    heights.push_back(highest);
  }
  EXPECT_LT(deepest_overlap(world, 0), 0.02 * 0.02);
  EXPECT_GT(heights[0], 0.08);
  EXPECT_GT(heights[1], 0.95 * heights[0]);
  double fastest = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    fastest = std::max(fastest, double(length(world.velocity[i].xyz())));
  EXPECT_LT(fastest, 2 * 9.81 / 600);
}

TEST(ParticleContacts, MemoryCarriesARunOnBitForBit) {
  MiniWorld world;
  drop_grains(world, 4, 5, 0.01f, {});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);
  MiniWorld resumed = world;
  resumed.on_colliders = {};
  resumed.on_particles = {};
  resumed.on_particles.set_friction_cache(world.on_particles.friction_cache());
  EXPECT_FALSE(world.on_particles.friction_cache().empty());
  for (int frame = 0; frame < 30; ++frame) {
    world.step(1.0 / 60, 10);
    resumed.step(1.0 / 60, 10);
  }
  EXPECT_EQ(world.hash(), resumed.hash());
}

TEST(ParticleContacts, ErasingParticlesRenumbersTheMemory) {
  ParticleContacts contacts;
  const CachedFriction friction[] = {
      {0, 4, {{1, 0, 0}, {}}}, {2, 5, {{0, 1, 0}, {}}}, {4, 7, {{0, 0, 1}, {1, 2, 3}}}};
  contacts.set_friction_cache(friction);
  contacts.erase_particles(1, 4);
  ASSERT_EQ(contacts.friction_cache().size(), 2u);
  EXPECT_EQ(contacts.friction_cache()[0].j, 1u);
  EXPECT_EQ(contacts.friction_cache()[1].i, 1u);
  EXPECT_EQ(contacts.friction_cache()[1].j, 4u);
}

TEST(ParticleContacts, AnUnsupportedClusterKeepsItsMomentum) {
  MiniWorld world;
  world.gravity = {};
  Random random(9);
  while (world.position.size() < 300) {
    const Vec3d x = random.point(-0.12, 0.12);
    bool free = true;
    for (std::size_t i = 0; i < world.position.size(); ++i) free = free && length(world.at(i) - x) > 0.0201;
    if (!free) continue;
    world.add(x, 0.01f, float(random.uniform(0.005, 0.02)), Vec3f(x * -5.0 + random.point(-0.2, 0.2)));
  }
  world.end_object({0.4f, std::nullopt, 0.3f}).self_collision = true;
  const Vec3d before = momentum(world);
  double scale = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    scale += double(length(world.velocity[i].xyz()) / world.position[i].w);
  const double kinetic = energy(world);
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60, 10);
    EXPECT_LT(energy(world), kinetic * 1.0001);
  }
  EXPECT_LT(length(momentum(world) - before), 1e-5 * scale);
}

// One grain on a fixed one, off center: friction holds it while tan(angle) <= mu.
TEST(ParticleContacts, FrictionHoldsAGrainOnAnother) {
  for (const float mu : {0.45f, 0.35f}) {
    MiniWorld world;
    const double angle = std::atan(0.4);
    world.add({0, 0, 0}, 0.1f, 0);
    world.add({0.2 * std::sin(angle), 0.2 * std::cos(angle), 0}, 0.1f, 1);
    world.end_object({mu, std::nullopt, 0}).self_collision = true;
    const Vec3d before = world.at(1);
    for (int frame = 0; frame < 120; ++frame) world.step(1.0 / 60, 20);
    if (mu > 0.4f) {
      EXPECT_LT(length(world.at(1) - before), 1e-4);
    } else {
      EXPECT_LT(world.at(1).y, 0);
    }
  }
}

TEST(ParticleContacts, OneKilometreFromTheOriginSettlesAlike) {
  std::vector<std::vector<Vec3d>> end;
  for (const double far : {0.0, 1024.0}) {
    const Vec3d origin{far, -far, far};
    MiniWorld world;
    drop_grains(world, 3, 3, 0.01f, origin);
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60, 10);
    end.emplace_back();
    for (std::size_t i = 0; i < world.position.size(); ++i) end.back().push_back(world.at(i) - origin);
  }
  for (std::size_t i = 0; i < end[0].size(); ++i) EXPECT_LT(length(end[0][i] - end[1][i]), 1e-4);
}

TEST(ParticleContacts, TheSameRunGivesTheSameBits) {
  std::vector<std::uint64_t> hashes;
  for (int run = 0; run < 2; ++run) {
    MiniWorld world;
    drop_grains(world, 5, 5, 0.01f, {});
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);
    hashes.push_back(world.hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// The broad phase against all pairs: different radii, distant cells, fast and slow particles, and objects
// that collide or not.
TEST(ParticleContacts, TheGridFindsEveryTouchingPair) {
  MiniWorld world;
  world.gravity = {};
  Random random(4);
  for (int object = 0; object < 3; ++object) {
    for (int k = 0; k < 700; ++k)
      world.add(random.point(-0.5, 0.5) + Vec3d{0, 0, -3}, float(random.uniform(0.004, 0.05)), 1);
    ContactObject& added = world.end_object({0.3f, std::nullopt, 0}, std::to_string(object));
    added.are_balls = true;
    added.self_collision = object == 1;
  }
  world.table.set_collide("1", "2", false);
  // Every pair nearer than 1.1 times the sum of its radii must become exactly one contact of the first
  // substep.
  std::size_t expected = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i) {
    for (std::size_t j = i + 1; j < world.position.size(); ++j) {
      const std::size_t a = i / 700, b = j / 700;
      const bool meet = (a == 0 && b > 0) || (a == 1 && b == 1);
      if (meet && length(world.at(i) - world.at(j)) < 1.1 * double(world.radius[i] + world.radius[j]))
        ++expected;
    }
  }
  world.step(1.0 / 600, 1);
  EXPECT_GT(expected, 1000u);
  EXPECT_EQ(world.on_particles.size(), expected);
  std::vector<ContactPush> events;
  world.on_particles.events(world.view(), events);
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const ContactPush& a, const ContactPush& b) {
    return std::pair(a.particle, a.other) < std::pair(b.particle, b.other);
  }));
}

}  // namespace souple::test_contacts_particle_contacts
