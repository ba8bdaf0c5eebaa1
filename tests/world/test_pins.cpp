#include "souple/constraints/distance.h"
#include "souple/solver/set_projector.h"
#include "souple/souple.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>

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

// A spring of stiffness 1/compliance between the cloth's only free particle and a moving target: m g / k
// below it at rest.
TEST(Pins, AnAttachmentIsASpring) {
  World world({.substeps = 20, .drag = 4});
  const Vec3d points[] = {{0, 0, 0}};
  const ObjectId grain = world.add_grains(points, {.radius = 0.05f, .density = 1000});
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

TEST(Pins, ConnectedVerticesStayTogether) {
  World world({.substeps = 30});
  const Vec3d a[] = {{0, 0, 0}, {1, 0, 0}}, b[] = {{1, 0, 0}, {2, 0, 0}};
  const ObjectId left = world.add_rope(a, 10), right = world.add_rope(b, 10);
  world.pin(left, vertices({0}));
  const std::pair<VertexRef, VertexRef> tie{{left, 10}, {right, 0}};
  const ProjectorId id = world.connect(std::span(&tie, 1));
  for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
  EXPECT_LT(length(world.positions(left)[10] - world.positions(right)[0]), 2e-3f);
  world.remove(id);
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  EXPECT_GT(length(world.positions(left)[10] - world.positions(right)[0]), 1.0f);
}

struct JoinedRopes {
  World world{{.substeps = 30}};
  ObjectId left, right;

  explicit JoinedRopes(std::optional<double> until) {
    const Vec3d a[] = {{0, 0, 0}, {1, 0, 0}}, b[] = {{1, 0, 0}, {2, 0, 0}};
    left = world.add_rope(a, 10), right = world.add_rope(b, 10);
    world.pin(left, vertices({0}));
    const std::pair<VertexRef, VertexRef> tie{{left, 10}, {right, 0}};
    world.connect(std::span(&tie, 1), 0, 0, until);
  }
  void step(int frames) {
    for (int i = 0; i < frames; ++i) world.step(1.0 / 60);
  }
  float gap() const { return length(world.positions(left)[10] - world.positions(right)[0]); }
};

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
  expect_error([&] { world.set_pressure(sheet, 100); }, {"cloth", "not closed", "8 open edges"});
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

}  // namespace souple::test_world_pins
