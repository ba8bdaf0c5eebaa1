#include "souple/io/checkpoint_file.h"
#include "souple/souple.h"
#include "souple/surface/fluid_surface.h"
#include "souple/threads/threads.h"
#include "tests/expect_error.h"
#include "tests/failing_allocations.h"
#include "tests/threads/busy_world.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

// Memory runs out at every allocation of small worlds: from building them to their third step.

namespace souple::test_world_out_of_memory {

namespace fs = std::filesystem;
using test::FailingAllocations;
using Which = FailingAllocations::Which;

constexpr double dt = 1.0 / 60;

/// A folder for the files of this process, removed at the end.
const fs::path& folder() {
  struct Folder {
    fs::path path =
        fs::path(testing::TempDir()) / ("souple_memory_" + std::to_string(std::random_device{}()));
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

struct Case {
  const char* name;
  void (*build)(World& world);
  void (*use)(World& world);  ///< after each step
  bool json = false;  ///< writes run.json while an exception unwinds: not all later allocations may fail
};

void read_all(World& world) {
  for (const ObjectId object : world.objects()) {
    world.positions(object);
    world.velocities(object);
    world.normals(object);
  }
  world.contacts();
  world.ray_cast({0.1f, 2, 0.1f}, {0, -1, 0});
  world.elastic_energy();
}

void cloth_on_itself(World& world) {
  ObjectOptions options{.transform = {{0, 0.3, 0}, Quatd::from_axis_angle({0, 0, 1}, 1.4), 1},
                        .self_collision = SelfCollision::surfaces};
  const ObjectId cloth = world.add_cloth(grid(6, 6, 0.5), {.bending = BendingModel::dihedral}, options);
  world.pin(cloth, vertices({0}));
  world.add_tethers(cloth);
  Settings settings = world.settings();
  settings.wind.velocity = {1, 0, 0};
  world.set_settings(settings);
  world.add_collider(Plane{});
  world.track_contacts(true);
}

void soft_bodies(World& world) {
  world.add_soft_body(tet_bar(2, 2, 2, {0.2, 0.2, 0.2}), {}, {.transform = {{0, 0.09, 0}, {}, 1}});
  world.add_soft_body(box({0.2, 0.2, 0.2}), {.model = SoftBodyModel::shape_matching}, {.cells = 40},
                      {.transform = {{0, 0.3, 0}, {}, 1}});
  world.add_collider(Plane{});
}

void rope(World& world) {
  const ObjectId rope =
      world.add_rope(std::vector<Vec3d>{{0, 0.1, 0}, {0.3, 0.1, 0}, {0.3, 0.1, 0.1}, {0, 0.11, 0.1}}, 24,
                     {.radius = 0.01f}, {.self_collision = SelfCollision::surfaces});
  const std::pair<VertexRef, VertexRef> joint[] = {{{rope, 0}, {rope, 24}}};
  world.connect(joint, -1, 0, dt * 1.5);
  world.attach(rope, vertices({12}), [](std::uint32_t, double t) { return Vec3d{0.3, 0.1 + t, 0.05}; });
  world.add_collider(Sphere{.radius = 0.09f});
}

void grains(World& world) {
  Settings settings = world.settings();
  settings.sleeping.enabled = true;
  world.set_settings(settings);
  std::vector<Vec3d> centers;
  centers.reserve(30);
  for (int i = 0; i < 30; ++i) {
    const int layer = i / 6;
    centers.push_back({0.021 * (i % 3), 0.011 + 0.021 * layer, 0.021 * (i % 2)});
  }
  world.add_grains(centers, {.radius = 0.011f}, {.angular_velocity = {1, 0, 0}});
  world.add_collider(Plane{});
}

void fluid(World& world) {
  const ObjectId water =
      world.add_fluid(fill({-0.2, 0, -0.2}, {0.2, 0.2, 0.2}, 0.05), {.spacing = 0.05f, .foam = 1},
                      {.velocity = {0, -3, 0}, .max_particles = 600});
  world.add_emitter(water, {.position = {0, 0.6f, 0}, .radius = 0.1f, .speed = 4});
  world.add_drain({.shape = Sphere{.radius = 0.06f}, .pose = {{0.1, 0.05, 0}, {}, 1}});
  world.add_soft_body(tet_bar(1, 1, 1, {0.1, 0.1, 0.1}), {}, {.transform = {{0, 0.3, 0}, {}, 1}});
  world.add_collider(Plane{});
}

void obstacle(World& world) {
  const TriangleMesh plate = grid(5, 5, 0.5);
  ObstacleMotion motion{.pose = ColliderMotion::keyframes({{0, {0, 0, 0}}, {0.3, {0, 0.5, 0}}}, true)};
  motion.sequence.loop = true;
  for (const double size : {1.0, 1.1, 1.0}) {
    std::vector<Vec3f>& frame = motion.sequence.frames.emplace_back();
    for (const Vec3d& x : plate.positions) frame.push_back(Vec3f(x * size));
  }
  world.add_obstacle(plate, {}, motion);
  world.add_cloth(grid(5, 5, 0.4), {}, {.transform = {{0, 0.01, 0}, {}, 1}});
}

void small_fluid(World& world) {
  world.add_fluid(fill({-0.1, 0, -0.1}, {0.1, 0.15, 0.1}, 0.05), {.spacing = 0.05f});
  world.add_collider(Plane{});
}

void extract_surface(World& world) {
  read_all(world);
  FluidSurface surface({.spacing = 0.05f});
  const auto threads = make_threads(Threading::automatic, world.settings().threads);
  surface.build(world.positions(world.objects()[0]), *threads);
}

void recorded(World& world) {
  world.add_cloth(grid(3, 3, 0.4), {}, {.transform = {{0, 0.1, 0}, {}, 1}});
  world.add_fluid(fill({0.5, 0, 0}, {0.6, 0.1, 0.1}, 0.05), {.spacing = 0.05f});
}

// The JSON library needs memory to destroy a document, or ends the process: run.json is written with spare memory.
void record(World& world) {
  std::optional<test::SpareMemory> spare(std::in_place);
  Recorder recorder(world, folder().string(), {.formats = {CacheFormat::pc2, CacheFormat::mdd}, .frames = 1});
  spare.reset();
  recorder.capture();
  Checkpoint checkpoint;
  checkpoint.version = "0.1.0";
  checkpoint.state = world.snapshot().bytes;
  write_checkpoint(folder() / "checkpoint.souple", checkpoint);
  read_checkpoint(folder() / "checkpoint.souple", "0.1.0");
  spare.emplace();
  recorder.finish();
}

const Case cases[] = {{"Cloth", cloth_on_itself, read_all},
                      {"SoftBodies", soft_bodies, read_all},
                      {"Rope", rope, read_all},
                      {"Grains", grains, read_all},
                      {"Fluid", fluid, read_all},
                      {"Obstacle", obstacle, read_all},
                      {"Surface", small_fluid, extract_surface},
                      {"Recorder", recorded, record, true}};

/// A world as far as it came.
struct Attempt {
  std::optional<World> world;
  std::optional<Snapshot> snapshot;  ///< after the first step
  std::uint64_t hash = 0;            ///< after the last step

  void steps(const Case& c, int count) {
    for (int i = 0; i < count; ++i) world->step(dt), c.use(*world);
  }
  void run(const Case& c, int threads) {
    world.emplace(Settings{.substeps = 2, .threads = threads});
    c.build(*world);
    steps(c, 1);
    snapshot = world->snapshot();
    finish(c);
  }
  void finish(const Case& c) {
    steps(c, 2);
    hash = world->hash();
  }
};

/// Calls that a program may make of a world after an exception.
void expect_usable(const Case& c, Attempt& attempt, std::uint64_t hash) {
  World& world = *attempt.world;
  for (const ObjectId object : world.objects()) {
    const std::span<const Vec3f> x = world.positions(object);
    EXPECT_TRUE(std::all_of(x.begin(), x.end(), [](const Vec3f& p) { return is_finite(p); }));
    world.velocities(object), world.normals(object);
  }
  world.contacts();
  if (attempt.snapshot) {
    world.restore(*attempt.snapshot);
    attempt.finish(c);
    EXPECT_EQ(attempt.hash, hash) << "the restored world goes on with other bits";
    return;
  }
  try {
    world.step(dt);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("restore a snapshot, or build the world again"),
              std::string::npos)
        << error.what();
  }
}

enum class Ended { bad_alloc, error, completed };

/// Runs the case while the n-th allocation fails. Sets `count` to the number of allocations.
Ended run_failing(const Case& c, int threads, long n, Which which, Attempt& attempt, long& count) {
  const FailingAllocations failing(n, which);
  Ended ended = Ended::completed;
  try {
    attempt.run(c, threads);
  } catch (const std::bad_alloc&) {
    ended = Ended::bad_alloc;
  } catch (const Error&) {
    ended = Ended::error;
  }
  count = failing.count();
  return ended;
}

/// About `samples` allocations fail in turn; 0: each.
void expect_all_survived(const Case& c, int threads, long samples) {
  Attempt whole;
  long count = 0;
  ASSERT_EQ(run_failing(c, threads, std::numeric_limits<long>::max(), Which::one, whole, count),
            Ended::completed);
  const long stride = samples > 0 ? std::max(1L, count / samples) : 1;
  long ended_early = 0, tried = 0;
  for (long n = 1; n <= count; n += stride)
    for (const Which which : {Which::one, Which::all_later}) {
      SCOPED_TRACE(std::string(c.name) + ", allocation " + std::to_string(n) +
                   (which == Which::one ? "" : " and all later ones"));
      if (c.json && which == Which::all_later) continue;
      Attempt attempt;
      long ignored = 0;
      ++tried;
      const Ended ended = run_failing(c, threads, n, which, attempt, ignored);
      if (ended == Ended::completed) {
        EXPECT_EQ(attempt.hash, whole.hash) << "a result without memory";
      }
      if (ended == Ended::bad_alloc) ++ended_early;
      if (ended != Ended::completed && attempt.world) expect_usable(c, attempt, whole.hash);
      if (testing::Test::HasFailure()) return;
    }
  EXPECT_GT(2 * ended_early, tried) << "few allocations failed: the test tests nothing";
}

class OutOfMemory : public testing::TestWithParam<int> {};

TEST_P(OutOfMemory, EndsInAnExceptionAfterWhichTheWorldCanBeRestored) {
  const Case& c = cases[static_cast<std::size_t>(GetParam())];
  for (const int threads : {1, 4}) expect_all_survived(c, threads, 30);
}

TEST_P(OutOfMemory, AtEveryAllocationSlow) {
  const Case& c = cases[static_cast<std::size_t>(GetParam())];
  for (const int threads : {1, 4}) expect_all_survived(c, threads, 0);
}

/// Jobs of a host, all but the first on threads of their own: the pool's threads get no part on a busy machine.
class ThreadPerJob final : public JobSystem {
 public:
  int workers() const override { return 3; }
  void run(std::size_t count, RangeFunction job) override {
    std::vector<std::thread> threads;
    threads.reserve(count);
    for (std::size_t i = 1; i < count; ++i) threads.emplace_back([job, i] { job(i, i + 1); });
    job(0, 1);
    for (std::thread& thread : threads) thread.join();
  }
};

// Loops of a world that is large enough for several threads.
TEST(OutOfMemoryOnAnotherThread, IsThrownByTheStepAndTheWorldCanBeRestored) {
  std::size_t thrown = 0;
  ThreadPerJob jobs;
  World whole = test::busy_world();
  whole.set_job_system(&jobs);
  const Snapshot start = whole.snapshot();
  whole.step(dt);
  for (long n = 1, count = 1; n <= count; n += 1 + count / 12) {
    World world = test::busy_world();
    world.set_job_system(&jobs);
    bool failed = false;
    {
      const FailingAllocations failing(n, Which::one_elsewhere);
      try {
        world.step(dt);
      } catch (const std::bad_alloc&) {
        failed = true;
      }
      count = failing.count();
    }
    if (failed) {
      ++thrown;
      EXPECT_THROW(world.step(dt), Error);
      EXPECT_THROW(world.snapshot(), Error);
      EXPECT_THROW(world.add_cloth(grid(3, 3, 1)), Error);
      world.restore(start);
      world.step(dt);
    }
    EXPECT_EQ(world.hash(), whole.hash()) << "allocation " << n << " of the other threads";
  }
  EXPECT_GT(thrown, 0u) << "no allocation of another thread failed";
}

// A constraint runs out of memory on any of the threads, in a step of a world with objects of several kinds.
TEST(AWorldWhoseStepThrew, CanBeReadAndRestoredAndRefusesEverythingElse) {
  for (const int threads : {1, 3}) {
    World world = test::busy_world({.threads = threads});
    bool scarce = false;
    auto projector = std::make_unique<CustomProjector>();
    for (std::uint32_t vertex = 0; vertex < 2000; ++vertex) {
      auto constraint = std::make_shared<CallbackConstraint>(
          std::vector<std::uint32_t>{vertex}, [&scarce, vertex](std::span<const Vec3f>, std::span<Vec3f>) {
            if (scarce && vertex == 1900) throw std::bad_alloc();
            return 1.0f;
          });
      constraint->sense = Sense::non_negative;
      constraint->concurrent = true;
      projector->add(std::move(constraint));
    }
    world.add_projector(std::move(projector));
    world.step(dt);
    const Snapshot snapshot = world.snapshot();
    const std::uint64_t before = world.hash();
    const double time = world.time();
    world.step(dt);
    const std::uint64_t after = world.hash();
    world.restore(snapshot);

    scarce = true;
    EXPECT_THROW(world.step(dt), std::bad_alloc);
    scarce = false;
    EXPECT_EQ(world.hash(), before);
    EXPECT_EQ(world.time(), time);
    EXPECT_TRUE(world.contacts().empty());
    const ObjectId cloth = world.objects()[0];
    const std::vector<std::uint32_t> corner{0};
    const std::vector<std::function<void()>> refused{
        [&] { world.step(dt); },
        [&] { world.snapshot(); },
        [&] { world.foam(); },
        [&] { world.memory(); },
        [&] { world.elastic_energy(); },
        [&] { world.time_solve(dt, 1); },
        [&] { world.add_cloth(grid(3, 3, 1)); },
        [&] { world.remove(cloth); },
        [&] { world.set_settings({}); },
        [&] { world.add_collider(Plane{}); },
        [&] { world.attach(cloth, vertices(corner)); },
    };
    for (const auto& call : refused) expect_error(call, {"restore a snapshot", "build the world again"});
    world.restore(snapshot);
    world.step(dt);
    EXPECT_EQ(world.hash(), after);
  }
}

std::string name_of(const testing::TestParamInfo<int>& info) {
  return cases[static_cast<std::size_t>(info.param)].name;
}

INSTANTIATE_TEST_SUITE_P(All, OutOfMemory, testing::Range(0, static_cast<int>(std::size(cases))), name_of);

}  // namespace souple::test_world_out_of_memory
