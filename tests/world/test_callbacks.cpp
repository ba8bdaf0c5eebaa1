#include "souple/simd/instruction_set.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/kernels/find_kernels.h"
#include "souple/solver/kernels/motion.h"
#include "souple/state/particles.h"
#include "tests/expect_error.h"
#include "tests/instruction_sets.h"
#include "tests/world/scene.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_callbacks {

TEST(Callbacks, StagesRunInOrder) {
  World world({.substeps = 2});
  world.add_cloth(grid(2, 2, 1));
  std::string order;
  for (const Stage stage :
       {Stage::broad_phase, Stage::integrate, Stage::contacts, Stage::solve, Stage::finish, Stage::velocity})
    world.before(stage, [&order, stage](World&) { order += stage_name(stage)[0]; });
  world.step(0.01);
  EXPECT_EQ(order, "bicsfvicsfv");
}

TEST(Callbacks, AnExceptionIsReportedNotPassedOn) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  world.after(Stage::solve, [](World&) { throw std::runtime_error("stage trouble"); });
  world.add_force_field(
      [](const Vec3f&, const Vec3f&, float, double) -> Vec3f { throw std::runtime_error("field trouble"); });
  world.pin(cloth, vertices({0}),
            [](std::uint32_t, double) -> Vec3d { throw std::runtime_error("pin trouble"); });
  world.attach(cloth, vertices({8}), [](std::uint32_t, double) -> Vec3d { throw 7; });
  world.add_collider(Sphere{}, {.motion = ColliderMotion::callback([](double t) -> Transform {
                                  if (t >= 0) throw std::runtime_error("collider trouble");
                                  return {};
                                })});
  const StepReport& report = world.step(0.01);
  EXPECT_TRUE(report.has(Flag::callback_failed));
  for (const char* words :
       {"stage trouble", "field trouble", "pin trouble", "collider trouble", "attachment"})
    EXPECT_NE(report.message.find(words), std::string::npos) << report.message;
  for (const Vec3f& x : world.positions(cloth)) EXPECT_TRUE(is_finite(x));
}

TEST(Callbacks, ARuntimeConstraintThatThrowsIsReported) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  auto projector = std::make_unique<CustomProjector>();
  projector->add(std::make_shared<CallbackConstraint>(
      std::vector<std::uint32_t>{world.particle(cloth, 0)},
      [](std::span<const Vec3f>, std::span<Vec3f>) -> float { throw std::runtime_error("custom trouble"); }));
  world.add_projector(std::move(projector));
  EXPECT_NE(world.step(0.01).message.find("custom trouble"), std::string::npos);
}

TEST(Callbacks, AddingDuringAStepIsRefused) {
  World world;
  world.add_cloth(grid(3, 3, 1));
  world.before(Stage::solve, [](World& w) { w.add_cloth(grid(3, 3, 1)); });
  EXPECT_NE(world.step(0.01).message.find("not while a step runs"), std::string::npos);
  EXPECT_EQ(world.objects().size(), 1u);
}

TEST(Callbacks, AStepWithinAStepIsRefused) {
  World world;
  world.add_cloth(grid(3, 3, 1));
  StepOutcome inner = StepOutcome::done;
  world.before(Stage::velocity, [&](World& w) { inner = w.step(0.01).outcome; });
  const StepReport& report = world.step(0.01);
  EXPECT_EQ(inner, StepOutcome::refused);
  EXPECT_TRUE(report.ok());
  EXPECT_NE(report.message.find("called step"), std::string::npos);
  EXPECT_NEAR(world.time(), 0.01, 1e-12);
}

// A force field that becomes NaN at t = 0.5 s: the step reports the particle and restores the world.
TEST(Callbacks, ABadNumberStopsTheStepAndRestoresTheLastGoodState) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1), {}, {.name = "sheet"});
  world.add_force_field([](const Vec3f& x, const Vec3f&, float, double t) {
    return t > 0.5 && x.x > 0.4f && x.z > 0.4f ? Vec3f{std::nanf(""), 0, 0} : Vec3f{};
  });
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.step(1.0 / 60).ok());
  const std::uint64_t good = world.hash();
  const StepReport& report = world.step(1.0 / 60);
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.outcome, StepOutcome::diverged);
  EXPECT_EQ(report.bad_object, "sheet");
  EXPECT_EQ(report.bad_vertex, 8u);
  EXPECT_EQ(world.hash(), good);
  EXPECT_NEAR(world.time(), 0.5, 1e-12);
  world.clear_force_fields();
  EXPECT_TRUE(world.step(1.0 / 60).ok());
  for (const Vec3f& x : world.positions(cloth)) EXPECT_TRUE(is_finite(x));
}

TEST(Callbacks, AreRemovedOneByOne) {
  World world({.substeps = 1});
  const ObjectId cloth = world.add_cloth(grid(2, 2, 1));
  std::string calls;
  const CallbackId a = world.before(Stage::solve, [&](World&) { calls += 'a'; });
  CallbackId once{};
  once = world.before(Stage::solve, [&](World& w) { calls += 'o', w.remove(once); });
  world.after(Stage::solve, [&](World& w) {
    calls += 'b';
    w.after(Stage::solve, [&](World&) { calls += 'n'; });  // from the next step on
  });
  world.step(0.01);
  EXPECT_EQ(calls, "aob");
  world.remove(a);
  calls.clear();
  world.step(0.01);
  EXPECT_EQ(calls, "bn");
  expect_error([&] { world.remove(a); }, {"no callback has the handle"});
  expect_error([&] { world.remove(once); }, {"no callback has the handle"});
  expect_error([&] { world.before(Stage::solve, {}); }, {"empty"});

  const auto lift = [](const Vec3f&, const Vec3f&, float mass, double) { return Vec3f{0, 9.81f * mass, 0}; };
  const ForceFieldId first = world.add_force_field(lift);
  const ForceFieldId second = world.add_force_field(lift);
  world.set_velocities(cloth, std::vector<Vec3f>(4));
  world.remove(first);
  world.step(0.01);
  EXPECT_NEAR(world.velocities(cloth)[0].y, 0, 1e-5);  // one field carries the weight
  world.remove(second);
  world.step(0.01);
  EXPECT_NEAR(world.velocities(cloth)[0].y, -0.0981, 1e-4);
  expect_error([&] { world.remove(first); }, {"no force field has the handle"});
}

// The callback of a stage may replace the log function; the log function that hears of its exception may not.
TEST(Callbacks, TheLogThatHearsOfAStagesCallbackMayOnlyRead) {
  World world({.substeps = 1});
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  std::string refused;
  world.set_log([&](LogLevel, std::string_view) {
    const auto attempt = [&](const auto& change) {
      try {
        change();
      } catch (const Error& error) {
        refused += error.what();
      }
    };
    (void)world.positions(cloth);
    attempt([&] { world.set_log({}); });
    attempt([&] { world.teleport(cloth, {}); });
  });
  world.before(Stage::solve, [](World&) { throw std::runtime_error("stage trouble"); });
  world.step(0.01);
  EXPECT_NE(refused.find("set_log: not while"), std::string::npos) << refused;
  EXPECT_NE(refused.find("teleport: not while"), std::string::npos) << refused;
}

TEST(Callbacks, TheLogHearsWhatWasMended) {
  World world;
  std::string heard;
  world.set_log([&](LogLevel, std::string_view words) { heard += words; });
  TriangleMesh mesh = grid(3, 3, 1);
  std::swap(mesh.triangles[2][0], mesh.triangles[2][1]);
  world.add_cloth(mesh, {}, {.name = "odd"});
  EXPECT_NE(heard.find("odd: "), std::string::npos) << heard;
}

// Prediction and velocity update, as SIMD kernels and as scalar code.

World hanging_cloth(const Settings& settings) {
  World world(settings);
  const ObjectId cloth = world.add_cloth(grid(9, 6, 1), {.damping = 3});
  world.pin(cloth, vertices({0, 4}));
  ObjectOptions beside{.transform = {.translation = {2, 0, 0}}};
  world.add_cloth(grid(3, 3, 0.3), {}, beside);  // 63 particles in total: the last do not fill a register
  return world;
}

// With users' force fields the world uses scalar code: a field without force must give the bits of the SIMD
// kernels.
TEST(Motion, AFieldWithoutForceChangesNoBit) {
  for (const float wind : {0.0f, 8.0f}) {
    Settings settings;
    settings.wind.velocity = {wind, 0, 0.5f * wind};
    World packed = hanging_cloth(settings), one_by_one = hanging_cloth(settings);
    one_by_one.add_force_field([](const Vec3f&, const Vec3f&, float, double) { return Vec3f{}; });
    for (int i = 0; i < 30; ++i) packed.step(1.0 / 60), one_by_one.step(1.0 / 60);
    EXPECT_EQ(packed.hash(), one_by_one.hash());
    const Vec3f before = hanging_cloth(settings).positions(packed.objects()[0])[49];
    EXPECT_GT(length(packed.positions(packed.objects()[0])[49] - before), 0.1f);
  }
}

struct Bodies {
  std::vector<Vec4f> position, offset, start, velocity;

  explicit Bodies(std::size_t count) : position(count), offset(count), start(count), velocity(count) {
    float number = 0.37f;
    const auto next = [&number] { return number = std::fmod(number * 7.13f + 0.61f, 3.7f); };
    for (std::size_t i = 0; i < count; ++i) {
      position[i] = {next(), -next(), next() - 1, i % 5 == 2 ? 0.0f : next()};
      offset[i] = {1e-8f * next(), -1e-8f * next(), 0, 0};
      velocity[i] = {next(), next() - 2, -next(), 0};
    }
  }
  kernels::MotionArrays arrays() { return {&position[0].x, &offset[0].x, &start[0].x, &velocity[0].x}; }
};

constexpr float gravity[3] = {0.5f, -9.81f, 0};
constexpr float h = 1.0f / 600;

// Predicts, moves one particle as a solver would, and finishes.
Bodies advance(const kernels::MotionKernels& kernels) {
  Bodies bodies(23);
  const kernels::MotionArrays arrays = bodies.arrays();
  EXPECT_TRUE(kernels.predict(arrays, 0, 23, gravity, h));
  arrays.moving[4 * 9 + 1] += 0.01f;
  EXPECT_TRUE(kernels.finish(arrays, 0, 23, h));
  return bodies;
}

std::vector<const kernels::MotionKernels*> all_kernels() {
  std::vector<const kernels::MotionKernels*> result;
  for (const InstructionSet set : all_sets())
    if (const auto* kernels = find_motion_kernels(set)) result.push_back(kernels);
  return result;
}

// A free particle falls as the scheme says, a pinned one stays, and both keep their inverse masses.
TEST(Motion, PinnedParticlesStay) {
  for (const kernels::MotionKernels* kernels : all_kernels()) {
    const Bodies before(23), after = advance(*kernels);
    for (std::size_t i = 0; i < 23; ++i) {
      EXPECT_EQ(after.position[i].w, before.position[i].w);
      if (i == 9) continue;
      const bool pinned = before.position[i].w == 0;
      const float v = before.velocity[i].y - 9.81f * h;
      EXPECT_NEAR(after.velocity[i].y, pinned ? 0 : v, 1e-6) << i;
      EXPECT_NEAR(after.position[i].y, before.position[i].y + (pinned ? 0 : v * h), 1e-6) << i;
    }
  }
}

TEST(Motion, BadNumbersAreSeen) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const kernels::MotionKernels* kernels : all_kernels())
    for (const float bad : {infinity, -infinity, std::nanf(""), 3e38f})
      for (const std::size_t i : {0u, 13u, 22u}) {
        Bodies bodies(23);
        bodies.velocity[i].z = bad;
        EXPECT_FALSE(kernels->predict(bodies.arrays(), 0, 23, gravity, h));
        bodies = Bodies(23);
        bodies.offset[i].x = bad;
        EXPECT_FALSE(kernels->finish(bodies.arrays(), 0, 23, h));
      }
}

}  // namespace souple::test_world_callbacks
