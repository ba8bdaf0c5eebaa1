#include "souple/host/grab.h"
#include "souple/solver/projector.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

// Objects at rest fall asleep. They wake when they or objects near them are moved.

namespace souple::test_world_sleeping {

constexpr double frame = 1.0 / 60;

Settings sleepy(int threads = 0) {
  Settings settings;
  settings.sleeping.enabled = true;
  settings.threads = threads;
  return settings;
}

/// Number of frames until all objects sleep, or `most`.
int frames_until_asleep(World& world, int most) {
  std::size_t movable = 0;
  for (const ObjectId id : world.objects()) movable += world.kind(id) != ObjectKind::obstacle ? 1 : 0;
  for (int k = 1; k <= most; ++k)
    if (world.step(frame).asleep == movable) return k;
  return most;
}

ObjectId add_box(World& world, const Vec3d& where, const char* name) {
  ObjectOptions options = at(where);
  options.name = name;
  return world.add_soft_body(tet_bar(2, 1, 2, {0.4, 0.2, 0.4}), {.young_modulus = 1e5f, .damping = 10},
                             options);
}

void add_heap_of_cloth(World& world) {
  ObjectOptions options = at(0, 0.25, 0);
  options.transform.rotation = Quatd::from_euler_xyz({0.3, 0, 1.4});
  options.self_collision = SelfCollision::surfaces;
  world.add_cloth(grid(9, 9, 0.4), {.damping = 4}, options);
}

void add_grains(World& world) {
  std::vector<Vec3d> centers;
  centers.reserve(75);
  for (int layer = 0; layer < 3; ++layer)
    for (int k = 0; k < 5; ++k)
      for (int i = 0; i < 5; ++i)
        centers.push_back({0.041 * i + 0.001 * ((i + k) % 3), 0.02 + 0.041 * layer, 0.041 * k});
  world.add_grains(centers, {.radius = 0.02f, .friction = 0.8f});
}

// Objects of every kind on a floor.
TEST(Sleeping, WhatLiesStillFallsAsleepAndStaysToTheBit) {
  const std::function<void(World&)> heaps[] = {
      add_heap_of_cloth,
      [](World& world) {
        add_box(world, {0, 0.2, 0}, "box");
      },
      [](World& world) {
        world.add_soft_body(box({0.3, 0.1, 0.3}), {.young_modulus = 1e5f, .damping = 10}, {.cells = 60},
                            at({0, 0.1, 0}));
      },
      add_grains,
      [](World& world) {
        world.add_rope(std::vector<Vec3d>{{-0.5, 0.1, 0}, {0.5, 0.15, 0}}, 30, {.damping = 4});
      },
  };
  for (const auto& add : heaps) {
    World world(sleepy());
    world.add_collider(Plane{}, {.friction = 0.8f});
    add(world);
    const ObjectId id = world.objects()[0];
    SCOPED_TRACE(std::string(kind_name(world.kind(id))));
    EXPECT_FALSE(world.is_asleep(id));
    const int frames = frames_until_asleep(world, 600);
    EXPECT_LT(frames, 600);
    EXPECT_GT(frames, 30) << "at rest for half a second first";
    ASSERT_TRUE(world.is_asleep(id));
    EXPECT_EQ(world.kinetic_energy(id), 0.0);
    const std::vector<Vec3f> before = copy(world.positions(id));
    run(world, 1);
    EXPECT_TRUE(world.is_asleep(id));
    EXPECT_EQ(world.kinetic_energy(id), 0.0);
    EXPECT_EQ(copy(world.positions(id)), before);
    for (const Vec3f& v : world.velocities(id)) ASSERT_EQ(v, Vec3f{});
  }
}

TEST(Sleeping, NothingSleepsUnlessAsked) {
  World world;
  world.add_collider(Plane{});
  const ObjectId box = add_box(world, {0, 0.1, 0}, "box");
  run(world, 3);
  EXPECT_FALSE(world.is_asleep(box));
  EXPECT_EQ(world.report().asleep, 0u);
}

// A sheet pinned at its corners must catch a falling object as if it had never slept.
TEST(Sleeping, ABallWakesTheSheetThatCatchesIt) {
  const auto deepest = [](bool enabled) {
    World world({.sleeping = {.enabled = enabled}});
    const ObjectId sheet = world.add_cloth(grid(13, 13, 1), {.thickness = 0.01f, .damping = 6});
    world.pin(sheet, vertices({0, 12, 156, 168}));
    run(world, 8);
    EXPECT_EQ(world.is_asleep(sheet), enabled);
    const double rest = world.center_of_mass(sheet).y;
    const std::vector<Vec3d> center{{0.01, 0.4, 0.02}};
    const ObjectId ball = world.add_grains(center, {.radius = 0.06f, .density = 300});
    run(world, 0.1);
    EXPECT_EQ(world.is_asleep(sheet), enabled) << "the ball has not come near";
    double lowest = rest;
    for (int k = 0; k < 40; ++k) {
      world.step(frame);
      lowest = std::min(lowest, world.center_of_mass(sheet).y);
    }
    EXPECT_FALSE(world.is_asleep(sheet));
    EXPECT_GT(world.center_of_mass(ball).y, -0.4) << "caught";
    return rest - lowest;
  };
  const double slept = deepest(true), awake = deepest(false);
  EXPECT_GT(awake, 0.02);
  EXPECT_NEAR(slept, awake, 0.1 * awake);
}

// Both share the momentum of the impact: no immovable wall absorbs it.
TEST(Sleeping, ABlowIsFeltByBothSides) {
  Settings settings = sleepy();
  settings.gravity = {};
  World world(settings);
  const ObjectId target = add_box(world, {0, 0, 0}, "target");
  EXPECT_LT(frames_until_asleep(world, 60), 60);
  ObjectOptions options = at({-0.6, 0.01, 0.01});
  options.velocity = {2, 0, 0};
  const ObjectId bullet =
      world.add_soft_body(tet_bar(1, 1, 1, {0.1, 0.1, 0.1}), {.young_modulus = 1e5f}, options);
  const Vec3d before = world.momentum(bullet);
  run(world, 1);
  const Vec3d after = world.momentum(bullet) + world.momentum(target);
  EXPECT_LT(length(after - before), 1e-3 * length(before));
  EXPECT_GT(world.momentum(target).x, 0.5 * before.x);
}

TEST(Sleeping, GrainsAndRopesAreWokenToo) {
  World world(sleepy());
  world.add_collider(Plane{}, {.friction = 0.8f});
  add_grains(world);
  const ObjectId heap = world.objects()[0];
  EXPECT_LT(frames_until_asleep(world, 600), 600);
  world.add_grains(std::vector<Vec3d>{{0.08, 0.6, 0.08}}, {.radius = 0.02f});
  run(world, 0.15);
  EXPECT_TRUE(world.is_asleep(heap));
  run(world, 0.3);
  EXPECT_FALSE(world.is_asleep(heap)) << "a grain fell on it";
  EXPECT_LT(frames_until_asleep(world, 600), 600);
  world.add_rope(std::vector<Vec3d>{{-0.1, 0.3, 0.08}, {0.3, 0.3, 0.08}}, 20);
  run(world, 0.3);
  EXPECT_FALSE(world.is_asleep(heap)) << "a rope fell on it";
}

TEST(Sleeping, APendulumDoesNotFallAsleepWhereItTurns) {
  Settings settings = sleepy();
  settings.sleeping.speed = 0.5f;  // m/s: below it for a seventh of a second at each turn
  World world(settings);
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 0}, {0.7, -0.7, 0}}, 1);
  world.pin(rope, vertices({0}));
  for (int k = 0; k < 600; ++k) {
    ASSERT_EQ(world.step(frame).asleep, 0u);
  }
  float highest = -2;
  for (int k = 0; k < 120; ++k) {
    world.step(frame);
    highest = std::max(highest, world.positions(rope)[1].y);
  }
  EXPECT_GT(highest, -0.8f) << "it still swings";
}

TEST(Sleeping, AStackSleepsAndWakesAsOne) {
  const std::function<void(World&, ObjectId, ColliderId)> pulls[] = {
      [](World& world, ObjectId bottom, ColliderId) {
        world.teleport(bottom, {{3, 0, 0}, {}, 1});
      },
      [](World& world, ObjectId bottom, ColliderId) { world.remove(bottom); },
      [](World& world, ObjectId bottom, ColliderId) {
        world.apply_impulse(bottom, all(), {400, 0, 0});
      },
      [](World& world, ObjectId, ColliderId floor) { world.remove(floor); },
      [](World& world, ObjectId, ColliderId floor) {
        ColliderOptions options = world.collider_options(floor);
        options.motion = ColliderMotion::fixed({{0, -1, 0}, {}, 1});
        world.set_collider(floor, world.shape(floor), options);
      },
      [](World& world, ObjectId bottom, ColliderId) { world.set_collision_groups(bottom, 0); },
  };
  for (std::size_t which = 0; which < std::size(pulls); ++which) {
    SCOPED_TRACE(which);
    World world(sleepy());
    const ColliderId floor = world.add_collider(Plane{});
    const ObjectId bottom = add_box(world, {0, 0.11, 0}, "bottom");
    const ObjectId middle = add_box(world, {0.01, 0.32, 0.01}, "middle");
    const ObjectId top = add_box(world, {0, 0.53, 0}, "top");
    EXPECT_LT(frames_until_asleep(world, 600), 600);
    const double height = world.center_of_mass(top).y;
    ASSERT_GT(height, 0.45) << "they stand on each other";
    pulls[which](world, bottom, floor);
    EXPECT_FALSE(world.is_asleep(middle));
    EXPECT_FALSE(world.is_asleep(top));
    run(world, 0.4);
    EXPECT_LT(world.center_of_mass(top).y, height - 0.1);
  }
}

TEST(Sleeping, TwoStacksSleepApart) {
  World world(sleepy());
  world.add_collider(Plane{});
  const ObjectId one = add_box(world, {0, 0.11, 0}, "one"), other = add_box(world, {1, 0.11, 0}, "other");
  const ObjectId tied = add_box(world, {2, 0.11, 0}, "tied");
  const std::pair<VertexRef, VertexRef> ends{{other, 0}, {tied, 0}};
  world.connect(std::span(&ends, 1), -1);
  EXPECT_LT(frames_until_asleep(world, 600), 600);
  world.wake(one);
  EXPECT_FALSE(world.is_asleep(one));
  EXPECT_TRUE(world.is_asleep(other));
  run(world, 0.3);
  EXPECT_EQ(world.report().asleep, 2u);
  world.wake(tied);
  EXPECT_FALSE(world.is_asleep(other)) << "they are tied";
  EXPECT_LT(frames_until_asleep(world, 600), 600);
}

// Every action of a user wakes the object it affects.
TEST(Sleeping, UsersWakeWhatTheyTouch) {
  const std::function<void(World&, ObjectId)> touches[] = {
      [](World& w, ObjectId id) { w.set_positions(id, copy(w.positions(id))); },
      [](World& w, ObjectId id) { w.set_velocities(id, copy(w.velocities(id))); },
      [](World& w, ObjectId id) {
        w.apply_impulse(id, vertices({0}), {0, 0.1f, 0});
      },
      [](World& w, ObjectId id) { w.pin(id, vertices({3})); },
      [](World& w, ObjectId id) { w.unpin(id, vertices({0})); },
      [](World& w, ObjectId id) { w.attach(id, vertices({3})); },
      [](World& w, ObjectId id) { w.add_tethers(id); },
      [](World& w, ObjectId id) { w.set_material(id, material::silk); },
      [](World& w, ObjectId) { w.add_collider(Sphere{}); },
      [](World& w, ObjectId) { w.set_pair("cloth", "collider", 0.1f, 0); },
      [](World& w, ObjectId) {
        w.add_force_field([](const Vec3f&, const Vec3f&, float, double) { return Vec3f{}; });
      },
      [](World& w, ObjectId) { change(w, [](Settings& s) { s.gravity.y = -1; }); },
      [](World& w, ObjectId) { change(w, [](Settings& s) {
                                 s.wind.velocity = {1, 0, 0};
                               }); },
      [](World& w, ObjectId) { change(w, [](Settings& s) { s.sleeping.enabled = false; }); },
      [](World& w, ObjectId id) { w.wake(id); },
  };
  for (std::size_t which = 0; which < std::size(touches); ++which) {
    SCOPED_TRACE(which);
    World world(sleepy());
    world.add_collider(Plane{});
    const ObjectId cloth = world.add_cloth(grid(4, 4, 0.3), {.damping = 5}, at({0, 0.02, 0}));
    world.pin(cloth, vertices({0}));
    ASSERT_LT(frames_until_asleep(world, 600), 600);
    change(world, [](Settings& s) { s.threads = 1; });
    ASSERT_TRUE(world.is_asleep(cloth)) << "nothing that matters has changed";
    touches[which](world, cloth);
    EXPECT_FALSE(world.is_asleep(cloth));
    const std::uint32_t free = world.particle(cloth, 5);
    EXPECT_GT(world.carriers(cloth, 5)[0].inverse_mass, 0) << free;
    run(world, 0.1);
  }
}

TEST(Sleeping, AHandWakesAndKeepsAwake) {
  World world(sleepy());
  world.add_collider(Plane{});
  const ObjectId box = add_box(world, {0, 0.11, 0}, "box"), other = add_box(world, {1, 0.11, 0}, "other");
  ASSERT_LT(frames_until_asleep(world, 600), 600);
  EXPECT_GT(world.carriers(box, 0)[0].inverse_mass, 0) << "as if it were awake";
  Grab grab(world, box, 0, world.positions(box)[0]);
  ASSERT_TRUE(grab.holds());
  EXPECT_FALSE(world.is_asleep(box));
  EXPECT_TRUE(world.is_asleep(other));
  run(world, 2);
  EXPECT_FALSE(world.is_asleep(box));
  grab.move_to(world.positions(box)[0] + Vec3f{0, 0.5f, 0});
  run(world, 1);
  EXPECT_GT(world.center_of_mass(box).y, 0.2);
  grab.release();
  EXPECT_TRUE(world.is_asleep(other));
  EXPECT_LT(frames_until_asleep(world, 600), 600);
}

TEST(Sleeping, WhatCarriesThemWakesThemWhenItMoves) {
  const std::vector<PoseKey> keys{{0, {0, 0, 0}, {}}, {4, {0, 0, 0}, {}}, {5, {0.5, 0, 0}, {}}};
  for (const bool is_collider : {true, false}) {
    SCOPED_TRACE(is_collider ? "collider" : "obstacle");
    World world(sleepy());
    ColliderMotion motion = ColliderMotion::keyframes(keys);
    if (is_collider) {
      world.add_collider(Box{.center = {0, -0.1f, 0}, .half_extents = {1, 0.1f, 1}},
                         {.friction = 1, .motion = motion});
    } else {
      world.add_obstacle(grid(9, 9, 2), {.friction = 1}, {.pose = motion});
    }
    const ObjectId box = add_box(world, {0, 0.11, 0}, "box");
    ASSERT_LT(frames_until_asleep(world, 200), 200);
    while (world.time() < 3.9) world.step(frame);
    EXPECT_TRUE(world.is_asleep(box));
    const double x = world.center_of_mass(box).x;
    while (world.time() < 4.2) world.step(frame);
    EXPECT_FALSE(world.is_asleep(box));
    while (world.time() < 8) world.step(frame);
    EXPECT_NEAR(world.center_of_mass(box).x - x, 0.5, 0.1);
    EXPECT_TRUE(world.is_asleep(box)) << "they stand again";
  }
}

// Its center stays where it is.
TEST(Sleeping, ABarThatTurnsWakesWhatItSweeps) {
  World world(sleepy());
  world.add_collider(Plane{});
  const ObjectId box = add_box(world, {0.9, 0.11, 0}, "box");
  const Quatd across = Quatd::from_axis_angle({0, 1, 0}, pi / 2);
  world.add_collider(Box{.center = {0, 0.2f, 0}, .half_extents = {1, 0.15f, 0.05f}},
                     {.motion = ColliderMotion::keyframes({{0, {}, across}, {4, {}, across}, {5, {}, {}}})});
  ASSERT_LT(frames_until_asleep(world, 200), 200);
  while (world.time() < 3.9) world.step(frame);
  EXPECT_TRUE(world.is_asleep(box));
  const Vec3d before = world.center_of_mass(box);
  while (world.time() < 5) world.step(frame);
  EXPECT_FALSE(world.is_asleep(box));
  EXPECT_GT(length(world.center_of_mass(box) - before), 0.1);
}

// Distant objects may move; slow objects wake no others.
TEST(Sleeping, OthersLeaveThemAlone) {
  World world(sleepy());
  world.add_collider(Plane{});
  const ObjectId box = add_box(world, {0, 0.11, 0}, "box");
  ASSERT_LT(frames_until_asleep(world, 200), 200);
  world.add_collider(Sphere{.radius = 0.2f},
                     {.motion = ColliderMotion::keyframes({{0, {5, 1, 0}, {}}, {100, {50, 1, 0}, {}}})});
  ASSERT_LT(frames_until_asleep(world, 200), 200) << "a new collider wakes everything once";
  add_box(world, {2, 0.5, 0}, "other");
  run(world, 1);
  EXPECT_TRUE(world.is_asleep(box));
  world.set_collide("box", "other", false);
  ASSERT_LT(frames_until_asleep(world, 300), 300);
  ObjectOptions ghost = at({0, 0.8, 0});
  ghost.collision_mask = 0;
  world.add_soft_body(tet_bar(1, 1, 1, {0.1, 0.1, 0.1}), {}, ghost);
  run(world, 1);
  EXPECT_TRUE(world.is_asleep(box)) << "what does not meet it";
}

World three_heaps() {
  Settings settings = sleepy(1);
  settings.sleeping.seconds = 0.2f;
  settings.substeps = 5;
  World world(settings);
  world.add_collider(Plane{}, {.friction = 0.8f});
  add_heap_of_cloth(world);
  add_grains(world);
  const ObjectId grains = world.objects()[1];
  world.teleport(grains, {{1, 0, 0}, {}, 1});
  add_box(world, {-1, 0.2, 0}, "box");
  add_box(world, {-1, 0.5, 0}, "on top");
  return world;
}

TEST(Sleeping, SnapshotsKeepWhoSleeps) {
  World a = three_heaps();
  for (int k = 0; k < 100; ++k) a.step(frame);
  ASSERT_GT(a.report().asleep, 0u);
  ASSERT_LT(a.report().asleep, 5u);
  World b = three_heaps();
  b.restore(a.snapshot());
  for (const ObjectId id : a.objects()) EXPECT_EQ(a.is_asleep(id), b.is_asleep(b.find_object(a.name(id))));
  for (int k = 0; k < 60; ++k) {
    a.step(frame), b.step(frame);
    ASSERT_EQ(a.hash(), b.hash()) << k;
    ASSERT_EQ(a.report().asleep, b.report().asleep) << k;
  }
  // Restored to a state before any object slept.
  World fresh = three_heaps();
  const Snapshot start = fresh.snapshot();
  for (int k = 0; k < 10; ++k) fresh.step(frame);
  a.restore(start);
  for (int k = 0; k < 10; ++k) a.step(frame);
  EXPECT_EQ(a.hash(), fresh.hash());
}

// A callback may apply an impulse during a step: the awakened object collides with others within the same
// step.
TEST(Sleeping, ACallbackMayWakeWithinAStep) {
  World world(sleepy());
  world.add_obstacle(grid(5, 5, 1));
  const ObjectId box = add_box(world, {0, 0.11, 0}, "box");
  ASSERT_LT(frames_until_asleep(world, 200), 200);
  bool push = false;
  world.before(Stage::integrate, [&](World& w) {
    if (push) w.apply_impulse(box, all(), {0, -0.01f, 0});
    push = false;
  });
  push = true;
  ASSERT_TRUE(world.step(frame).ok());
  EXPECT_FALSE(world.is_asleep(box));
  EXPECT_GT(world.report().contacts, 0u);
  for (const Vec3f& x : world.positions(box)) EXPECT_GT(x.y, -0.01f);
}

/// Makes a particle's motion NaN.
class Breaker final : public Projector {
 public:
  Breaker(const bool& breaks, std::uint32_t particle) : breaks_(breaks), particle_(particle) {}
  std::string_view kind() const override { return "breaker"; }
  std::size_t size() const override { return 1; }
  void prepare(std::size_t) override {}
  int color_count() const override { return 0; }
  std::size_t color_size(int) const override { return 0; }
  void begin_substep(const ParticleView& view, const Substep&) override {
    if (breaks_) view.correct(particle_, {NAN, 0, 0});
  }
  void project(int, std::size_t, std::size_t, const ParticleView&, const Substep&) override {}
  Residual residual(const ParticleView&, Threads*) const override { return {}; }
  void visit(const ParticleView&, const ConstraintVisitor& visitor) const override {
    visitor({{&particle_, 1}});
  }
  void erase_particles(std::uint32_t, std::uint32_t) override {}

 private:
  const bool& breaks_;
  std::uint32_t particle_;
};

TEST(Sleeping, ABadStepPutsSleepersBackAsTheyWere) {
  World world(sleepy());
  world.add_collider(Plane{});
  const ObjectId box = add_box(world, {0, 0.11, 0}, "box");
  ASSERT_LT(frames_until_asleep(world, 200), 200);
  const ObjectId bad = add_box(world, {1, 0.11, 0}, "bad");
  bool break_it = true;
  const ProjectorId hand = world.add_projector(std::make_unique<Breaker>(break_it, world.particle(bad, 0)));
  EXPECT_FALSE(world.step(frame).ok());
  EXPECT_TRUE(world.is_asleep(box));
  break_it = false;
  world.remove(hand);
  run(world, 0.2);
  EXPECT_TRUE(world.is_asleep(box));
  EXPECT_GT(world.carriers(bad, 0)[0].inverse_mass, 0);
}

// Nothing is solved when all objects sleep: there are no contacts.
TEST(Sleeping, NothingIsSolvedWhenAllSleep) {
  World world(sleepy());
  world.add_collider(Plane{}, {.friction = 0.8f});
  add_grains(world);
  EXPECT_LT(frames_until_asleep(world, 600), 600);
  run(world, 0.1);
  EXPECT_EQ(world.report().contacts, 0u);
  EXPECT_TRUE(world.contacts().empty());
}

// The constraints and the motion of sleeping objects are left out: what moves beside them keeps its bits.
// A step of a world at rest does nothing, unless something changed or comes near. Beside a pendulum, objects at rest are left
// out of most of a step.
TEST(Sleeping, WhatIsAtRestIsLeftOutToTheBit) {
  for (const bool swings : {false, true}) {
    const auto make = [&] {
      auto world = std::make_unique<World>(sleepy());
      world->add_collider(Plane{});
      world->add_obstacle(grid(3, 3, 1), {}, {}, at(3, 0.1, 0));
      add_box(*world, {0, 0.11, 0}, "box");
      world->add_rigid_body(Box{{}, {0.1f, 0.1f, 0.1f}}, {}, at(1, 0.1, 0));
      const auto arrives = [](double t) { return Transform{.translation = {1, std::max(0.25, 5 - t), 0}}; };
      world->add_collider(Sphere{{}, 0.1f}, {.motion = ColliderMotion::callback(arrives)});
      if (swings) world->pin(world->add_rope(std::vector<Vec3d>{{0, 3, 0}, {1, 3, 0}}, 8), vertices({0}));
      return world;
    };
    const auto left_out = make(), changed = make();
    std::size_t most = 0;
    for (int k = 0; k < 300; ++k) {
      changed->restore(changed->snapshot());
      most = std::max(most, left_out->step(frame).asleep);
      changed->step(frame);
      ASSERT_EQ(left_out->hash(), changed->hash()) << "frame " << k;
    }
    EXPECT_EQ(most, 2u);
    EXPECT_EQ(left_out->report().asleep, 1u) << "the ball of the collider wakes the rigid box";
  }
}

TEST(Sleeping, WhatMovesDoesNotDependOnWhatSleeps) {
  const auto swing = [](int boxes) {
    World world(sleepy());
    world.add_collider(Plane{});
    for (int k = 0; k < boxes; ++k)
      add_box(world, {2.0 * k, 0.1, 0}, k == 0 ? "box" : k == 1 ? "second" : "third");
    if (boxes > 0) {
      EXPECT_LT(frames_until_asleep(world, 300), 300);
    }
    const ObjectId cloth = world.add_cloth(grid(12, 12, 1.0), {}, at({-20, 3, 0}));
    world.pin(cloth, vertices({0, 11}));
    for (int k = 0; k < 40; ++k) EXPECT_EQ(world.step(frame).asleep, static_cast<std::size_t>(boxes));
    return copy(world.positions(cloth));
  };
  EXPECT_EQ(swing(0), swing(3));
}

}  // namespace souple::test_world_sleeping
