#include "souple/rigid/impulse.h"
#include "tests/rigid/one_body.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_rigid_free_motion {

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

}  // namespace souple::test_rigid_free_motion
