#include "souple/broad_phase/spatial_hash.h"
#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/intersections/crossings.h"
#include "tests/paths.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

// An object of a shipped scene is thrown at the next one, at 0 to 1e6 m/s. Time and memory of a frame follow the meshes
// and not the speed. No edge passes through a triangle unless the step says that it shortened motions. Each case prints
// its row of the table in docs/notes/collisions.md. With SOUPLE_ALL_SPEEDS in the environment it has all speeds, otherwise
// every third.

namespace souple::test_physics_speeds {

constexpr std::array<double, 8> speeds{0, 1, 10, 100, 1e3, 1e4, 1e5, 1e6};  // m/s
constexpr int frames_before = 2, frames_after = 3;

struct Outcome {
  double frame = 0;           // the longest: processor time outside the kernel [s]
  double megabytes = 0;       // peak of the process
  std::size_t crossings = 0;  // of surfaces that are kept apart, while no flag was raised
  bool flagged = false;       // shortened_motion
  bool finite = true;
  bool fluid = false;  // thrown; fluids have no bound of memory, and may end with Flag::non_finite
  bool ended = false;  // the process did not crash
};

double processor_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
}

/// Objects whose triangles collide: a body in a lattice collides by the lattice's nodes.
std::vector<ObjectId> surfaces_of(const World& world) {
  std::vector<ObjectId> surfaces;
  for (const ObjectId id : world.objects())
    if (!world.triangles(id).empty() && world.tet_statistics(id).cell_size == 0) surfaces.push_back(id);
  return surfaces;
}

/// Edges of an object that pass through triangles of another one.
std::size_t crossings_between(const World& world) {
  test::CrossingCounter all;
  std::vector<std::size_t> first{0};  // point of each object
  for (const ObjectId id : surfaces_of(world)) {
    all.add(world.positions(id), world.triangles(id));
    first.push_back(all.points.size());
  }
  std::vector<Bounds> boxes;
  for (const Triangle& t : all.triangles) {
    const auto x = [&](std::size_t k) { return Vec3f(all.points[t[k]]); };
    boxes.push_back(united(united({x(0), x(0)}, {x(1), x(1)}), {x(2), x(2)}));
  }
  SpatialHash hash;
  hash.build(boxes, SpatialHash::choose_cell_size(boxes), *make_threads(Threading::serial, 1));
  const auto object_of = [&](std::uint32_t point) {
    return std::upper_bound(first.begin(), first.end(), point) - first.begin();
  };
  std::size_t count = 0;
  std::vector<std::uint32_t> near;
  for (const Edge& edge : unique_edges(all.triangles)) {
    const Vec3f x(all.points[edge[0]]), y(all.points[edge[1]]);
    near.clear();
    hash.find(united({x, x}, {y, y}), near);
    for (const std::uint32_t t : near)
      if (object_of(edge[0]) != object_of(all.triangles[t][0]))
        count += all.passes(edge, all.triangles[t]) ? 1 : 0;
  }
  return count;
}

std::size_t crossings_of(const World& world) {
  std::size_t count = crossings_between(world);
  for (const ObjectId id : surfaces_of(world))
    if (world.self_collision(id) == SelfCollision::surfaces) count += world.count_crossings(id);
  return count;
}

Vec3d center(const World& world, ObjectId id) {
  Vec3d sum;
  for (const Vec3f& x : world.positions(id)) sum += Vec3d(x) / double(world.positions(id).size());
  return sum;
}

/// The object is aimed at the nearest other one, or at the floor, a little beside the middle.
Vec3d direction_of(const World& world, ObjectId thrown) {
  Vec3d to{0, -1, 0};
  double nearest = 1e9;
  for (const ObjectId id : world.objects()) {
    if (id == thrown || world.positions(id).empty()) continue;
    const Vec3d way = center(world, id) - center(world, thrown);
    if (length(way) < 1e-6 || length(way) >= nearest) continue;
    nearest = length(way);
    to = way / nearest;
  }
  to += Vec3d{0.05, -0.02, 0.03};
  return to / length(to);
}

Outcome watch(World& world, double dt) {
  Outcome outcome;
  for (int frame = 0; frame < frames_after && outcome.finite; ++frame) {
    const double start = processor_time();
    const StepReport& report = world.step(dt);
    outcome.frame = std::max(outcome.frame, processor_time() - start);
    outcome.flagged = outcome.flagged || report.has(Flag::shortened_motion);
    outcome.finite = report.ok();
    if (!outcome.flagged && outcome.finite) outcome.crossings += crossings_of(world);
  }
  return outcome;
}

Outcome throw_object(const std::string& scene_name, const std::string& object, double speed) {
  const SceneDescription scene = load_scene(source_path("scenes/" + scene_name + ".json"));
  World world = build_world(scene);
  Settings settings = world.settings();
  settings.threading = Threading::serial;
  settings.sleeping.enabled = false;
  world.set_settings(settings);
  const ObjectId thrown = world.find_object(object);
  for (int frame = 0; frame < frames_before; ++frame) world.step(1 / scene.frame_rate);
  const Vec3d push = direction_of(world, thrown) * (speed * world.total_mass(thrown));
  if (speed > 0) world.apply_impulse(thrown, all(), Vec3f(push));
  Outcome outcome = watch(world, 1 / scene.frame_rate);
  outcome.fluid = world.kind(thrown) == ObjectKind::fluid;
  return outcome;
}

/// Sheets above each other, every second one thrown up and the others down, over a floor. There is no air, which would stop
/// them within a few meters.
Outcome throw_sheets(int count, float speed) {
  World world({.substeps = 2,
               .wind = {.air_density = 0},
               .measure_residuals = false,
               .threading = Threading::serial});
  world.add_collider(Plane{{0, 1, 0}, -1});
  for (int i = 0; i < count; ++i)
    world.add_cloth(grid(25, 25, 1), {},
                    {.transform = {.translation = {0, 0.1 * i, 0}},
                     .velocity = {0, i % 2 == 0 ? -speed : speed, 0},
                     .self_collision = SelfCollision::surfaces});
  return watch(world, 1.0 / 60);
}

/// In a process of its own, whose peak of memory is that of the case.
template <class Case>
Outcome in_child(const Case& run) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    const Outcome outcome = run();
    const bool written = write(ends[1], &outcome, sizeof outcome) == ssize_t{sizeof outcome};
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Outcome outcome;
  const bool read_all = child > 0 && read(ends[0], &outcome, sizeof outcome) == ssize_t{sizeof outcome};
  close(ends[0]);
  int status = 0;
  rusage usage{};
  if (child > 0) wait4(child, &status, 0, &usage);
  outcome.ended = read_all && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  outcome.megabytes = double(usage.ru_maxrss) / 1024;
  return outcome;
}

struct Thrown {
  const char *scene, *object;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest looks for this name
void PrintTo(const Thrown& thrown, std::ostream* out) {
  *out << thrown.scene;
}

class Speeds : public testing::TestWithParam<Thrown> {};

TEST_P(Speeds, TimeAndMemoryAreThoseOfTheMeshSlow) {
  const auto [scene, object] = GetParam();
  const auto thrown_at = [&](double speed) {
    return in_child([&] { return throw_object(scene, object, speed); });
  };
  const Outcome calm = thrown_at(speeds[0]);
  ASSERT_TRUE(calm.ended);
  std::string row =
      fmt::format("| {}, {} | {:.0f} ms, {:.0f} MB |", scene, object, 1e3 * calm.frame, calm.megabytes);
  const std::size_t stride = std::getenv("SOUPLE_ALL_SPEEDS") ? 1 : 3;
  for (std::size_t i = 1; i < speeds.size(); i += stride) {
    const Outcome fast = thrown_at(speeds[i]);
    EXPECT_TRUE(fast.ended) << speeds[i] << " m/s";
    if (!fast.fluid) {
      EXPECT_TRUE(fast.finite) << speeds[i] << " m/s";
      EXPECT_LT(fast.megabytes, calm.megabytes + 300) << speeds[i] << " m/s";
    }
    if (calm.crossings == 0) {
      EXPECT_EQ(fast.crossings, 0u) << speeds[i] << " m/s";
    }
    row += fmt::format(" {:.1f}, {:+.0f}{}{} |", fast.frame / calm.frame, fast.megabytes - calm.megabytes,
                       !fast.finite   ? " n"
                       : fast.flagged ? " s"
                                      : "",
                       fast.crossings > 0 ? fmt::format(" {}x", fast.crossings) : "");
  }
  std::printf("%s\n", row.c_str());
}

INSTANTIATE_TEST_SUITE_P(Scenes, Speeds,
                         testing::Values(Thrown{"balloon", "balloon"}, Thrown{"balls_in_a_glass", "ball1"},
                                         Thrown{"brick_wall", "brick_1"}, Thrown{"curtain", "curtain"},
                                         Thrown{"dam_break", "water"}, Thrown{"ducks", "duck"},
                                         Thrown{"one_room", "tablecloth"}, Thrown{"flag", "flag"},
                                         Thrown{"folded_cloth", "cloth"}, Thrown{"layers", "coat"},
                                         Thrown{"reef_knot", "left"}, Thrown{"rope_bridge", "plank_1"},
                                         Thrown{"sand_pile", "sand"}, Thrown{"shot", "grains"},
                                         Thrown{"stiff_boxes", "box_1"}, Thrown{"tablecloth", "tablecloth"},
                                         Thrown{"trampoline", "ball"}, Thrown{"turning_torus", "cloth"},
                                         Thrown{"water_balloon", "balloon"}, Thrown{"wrung_cloth", "tube"}),
                         [](const auto& tested) { return tested.param.scene; });

// Five sheets at 300 m/s took 5 GB.
TEST(SheetsAtSpeed, ManySheetsThatArriveTogetherTakeLittleMemory) {
  for (const auto& [count, speed] : {std::pair{5, 300.0f}, {5, 3000.0f}, {10, 30.0f}, {10, 300.0f}}) {
    SCOPED_TRACE(fmt::format("{} sheets at {} m/s", count, speed));
    const Outcome outcome = in_child([&] { return throw_sheets(count, speed); });
    EXPECT_TRUE(outcome.ended && outcome.finite);
    EXPECT_LT(outcome.megabytes, 400);
    EXPECT_EQ(outcome.crossings, 0u);
  }
}

}  // namespace souple::test_physics_speeds
