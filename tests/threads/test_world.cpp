#include "souple/constraints/distance.h"
#include "souple/math/fnv1a.h"
#include "souple/solver/set_projector.h"
#include "souple/souple.h"
#include "souple/surface/fluid_surface.h"
#include "souple/surface/splat_shapes.h"
#include "souple/threads/threads.h"
#include "tests/instruction_sets.h"
#include "tests/threads/busy_world.h"
#include "tests/threads/idle.h"
#include "tests/threads/in_child.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace souple::test_threads_world {

#ifdef SOUPLE_SANITIZED  // to see a race, the sanitizer needs every loop once
constexpr int frames = 2;
#else
constexpr int frames = 8;
#endif

/// With the sanitizer it has come into contact already.
World world_of(const Settings& settings) {
  World world = test::busy_world(settings);
#ifdef SOUPLE_SANITIZED
  static const Snapshot in_contact = [] {
    World alone = test::busy_world({.threads = 1});
    for (int frame = 0; frame < 6; ++frame) alone.step(1.0 / 60);
    return alone.snapshot();
  }();
  world.restore(in_contact);
#endif
  return world;
}

std::vector<std::uint64_t> hashes_of(const Settings& settings) {
  World world = world_of(settings);
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
    World world = world_of({.iterations = 3, .mode = Mode::xpbd, .threads = threads});
    std::vector<std::uint64_t> hashes;
    for (int frame = 0; frame < frames / 2; ++frame) {
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
  World one = world_of({.threads = 1}), three = world_of({.threads = 3});
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
  World straight = world_of({.threads = 1}), resumed = world_of({.threads = 8});
  for (int frame = 0; frame < frames / 2; ++frame) straight.step(1.0 / 60);
  resumed.restore(straight.snapshot());
  for (int frame = 0; frame < frames / 2; ++frame) straight.step(1.0 / 60), resumed.step(1.0 / 60);
  Settings settings = resumed.settings();
  settings.threads = 2;
  resumed.set_settings(settings);
  for (int frame = 0; frame < frames / 2; ++frame) straight.step(1.0 / 60), resumed.step(1.0 / 60);
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

// Every instruction set that this processor has gives the same bits with any number of threads. Golden scenes say the same
// of what they show (tests/golden). Here is what they lack: vertex balls, sleeping, all kernels of fluids, vorticity, coarse
// triangles on colliders of each shape, and the meshes of fluids.

ObjectOptions at(const Vec3d& place, SelfCollision self_collision = SelfCollision::off, int layer = 0) {
  ObjectOptions options{
      .transform = {.translation = place}, .self_collision = self_collision, .layer = layer};
  return options;
}

/// A cloth that folds over itself on a turning ring, soft bodies, a rope that coils and grains on it.
void add_crowd(World& world) {
  const auto above = [](double x, double y, double z) { return at({x, y, z}, SelfCollision::surfaces); };
  const auto turning = ColliderMotion::callback([](double t) {
    return Transform{.rotation = Quatd::from_axis_angle({0, 1, 0}, 2 * t)};
  });
  world.add_obstacle(torus(0.25, 0.08, 24, 12), {.thickness = 0.01f}, {.pose = turning});
  world.add_cloth(grid(20, 20, 0.9), {.thickness = 0.012f}, above(0.05, 0.1, 0));
  world.add_cloth(grid(10, 10, 0.4), {.thickness = 0.01f}, above(-0.1, 0.12, 0.1));
  world.add_soft_body(tet_ball(1, 2, 0.08), {.thickness = 0.01f}, above(0.1, 0.2, 0));
  world.add_soft_body(tet_bar(3, 3, 3, {0.12, 0.12, 0.12}), {.thickness = 0.01f}, above(-0.12, 0.2, 0.05));
  world.add_soft_body(box({0.1, 0.1, 0.1}), {.model = SoftBodyModel::shape_matching}, {.cells = 60},
                      above(0, 0.2, -0.15));
  std::vector<Vec3d> line, centers;
  for (int k = 0; k <= 24; ++k) {
    const double angle = 2 * pi * k / 8;
    line.push_back({0.06 * std::cos(angle), 0.12 + 0.015 * k, 0.25 + 0.06 * std::sin(angle)});
  }
  world.add_rope(line, 72, {.radius = 0.006f}, above(0, 0, 0));
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) centers.push_back({0.025 * x + 1e-3 * y, 0.025 * y, 0.025 * z + 1e-3 * x});
  world.add_grains(centers, {.radius = 0.01f}, above(-0.2, 0.12, -0.25));
}

/// Coarse triangles that lie on a shape of each kind.
void add_coarse_cloths(World& world) {
  const Shape shapes[] = {Sphere{{}, 0.1f}, Box{{}, {0.1f, 0.1f, 0.1f}}, Capsule{{}, 0.1f, 0.1f},
                          Cylinder{{}, 0.1f, 0.1f}, SignedDistanceField(sphere(2, 0.1), 0.02)};
  for (double x = 2; const Shape& shape : shapes) {
    const double top = std::holds_alternative<Capsule>(shape) ? 0.2 : 0.1;
    world.add_collider(shape, {.motion = ColliderMotion::fixed({.translation = {x, 0, 0}})});
    world.add_cloth(grid(3, 3, 0.5), {.bending_stiffness = 0.1f, .thickness = 0.02f},
                    at({x + 0.03, top + 0.015, 0.02}));
    x += 1;
  }
}

/// Rigid bodies joined and tied, two layers in the wrong order, vertex balls that meet, and a box that falls asleep.
void add_rest(World& world) {
  for (int i = 0; i < 6; ++i)
    world.add_rigid_body(i % 2 == 0 ? Shape(Box{{}, {0.1f, 0.05f, 0.1f}}) : Shape(Capsule{{}, 0.06f, 0.1f}),
                         {}, at({-3 + 0.02 * i, 0.12 * i, 0.01 * i}));
  const ObjectId post = world.add_rigid_body(Box{{}, {0.02f, 0.2f, 0.02f}}, {}, at({-4, 0.3, 0})),
                 door = world.add_rigid_body(Box{{}, {0.2f, 0.2f, 0.02f}}, {}, at({-3.75, 0.3, 0}));
  world.add_joint(post, door, joint::Hinge{}, {.point = {-3.97, 0.3, 0}, .axis = {0, 1, 0}});
  const ObjectId hung = world.add_cloth(grid(8, 8, 0.4), {}, at({-4, 1, 0}));
  world.pin(hung, vertices({0, 7}));
  world.add_tie(SurfacePoint{hung, {60}}, door, {.point = {-3.75, 0.5, 0}});
  world.add_cloth(grid(10, 10, 0.4), {}, at({0, 1.5, 0}, SelfCollision::surfaces, 2));
  world.add_cloth(grid(9, 9, 0.36), {}, at({0.01, 1.507, 0.02}, SelfCollision::surfaces, 1));
  ObjectOptions upright = at({0, 0.4, 2}, SelfCollision::particles);
  upright.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, 1.48);
  world.add_cloth(grid(24, 24, 0.8), {.thickness = 0.02f}, upright);
  world.add_rigid_body(Box{{}, {0.05f, 0.05f, 0.05f}}, {}, at({0, -0.1, 4}));
}

/// Water with everything, thrown through cloth at grains, by one of the kernels.
World splash(SmoothingShape kernel, int threads) {
  constexpr double d = 0.04;
  Settings settings{.substeps = 6, .threads = threads};
  settings.fluid = {.kernel = kernel, .artificial_pressure = 100};
  World world(settings);
  for (const auto& [normal, offset] : {std::pair(Vec3f{0, 1, 0}, 0.0f),
                                       {Vec3f{1, 0, 0}, -0.6f},
                                       {Vec3f{-1, 0, 0}, -0.6f},
                                       {Vec3f{0, 0, 1}, -0.2f},
                                       {Vec3f{0, 0, -1}, -0.2f}})
    world.add_collider(Plane{normal, offset});
  const ObjectId water = world.add_fluid(fill(Vec3d{-0.6, 0, -0.2}, Vec3d{-0.2, 0.4, 0.2}, d),
                                         {.spacing = float(d),
                                          .viscosity = 0.5f,
                                          .surface_tension = 0.05f,
                                          .vorticity = 0.2f,
                                          .air_drag = 0.47f,
                                          .foam = 1},
                                         {.velocity = {4, 0, 0}, .max_particles = 1200});
  world.add_emitter(water, {.position = {0.4f, 0.6f, 0}, .radius = 0.08f, .speed = 2});
  world.add_drain({.shape = Sphere{{0.5f, 0, 0}, 0.1f}});
  const ObjectId veil = world.add_cloth(grid(9, 9, 0.4), {}, at({0, 0.3, 0}));
  world.pin(veil, vertices({0, 8}));
  world.add_soft_body(box({0.12, 0.12, 0.12}), {.density = 500}, {.cells = 60}, at({0.2, 0.1, 0}));
  world.add_grains(fill(Vec3d{0.3, 0, -0.1}, Vec3d{0.4, 0.2, 0.1}, 0.04),
                   {.radius = 0.015f, .density = 2000});
  return world;
}

template <class T>
std::uint64_t hash_of(std::span<T> values, std::uint64_t hash) {
  return fnv1a64(std::as_bytes(values), hash);
}

std::uint64_t hash_of_solids(int threads) {
  Settings settings{.substeps = 5, .sleeping = {.enabled = true, .seconds = 0.05f}, .threads = threads};
  World world(settings);
  add_crowd(world), add_coarse_cloths(world), add_rest(world);
  world.add_collider(Plane{.offset = -0.15f});
  std::size_t contacts = 0, asleep = 0;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 12)  // wakes the box that sleeps
      world.add_grains(std::vector<Vec3d>{{0, 0, 4}}, {.radius = 0.02f}, {.velocity = {0, -2, 0}});
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << report.message;
    contacts = std::max(contacts, report.contacts), asleep = std::max(asleep, report.asleep);
  }
  EXPECT_GT(contacts, 500u);
  EXPECT_GT(asleep, 0u);
  return world.hash();
}

std::uint64_t hash_of_fluids(int threads) {
  const auto pool = make_threads(Threading::automatic, threads);
  std::uint64_t hash = fnv1a64_start;
  for (const SmoothingShape kernel : {SmoothingShape::wendland, SmoothingShape::poly6_spiky,
                                      SmoothingShape::cubic_spline, SmoothingShape::wide_wendland}) {
    World world = splash(kernel, threads);
    for (int frame = 0; frame < 8; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok()) << world.report().message;
    EXPECT_GT(world.foam().positions.size(), 10u);
    const std::uint64_t state = world.hash();
    hash = hash_of(std::span(&state, 1), hash_of(world.foam().positions, hash));
    if (kernel != SmoothingShape::wendland) continue;
    const auto water = world.positions(world.find_object("fluid"));
    SplatShapes splats(0.04f);
    splats.build(water, *pool);
    hash = hash_of(splats.axes(), hash);
    for (const SurfaceMethod method : {SurfaceMethod::anisotropic, SurfaceMethod::isotropic}) {
      FluidSurface surface({.method = method, .spacing = 0.04f, .smoothing_passes = 2});
      hash = hash_of(std::span(surface.build(water, *pool).positions), hash);
    }
  }
  return hash;
}

std::string bits(int threads) {
  return fmt::format("bits {:016x} {:016x}", hash_of_solids(threads), hash_of_fluids(threads));
}

/// Runs in a process of its own: an instruction set is chosen once in a process.
TEST(SameBits, DISABLED_ArePrinted) {
  std::puts(bits(0).c_str());
}

TEST(SameBits, OnEveryInstructionSetWithAnyNumberOfThreads) {
  const std::string alone = bits(1), program = std::filesystem::read_symlink("/proc/self/exe").string();
  for (int threads = 8; const InstructionSet set : all_sets()) {
    const std::string command = fmt::format(
        "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX SOUPLE_SIMD={} SOUPLE_THREADS={} '{}' "
        "--gtest_also_run_disabled_tests --gtest_filter=SameBits.DISABLED_ArePrinted 2>&1",
        simd_name(set), threads, program);
    std::string said;
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::array<char, 4096> piece{};
    for (std::size_t n = 0; (n = fread(piece.data(), 1, piece.size(), pipe)) > 0;)
      said.append(piece.data(), n);
    pclose(pipe);
    if (said.find("which this build and this processor support") != std::string::npos) continue;
    EXPECT_NE(said.find(alone), std::string::npos)
        << simd_name(set) << ", " << threads << " threads: " << said;
    threads = threads == 8 ? 2 : threads + 1;
  }
}

// Contracts a chain of 200 links, stretched to twice its length, by 50 colored sweeps.
std::vector<Vec4f> contract_chain() {
  constexpr std::uint32_t particles = 201;
  std::vector<Vec4f> position(particles);
  for (std::uint32_t i = 0; i < particles; ++i)
    position[i] = {0.02f * static_cast<float>(i), 0, 0, i == 0 ? 0.0f : 1.0f};
  std::vector<Vec4f> moving(particles);
  const std::vector<Vec4f> start = moving;
  SetProjector<Distance> links;
  for (std::uint32_t i = 0; i + 1 < particles; ++i) links.add({i, i + 1}, {0.01f});
  links.prepare(particles);
  const ParticleView view{position, moving, start};
  const Substep substep{.h = 0.01f};
  links.begin_substep(view, substep);
  for (int sweep = 0; sweep < 50; ++sweep)
    for (int color = 0; color < links.color_count(); ++color) links.project(color, view, substep);
  for (std::uint32_t i = 0; i < particles; ++i) position[i].x += moving[i].x;
  return position;
}

// There is no global state: solvers on different threads share no data (checked by the thread sanitizer). Each gives
// the bits of a solver that runs alone.
TEST(Threads, SolversAreIndependent) {
  const std::vector<Vec4f> alone = contract_chain();
  ASSERT_LT(alone.back().x, 3.99f);
  std::vector<std::vector<Vec4f>> together(4);
  std::vector<std::thread> threads;
  threads.reserve(together.size());
  for (std::vector<Vec4f>& result : together) threads.emplace_back([&result] { result = contract_chain(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Vec4f>& result : together)
    EXPECT_EQ(std::memcmp(result.data(), alone.data(), alone.size() * sizeof(Vec4f)), 0);
}

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

}  // namespace souple::test_threads_world
