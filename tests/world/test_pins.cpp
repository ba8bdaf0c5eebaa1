#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_pins {

TEST(Pins, SelectorsMeanTheSameVertices) {
  World world;
  TriangleMesh mesh = grid(5, 5, 2);
  mesh.groups["corner"] = {0};
  const ObjectId cloth = world.add_cloth(mesh);
  using List = std::vector<std::uint32_t>;
  EXPECT_EQ(world.select(cloth, group("corner")), List{0});
  EXPECT_EQ(world.select(cloth, nearest({-5, 0, -5})), List{0});
  EXPECT_EQ(world.select(cloth, in_box({-1.1f, -1, -1.1f}, {-0.9f, 1, -0.9f})), List{0});
  EXPECT_EQ(world.select(cloth, vertices({3, 1, 3})), (List{1, 3}));
  EXPECT_EQ(world.select(cloth, all()).size(), 25u);
  expect_error([&] { world.pin(cloth, group("corners")); }, {"corners", "did you mean 'corner'"});
  expect_error([&] { world.pin(cloth, vertices({25})); }, {"25"});
  expect_error([&] { world.pin(cloth, in_box({5, 5, 5}, {6, 6, 6})); }, {"no vertex"});
}

TEST(Pins, APinnedVertexStaysAndAnUnpinnedOneFalls) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(5, 5, 1));
  world.pin(cloth, vertices({0, 4}));
  EXPECT_EQ(world.pinned(cloth), (std::vector<std::uint32_t>{0, 4}));
  const Vec3f before = world.positions(cloth)[4];
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  EXPECT_EQ(world.positions(cloth)[4], before);
  world.unpin(cloth, all());
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  EXPECT_LT(world.positions(cloth)[4].y, before.y - 2);
}

TEST(Pins, ATargetIsFollowedExactly) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(5, 5, 1));
  world.pin(cloth, vertices({0}), [](std::uint32_t, double t) { return Vec3d{std::sin(t), 1 + t, 0}; });
  for (int i = 1; i <= 30; ++i) {
    world.step(1.0 / 60);
    const double t = i / 60.0;
    ASSERT_LT(length(Vec3d(world.positions(cloth)[0]) - Vec3d{std::sin(t), 1 + t, 0}), 1e-6);
  }
  EXPECT_NEAR(world.velocities(cloth)[0].y, 1, 1e-3);
}

// The vertex stays, and the message tells whose target it is.
TEST(Pins, ATargetThatIsNotFiniteIsNamed) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), infinity, 1e19}) {
    World world;
    const ObjectId cloth = world.add_cloth(grid(3, 3, 1), {}, {.name = "sheet"});
    const auto target = [bad](std::uint32_t vertex, double t) {
      return Vec3d{t > 0.02 ? bad : vertex == 3 ? -0.5 : 0.5, 0, 0};
    };
    world.pin(cloth, vertices({3}), target);
    world.attach(cloth, vertices({5}), target, 0.01f);
    EXPECT_TRUE(world.step(1.0 / 60).message.empty());
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok());
    EXPECT_TRUE(report.has(Flag::callback_failed));
    EXPECT_NE(report.message.find("a pin's target"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find("vertex 3 of sheet"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find("an attachment's target"), std::string::npos) << report.message;
    EXPECT_NE(report.message.find("vertex 5 "), std::string::npos) << report.message;
    EXPECT_LT(length(world.positions(cloth)[3] - Vec3f{-0.5f, 0, 0}), 1e-6f);
  }
}

// A spring of stiffness 1/compliance between the cloth's only free particle and a moving target: m g / k
// below it at rest.
TEST(Pins, AnAttachmentIsASpring) {
  World world({.substeps = 20, .drag = 4});
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0, 0, 0}}, {.radius = 0.05f, .density = 1000});
  const auto m = world.total_mass(grain);
  world.attach(
      grain, all(),
      [](std::uint32_t, double) {
        return Vec3d{0, 2, 0};
      },
      1e-2f);
  for (int i = 0; i < 600; ++i) world.step(1.0 / 60);
  EXPECT_NEAR(world.positions(grain)[0].y, 2 - m * 9.81 * 1e-2, 1e-4);
}

struct JoinedRopes {
  World world{{.substeps = 30}};
  ObjectId left, right;
  ProjectorId joint;

  explicit JoinedRopes(std::optional<double> until = {}) {
    const Vec3d a[] = {{0, 0, 0}, {1, 0, 0}}, b[] = {{1, 0, 0}, {2, 0, 0}};
    left = world.add_rope(a, 10), right = world.add_rope(b, 10);
    world.pin(left, vertices({0}));
    const std::pair<VertexRef, VertexRef> tie{{left, 10}, {right, 0}};
    joint = world.connect(std::span(&tie, 1), 0, 0, until);
  }
  void step(int frames) {
    for (int i = 0; i < frames; ++i) world.step(1.0 / 60);
  }
  float gap() const { return length(world.positions(left)[10] - world.positions(right)[0]); }
};

TEST(Pins, ConnectedVerticesStayTogether) {
  JoinedRopes tied;
  tied.step(120);
  EXPECT_LT(tied.gap(), 2e-3f);
  tied.world.remove(tied.joint);
  tied.step(60);
  EXPECT_GT(tied.gap(), 1.0f);
}

TEST(Pins, ConnectedVerticesHaveADistanceThatIsANumber) {
  JoinedRopes tied;
  const std::pair<VertexRef, VertexRef> pair{{tied.left, 5}, {tied.right, 5}};
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {std::nanf(""), infinity, -infinity, 3e38f, 1e10f})
    expect_error([&] { tied.world.connect(std::span(&pair, 1), bad); }, {"connect: rest_length", "finite"});
  tied.step(1);
  EXPECT_TRUE(tied.world.report().ok());
}

// Frames 1 to 30 start before 0.5 s; the 31st starts then.
TEST(Pins, JointsAreReleasedInTime) {
  JoinedRopes tied(0.5);
  tied.step(30);
  EXPECT_LT(tied.gap(), 5e-3f);
  tied.step(30);
  EXPECT_GT(tied.gap(), 0.5f);
  expect_error([] { JoinedRopes(-1.0); }, {"until", "-1"});
}

// Snapshots from before and after the release: a restored world continues as before, and reactivates the
// joints that were active.
TEST(Pins, SnapshotsKeepWhichJointsAreActive) {
  JoinedRopes tied(0.5), other(0.5);
  tied.step(20);
  const Snapshot before = tied.world.snapshot();
  tied.step(20);
  const Snapshot after = tied.world.snapshot();
  tied.step(20);
  const std::uint64_t end = tied.world.hash();
  tied.world.restore(before);
  tied.step(9);
  EXPECT_LT(tied.gap(), 5e-3f);
  tied.step(31);
  EXPECT_EQ(tied.world.hash(), end);
  other.world.restore(after);
  other.step(20);
  EXPECT_EQ(other.world.hash(), end);
}

// Soft cloth stretches; tethers keep its end within 1 + slack of the rest length.
TEST(Pins, TethersLimitTheReach) {
  const auto hang = [](bool tethers) {
    World world({.drag = 2});
    const ObjectId cloth = world.add_cloth(grid(5, 21, 0.4), {.membrane_stiffness = 5});
    world.pin(cloth, vertices({0, 1, 2, 3, 4}));
    if (tethers) world.add_tethers(cloth, 0.05f);
    for (int i = 0; i < 300; ++i) world.step(1.0 / 60);
    return length(world.positions(cloth)[102] - world.positions(cloth)[2]);
  };
  EXPECT_GT(hang(false), 2.2f);
  EXPECT_LT(hang(true), 2.0f * 1.05f * 1.005f);
}

TEST(Pins, PressureNeedsAClosedSurface) {
  World world;
  const ObjectId sheet = world.add_cloth(grid(3, 3, 1));
  expect_error([&] { world.set_pressure(sheet, 100); }, {"cloth", "8 edges are open", "1 hole ("});
  const ObjectId ball = world.add_cloth(sphere(2, 0.5), {.membrane_stiffness = 100});
  world.set_settings({.gravity = {}, .drag = 2});
  world.set_pressure(ball, 50);
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  EXPECT_GT(length(world.positions(ball)[0] - Vec3f(world.center_of_mass(ball))), 0.51f);
}

// The solvers, the coloring and the report work for a user's struct.
struct OnTheGround {
  static constexpr const char* name = "on_the_ground";
  static constexpr int arity = 1;
  static constexpr Sense sense = Sense::non_negative;
  template <class T>
  struct Params {
    T height;
  };
  template <class T>
  static Vec3<T> origin(const Params<T>&) {
    return {};
  }
  template <class T>
  static T evaluate(const Vec3<T> (&x)[1], const Params<T>& p, Vec3<T> (&gradient)[1]) {
    gradient[0] = {T(0), T(1), T(0)};
    return x[0].y - p.height;
  }
};

TEST(Pins, AUsersOwnConstraint) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(5, 5, 1));
  auto mine = std::make_unique<SetProjector<OnTheGround>>();
  for (std::uint32_t v = 0; v < 25; ++v) mine->add({world.particle(cloth, v)}, {-0.5f});
  world.add_projector(std::move(mine));
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  for (const Vec3f& x : world.positions(cloth)) EXPECT_NEAR(x.y, -0.5f, 1e-3f);
  const auto& kinds = world.report().kinds;
  EXPECT_TRUE(
      std::any_of(kinds.begin(), kinds.end(), [](const KindReport& k) { return k.kind == "on_the_ground"; }));
}

TEST(Pins, AConstraintOnNobodyIsRefused) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1));
  auto bad = std::make_unique<SetProjector<Distance>>();
  bad->add({0, 99}, {1.0f});
  expect_error([&] { world.add_projector(std::move(bad)); }, {"distance 0", "particle 99", "there are 9"});
  auto later = std::make_unique<SetProjector<Distance>>();
  SetProjector<Distance>& mine = *later;
  world.add_projector(std::move(later));
  mine.add({0, 99}, {1.0f});
  const std::uint64_t before = world.hash();
  EXPECT_NE(world.step(0.01).message.find("particle 99"), std::string::npos);
  EXPECT_EQ(world.hash(), before);
  EXPECT_TRUE(world.contains(cloth));
}

// Inputs of a game: colliders and pins that arrive at a pose, wind of each object, force fields that know whom they
// push. Also the host's threads, and warnings.

constexpr double dt = 1.0 / 60;

Quatd turn_about_y(double angle) {
  return {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
}

/// A plate that rises under a grain carries it: it is swept, and arrives where it was told, with the step's speed.
TEST(Arrivals, AColliderArrivesAtItsPoseAndSweepsItsPath) {
  World world({.gravity = {}});
  const ColliderId plate = world.add_collider(Box{.half_extents = {1, 0.05f, 1}});
  const ObjectId grain = world.add_grains(std::vector<Vec3d>{{0, 0.2, 0}}, {.radius = 0.02f});
  double y = 0;
  for (int frame = 0; frame < 20; ++frame) {
    y += 0.05;  // 3 m/s: in one jump the plate would be beyond the grain
    world.move_collider(plate, {{0, y, 0}, turn_about_y(0.1 * frame)});
    world.step(dt);
    EXPECT_EQ(world.collider_pose(plate).translation.y, y);
    EXPECT_NEAR(world.collider_pose(plate).rotation.y, std::sin(0.05 * frame), 1e-12);
  }
  EXPECT_GT(world.positions(grain)[0].y, y + 0.05 + 0.02 - 1e-3);
  EXPECT_NEAR(world.velocities(grain)[0].y, 3, 0.05);
  world.step(dt);  // without another call it stays
  EXPECT_EQ(world.collider_pose(plate).translation.y, y);
}

TEST(Arrivals, HalfWayThroughTheStepAColliderIsHalfWay) {
  World world({.substeps = 2});
  const ColliderId ball = world.add_collider(Sphere{});
  std::vector<double> seen;
  world.after(Stage::velocity, [&](World& w) { seen.push_back(w.collider_pose(ball).translation.x); });
  world.move_collider(ball, {{1, 0, 0}});
  world.step(dt);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_NEAR(seen[1], 0.5, 1e-12);  // time advances after the stage
  EXPECT_EQ(world.collider_pose(ball).translation.x, 1);
}

TEST(Arrivals, PinsArriveStraightAndKeepTheSpeed) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(5, 5, 1.0f));
  world.pin(cloth, vertices({0, 4}));
  const Vec3f first = world.positions(cloth)[0];
  const Transform bone{{0, 0.25, 0}, turn_about_y(0.5)};
  world.move_pins(cloth, vertices({0, 4}), bone);
  world.step(dt);
  const Vec3d there = bone.point(Vec3d(first));
  EXPECT_LT(length(Vec3d(world.positions(cloth)[0]) - there), 1e-6);
  EXPECT_NEAR(world.velocities(cloth)[0].y, 0.25 / dt, 1e-2);
  world.step(dt);
  EXPECT_LT(length(Vec3d(world.positions(cloth)[0]) - there), 1e-6);
  EXPECT_EQ(world.velocities(cloth)[0].y, 0);
  // Another call with this motion gives the same place: it counts from where the vertices were pinned.
  world.move_pins(cloth, vertices({0}), bone);
  world.step(dt);
  EXPECT_LT(length(Vec3d(world.positions(cloth)[0]) - there), 1e-6);
  const std::uint32_t chosen[] = {4};
  const Vec3f place[] = {{0.5f, 1, -0.5f}};
  world.move_pins(cloth, chosen, place);
  world.step(dt);
  EXPECT_LT(length(world.positions(cloth)[4] - place[0]), 1e-6f);
}

TEST(Arrivals, OfALatticeAVertexTakesItsTetWithIt) {
  World world({.gravity = {}});
  const ObjectId body = world.add_soft_body(sphere(2, 0.5), {}, {.cells = 300});
  world.pin(body, nearest({0, 0.5f, 0}));
  const std::uint32_t top = world.select(body, nearest({0, 0.5f, 0}))[0];
  const Vec3f before = world.positions(body)[top];
  world.move_pins(body, vertices({top}), {{0.1, 0, 0}});
  world.step(dt);
  EXPECT_LT(length(world.positions(body)[top] - before - Vec3f{0.1f, 0, 0}), 1e-5f);
}

TEST(Arrivals, SayWhatIsWrong) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1.0f), {}, {.name = "cape"});
  world.pin(cloth, vertices({0}));
  expect_error([&] { world.move_pins(cloth, all(), {}); },
               {"move_pins: vertex 1 of cape is not pinned; pin it first"});
  const std::uint32_t one[] = {0};
  expect_error([&] { world.move_pins(cloth, one, {}); }, {"1 vertices of cape and 0 positions"});
  const ColliderId ball = world.add_collider(Sphere{});
  EXPECT_THROW(world.move_collider(ball, {{std::nan(""), 0, 0}}), Error);
  EXPECT_THROW(world.set_wind_exposure(cloth, -1), Error);
}

/// Also in a world that is built again, where the collider was never moved.
TEST(Arrivals, ARestoredWorldGoesOnBitwise) {
  const auto built = [] {
    World world;
    const ObjectId cloth = world.add_cloth(grid(12, 12, 1.0f));
    world.pin(cloth, vertices({0, 11}));
    world.add_collider(Capsule{.center = {0, -0.4f, 0}, .radius = 0.2f});
    return world;
  };
  const auto play = [](World& world, int from, int to) {
    for (int frame = from; frame < to; ++frame) {
      const Transform pose{{0.02 * frame, 0.01 * frame, 0}, turn_about_y(0.05 * frame)};
      world.move_collider(world.colliders()[0], pose);
      world.move_pins(world.objects()[0], vertices({0, 11}), pose);
      world.step(dt);
    }
  };
  World world = built();
  const Snapshot first = world.snapshot();
  play(world, 0, 10);
  const Snapshot snapshot = world.snapshot();
  play(world, 10, 20);
  const std::uint64_t end = world.hash();
  World again = built();
  again.restore(snapshot);
  play(again, 10, 20);
  EXPECT_EQ(again.hash(), end);
  world.restore(first);
  EXPECT_EQ(world.collider_pose(world.colliders()[0]).translation.x, 0);
  play(world, 0, 20);
  EXPECT_EQ(world.hash(), end);
}

TEST(Wind, ReachesEachObjectByItsExposure) {
  World world({.gravity = {}});
  const ObjectId open = world.add_cloth(grid(5, 5, 1.0f)), half = world.add_cloth(grid(5, 5, 1.0f)),
                 sheltered = world.add_cloth(grid(5, 5, 1.0f));
  for (const ObjectId cloth : {half, sheltered}) world.teleport(cloth, {{0, cloth == half ? 3.0 : 6.0, 0}});
  world.set_wind({.velocity = {0, 4, 0}});
  world.set_wind_exposure(half, 0.5f);
  world.set_wind_exposure(sheltered, 0);
  EXPECT_EQ(world.wind_exposure(open), 1);
  world.step(dt);
  const double all = world.momentum(open).y, some = world.momentum(half).y;
  EXPECT_GT(all, 0);
  EXPECT_NEAR(some / all, 0.25, 0.04);  // drag goes by the square of the speed
  EXPECT_EQ(world.momentum(sheltered).y, 0);
}

TEST(ForceFields, KnowObjectAndVertex) {
  World world({.gravity = {}});
  const ObjectId left = world.add_cloth(grid(3, 3, 1.0f)), right = world.add_cloth(grid(3, 3, 1.0f));
  world.teleport(right, {{5, 0, 0}});
  world.add_force_field([&](const ForcePoint& point) {
    return point.object == right && point.vertex == 4 ? Vec3f{0, 100 * point.mass, 0} : Vec3f{};
  });
  world.step(1e-3);
  EXPECT_EQ(world.momentum(left).y, 0);
  std::uint32_t fastest = 0;
  for (std::uint32_t v = 1; v < 9; ++v)
    if (world.velocities(right)[v].y > world.velocities(right)[fastest].y) fastest = v;
  EXPECT_EQ(fastest, 4u);
}

/// Runs each job on a thread of its own, the last one first.
class Reversed final : public JobSystem {
 public:
  int workers() const override { return 3; }
  void run(std::size_t count, RangeFunction job) override {
    ++runs;
    for (std::size_t i = count; i-- > 0;) std::thread([&] { job(i, i + 1); }).join();
  }
  int runs = 0;
};

TEST(Jobs, OfTheHostGiveTheSameBits) {
  const auto hash = [](JobSystem* jobs) {
    World world({.threads = 1});
    world.set_job_system(jobs);
    world.add_cloth(grid(60, 60, 1.0f));
    world.add_collider(Sphere{.center = {0, -0.4f, 0}, .radius = 0.3f});
    for (int i = 0; i < 4; ++i) world.step(dt);
    return world.hash();
  };
  Reversed jobs;
  EXPECT_EQ(hash(&jobs), hash(nullptr));
  EXPECT_GT(jobs.runs, 0);
}

TEST(Log, HasAWarningOnceUntilItClears) {
  World world({.gravity = {}, .drag = 2});
  const ObjectId cloth = world.add_cloth(grid(8, 8, 1.0f));
  world.pin(cloth, vertices({0, 7, 56, 63}));
  int warnings = 0;
  world.set_log([&](LogLevel level, std::string_view) { warnings += level == LogLevel::warning ? 1 : 0; });
  const std::uint32_t corner[] = {0};
  const Vec3f rest[] = {world.positions(cloth)[0]}, far[] = {{-0.9f, 0, -0.9f}};
  int flagged = 0;
  for (int round = 1; round <= 2; ++round) {
    world.move_pins(cloth, corner, far);
    for (int i = 0; i < 20; ++i)
      flagged += world.step(dt).flags & static_cast<std::uint32_t>(Flag::large_strain) ? 1 : 0;
    EXPECT_GE(warnings, round);
    EXPECT_LE(warnings, 3 * round) << flagged << " flagged steps";
    world.move_pins(cloth, corner, rest);
    for (int i = 0; i < 120; ++i) world.step(dt);
    EXPECT_EQ(world.report().message, "") << "the cloth has not recovered";
  }
  EXPECT_GT(flagged, 30);
}

}  // namespace souple::test_world_pins
