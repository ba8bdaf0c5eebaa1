#include "tests/threads/busy_world.h"
#include "tests/threads/idle.h"
#include "tests/threads/in_child.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace souple::test_threads_world {

constexpr int frames = 8;

std::vector<std::uint64_t> hashes_of(const Settings& settings) {
  World world = test::busy_world(settings);
  std::vector<std::uint64_t> hashes;
  for (int frame = 0; frame < frames; ++frame) {
    world.step(1.0 / 60);
    hashes.push_back(world.hash());
  }
  EXPECT_TRUE(world.report().ok()) << world.report().message;
  EXPECT_GT(world.report().contacts, 1000u);
  return hashes;
}

TEST(WorldThreads, ResultsDoNotDependOnThem) {
  const std::vector<std::uint64_t> alone = hashes_of({.threads = 1});
  for (const int threads : {2, 3, 8})
    EXPECT_EQ(hashes_of({.threads = threads, .threading = Threading::pool}), alone) << threads << " threads";
  EXPECT_EQ(hashes_of({.threads = 3, .threading = Threading::serial}), alone);
  EXPECT_EQ(hashes_of({.threads = 3, .threading = Threading::automatic}), alone);
  EXPECT_EQ(hashes_of({.threads = 3, .threading = has_tbb() ? Threading::tbb : Threading::serial}), alone);
}

TEST(WorldThreads, ResultsOfManyIterationsDoNotDependOnThem) {
  std::vector<std::uint64_t> alone;
  for (const int threads : {1, 2, 5}) {
    World world = test::busy_world({.iterations = 3, .mode = Mode::xpbd, .threads = threads});
    std::vector<std::uint64_t> hashes;
    for (int frame = 0; frame < 4; ++frame) {
      world.step(1.0 / 60);
      hashes.push_back(world.hash());
    }
    if (threads == 1) alone = hashes;
    EXPECT_EQ(hashes, alone) << threads << " threads";
  }
}

#ifndef SOUPLE_SANITIZED  // the thread sanitizer starts no threads in a child
// A server forks after it has built and stepped its world; parent and child go on alike.
TEST(WorldThreads, AWorldStepsInAChildMadeByFork) {
  for (const Threading threading : {Threading::automatic, Threading::pool, Threading::tbb})
    for (const int threads : {2, 4}) {
      World world = test::busy_world({.threads = threads, .threading = threading});
      for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60);
      World twin = test::busy_world({.threads = 1});
      for (int frame = 0; frame < 5; ++frame) twin.step(1.0 / 60);
      const auto goes_on = [&] {
        for (int frame = 0; frame < 2; ++frame) world.step(1.0 / 60);
        return world.hash() == twin.hash();
      };
      EXPECT_TRUE(test::succeeds_in_child(goes_on))
          << static_cast<int>(threading) << ", " << threads << " threads";
      EXPECT_TRUE(test::succeeds_in_child([] {  // a world of the child's own
        World own = test::busy_world({.threads = 3, .threading = Threading::pool});
        own.step(1.0 / 60);
        return own.report().ok();
      }));
      EXPECT_TRUE(goes_on());
    }
}
#endif

// All results of a run: checkpoint, reports, contacts.
TEST(WorldThreads, CheckpointsReportsAndContactsDoNotDependOnThem) {
  World one = test::busy_world({.threads = 1}), three = test::busy_world({.threads = 3});
  for (int frame = 0; frame < frames; ++frame) one.step(1.0 / 60), three.step(1.0 / 60);
  EXPECT_EQ(one.snapshot().bytes, three.snapshot().bytes);
  const StepReport &a = one.report(), &b = three.report();
  EXPECT_EQ(a.contacts, b.contacts);
  EXPECT_EQ(a.deepest_contact, b.deepest_contact);
  EXPECT_EQ(a.largest_strain, b.largest_strain);
  ASSERT_EQ(a.kinds.size(), b.kinds.size());
  for (std::size_t k = 0; k < a.kinds.size(); ++k) {
    EXPECT_EQ(a.kinds[k].count, b.kinds[k].count) << a.kinds[k].kind;
    EXPECT_EQ(a.kinds[k].largest, b.kinds[k].largest) << a.kinds[k].kind;
    EXPECT_EQ(a.kinds[k].mean, b.kinds[k].mean) << a.kinds[k].kind;
  }
  const auto x = one.contacts(), y = three.contacts();
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_EQ(x[k].vertex, y[k].vertex);
    EXPECT_EQ(x[k].other_vertex, y[k].other_vertex);
    EXPECT_EQ(x[k].impulse, y[k].impulse);
  }
}

TEST(WorldThreads, ARunGoesOnTheSameWithOtherThreads) {
  World straight = test::busy_world({.threads = 1}), resumed = test::busy_world({.threads = 8});
  for (int frame = 0; frame < 4; ++frame) straight.step(1.0 / 60);
  resumed.restore(straight.snapshot());
  for (int frame = 0; frame < 4; ++frame) straight.step(1.0 / 60), resumed.step(1.0 / 60);
  Settings settings = resumed.settings();
  settings.threads = 2;
  resumed.set_settings(settings);
  for (int frame = 0; frame < 4; ++frame) straight.step(1.0 / 60), resumed.step(1.0 / 60);
  EXPECT_EQ(straight.hash(), resumed.hash());
}

// If several particles become non-finite at once, runs with any number of threads report the same particle.
TEST(WorldThreads, TheSameParticleIsBlamed) {
  std::vector<Vec3d> line(20000);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].x = 0.1 * static_cast<double>(i);
  const std::vector<std::uint32_t> pushed{9000, 9001, 15000, 19999};
  std::uint32_t blamed = 0;
  for (const int threads : {1, 2, 7}) {
    World world({.threads = threads});
    world.add_grains(line);
    // A force that overflows in the first substep.
    world.add_force_field([&](const Vec3f& x, const Vec3f&, float, double) {
      const auto i = static_cast<std::uint32_t>(std::lround(10 * x.x));
      const bool is_pushed = std::find(pushed.begin(), pushed.end(), i) != pushed.end();
      return Vec3f{is_pushed ? 3e38f : 0, 0, 0};
    });
    const StepReport& report = world.step(100);
    EXPECT_FALSE(report.ok());
    if (threads == 1) blamed = report.bad_vertex;
    EXPECT_EQ(report.bad_vertex, blamed) << threads << " threads";
  }
  EXPECT_NE(std::find(pushed.begin(), pushed.end(), blamed), pushed.end());
}

TEST(WorldThreads, WorldsOnDifferentThreadsDoNotDisturbEachOther) {
  const std::uint64_t alone = hashes_of({.threads = 1}).back();
  std::vector<std::uint64_t> together(3);
  std::vector<std::thread> users;
  users.reserve(together.size());
  for (std::uint64_t& hash : together)
    users.emplace_back([&hash] { hash = hashes_of({.threads = 2, .threading = Threading::pool}).back(); });
  for (std::thread& user : users) user.join();
  for (const std::uint64_t hash : together) EXPECT_EQ(hash, alone);
}

// A world may be created on one thread, stepped on a second and destroyed on a third.
TEST(WorldThreads, AWorldMayWanderBetweenUsersThreads) {
  auto world = std::make_unique<World>(test::busy_world({.threads = 2}));
  std::thread([&] { world->step(1.0 / 60); }).join();
  std::thread([&] {
    World moved = std::move(*world);
    moved.step(1.0 / 60);
    *world = std::move(moved);
  }).join();
  EXPECT_TRUE(world->report().ok());
  std::thread([&] { world.reset(); }).join();
}

// If callbacks of users throw, in whatever stage, no thread of the world spins after the step.
TEST(WorldThreads, SleepAfterAStepWhoseCallbacksThrow) {
  World world = test::busy_world({.threads = 3, .threading = Threading::pool});
  for (const Stage stage : {Stage::broad_phase, Stage::integrate, Stage::solve, Stage::velocity})
    world.after(stage, [](World&) { throw std::runtime_error("no"); });
  world.add_force_field([](const Vec3f&, const Vec3f&, float, double) -> Vec3f { throw 1; });
  auto custom = std::make_unique<CustomProjector>();
  for (std::uint32_t i = 0; i < 100; ++i) {
    auto thrower = std::make_shared<CallbackConstraint>(
        std::vector<std::uint32_t>{i},
        [](std::span<const Vec3f>, std::span<Vec3f>) -> float { throw std::runtime_error("custom"); });
    thrower->concurrent = true;
    custom->add(std::move(thrower));
  }
  world.add_projector(std::move(custom));
  const StepReport& report = world.step(1.0 / 60);
  EXPECT_TRUE(report.has(Flag::callback_failed));
  EXPECT_NE(report.message.find("custom"), std::string::npos) << report.message;
  EXPECT_LT(test::idle_seconds(), 0.01);
}

}  // namespace souple::test_threads_world
