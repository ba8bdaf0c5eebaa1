#include "souple/math/fnv1a.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

// Snapshots that are damaged, forged, or those of other worlds: an Error in words, and an unchanged world.

namespace souple::test_world_snapshots {

using Build = std::function<void(World&)>;

World built(const Build& build) {
  World world({.substeps = 4, .threads = 1});
  build(world);
  return world;
}

/// A box on a rope, which slides along some of its vertices.
Build sliding(std::uint32_t segments, std::vector<std::uint32_t> along) {
  return [=](World& world) {
    const std::vector<Vec3d> line{{-1, 2, 0}, {1, 1.8, 0}};
    const ObjectId rope = world.add_rope(line, segments);
    world.pin(rope, vertices({0, segments}));
    const ObjectId box = world.add_rigid_body(small_box, {}, at(-0.5, 1.9, 0));
    world.add_tie(box, rope, {.point = {-0.5, 1.95, 0}, .slide = TieSlide{.along = along}});
  };
}

/// Two boxes and a third, the first joined to one of the others.
Build joined(const joint::Kind& kind, bool to_third = false) {
  return [=](World& world) {
    const ObjectId a = world.add_rigid_body(small_box, {}, at(0, 1, 0));
    const ObjectId b = world.add_rigid_body(small_box, {}, at(0.3, 1, 0));
    const ObjectId c = world.add_rigid_body(small_box, {}, at(0.6, 1, 0));
    world.add_joint(a, to_third ? c : b, kind, {.point = {0.15, 1, 0}, .axis = {0, 0, 1}});
  };
}

Build cloth(int columns, int rows) {
  return [=](World& world) { world.add_cloth(grid(columns, rows, 1)); };
}

/// A world with everything that a snapshot holds.
void everything(World& world) {
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  settings.fluid.foam.energy = {0, 0.1f};
  world.set_settings(settings);
  sliding(12, {})(world);
  joined(joint::Hinge{})(world);
  world.add_cloth(grid(4, 4, 0.4), {}, at(0, 0.5, 1));
  std::vector<Vec3d> centers;
  for (int i = 0; i < 12; ++i) centers.push_back({2 + 0.019 * (i % 2), 0.01 + 0.02 * (i / 2), 0});
  world.add_grains(centers);
  const ObjectId water =
      world.add_fluid(std::vector<Vec3d>{{-2, 0.1, 0}, {-2, 0.14, 0}}, {.spacing = 0.04f, .foam = 1},
                      {.velocity = {3, -2, 0}, .max_particles = 60});
  world.add_emitter(water, {.position = {-2, 0.5, 0}, .radius = 0.05f, .speed = 2});
  world.add_drain({.shape = Sphere{.center = {-2, 0, 1}, .radius = 0.2f}, .rate = 0.001f});
  world.add_collider(Plane{}, {.friction = 0.5f});
  const ColliderId ball = world.add_collider(Sphere{.center = {5, 0, 0}, .radius = 0.1f});
  world.move_collider(ball, {{0.1, 0, 0}, {}, 1});
}

void run_to_contact(World& world) {
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.step(1.0 / 60).ok());
}

void repair_checksum(Snapshot& snapshot) {
  const std::span<std::byte> bytes = snapshot.bytes;
  if (bytes.size() < sizeof(std::uint64_t)) return;
  const std::uint64_t checksum = fnv1a64(bytes.first(bytes.size() - sizeof checksum));
  std::memcpy(bytes.data() + bytes.size() - sizeof checksum, &checksum, sizeof checksum);
}

/// With some of its bytes changed, and mostly with a checksum that fits.
Snapshot mutant_of(const Snapshot& good, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  Snapshot result = good;
  std::vector<std::byte>& bytes = result.bytes;
  const auto write = [&](std::size_t place, std::uint32_t word) {
    std::memcpy(&bytes[std::min(place, bytes.size() - sizeof word)], &word, sizeof word);
  };
  constexpr std::uint32_t odd[] = {0u,          1u,          3u,          0xffffffffu, 0x7fc00000u,
                                   0x7f800000u, 0xff800000u, 0x80000000u, 0x7fffffffu};
  switch (below(8)) {
    case 0:  // a part is missing
      bytes.resize(below(bytes.size()));
      break;
    case 1:  // something follows
      bytes.resize(bytes.size() + 1 + below(100));
      break;
    case 2: {  // one part in place of another
      const std::size_t size = 1 + below(200), from = below(bytes.size() - size),
                        to = below(bytes.size() - size);
      std::copy_n(good.bytes.begin() + static_cast<std::ptrdiff_t>(from), size,
                  bytes.begin() + static_cast<std::ptrdiff_t>(to));
      break;
    }
    case 3:  // a bit
      bytes[below(bytes.size())] ^= std::byte(1u << below(8));
      break;
    default:
      for (std::size_t n = 1 + below(3); n > 0; --n)
        write(below(4) == 0 ? below(bytes.size()) : below(bytes.size() / 4) * 4,
              below(3) == 0 ? static_cast<std::uint32_t>(random()) : odd[below(std::size(odd))]);
  }
  if (below(20) != 0) repair_checksum(result);
  return result;
}

void expect_finite(const World& world) {
  for (const ObjectId object : world.objects()) {
    for (const Vec3f& x : world.positions(object)) EXPECT_TRUE(is_finite(x)) << world.name(object);
    for (const Vec3f& v : world.velocities(object)) EXPECT_TRUE(is_finite(v)) << world.name(object);
  }
}

/// Each mutant is refused and changes nothing, or is the state of a world that lives on. Returns how many were refused.
int try_mutants(int count, bool step_each) {
  World world = built(everything);
  run_to_contact(world);
  const Snapshot good = world.snapshot();
  const std::uint64_t hash = world.hash();
  std::mt19937 random(44);
  int refused = 0;
  for (int k = 0; k < count && !testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE("mutant " + std::to_string(k));
    const Snapshot mutant = mutant_of(good, random);
    try {
      world.restore(mutant);
    } catch (const Error& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()).find("restore: the snapshot"), std::string::npos) << error.what();
      EXPECT_EQ(world.hash(), hash);
      if (k % 50 == 0) {
        EXPECT_EQ(world.snapshot().bytes, good.bytes);
      }
      continue;
    }
    expect_finite(world);
    if (step_each) {
      world.step(1.0 / 60);
      expect_finite(world);
    }
    world.restore(good);
    EXPECT_EQ(world.hash(), hash);
  }
  EXPECT_EQ(world.snapshot().bytes, good.bytes);
  return refused;
}

TEST(Snapshots, AMutantIsRefusedOrIsAStateThatLivesOn) {
  const int refused = try_mutants(400, true);
  EXPECT_GT(refused, 200);
  EXPECT_LT(refused, 400);
}

TEST(Snapshots, TenThousandMutantsSlow) {
  EXPECT_GT(try_mutants(10000, true), 5000);
}

TEST(Snapshots, ThoseOfOtherWorldsAreRefused) {
  const std::vector<std::uint32_t> three{0, 1, 2};
  std::vector<std::uint32_t> many(38);
  for (std::uint32_t i = 0; i < many.size(); ++i) many[i] = i;
  const std::vector<Build> builds{
      sliding(40, three),
      sliding(40, many),
      sliding(40, {3, 4, 5}),
      joined(joint::Hinge{}),
      joined(joint::Fixed{}),
      joined(joint::Ball{}),
      joined(joint::Slider{}),
      joined(joint::Universal{}),
      joined(joint::Hinge{}, true),
      cloth(6, 6),
      cloth(4, 9),
      cloth(9, 4),
      [](World& world) {
        world.add_soft_body(tet_bar(1, 1, 1, {0.2, 0.2, 0.2}), {}, {.name = "cloth"});
      },
      [](World& world) {
        world.add_soft_body(box({0.2, 0.2, 0.2}), {}, {.cells = 20}, {.name = "cloth"});
      },
  };
  for (std::size_t a = 0; a < builds.size(); ++a) {
    World world = built(builds[a]);
    for (int i = 0; i < 3; ++i) world.step(1.0 / 60);
    const std::uint64_t hash = world.hash();
    const std::vector<std::byte> before = world.snapshot().bytes;
    for (std::size_t b = 0; b < builds.size(); ++b) {
      SCOPED_TRACE(std::to_string(b) + " into " + std::to_string(a));
      World other = built(builds[b]);
      for (int i = 0; i < 5; ++i) other.step(1.0 / 60);
      if (a == b) {
        world.restore(other.snapshot());
        EXPECT_EQ(world.hash(), other.hash());
        world.restore({before});
      } else {
        expect_error([&] { world.restore(other.snapshot()); }, {"restore", "other objects"});
      }
      EXPECT_EQ(world.hash(), hash);
    }
    EXPECT_EQ(world.snapshot().bytes, before);
    EXPECT_TRUE(world.step(1.0 / 60).ok());
  }
}

}  // namespace souple::test_world_snapshots
