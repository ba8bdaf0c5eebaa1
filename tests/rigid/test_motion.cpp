#include "souple/rigid/impulse.h"
#include "tests/rigid/one_body.h"
#include "tests/rigid/rigid_scene.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Contacts of rigid bodies in motion: sliding, rolling, bouncing, impacts.

namespace souple::test::test_rigid_motion {

using AddBody = std::function<void(RigidScene&, double height)>;
struct Kind {
  std::string name;
  AddBody add;
  double half_height;  // m
};

const Quatd along_x = Quatd::from_axis_angle({0, 0, 1}, std::numbers::pi / 2);
const Quatd along_z = Quatd::from_axis_angle({1, 0, 0}, std::numbers::pi / 2);

const Kind box{"box", [](RigidScene& s, double y) { s.box({0.2, 0.1, 0.2}, {0, y, 0}); }, 0.1};
const Kind ball{"ball", [](RigidScene& s, double y) { s.ball(0.1, {0, y, 0}); }, 0.1};
const Kind standing_cylinder{"cylinder",
                             [](RigidScene& s, double y) {
                               s.cylinder(0.2, 0.1, {0, y, 0});
                             },
                             0.1};
const Kind lying_capsule{"capsule",
                         [](RigidScene& s, double y) {
                           s.capsule(0.1, 0.3, {0, y, 0}, along_x);
                         },
                         0.1};

/// A slope of the angle `slope` that falls along x: a plane, and gravity that is inclined.
Vec3d inclined(double slope) {
  return Vec3d{std::sin(slope), -std::cos(slope), 0} * RigidScene::g;
}

class OnASlope : public testing::TestWithParam<Kind> {};

TEST_P(OnASlope, SlidesByCoulombsLaw) {
  constexpr double slope = 0.5, seconds = 2;
  RigidScene scene;
  scene.material.friction = 0.3f;
  scene.gravity = inclined(slope);
  GetParam().add(scene, GetParam().half_height);
  scene.plane();
  scene.run(seconds);
  const double expected = RigidScene::g * (std::sin(slope) - 0.3 * std::cos(slope)) * seconds;
  EXPECT_NEAR(scene.bodies.velocity[0].linear.x / expected, 1, 0.02);
}

TEST_P(OnASlope, SticksBelowTheAngleOfFriction) {
  RigidScene scene;
  scene.material.friction = 0.3f;
  scene.gravity = inclined(std::atan(0.3 * 0.98));
  GetParam().add(scene, GetParam().half_height);
  scene.plane();
  scene.run(1);
  const std::vector<BodyPose> before = scene.bodies.pose;
  scene.run(10);
  EXPECT_LT(before[0].position.x, 1e-3);
  EXPECT_LT(farthest(before, scene.bodies.pose), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Kinds, OnASlope, testing::Values(box, standing_cylinder, lying_capsule),
                         [](const auto& kind) { return kind.param.name; });

/// Acceleration on a slope of 0.3, as a part of g sin 0.3.
double rolling_part(const AddBody& add) {
  constexpr double seconds = 2;
  RigidScene scene;
  scene.gravity = inclined(0.3);
  add(scene, 0.1);
  scene.plane();
  scene.run(seconds);
  return scene.bodies.velocity[0].linear.x / (scene.gravity.x * seconds);
}

TEST(RigidRolling, BallRollsWithFiveSeventhsOfTheSlope) {
  EXPECT_NEAR(rolling_part(ball.add) * 7 / 5, 1, 1e-3);
}
// Its inertia about its axis is m r^2 / 2.
TEST(RigidRolling, CapsuleRollsWithTwoThirdsOfTheSlope) {
  const AddBody add = [](RigidScene& s, double y) { s.capsule(0.1, 0.3, {0, y, 0}, along_z); };
  EXPECT_NEAR(rolling_part(add) * 3 / 2, 1, 0.02);
}
// So it does on its rounded side.
TEST(RigidRolling, CylinderRollsWithTwoThirdsOfTheSlope) {
  const AddBody add = [](RigidScene& s, double y) { s.cylinder(0.1, 0.3, {0, y, 0}, along_z); };
  EXPECT_NEAR(rolling_part(add) * 3 / 2, 1, 1e-3);
}

/// How far a cube on a slope has turned after 2 s [rad].
double turn_on(double slope) {
  RigidScene scene;
  scene.material.friction = 2;
  scene.gravity = inclined(slope);
  scene.box({0.1, 0.1, 0.1}, {0, 0.1, 0});
  scene.plane();
  double turned = 0;
  for (int f = 0; f < 120; ++f)
    scene.step(), turned -= scene.bodies.velocity[0].angular.z * RigidScene::frame;
  return turned;
}

TEST(RigidRolling, CubeTipsOverWhereItsCenterIsBeyondItsEdge) {
  EXPECT_LT(std::abs(turn_on(0.75)), 1e-3);
  EXPECT_GT(turn_on(0.82), 1);
}

class Bounce : public testing::TestWithParam<Kind> {};

/// The height to which a body rises again, as a part of the one it fell from.
double rise_again(const Kind& kind, double restitution) {
  constexpr double height = 2;
  RigidScene scene;
  scene.material.restitution = static_cast<float>(restitution);
  kind.add(scene, kind.half_height + height);
  scene.plane();
  double highest = 0;
  bool rises = false;
  for (int f = 0; f < 180; ++f) {
    const double before = scene.bodies.velocity[0].linear.y;
    scene.step();
    const double now = scene.bodies.velocity[0].linear.y;
    rises = rises || now > 0;
    if (rises) highest = std::max(highest, scene.bodies.pose[0].position.y - kind.half_height);
    if (rises && now < before && now < 0) break;
  }
  return highest / height;
}

TEST_P(Bounce, RisesToTheSquareOfTheRestitution) {
  for (const double e : {0.3, 0.5, 0.8, 1.0})
    EXPECT_NEAR(rise_again(GetParam(), e) / (e * e), 1, 0.02) << "e " << e;
}

TEST_P(Bounce, NoRestitutionDoesNotBounce) {
  EXPECT_LT(rise_again(GetParam(), 0), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Bounce, testing::Values(box, ball, standing_cylinder, lying_capsule),
                         [](const auto& kind) { return kind.param.name; });

TEST(RigidImpact, NewtonsCradlePassesTheSpeedOn) {
  RigidScene scene;
  scene.gravity = {};
  scene.material.friction = 0, scene.material.restitution = 1;
  for (int i = 0; i < 5; ++i) scene.ball(0.1, {i * 0.2 + (i > 0 ? 0.0 : -0.3), 0, 0}, 7800);
  scene.bodies.velocity[0].linear = {1, 0, 0};
  const double momentum = scene.momentum().x, energy = scene.energy();
  scene.run(1);
  EXPECT_GT(scene.bodies.velocity[4].linear.x, 0.95);
  EXPECT_LT(std::abs(scene.bodies.velocity[0].linear.x), 0.05);
  EXPECT_NEAR(scene.momentum().x / momentum, 1, 1e-12);
  EXPECT_NEAR(scene.energy() / energy, 1, 1e-9);
}

TEST(RigidImpact, FreeBodiesThatHitOffCenterKeepTheirMomenta) {
  for (const float e : {0.0f, 0.5f, 1.0f})
    for (const float friction : {0.0f, 0.5f})
      for (int k = 0; k < 5; ++k) {
        RigidScene scene;
        scene.gravity = {};
        scene.material.friction = friction, scene.material.restitution = e;
        const Quatd turned = Quatd::from_axis_angle(normalized(Vec3d{1, 2.0 * k, -1}), 0.4 * k);
        scene.box({0.1, 0.2, 0.15}, {0, 0, 0}, turned);
        scene.box({0.2, 0.1, 0.1}, {0.8, 0.06 * k, 0.05}, Quatd::from_axis_angle({0, 0, 1}, 0.3), 500);
        scene.bodies.velocity[0] = {{4, 0, 0}, {1, 2, 0.5 * k}};
        scene.bodies.velocity[1] = {{-3, 0.2, 0}, {0, -1, 1}};
        const Vec3d momentum = scene.momentum(), turn = scene.angular_momentum();
        const double energy = scene.energy();
        double highest = 0;
        for (int f = 0; f < 60; ++f) scene.step(), highest = std::max(highest, scene.energy());
        EXPECT_LT(scene.bodies.velocity[0].linear.x, 3) << "they hit";
        EXPECT_LT(highest / energy - 1, 2e-4);
        EXPECT_LT(length(scene.momentum() - momentum), 1e-9 * length(momentum));
        EXPECT_LT(length(scene.angular_momentum() - turn), 1e-9 * length(turn));
      }
}

TEST(RigidImpact, ContactsAreSolvedAgainWhereTheyWereLeft) {
  RigidScene once, twice;
  twice.between = [](RigidBodies&) {};
  for (RigidScene* scene : {&once, &twice}) {
    scene->box({0.1, 0.1, 0.1}, {0, 0.1, 0});
    scene->box({0.1, 0.1, 0.1}, {0.02, 0.32, 0});
    scene->plane();
    scene->bodies.velocity[1].linear = {0.5, 0, 0};
    scene->run(1);
  }
  EXPECT_LT(farthest(once.bodies.pose, twice.bodies.pose), 1e-4);
}

TEST(RigidImpact, ContactsTakeBackWhatOthersMovedBetweenTheirSolves) {
  RigidScene scene;
  scene.box({0.1, 0.1, 0.1}, {0, 0.1, 0});
  scene.box({0.1, 0.1, 0.1}, {0, 0.3, 0});
  scene.plane();
  scene.run(0.5);
  // As by a joint that pulls with 100 times the weight of a box.
  scene.between = [](RigidBodies& bodies) { bodies.pose[1].position.y -= 100 * RigidScene::g / 360000; };
  scene.run(0.5);
  EXPECT_LT(scene.deepest(), 1e-4);
  EXPECT_NEAR(scene.bodies.pose[1].position.y, 0.3, 1e-4);
}

TEST(RigidImpact, NothingFallsThroughAPlaneAt500MetersPerSecond) {
  for (const Kind& kind : {box, ball, standing_cylinder, lying_capsule})
    for (int k = 0; k < 8; ++k) {
      RigidScene scene;
      kind.add(scene, 20 + 0.37 * k);
      scene.plane();
      scene.bodies.velocity[0] = {{3.0 * k, -500, 0}, {0, 0, 5.0 * k}};
      const double energy = scene.energy();
      double lowest = 1;
      for (int f = 0; f < 30; ++f) scene.step(), lowest = std::min(lowest, scene.bodies.pose[0].position.y);
      EXPECT_GT(lowest, 0.9 * kind.half_height) << kind.name << " " << k;
      EXPECT_LT(scene.energy(), energy) << kind.name << " " << k;
    }
}

TEST(RigidImpact, FastBallDoesNotPassAThinBox) {
  for (int k = 0; k < 16; ++k) {
    RigidScene scene;
    scene.gravity = {};
    scene.ball(0.05, {0.03 * k, 3 + 0.21 * k, 0});
    scene.static_box({2, 0.01, 2}, {0, 0, 0});
    scene.bodies.velocity[0].linear = {2.0 * k, -300, 0};
    double lowest = 1;
    for (int f = 0; f < 10; ++f) scene.step(), lowest = std::min(lowest, scene.bodies.pose[0].position.y);
    EXPECT_GT(lowest, 0.05) << k;
  }
}

constexpr double h = 1.0 / 600;

/// Time between two flips of a free body that spins about nearly its middle axis. It follows from Jacobi's solution of
/// Euler's equations with I1 > I2 > I3 (Landau and Lifshitz, Mechanics, section 37). The spin about the middle axis
/// changes its sign every 2 K(k) / rate seconds.
double flip_time(const Vec3d& I, const Vec3d& w) {
  const double L2 = I.x * I.x * w.x * w.x + I.y * I.y * w.y * w.y + I.z * I.z * w.z * w.z;
  const double E2 = I.x * w.x * w.x + I.y * w.y * w.y + I.z * w.z * w.z;
  double I1 = I.x, I3 = I.z;
  if (L2 < E2 * I.y) std::swap(I1, I3);  // the solution about the other axis
  const double rate = std::sqrt((I1 - I.y) * (L2 - E2 * I3) / (I.x * I.y * I.z));
  const double k2 = (I.y - I3) * (E2 * I1 - L2) / ((I1 - I.y) * (L2 - E2 * I3));
  return 2 * complete_elliptic(std::sqrt(k2)) / rate;
}

/// Spins a wing nut about its middle axis for `seconds`. Times at which the spin about it changes its sign.
std::vector<double> flips_of(RigidBodies& bodies, double seconds) {
  std::vector<double> flips;
  double before = local_spin(bodies).y;
  for (int i = 1; i * h < seconds; ++i) {
    move_freely(bodies, {}, h);
    const double now = local_spin(bodies).y;
    if ((before < 0) != (now < 0)) flips.push_back((i - now / (now - before)) * h);
    before = now;
  }
  return flips;
}

TEST(FreeMotion, ABodyThatSpinsAboutItsMiddleAxisFlipsInJacobisTime) {
  const Vec3d I{3e-3, 2e-3, 1e-3}, w{0.05, 6, 0.02};
  RigidBodies bodies = one_body(0.5, I);
  bodies.velocity[0].angular = w;
  const Vec3d momentum = spin_momentum(bodies);
  const double energy = spin_energy(bodies);
  const std::vector<double> flips = flips_of(bodies, 60);
  ASSERT_GE(flips.size(), 5u);
  const double period = (flips.back() - flips.front()) / static_cast<double>(flips.size() - 1);
  EXPECT_NEAR(period / flip_time(I, w), 1, 0.005);
  EXPECT_LT(length(spin_momentum(bodies) - momentum), 1e-9 * length(momentum));
  EXPECT_NEAR(spin_energy(bodies) / energy, 1, 1e-4);
}

TEST(FreeMotion, FastSpinKeepsItsEnergyAndItsMomentum) {
  RigidBodies bodies = one_body(2, {0.3, 0.5, 0.7});
  bodies.velocity[0].angular = {40, 30, -50};
  const Vec3d momentum = spin_momentum(bodies);
  const double energy = spin_energy(bodies);
  double worst = 0;
  for (int i = 0; i < 36000; ++i) {
    move_freely(bodies, {}, h);
    worst = std::max(worst, std::abs(spin_energy(bodies) / energy - 1));
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_LT(length(spin_momentum(bodies) - momentum), 1e-8 * length(momentum));
}

TEST(FreeMotion, ASpinAboutAPrincipalAxisTurnsByItsAngle) {
  RigidBodies bodies = one_body(2, {0.3, 0.5, 0.7});
  bodies.velocity[0].angular = {0, 60, 0};
  for (int i = 0; i < 600; ++i) move_freely(bodies, {}, h);
  const Vec3d x = bodies.pose[0].direction({1, 0, 0});
  EXPECT_NEAR(std::atan2(-x.z, x.x), std::remainder(60.0, 2 * std::numbers::pi), 1e-3);
}

TEST(FreeMotion, FallsAsGravitySays) {
  RigidBodies bodies = one_body(2, {0.3, 0.5, 0.7});
  bodies.velocity[0] = {{3, 5, 0}, {1, 2, 3}};
  for (int i = 0; i < 600; ++i) move_freely(bodies, {0, -9.81, 0}, h);
  EXPECT_NEAR(bodies.pose[0].position.x, 3, 1e-9);
  EXPECT_NEAR(bodies.pose[0].position.y, 5 - 9.81 / 2, 9.81 * h);
}

TEST(FreeMotion, ABodyWithoutMassMovesByItsVelocityAlone) {
  RigidBodies bodies = one_body(1, {1, 1, 1});
  bodies.mass[0] = {};
  bodies.velocity[0] = {{1, 0, 0}, {0, 0, 0.5}};
  for (int i = 0; i < 600; ++i) move_freely(bodies, {0, -9.81, 0}, h);
  EXPECT_NEAR(bodies.pose[0].position.x, 1, 1e-9);
  EXPECT_EQ(bodies.pose[0].position.y, 0);
  const Vec3d x = bodies.pose[0].direction({1, 0, 0});
  EXPECT_NEAR(std::atan2(x.y, x.x), 0.5, 1e-6);
}

RigidBodies turned_body() {
  RigidBodies bodies = one_body(2, {0.3, 0.5, 0.7});
  bodies.pose[0] = {{1, 2, 3}, normalized(Quatd{0.3, -0.2, 0.5, 0.7})};
  bodies.inverse_inertia[0] = world_inverse_inertia(bodies.mass[0], bodies.pose[0].rotation);
  return bodies;
}

const Vec3d r{0.4, -0.3, 0.2}, impulse{1e-5, 2e-5, -3e-5};

TEST(Impulse, APointMovesByTheImpulseTimesItsInverseMass) {
  RigidBodies bodies = turned_body();
  const Vec3d local = bodies.pose[0].local_point(bodies.pose[0].position + r);
  const Vec3d before = bodies.pose[0].point(local);
  const Mat3d K = inverse_mass_at(bodies, 0, r);
  push(bodies, 0, r, impulse);
  EXPECT_LT(length(bodies.pose[0].point(local) - before - K * impulse), 1e-8);
}

TEST(Impulse, PosesAndVelocitiesFollowEachOther) {
  RigidBodies pushed = turned_body(), kicked = turned_body();
  std::vector<BodyPose> predicted(1);
  predict_bodies(pushed, {}, h, predicted);
  push(pushed, 0, r, impulse * h);
  turn(pushed, 0, impulse * h);
  finish_bodies(pushed, predicted, h);
  push_velocity(kicked, 0, r, impulse);
  turn_velocity(kicked, 0, impulse);
  EXPECT_LT(length(pushed.velocity[0].linear - kicked.velocity[0].linear), 1e-12);
  EXPECT_LT(length(pushed.velocity[0].angular - kicked.velocity[0].angular), 1e-10);
}

TEST(Impulse, NothingMovesTheWorld) {
  RigidBodies bodies = turned_body();
  push(bodies, no_body, r, impulse);
  turn(bodies, no_body, impulse);
  push_velocity(bodies, no_body, r, impulse);
  turn_velocity(bodies, no_body, impulse);
  EXPECT_EQ(frobenius_squared(inverse_mass_at(bodies, no_body, r)), 0);
  EXPECT_EQ(length(velocity_at(bodies, no_body, r)), 0);
  EXPECT_EQ(bodies.pose[0].position, (Vec3d{1, 2, 3}));
}

}  // namespace souple::test::test_rigid_motion
