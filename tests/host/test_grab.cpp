#include "souple/host/drag_plane.h"
#include "souple/host/grab.h"
#include "souple/souple.h"
#include "tests/expect_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

namespace souple::host::test_host_grab {

constexpr double dt = 1.0 / 60;
constexpr Vec3f far_away{70, 60, 40};

/// Largest extension of a mesh's edges.
double strain_of(const World& world, ObjectId object) {
  const std::vector<Vec3d>& rest = world.mesh(object).positions;
  const auto x = world.positions(object);
  double largest = 0;
  for (const Triangle& t : world.triangles(object))
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      largest = std::max(largest, length(Vec3d(x[a]) - Vec3d(x[b])) / length(rest[a] - rest[b]) - 1);
    }
  return largest;
}

/// A cloth that hangs from five vertices of its upper edge.
struct Curtain {
  World world{{.drag = 2}};
  ObjectId cloth;
  std::uint32_t middle = 8 * 17 + 8;

  explicit Curtain(double tilt = 0) {
    const auto upright = Quaternion<double>::from_axis_angle({1, 0, 0}, pi / 2 + tilt);
    cloth = world.add_cloth(grid(17, 17, 1.0), {.damping = 2}, {.transform = {.rotation = upright}});
    world.pin(cloth, vertices({0, 4, 8, 12, 16}));
  }
  void run(int frames) {
    for (int i = 0; i < frames; ++i) ASSERT_TRUE(world.step(dt).ok());
  }
  Vec3f at(std::uint32_t vertex) const { return world.positions(cloth)[vertex]; }
};

TEST(Grab, AClothFollowsTheMouseAndIsLetGo) {
  Curtain c;
  c.run(150);
  const Vec3f start = c.at(c.middle), resting = c.at(c.middle);
  {
    Grab grab(c.world, c.cloth, c.middle, start);
    EXPECT_TRUE(grab.holds());
    // Taking hold moves nothing: the spring is relaxed.
    c.run(10);
    EXPECT_LT(length(c.at(c.middle) - start), 0.02f);
    for (int i = 1; i <= 60; ++i) {
      grab.move_to(start + Vec3f(0, 0.1f, 0.2f) * (static_cast<float>(i) / 60));
      c.run(1);
      EXPECT_LT(length(grab.point() - grab.target()), 0.05f);
    }
    c.run(60);
    EXPECT_LT(length(c.at(c.middle) - (start + Vec3f(0, 0.1f, 0.2f))), 0.03f);
    EXPECT_LT(strain_of(c.world, c.cloth), 0.15);
  }
  c.run(300);
  EXPECT_LT(length(c.at(c.middle) - resting), 0.05f);
  for (const KindReport& kind : c.world.report().kinds) EXPECT_NE(kind.kind, "grab");
}

// The folds that a cloth takes are chance, and with them how far the vertex stays behind: 2 or 2.6 cm.
TEST(Grab, AHeldVertexIsNearTheMouse) {
  double mean = 0;
  for (int k = 0; k < 4; ++k) {
    Curtain c(1e-7 * k);
    c.run(150);
    const Vec3f goal = c.at(c.middle) + Vec3f(0, 0.1f, 0.2f);
    Grab grab(c.world, c.cloth, c.middle, c.at(c.middle));
    for (int i = 1; i <= 60; ++i) {
      grab.move_to(goal - Vec3f(0, 0.1f, 0.2f) * (1 - static_cast<float>(i) / 60));
      c.run(1);
    }
    c.run(60);
    mean += static_cast<double>(length(c.at(c.middle) - goal)) / 4;
  }
  EXPECT_LT(mean, 0.025);  // converged: 0.004
}

/// A mouse is thrown 100 m away in one frame, and back and forth. There is no NaN and no torn cloth, and afterwards it
/// hangs as before.
TEST(Grab, AMouseThrownFarAwayTearsNothing) {
  for (const bool shaken : {false, true}) {
    Curtain c;
    c.run(150);
    const Vec3f resting = c.at(c.middle);
    Grab grab(c.world, c.cloth, c.middle, resting);
    double worst = 0;
    for (int i = 0; i < 90; ++i) {
      grab.move_to(resting + (shaken && i % 2 ? -far_away : far_away));
      c.run(1);
      worst = std::max(worst, strain_of(c.world, c.cloth));
    }
    EXPECT_LT(worst, 0.25);
    EXPECT_GT(worst, 0.02);  // it does pull
    grab.release();
    EXPECT_FALSE(grab.holds());
    c.run(300);
    EXPECT_LT(strain_of(c.world, c.cloth), 0.1);
    EXPECT_LT(length(c.at(c.middle) - resting), 0.05f);
  }
}

/// Finer and coarser in space and time, and in the other modes; without air, in which sheets follow more slowly.
TEST(Grab, HoldsForAllSettings) {
  const Settings settings[] = {{.substeps = 4},
                               {.substeps = 2, .iterations = 20, .mode = Mode::xpbd},
                               {.substeps = 2, .iterations = 10, .mode = Mode::pbd},
                               {.substeps = 20},
                               {.integrator = Integrator::explicit_euler}};
  for (Settings s : settings) {
    s.wind.air_density = 0;
    Curtain c;
    c.world.set_settings(s);
    c.run(30);
    const Vec3f start = c.at(c.middle);
    Grab grab(c.world, c.cloth, c.middle, start);
    const double before = strain_of(c.world, c.cloth);
    for (int i = 0; i < 60; ++i) {
      grab.move_to(start + far_away);
      c.run(1);
      EXPECT_LT(strain_of(c.world, c.cloth), before + 0.5) << s.substeps;
    }
    grab.move_to(start);
    c.run(120);
    EXPECT_LT(length(grab.point() - start), 0.05f) << s.substeps;
  }
}

/// An object of each kind in a vacuum, without gravity, pulled up by 0.3 m: it comes along.
struct AnyKind {
  World world;
  std::vector<ObjectId> objects;

  explicit AnyKind(float drag = 0) : world({.gravity = {}, .wind = {.air_density = 0}, .drag = drag}) {
    const auto place = [](double x) { return ObjectOptions{.transform = {.translation = {x, 0, 0}}}; };
    objects.push_back(world.add_cloth(grid(9, 9, 0.5), {}, place(0)));
    objects.push_back(world.add_soft_body(sphere(2, 0.2), {}, {.cells = 80}, place(5)));
    objects.push_back(world.add_soft_body(tet_bar(3, 2, 2, {0.3, 0.2, 0.2}), {}, place(10)));
    objects.push_back(world.add_soft_body(tet_bar(2, 2, 2, {0.3, 0.3, 0.3}),
                                          {.model = SoftBodyModel::shape_matching}, place(15)));
    const std::vector<Vec3d> line{{20, 0, 0}, {20.5, 0, 0}};
    objects.push_back(world.add_rope(line, 20));
    const std::vector<Vec3d> centers{{25, 0, 0}, {25, 0, 0.5}};
    objects.push_back(world.add_grains(centers, {.radius = 0.05f}));
  }
};

TEST(Grab, EveryKindOfObjectComesAlong) {
  AnyKind any(3);
  for (const ObjectId object : any.objects) {
    const std::string& name = any.world.name(object);
    const Vec3f start = any.world.positions(object)[0];
    const Vec3d center = any.world.center_of_mass(object);
    Grab grab(any.world, object, 0, start);
    ASSERT_TRUE(grab.holds()) << name;
    const Vec3f goal = start + Vec3f(0, 0.3f, 0);
    grab.move_to(goal);
    for (int i = 0; i < 240; ++i) ASSERT_TRUE(any.world.step(dt).ok());
    const double lifted = (any.world.center_of_mass(object) - center).y;
    EXPECT_LT(length(grab.point() - goal), 0.01f) << name;
    EXPECT_LT(length(any.world.positions(object)[0] - goal), 0.05f) << name;
    if (any.world.kind(object) == ObjectKind::grains) {
      EXPECT_EQ(any.world.positions(object)[1], Vec3f(25, 0, 0.5f));  // the other grain stays
      EXPECT_NEAR(lifted, 0.15, 0.01);
    } else {
      EXPECT_GT(lifted, 0.1) << name;
    }
  }
}

TEST(Grab, EveryKindOfObjectSurvivesBeingThrown) {
  AnyKind any;
  std::vector<Grab> grabs;
  for (const ObjectId object : any.objects)
    grabs.emplace_back(any.world, object, 0, any.world.positions(object)[0]);
  for (int i = 0; i < 120; ++i) {
    for (Grab& grab : grabs) grab.move_to(i % 20 < 10 ? far_away : -far_away);
    ASSERT_TRUE(any.world.step(dt).ok());
    for (const ObjectId object : any.objects) {
      EXPECT_LT(strain_of(any.world, object), 1) << any.world.name(object);
      for (const Vec3f& v : any.world.velocities(object)) {
        ASSERT_LT(length(v), 30) << any.world.name(object);
      }
    }
  }
  grabs.clear();
  for (int i = 0; i < 240; ++i) ASSERT_TRUE(any.world.step(dt).ok());
  for (const ObjectId object : any.objects)
    EXPECT_LT(strain_of(any.world, object), 0.2) << any.world.name(object);
}

/// The hand changes the object's momentum by its force and no more, and not at all after the release.
TEST(Grab, ForceIsCappedAndEndsWithTheGrab) {
  AnyKind any;
  const ObjectId box = any.objects[3];
  const Vec3f start = any.world.positions(box)[0];
  Grab grab(any.world, box, 0, start, {.max_force = 7});
  EXPECT_EQ(grab.max_force(), 7);
  grab.move_to(start + far_away);
  Vec3d before = any.world.momentum(box);
  double pulled = 0;
  for (int i = 0; i < 30; ++i) {
    any.world.step(dt);
    const Vec3d after = any.world.momentum(box);
    EXPECT_LT(length(after - before), 7 * dt * 1.001);
    pulled = std::max(pulled, length(after - before));
    before = after;
  }
  EXPECT_GT(pulled, 0.5 * 7 * dt);
  grab.release();
  for (int i = 0; i < 30; ++i) any.world.step(dt);
  EXPECT_LT(length(any.world.momentum(box) - before), 1e-3 * length(before));
}

TEST(Grab, AfterwardsItFallsFreely) {
  World world({.wind = {.air_density = 0}});
  const ObjectId cloth = world.add_cloth(grid(9, 9, 0.5));
  Grab grab(world, cloth, 40, world.positions(cloth)[40]);
  grab.move_to({1, 1, 0});
  for (int i = 0; i < 20; ++i) world.step(dt);
  grab.release();
  const Vec3d before = world.momentum(cloth);
  for (int i = 0; i < 60; ++i) world.step(dt);
  const Vec3d expected = before + Vec3d(0, -9.81 * world.total_mass(cloth), 0);
  EXPECT_LT(length(world.momentum(cloth) - expected), 1e-3 * length(expected));
}

TEST(Grab, APinnedVertexIsNotHeld) {
  Curtain c;
  Grab grab(c.world, c.cloth, 0, c.at(0));
  EXPECT_FALSE(grab.holds());
  grab.move_to(far_away);
  const Vec3f before = c.at(0);
  c.run(5);
  EXPECT_EQ(c.at(0), before);
  grab.release();
  // A free one beside it moves, the pinned one does not.
  Grab beside(c.world, c.cloth, 1, c.at(1));
  EXPECT_TRUE(beside.holds());
  beside.move_to(far_away);
  c.run(30);
  EXPECT_EQ(c.at(0), before);
}

TEST(Grab, SurvivesWhatItHolds) {
  World world({.gravity = {}});
  const ObjectId first = world.add_cloth(grid(5, 5, 1.0));
  const ObjectId second = world.add_cloth(grid(5, 5, 1.0), {}, {.transform = {.translation = {0, 2, 0}}});
  const ObjectId third = world.add_cloth(grid(5, 5, 1.0), {}, {.transform = {.translation = {0, 4, 0}}});
  Grab grab(world, second, 12, {0, 2, 0});
  world.remove(first);  // the particles are renumbered
  EXPECT_TRUE(grab.holds());
  grab.move_to({0, 2.5f, 0});
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_NEAR(world.positions(second)[12].y, 2.5, 0.2);
  EXPECT_NEAR(world.positions(third)[12].y, 4, 1e-5);
  world.remove(second);
  EXPECT_FALSE(grab.holds());
  grab.move_to(far_away);
  ASSERT_TRUE(world.step(dt).ok());
  EXPECT_NEAR(world.positions(third)[12].y, 4, 1e-5);
  grab.release();
}

TEST(Grab, SurvivesTheWorld) {
  std::optional<Grab> grab;
  std::optional<World> world;
  const auto build = [&] {
    world.emplace();
    return world->add_cloth(grid(5, 5, 1.0));
  };
  grab.emplace(*world, build(), 12, Vec3f{});
  const ObjectId again = build();  // in the place of the first
  EXPECT_FALSE(grab->holds());
  world->attach(again, vertices({0}));  // may have the handle that the grab had
  grab->release();
  grab.reset();
  EXPECT_TRUE(world->step(dt).ok());
  const auto& kinds = world->report().kinds;
  EXPECT_TRUE(std::any_of(kinds.begin(), kinds.end(), [](const auto& k) { return k.kind == "attachment"; }));
  grab.emplace(*world, again, 12, Vec3f{});
  world.reset();
  EXPECT_FALSE(grab->holds());
}

TEST(Grab, GoesOnAfterARestoreAndIsMoved) {
  Curtain c;
  c.run(30);
  const Snapshot snapshot = c.world.snapshot();
  Grab grab(c.world, c.cloth, c.middle, c.at(c.middle));
  grab.move_to(c.at(c.middle) + Vec3f(0, 0.1f, 0.2f));
  c.run(30);
  const std::uint64_t hash = c.world.hash();
  c.world.restore(snapshot);
  c.run(30);
  EXPECT_EQ(c.world.hash(), hash);  // the hand has no memory of its own
  Grab other = std::move(grab);
  EXPECT_FALSE(grab.holds());  // NOLINT: a grab that was moved from holds nothing
  EXPECT_TRUE(other.holds());
  other = Grab(c.world, c.cloth, 3, c.at(3));
  c.run(1);
  std::size_t grabs = 0;
  for (const KindReport& kind : c.world.report().kinds) grabs += kind.kind == "grab";
  EXPECT_EQ(grabs, 1u);
}

TEST(Grab, LetsGoInTheMiddleOfAStep) {
  Curtain c;
  std::optional<Grab> grab(std::in_place, c.world, c.cloth, c.middle, c.at(c.middle));
  grab->move_to(far_away);
  c.world.after(Stage::solve, [&](World&) { grab.reset(); });
  EXPECT_TRUE(c.world.step(dt).ok());
  EXPECT_TRUE(c.world.step(dt).ok());
}

TEST(Grab, RefusesWhatItCannotDo) {
  Curtain c;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_error([&] { Grab(c.world, c.cloth, 289, {}); }, {"289"});
  expect_error([&] { Grab(c.world, ObjectId{99}, 0, {}); }, {"handle"});
  expect_error([&] { Grab(c.world, c.cloth, 5, {nan, 0, 0}); }, {"not finite"});
  expect_error([&] { Grab(c.world, c.cloth, 5, {}, {.max_force = -1}); }, {"max_force"});
  Grab grab(c.world, c.cloth, 5, c.at(5));
  expect_error([&] { grab.move_to({0, nan, 0}); }, {"not finite"});
}

constexpr Vec3f eye{0, 0, 5}, ahead{0, 0, -1};

/// Through (x, y) at the depth of the origin.
Ray through(float x, float y) {
  return {eye, Vec3f(x, y, 0) - eye};
}

TEST(DragPlane, ThePointStaysUnderTheMouseAndAtItsDepth) {
  DragPlane drag({0.5f, 0.25f, 0}, through(0.5f, 0.25f), ahead);
  EXPECT_EQ(drag.point(), Vec3f(0.5f, 0.25f, 0));
  EXPECT_LT(length(drag.drag(through(0.5f, 0.25f)) - Vec3f(0.5f, 0.25f, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(-2, 1)) - Vec3f(-2, 1, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(0.5f, 0.25f)) - Vec3f(0.5f, 0.25f, 0)), 1e-6f);  // and back
}

/// A picked vertex lies beside the ray: taking hold of it moves nothing, and dragging moves it as the mouse.
TEST(DragPlane, APointBesideTheRayStaysBesideTheMouse) {
  DragPlane drag({0.6f, 0.1f, 0}, through(0.5f, 0), ahead);
  EXPECT_LT(length(drag.drag(through(0.5f, 0)) - Vec3f(0.6f, 0.1f, 0)), 1e-6f);
  EXPECT_LT(length(drag.drag(through(1.5f, 0)) - Vec3f(1.6f, 0.1f, 0)), 1e-6f);
}

TEST(DragPlane, WithoutAViewThePlaneIsAcrossTheRay) {
  const Vec3f point{3, 0, 1};
  const Ray pick{eye, point - eye};
  DragPlane drag(point, pick);
  const Vec3f moved = drag.drag({eye, point + Vec3f(0.1f, 0.4f, 0) - eye});
  EXPECT_NEAR(dot(moved - point, normalized(pick.direction)), 0, 1e-5f);
  EXPECT_GT(length(moved - point), 0.3f);
}

TEST(DragPlane, RaysThatMissThePlaneLeaveThePointWhereItWas) {
  DragPlane drag({0, 0, 0}, through(0, 0), ahead);
  const Vec3f last = drag.drag(through(1, 1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& direction :
       {Vec3f(1, 0, 0), Vec3f(1, 0, -0.001f), Vec3f(0, 0, 1), Vec3f(), Vec3f(nan, 0, -1)})
    EXPECT_EQ(drag.drag({eye, direction}), last);
  EXPECT_EQ(drag.drag({{nan, 0, 0}, ahead}), last);
}

TEST(DragPlane, RefusesWhatIsNoRay) {
  const float infinite = std::numeric_limits<float>::infinity();
  expect_error([] { DragPlane({}, {eye, {}}); }, {"direction"});
  expect_error([&] { DragPlane({infinite, 0, 0}, through(0, 0)); }, {"not finite"});
  expect_error([&] { DragPlane({}, {{0, infinite, 0}, ahead}); }, {"not finite"});
}

}  // namespace souple::host::test_host_grab
