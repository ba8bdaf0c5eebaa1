#include "souple/rigid/impulse.h"
#include "tests/rigid/one_body.h"

#include <gtest/gtest.h>

namespace souple::test_rigid_impulse {

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
  const Vec3d n = normalized(impulse);
  EXPECT_NEAR(dot(n, K * n), inverse_mass_at(bodies, 0, r, n), 1e-12);
  push(bodies, 0, r, impulse);
  EXPECT_LT(length(bodies.pose[0].point(local) - before - K * impulse), 1e-8);
}

TEST(Impulse, PosesAndVelocitiesFollowEachOther) {
  const double h = 1.0 / 600;
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
  EXPECT_EQ(inverse_mass_at(bodies, no_body, r, {1, 0, 0}), 0);
  EXPECT_EQ(inverse_inertia_about(bodies, no_body, {1, 0, 0}), 0);
  EXPECT_EQ(length(velocity_at(bodies, no_body, r)), 0);
  EXPECT_EQ(bodies.pose[0].position, (Vec3d{1, 2, 3}));
}

}  // namespace souple::test_rigid_impulse
