#include "tests/count_allocations.h"
#include "tests/threads/busy_world.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_threads_allocation {

/// Fewest allocations of five successive steps. Buffers still grow in single steps while more pairs come near
/// each other than ever before.
long allocations_of_a_warm_step(World& world, int warm_frames) {
  for (int frame = 0; frame < warm_frames; ++frame) world.step(1.0 / 60);
  std::vector<long> before;
  before.reserve(21);
  for (int frame = 0; frame <= 20; ++frame) {
    before.push_back(test::allocations());
    world.step(1.0 / 60);
  }
  long fewest = std::numeric_limits<long>::max();
  for (std::size_t frame = 5; frame < before.size(); ++frame)
    fewest = std::min(fewest, before[frame] - before[frame - 5]);
  return fewest;
}

class WarmStep : public testing::TestWithParam<Settings> {};

// Cloth, soft bodies, grains, a balloon, colliders and custom constraints, residuals measured, wind. Stiff boxes hit
// the cloth in the first second, and pairs of its surface grow until they lie still.
TEST_P(WarmStep, AllocatesNothing) {
  World world = test::busy_world(GetParam());
  EXPECT_EQ(allocations_of_a_warm_step(world, 90), 0);
  EXPECT_GT(world.report().contacts, 100u);
}

std::string name_of(const testing::TestParamInfo<Settings>& info) {
  const Settings& settings = info.param;
  if (settings.mode == Mode::pbd) return "PBD";
  if (settings.integrator == Integrator::implicit_euler) return "Implicit";
  if (settings.iterations > 1) return "Iterations";
  return settings.threads == 1 ? "OneThread" : "TwoThreads";
}

class WarmStepInOtherModes : public WarmStep {};

TEST_P(WarmStepInOtherModes, AllocatesNothingSlow) {
  World world = test::busy_world(GetParam());
  EXPECT_EQ(allocations_of_a_warm_step(world, 90), 0);
  EXPECT_GT(world.report().contacts, 100u);
}

INSTANTIATE_TEST_SUITE_P(All, WarmStep, testing::Values(Settings{.threads = 2}), name_of);
INSTANTIATE_TEST_SUITE_P(All, WarmStepInOtherModes,
                         testing::Values(Settings{.threads = 1}, Settings{.iterations = 3, .threads = 2},
                                         Settings{.mode = Mode::pbd, .threads = 2},
                                         Settings{.integrator = Integrator::implicit_euler, .threads = 2}),
                         name_of);

// A body that hangs from cloth, and a bead that slides on a rope.
TEST(WarmStepOfTies, AllocatesNothing) {
  World world({.threads = 2});
  const ObjectId cloth = world.add_cloth(grid(20, 20, 1.0), {.membrane_stiffness = 1e5f}, {.name = "cloth"});
  world.pin(cloth, in_box({-1, -1, -0.51f}, {1, 1, -0.49f}));
  const ObjectId body = world.add_rigid_body(Sphere{{}, 0.1f}, {.density = 200},
                                             {.transform = {.translation = {0, -0.2, 0.4}}});
  world.set_collide("cloth", world.name(body), false);
  world.stitch(cloth, in_box({-0.1f, -1, 0.3f}, {0.1f, 1, 0.5f}), body, 0.3, {});
  const std::vector<Vec3d> line{{3, 0, 0}, {4, -0.5, 0}, {5, 0, 0}};
  const ObjectId rope = world.add_rope(line, 20, {}, {.name = "rope"});
  world.pin(rope, vertices({0, 20}));
  const ObjectId bead =
      world.add_grains(std::vector<Vec3d>{{3.5, -0.25, 0}}, {.radius = 0.01f}, {.name = "bead"});
  world.set_collide("rope", "bead", false);
  world.add_tie(bead, rope, {.point = {3.5, -0.25, 0}, .slide = TieSlide{}});
  EXPECT_EQ(allocations_of_a_warm_step(world, 90), 0);
}

// Balls at the vertices of a heap.
TEST(WarmStepOfVertexBalls, AllocatesNothing) {
  World world({.threads = 2});
  world.add_cloth(grid(30, 30, 1.0), {.thickness = 0.01f},
                  {.transform = {{0, 0.52, 0}, Quatd::from_axis_angle({0, 0, 1}, 1.48), 1},
                   .self_collision = SelfCollision::particles});
  world.add_collider(Plane{});
  EXPECT_EQ(allocations_of_a_warm_step(world, 120), 0);
  EXPECT_GT(world.report().contacts, 200u);
}

// An obstacle driven by keyframes and, relative to them, by a sequence.
TEST(WarmStepOfAnObstacle, AllocatesNothing) {
  World world({.threads = 2});
  const TriangleMesh mesh = grid(80, 80, 1.0);
  ObstacleMotion motion{.pose = ColliderMotion::keyframes({{0, {0, 0, 0}}, {0.3, {0, 1, 0}}}, true)};
  motion.sequence.loop = true;
  for (const double size : {1.0, 2.0, 1.0}) {
    std::vector<Vec3f>& frame = motion.sequence.frames.emplace_back();
    for (const Vec3d& x : mesh.positions) frame.push_back(Vec3f(x * size));
  }
  const ObjectId plate = world.add_obstacle(mesh, {}, motion);
  EXPECT_EQ(allocations_of_a_warm_step(world, 10), 0);
  EXPECT_GT(length(world.velocities(plate)[0]), 1.0f);
}

// A plate moves between two groups of sleeping grains, within their bounding box. Each step tests the plate
// against the grains and wakes none.
TEST(WarmStepBesideSleepers, AllocatesNothing) {
  World world({.sleeping = {.enabled = true}, .threads = 2});
  std::vector<Vec3d> centers;
  centers.reserve(50);
  for (int i = 0; i < 50; ++i) centers.push_back({i < 25 ? 0.0 : 4.0, i < 25 ? 0.0 : 4.0, 0.1 * (i % 25)});
  const ObjectId grains = world.add_grains(centers);
  world.pin(grains, all());
  ObstacleMotion motion{
      .pose = ColliderMotion::keyframes({{0, {1, 3, 0}}, {1, {1.2, 3, 0}}, {2, {1, 3, 0}}}, true)};
  world.add_obstacle(grid(20, 20, 1.0), {}, motion);
  EXPECT_EQ(allocations_of_a_warm_step(world, 60), 0);
  EXPECT_TRUE(world.is_asleep(grains));
}

// Contact pairs, a sensor, rays after each step and a batch of pin targets.
TEST(WarmStepOfAGame, AllocatesNothing) {
  World world({.threads = 2});
  const ObjectId cloth = world.add_cloth(grid(30, 30, 1.0), {}, {.transform = {.translation = {0, 0.3, 0}}});
  world.add_grains(std::vector<Vec3d>{{0, 0.1, 0}, {0.3, 0.1, 0}, {0.3, 0.29, 0}}, {.radius = 0.1f});
  world.add_collider(Plane{});
  world.add_collider(Sphere{.radius = 0.2f}, {.sensor = true});
  const std::vector<std::uint32_t> row{0, 29};
  world.pin(cloth, vertices(row));
  world.track_contacts(true);
  const CallbackId rays = world.after(Stage::velocity, [&](World& w) {
    w.ray_cast({0.1f, 2, 0}, {0, -1, 0});
    w.closest_point({0.1f, 2, 0});
    w.sphere_cast({0.1f, 2, 0}, 0.1f, {0, -1, 0});
  });
  std::vector<Vec3f> targets{world.positions(cloth)[0], world.positions(cloth)[29]};
  const CallbackId back = world.before(Stage::broad_phase, [&](World&) { targets[0].x += 1e-4f; });
  EXPECT_EQ(allocations_of_a_warm_step(world, 60), 0);
  EXPECT_GE(world.contact_pairs().size(), 4u);
  world.remove(rays);
  world.remove(back);
  for (int frame = 0; frame < 3; ++frame) world.move_pins(cloth, row, targets), world.step(1.0 / 60);
  const long before = test::allocations();
  world.move_pins(cloth, row, targets);
  EXPECT_EQ(test::allocations(), before);
}

// A step with a warning writes its report into the memory of the last report.
TEST(WarmStepThatWarns, AllocatesNothing) {
  World world({.substeps = 1, .threads = 2});
  const ObjectId cloth = world.add_cloth(grid(30, 30, 1.0), {.membrane_stiffness = 20});
  world.pin(cloth, vertices({0, 29}));
  EXPECT_EQ(allocations_of_a_warm_step(world, 30), 0);
  EXPECT_TRUE(world.report().has(Flag::large_strain));
  EXPECT_FALSE(world.report().message.empty());
}

}  // namespace souple::test_threads_allocation
