#include "tests/contacts/mini_world.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace souple::test_contacts_collider_contacts {

using test::MiniWorld;
constexpr double g = 9.81;

// A particle in contact with a plane tilted by `angle` about z, near the origin or far along the plane.
MiniWorld incline(double angle, float friction, const Vec3d& origin) {
  MiniWorld world;
  world.add(origin + Vec3d{-std::sin(angle), std::cos(angle), 0} * 0.05, 0.05f);
  world.end_object({friction, std::nullopt, 0});
  world.add_collider(Plane{}, {friction, std::nullopt, 0},
                     ColliderMotion::fixed({origin, Quatd::from_axis_angle({0, 0, 1}, angle), 1}));
  return world;
}

TEST(ColliderContacts, InclinedPlaneSticksBelowTheAngleOfFriction) {
  for (const int iterations : {1, 8}) {
    MiniWorld world = incline(0.95 * std::atan(0.5), 0.5f, {});
    const Vec3d before = world.at(0);
    for (int frame = 0; frame < 300; ++frame) world.step(1.0 / 60, 20, iterations);
    EXPECT_LT(length(world.at(0) - before), 1e-4);
    EXPECT_LT(length(world.velocity[0].xyz()), 1e-3f);
  }
}

TEST(ColliderContacts, InclinedPlaneSlidesWithGSinMinusMuCos) {
  for (const int iterations : {1, 8}) {
    const double angle = 1.2 * std::atan(0.5);
    MiniWorld world = incline(angle, 0.5f, {});
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 20, iterations);
    const double expected = g * (std::sin(angle) - 0.5 * std::cos(angle));
    EXPECT_NEAR(double(length(world.velocity[0].xyz())), expected, 0.02 * expected);
  }
}

TEST(ColliderContacts, KineticFrictionBelowStaticKeepsItSlidingOnceItSlides) {
  MiniWorld world = incline(0.35, 0.5f, {});
  world.materials[0].second = {0.5f, 0.1f, 0};
  world.colliders[0].material = {0.5f, 0.1f, 0};
  const Vec3d before = world.at(0);
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 20);
  EXPECT_LT(length(world.at(0) - before), 1e-5);  // tan 0.35 = 0.365 is below the static coefficient
  world.velocity[0] = {-1, -0.365f, 0, 0};
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 20);
  EXPECT_NEAR(double(length(world.velocity[0].xyz())), 1.0645 + g * (std::sin(0.35) - 0.1 * std::cos(0.35)),
              0.05);
}

double bounce_height(float restitution, int iterations, double offset) {
  MiniWorld world;
  world.add({0, 1 + 0.05 + offset, 0}, 0.05f);
  world.end_object({0, std::nullopt, restitution});
  world.add_collider(Plane{}, {});
  bool fallen = false;
  double highest = 0;
  for (int frame = 0; frame < 80; ++frame) {
    world.step(1.0 / 60, 20, iterations);
    fallen = fallen || world.on_colliders.report().count > 0 || world.velocity[0].y > 0;
    if (fallen) highest = std::max(highest, world.at(0).y - 0.05);
  }
  return highest / (1 + offset);
}

// Heights differ by less than the fall of a substep, so that contacts begin anywhere within one.
TEST(ColliderContacts, BounceHeightIsTheSquareOfRestitution) {
  for (const double offset : {0.0, 0.0007, 0.0013, 0.0021, 0.0029, 0.0035}) {
    for (const int iterations : {1, 5}) {
      EXPECT_NEAR(bounce_height(0.5f, iterations, offset), 0.25, 0.02 * 0.25);
      EXPECT_NEAR(bounce_height(0.9f, iterations, offset), 0.81, 0.02 * 0.81);
      EXPECT_LT(bounce_height(0, iterations, offset), 0.01);
      EXPECT_LT(bounce_height(1, iterations, offset), 1.005);
    }
  }
}

TEST(ColliderContacts, ABouncingBallComesToRestAndStaysThere) {
  MiniWorld world;
  world.add({0, 0.3, 0}, 0.05f);
  world.end_object({0.5f, std::nullopt, 0.6f});
  world.add_collider(Plane{}, {});
  for (int frame = 0; frame < 240; ++frame) world.step(1.0 / 60, 20);
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60, 20);
    ASSERT_NEAR(world.at(0).y, 0.05, 1e-6);
    ASSERT_LT(std::fabs(world.velocity[0].y), 1e-4f);
  }
  // At rest, the impulse per substep is m g h.
  std::vector<ContactPush> events;
  world.on_colliders.events(world.view(), events);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_NEAR(double(events[0].impulse), g / 1200, 0.05 * g / 1200);
  EXPECT_NEAR(double(events[0].point.y), 0, 1e-6);
  EXPECT_NEAR(double(events[0].normal.y), 1, 1e-6);
}

// Oblique impact without restitution: Coulomb takes mu (1 + e) v_n from the tangential speed.
TEST(ColliderContacts, ImpactFrictionFollowsTheNormalImpulse) {
  for (const double height : {0.001, 0.003, 0.009}) {
    MiniWorld world;
    world.gravity = {};
    world.add({0, 0.05 + height, 0}, 0.05f, 1, {5, -4, 0});
    world.end_object({0.3f, std::nullopt, 0.5f});
    world.add_collider(Plane{}, {0.3f, std::nullopt, 0});
    for (int frame = 0; frame < 4; ++frame) world.step(1.0 / 60, 10);
    EXPECT_NEAR(world.velocity[0].y, 2, 0.01);
    EXPECT_NEAR(world.velocity[0].x, 5 - 0.3 * (1 + 0.5) * 4, 0.02);
  }
}

// A moving plate carries a particle on it; a turntable rotates it.
TEST(ColliderContacts, AMovingColliderCarriesParticles) {
  for (const int iterations : {1, 4}) {
    MiniWorld world;
    world.add({0.2, 0.05, 0.1}, 0.05f);
    world.end_object({0.8f, std::nullopt, 0});
    world.add_collider(Box{{0, -0.1f, 0}, {1, 0.1f, 1}}, {0.8f, std::nullopt, 0},
                       ColliderMotion::callback([](double t) {
                         return Transform{{0.5 * t * t, 0.2 * t, 0}, {}, 1};
                       }));
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 20, iterations);
    EXPECT_LT(length(world.at(0) - Vec3d{0.7, 0.25, 0.1}), 2e-3);
    EXPECT_LT(length(Vec3d(world.velocity[0].xyz()) - Vec3d{1.0, 0.2, 0}), 1e-2);
  }
  MiniWorld world;
  world.add({0.5, 0.05, 0}, 0.05f, 1, {0, 0, float(-pi / 2)});
  world.end_object({0.8f, std::nullopt, 0});
  world.add_collider(Cylinder{{0, -0.1f, 0}, 1, 0.1f}, {0.8f, std::nullopt, 0},
                     ColliderMotion::callback([](double t) {
                       return Transform{{}, Quatd::from_axis_angle({0, 1, 0}, pi * t), 1};
                     }));
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 20);
  // Half a turn; omega^2 r = 4.9 m/s^2 is below mu g = 7.8, so it stays on its circle.
  EXPECT_LT(length(world.at(0) - Vec3d{-0.5, 0.05, 0}), 2e-2);
}

// A ball starts in the middle of a step, and a bar spins by a third of a turn in it. Both reach particles that were far
// away when candidates were searched.
TEST(ColliderContacts, AColliderThatSpeedsUpWithinAStepStillHits) {
  MiniWorld world;
  world.gravity = {};
  world.add({0.4, 0, 0}, 0.01f);
  world.end_object({0, std::nullopt, 0});
  const auto x = [](double t) { return 60 * std::max(0.0, t - 0.008); };
  world.add_collider(Sphere{.radius = 0.1f}, {0, std::nullopt, 0}, ColliderMotion::callback([x](double t) {
                       return Transform{{x(t), 0, 0}, {}, 1};
                     }));
  world.step(1.0 / 60, 20);
  EXPECT_GT(world.at(0).x, x(1.0 / 60) + 0.1) << "in front of the ball";

  MiniWorld other;
  other.gravity = {};
  other.add({0, 0.9, 0}, 0.01f);
  other.end_object({0, std::nullopt, 0});
  other.add_collider(Box{{}, {1, 0.05f, 0.05f}}, {0, std::nullopt, 0}, ColliderMotion::callback([](double t) {
                       return Transform{{}, Quatd::from_axis_angle({0, 0, 1}, 125 * t), 1};
                     }));
  other.step(1.0 / 60, 20);
  EXPECT_LT(other.at(0).x, -0.3) << "swept along by the bar";
}

// A restarting loop moves the collider at once: this must not give particles a velocity.
TEST(ColliderContacts, ALoopThatJumpsBackDoesNotKick) {
  MiniWorld world;
  world.gravity = {};
  world.add({0.7, 0, 0}, 0.05f);
  world.end_object({0.5f, std::nullopt, 1});
  world.add_collider(Sphere{}, {},
                     ColliderMotion::keyframes({{0, {0.2, 0, 0}, {}}, {0.5, {-1, 0, 0}, {}}}, true));
  for (int frame = 0; frame < 240; ++frame) {
    world.step(1.0 / 60, 10);
    ASSERT_LT(length(world.velocity[0].xyz()), 0.01f);
  }
}

TEST(ColliderContacts, FrictionlessTableSlidesAwayUnderneath) {
  MiniWorld world;
  world.add({0, 0.05, 0}, 0.05f);
  world.end_object({0, std::nullopt, 0});
  world.add_collider(Plane{}, {}, ColliderMotion::callback([](double t) {
                       return Transform{{3 * t, 0, 0}, {}, 1};
                     }));
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);
  EXPECT_NEAR(world.at(0).x, 0, 1e-6);
}

// 100 m/s and one substep of 1/60 s: 1.67 m per substep.
TEST(ColliderContacts, FastParticlesDoNotPassThinBoxesAndSmallSpheres) {
  const Shape targets[] = {Box{{}, {1, 1, 0.005f}}, Sphere{{}, 0.05f}, Capsule{{}, 0.05f, 0.2f},
                           Cylinder{{}, 0.05f, 0.2f}};
  for (const Shape& target : targets) {
    for (const bool target_moves : {false, true}) {
      for (const double z : {0.3, 0.8, 1.5, 2.9}) {
        for (const float radius : {0.0005f, 0.02f}) {
          MiniWorld world;
          world.gravity = {};
          world.add({0.01, 0.02, z}, radius, 1, target_moves ? Vec3f{} : Vec3f{0, 0, -100});
          world.end_object({0, std::nullopt, 0});
          world.add_collider(target, {},
                             !target_moves ? ColliderMotion{} : ColliderMotion::callback([](double t) {
                               return Transform{{0, 0, 100 * t}, {}, 1};
                             }));
          for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60, 1);
          const double target_z = target_moves ? 100 * world.time : 0;
          const double closest = surface_distance(target, world.at(0) - Vec3d{0, 0, target_z}).distance;
          EXPECT_GT(closest, double(radius) - 1e-4) << shape_name(target);
          if (std::holds_alternative<Box>(target)) {
            EXPECT_GT(world.at(0).z, target_z);
          }
          if (!target_moves) {
            EXPECT_GT(world.velocity[0].z, -30);
          }
        }
      }
    }
  }
}

// A fast miss must stay a miss.
TEST(ColliderContacts, FastParticlesBesideAShapeFlyOn) {
  MiniWorld world;
  world.gravity = {};
  world.add({0.0711, 0, 1}, 0.02f, 1, {0, 0, -100});
  world.end_object({0.5f, std::nullopt, 0});
  world.add_collider(Sphere{{}, 0.05f}, {});
  world.step(1.0 / 60, 1);
  EXPECT_EQ(world.velocity[0].xyz(), (Vec3f{0, 0, -100}));
}

TEST(ColliderContacts, OneKilometreFromTheOriginIsTheSame) {
  std::vector<Vec3d> end;
  for (const double far : {0.0, 1024.0}) {
    const Vec3d origin{far, 0.5 * far, -far};
    MiniWorld world = incline(0.5, 0.3f, origin);
    world.add_collider(Sphere{{}, 0.25f}, {0.3f, std::nullopt, 0.5f},
                       ColliderMotion::fixed({origin + Vec3d{-1.5, -0.6, 0.02}, {}, 1}));
    for (int frame = 0; frame < 120; ++frame) world.step(1.0 / 60, 10);
    end.push_back(world.at(0) - origin);
  }
  EXPECT_GT(length(end[0]), 0.5);
  EXPECT_LT(length(end[0] - end[1]), 1e-4);
}

// A particle that starts deep inside leaves at the given speed, without gaining velocity.
TEST(ColliderContacts, AnOldOverlapLeavesSlowlyAndKeepsNoSpeed) {
  MiniWorld world;
  world.add({0, -0.2, 0}, 0.05f);
  world.end_object({0.5f, std::nullopt, 0.9f});
  world.add_collider(Plane{}, {});
  world.step(1.0 / 60, 10);
  EXPECT_NEAR(world.at(0).y, -0.2 + 3.0 / 60, 1e-3);
  double highest = -1;
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60, 10);
    highest = std::max(highest, world.at(0).y);
  }
  EXPECT_NEAR(highest, 0.05, 1e-4);
}

TEST(ColliderContacts, PinnedParticlesAndDisabledCollidersAreLeftAlone) {
  MiniWorld world;
  world.add({0, 0, 0}, 0.05f, 0);
  world.add({1, 0, 0}, 0.05f, 1);
  world.end_object({});
  world.add_collider(Plane{}, {});
  world.colliders[0].enabled = false;
  world.step(1.0 / 60, 10);
  EXPECT_EQ(world.at(0), (Vec3d{0, 0, 0}));
  EXPECT_NEAR(world.at(1).y, -0.5 * g / 3600 * 1.1, 1e-5);
  world.colliders[0].enabled = true;
  world.step(1.0 / 60, 10);
  EXPECT_EQ(world.at(0), (Vec3d{0, 0, 0}));
}

TEST(ColliderContacts, AThrowingCallbackPassesThroughAndLeavesNoContacts) {
  MiniWorld world;
  world.add({0, 0.04, 0}, 0.05f);
  world.end_object({});
  world.add_collider(Plane{}, {});
  world.add_collider(Sphere{}, {},
                     ColliderMotion::callback([](double) -> Transform { throw std::runtime_error("user"); }));
  EXPECT_THROW(world.step(1.0 / 60, 1), std::runtime_error);
  EXPECT_EQ(world.on_colliders.size(), 0u);
}

TEST(ColliderContacts, NotANumberTouchesNothing) {
  MiniWorld world;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  world.add({nan, 0, 0}, 0.05f);
  world.add({0, 0.04, 0}, 0.05f);
  world.end_object({});
  world.add_collider(Box{}, {});
  world.step(1.0 / 60, 10);
  EXPECT_TRUE(is_finite(world.at(1)));
}

}  // namespace souple::test_contacts_collider_contacts
