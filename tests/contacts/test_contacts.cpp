#include "souple/contacts/contact_material.h"
#include "souple/error.h"
#include "tests/collision/random.h"
#include "tests/contacts/mini_world.h"
#include "tests/count_allocations.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_contacts {

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

ContactMaterialPair combine(const ContactMaterial& a, const ContactMaterial& b) {
  const NamedContactMaterial row{"a", a}, column{"b", b};
  return ContactMaterialTable({&row, 1}, {&column, 1}, {}).at(0, 0);
}

TEST(ContactMaterial, GeometricMeanOfFrictionsAndLargerRestitution) {
  const ContactMaterialPair pair = combine({0.9f, 0.4f, 0.1f}, {0.4f, std::nullopt, 0.7f});
  EXPECT_FLOAT_EQ(pair.static_friction, 0.6f);
  EXPECT_FLOAT_EQ(pair.kinetic_friction, 0.4f);
  EXPECT_FLOAT_EQ(pair.restitution, 0.7f);
  EXPECT_EQ(combine({0, std::nullopt, 0}, {5, std::nullopt, 0}).static_friction, 0);
}

TEST(ContactMaterial, PairOverridesComeFirstInEitherOrder) {
  PairOverrides table;
  table.set("ice", "skate", {0.02f, 0.01f, 0.0f});
  const std::vector<NamedContactMaterial> rows{{"skate", {1, std::nullopt, 0}},
                                               {"shoe", {1, std::nullopt, 0}}};
  const std::vector<NamedContactMaterial> columns{{"ice", {0.25f, std::nullopt, 0.5f}}};
  const ContactMaterialTable matrix(rows, columns, table);
  EXPECT_EQ(matrix.rows(), 2u);
  EXPECT_FLOAT_EQ(matrix.at(0, 0).kinetic_friction, 0.01f);
  EXPECT_FLOAT_EQ(matrix.at(1, 0).static_friction, 0.5f);
}

TEST(ContactMaterial, ATableOfManyObjectsHoldsOnlyPairsThatDeviate) {
  std::vector<std::string> names;
  names.reserve(40);
  for (int k = 0; k < 40; ++k) names.push_back("object" + std::string(1, static_cast<char>('0' + k)));
  std::vector<NamedContactMaterial> all;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const float friction = 0.1f * static_cast<float>(k % 7);
    all.push_back(
        {names[k],
         {friction, k % 3 == 0 ? std::optional(friction / 2) : std::nullopt, k % 5 == 0 ? 0.5f : 0.0f},
         {1u << k % 3, k % 4 == 0 ? 1u : ~0u}});
  }
  PairOverrides overrides;
  overrides.set(names[3], names[17], {0.9f, 0.8f, 0.1f});
  overrides.set(names[5], names[5], {0.7f, 0.6f, 0});
  overrides.set_collide(names[3], names[17], false);
  overrides.set_collide(names[8], names[2], false);
  overrides.set_collide(names[9], names[9], false);
  const ContactMaterialTable table(all, all, overrides);
  using Pair = std::pair<std::size_t, std::size_t>;
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = 0; b < all.size(); ++b) {
      const Pair which = std::minmax(a, b);
      ContactMaterialPair expected = combine(all[a].material, all[b].material);
      if (which == Pair{3, 17}) expected = {0.9f, 0.8f, 0.1f};
      if (which == Pair{5, 5}) expected = {0.7f, 0.6f, 0};
      const bool collides = (a == b || may_collide(all[a].filter, all[b].filter)) && which != Pair{3, 17} &&
                            which != Pair{2, 8} && which != Pair{9, 9};
      const ContactMaterialPair pair = table.at(a, b);
      EXPECT_EQ(pair.static_friction, expected.static_friction);
      EXPECT_EQ(pair.kinetic_friction, expected.kinetic_friction);
      EXPECT_EQ(pair.restitution, expected.restitution);
      EXPECT_EQ(table.collide(a, b), collides) << a << ", " << b;
    }
  std::vector<std::uint32_t> ignored;
  table.for_each_ignored(17, [&](std::uint32_t b) { ignored.push_back(b); });
  EXPECT_EQ(ignored, std::vector<std::uint32_t>{3});
}

TEST(ContactMaterial, BadCoefficientsAreRefused) {
  PairOverrides table;
  EXPECT_THROW(validate(ContactMaterial{-1, std::nullopt, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, 0.3f, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, std::nullopt, 1.5f}, "cloth"), Error);
  EXPECT_THROW(table.set("a", "b", {0.1f, 0.2f, 0}), Error);
  EXPECT_NO_THROW(validate(ContactMaterial{0.2f, 0.1f, 1}, "cloth"));
}

TEST(Contacts, AWarmStepAllocatesNothing) {
  test::MiniWorld world;
  test::Random random(2);
  for (int k = 0; k < 500; ++k) {
    const int layer = k / 100;
    const Vec3d cell{double(k % 10), double(layer), double(k / 10 % 10)};
    world.add(cell * 0.0201 + Vec3d{0, 0.01, 0} + random.point(-1e-4, 1e-4), 0.01f);
  }
  world.end_object({0.5f, std::nullopt, 0}).self_collision = true;
  world.add_collider(Plane{}, {});
  world.add_collider(Sphere{{0.1f, 0, 0.1f}, 0.02f}, {}, ColliderMotion::callback([](double t) {
                       return Transform{{0, 0.01 * std::sin(20 * t), 0}, {}, 1};
                     }));
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);

  const Substep substep{1.0f / 600, 1, Mode::small_steps};
  world.start = world.offset;
  const long before = test::allocations();
  world.begin_step(ContactStep{world.time, 1.0f / 60, 9.81f});
  for (int k = 0; k < 10; ++k) world.substep(substep);
  EXPECT_GT(world.on_particles.report().count + world.on_colliders.report().count, 300u);

  EXPECT_EQ(test::allocations() - before, 0);
}

using test::Random;

Vec3d momentum(const MiniWorld& world) {
  Vec3d sum;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    sum += Vec3d(world.velocity[i].xyz()) / double(world.position[i].w);
  return sum;
}

double energy(const MiniWorld& world) {
  double sum = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    sum += 0.5 * length_squared(Vec3d(world.velocity[i].xyz())) / double(world.position[i].w);
  return sum;
}

// Newton's law: momentum is conserved, the relative velocity becomes -e times its old value, and the energy
// falls by 1/2 mu (1 - e^2) v^2.
TEST(ParticleContacts, HeadOnCollisionKeepsMomentumAndTheEnergyLaw) {
  for (const float e : {0.0f, 0.5f, 1.0f}) {
    for (const float speed : {0.5f, 3.0f, 40.0f}) {
      MiniWorld world;
      world.gravity = {};
      world.add({-0.1, 0, 0}, 0.02f, 1, {speed, 0, 0});
      world.add({0.1, 0, 0}, 0.03f, 3, {-speed, 0, 0});
      world.end_object({0.5f, std::nullopt, e}).self_collision = true;
      const Vec3d before = momentum(world);
      for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60, 10);
      EXPECT_LT(length(momentum(world) - before), 1e-5 * 4 * double(speed));
      const double v = double(world.velocity[1].x - world.velocity[0].x);
      EXPECT_NEAR(v, double(2 * speed * e), 0.01 * double(speed)) << e << " " << speed;
      const double kinetic = 0.5 * 4 * 0.25 * double(speed * speed) + 0.5 * 0.75 * v * v;
      EXPECT_NEAR(energy(world), kinetic, 0.01 * kinetic);
    }
  }
}

// Frictionless, elastic and off center: the impulse is along the line of centers at contact, sin(angle) = b /
// (2 r).
TEST(ParticleContacts, ObliqueFastCollisionLeavesAlongTheLineOfCenters) {
  MiniWorld world;
  world.gravity = {};
  world.add({-0.052, 0.01, 0}, 0.01f, 1, {6, 0, 0});
  world.add({0, 0, 0}, 0.01f, 1);
  world.end_object({0, std::nullopt, 1}).self_collision = true;
  for (int frame = 0; frame < 3; ++frame) world.step(1.0 / 60, 10);
  const Vec3d v(world.velocity[1].xyz());
  EXPECT_NEAR(std::atan2(-v.y, v.x), std::asin(0.5), 0.02);
  EXPECT_NEAR(length(v), 6 * std::cos(std::asin(0.5)), 0.06);
  EXPECT_NEAR(energy(world), 18, 0.02 * 18);
}

void drop_grains(MiniWorld& world, int columns, int layers, float radius, const Vec3d& origin) {
  Random random(1);
  const double pitch = 2.05 * double(radius);
  for (int y = 0; y < layers; ++y)
    for (int x = 0; x < columns; ++x)
      for (int z = 0; z < columns; ++z)
        world.add(origin + Vec3d{x * pitch, double(radius) + y * pitch, z * pitch} +
                      random.point(-0.02, 0.02) * double(radius),
                  radius, 0.01f);
  world.end_object({0.5f, std::nullopt, 0}, "grains").self_collision = true;
  world.add_collider(Plane{}, {0.5f, std::nullopt, 0}, ColliderMotion::fixed({origin, {}, 1}));
}

double deepest_overlap(const MiniWorld& world, double floor) {
  double deepest = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i) {
    deepest = std::max(deepest, floor + double(world.radius[i]) - world.at(i).y);
    for (std::size_t j = i + 1; j < world.position.size(); ++j)
      deepest =
          std::max(deepest, double(world.radius[i] + world.radius[j]) - length(world.at(i) - world.at(j)));
  }
  return deepest;
}

// 10 substeps of one iteration. The heap comes to rest, up to the speed that gravity adds in two substeps,
// and stays.
TEST(ParticleContacts, APileOfGrainsSettlesAndDoesNotMelt) {
  MiniWorld world;
  drop_grains(world, 6, 8, 0.01f, {});
  for (std::size_t i = 0; i < world.position.size(); ++i) world.velocity[i].x = float(i % 7) * 0.05f;
  std::vector<double> heights;
  for (int frame = 0; frame < 360; ++frame) {
    world.step(1.0 / 60, 10);
    if (frame % 180 != 179) continue;
    double highest = 0;
    for (std::size_t i = 0; i < world.position.size(); ++i) highest = std::max(highest, world.at(i).y);
    heights.push_back(highest);
  }
  EXPECT_LT(deepest_overlap(world, 0), 0.02 * 0.02);
  EXPECT_GT(heights[0], 0.08);
  EXPECT_GT(heights[1], 0.95 * heights[0]);
  double fastest = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    fastest = std::max(fastest, double(length(world.velocity[i].xyz())));
  EXPECT_LT(fastest, 2 * 9.81 / 600);
}

TEST(ParticleContacts, MemoryCarriesARunOnBitForBit) {
  MiniWorld world;
  drop_grains(world, 4, 5, 0.01f, {});
  for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);
  MiniWorld resumed = world;
  resumed.on_colliders = {};
  resumed.on_particles = {};
  resumed.on_particles.set_friction_cache(world.on_particles.friction_cache());
  EXPECT_FALSE(world.on_particles.friction_cache().empty());
  for (int frame = 0; frame < 30; ++frame) {
    world.step(1.0 / 60, 10);
    resumed.step(1.0 / 60, 10);
  }
  EXPECT_EQ(world.hash(), resumed.hash());
}

TEST(ParticleContacts, ErasingParticlesRenumbersTheMemory) {
  ParticleContacts contacts;
  const CachedFriction friction[] = {
      {0, 4, {{1, 0, 0}, {}}}, {2, 5, {{0, 1, 0}, {}}}, {4, 7, {{0, 0, 1}, {1, 2, 3}}}};
  contacts.set_friction_cache(friction);
  contacts.erase_particles(1, 4);
  ASSERT_EQ(contacts.friction_cache().size(), 2u);
  EXPECT_EQ(contacts.friction_cache()[0].j, 1u);
  EXPECT_EQ(contacts.friction_cache()[1].i, 1u);
  EXPECT_EQ(contacts.friction_cache()[1].j, 4u);
}

TEST(ParticleContacts, AnUnsupportedClusterKeepsItsMomentum) {
  MiniWorld world;
  world.gravity = {};
  Random random(9);
  while (world.position.size() < 300) {
    const Vec3d x = random.point(-0.12, 0.12);
    bool free = true;
    for (std::size_t i = 0; i < world.position.size(); ++i) free = free && length(world.at(i) - x) > 0.0201;
    if (!free) continue;
    world.add(x, 0.01f, float(random.uniform(0.005, 0.02)), Vec3f(x * -5.0 + random.point(-0.2, 0.2)));
  }
  world.end_object({0.4f, std::nullopt, 0.3f}).self_collision = true;
  const Vec3d before = momentum(world);
  double scale = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i)
    scale += double(length(world.velocity[i].xyz()) / world.position[i].w);
  const double kinetic = energy(world);
  for (int frame = 0; frame < 60; ++frame) {
    world.step(1.0 / 60, 10);
    EXPECT_LT(energy(world), kinetic * 1.0001);
  }
  EXPECT_LT(length(momentum(world) - before), 1e-5 * scale);
}

// One grain on a fixed one, off center: friction holds it while tan(angle) <= mu.
TEST(ParticleContacts, FrictionHoldsAGrainOnAnother) {
  for (const float mu : {0.45f, 0.35f}) {
    MiniWorld world;
    const double angle = std::atan(0.4);
    world.add({0, 0, 0}, 0.1f, 0);
    world.add({0.2 * std::sin(angle), 0.2 * std::cos(angle), 0}, 0.1f, 1);
    world.end_object({mu, std::nullopt, 0}).self_collision = true;
    const Vec3d before = world.at(1);
    for (int frame = 0; frame < 120; ++frame) world.step(1.0 / 60, 20);
    if (mu > 0.4f) {
      EXPECT_LT(length(world.at(1) - before), 1e-4);
    } else {
      EXPECT_LT(world.at(1).y, 0);
    }
  }
}

TEST(ParticleContacts, OneKilometreFromTheOriginSettlesAlike) {
  std::vector<std::vector<Vec3d>> end;
  for (const double far : {0.0, 1024.0}) {
    const Vec3d origin{far, -far, far};
    MiniWorld world;
    drop_grains(world, 3, 3, 0.01f, origin);
    for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60, 10);
    end.emplace_back();
    for (std::size_t i = 0; i < world.position.size(); ++i) end.back().push_back(world.at(i) - origin);
  }
  for (std::size_t i = 0; i < end[0].size(); ++i) EXPECT_LT(length(end[0][i] - end[1][i]), 1e-4);
}

TEST(ParticleContacts, TheSameRunGivesTheSameBits) {
  std::vector<std::uint64_t> hashes;
  for (int run = 0; run < 2; ++run) {
    MiniWorld world;
    drop_grains(world, 5, 5, 0.01f, {});
    for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60, 10);
    hashes.push_back(world.hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// The broad phase against all pairs: different radii, distant cells, fast and slow particles, and objects
// that collide or not.
TEST(ParticleContacts, TheGridFindsEveryTouchingPair) {
  MiniWorld world;
  world.gravity = {};
  Random random(4);
  for (int object = 0; object < 3; ++object) {
    for (int k = 0; k < 700; ++k)
      world.add(random.point(-0.5, 0.5) + Vec3d{0, 0, -3}, float(random.uniform(0.004, 0.05)), 1);
    ContactObject& added = world.end_object({0.3f, std::nullopt, 0}, std::to_string(object));
    added.are_balls = true;
    added.self_collision = object == 1;
  }
  world.table.set_collide("1", "2", false);
  // Every pair nearer than 1.1 times the sum of its radii must become exactly one contact of the first
  // substep.
  std::size_t expected = 0;
  for (std::size_t i = 0; i < world.position.size(); ++i) {
    for (std::size_t j = i + 1; j < world.position.size(); ++j) {
      const std::size_t a = i / 700, b = j / 700;
      const bool meet = (a == 0 && b > 0) || (a == 1 && b == 1);
      if (meet && length(world.at(i) - world.at(j)) < 1.1 * double(world.radius[i] + world.radius[j]))
        ++expected;
    }
  }
  world.step(1.0 / 600, 1);
  EXPECT_GT(expected, 1000u);
  EXPECT_EQ(world.on_particles.size(), expected);
  std::vector<ContactPush> events;
  world.on_particles.events(world.view(), events);
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const ContactPush& a, const ContactPush& b) {
    return std::pair(a.particle, a.other) < std::pair(b.particle, b.other);
  }));
}

}  // namespace souple::test_contacts_contacts
