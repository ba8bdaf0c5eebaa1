#include "tests/rigid/rigid_scene.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

// Contacts of rigid bodies at rest: lying, standing.

namespace souple::test::test_rigid_contacts_rest {

/// Ten boxes, each `ratio` times as large as the one below; the largest is 0.5 m.
void stack(RigidScene& scene, double ratio) {
  double size = ratio > 1 ? 0.5 / std::pow(ratio, 9) : 0.5, y = 0;
  for (int i = 0; i < 10; ++i, size *= ratio) {
    scene.box(Vec3d{size, size, size} * 0.5, {0, y + size / 2, 0});
    y += size;
  }
  scene.plane();
}

struct Rest {
  double sag = 0;    // in the first second, of the uppermost body [m]
  double drift = 0;  // after the first second, of any body [m]
  double speed = 0;  // after the first second [m/s]
};

Rest rest_for(RigidScene& scene, double seconds, std::uint32_t top) {
  const double height = scene.bodies.pose[top].position.y;
  scene.run(1);
  Rest rest{.sag = height - scene.bodies.pose[top].position.y};
  const std::vector<BodyPose> before = scene.bodies.pose;
  for (int f = 60; f < std::lround(seconds * 60); ++f) {
    scene.step();
    rest.speed = std::max(rest.speed, scene.fastest());
  }
  rest.drift = farthest(before, scene.bodies.pose);
  return rest;
}

void expect_stack_stands(double ratio, double largest_sag) {
  RigidScene scene;
  stack(scene, ratio);
  const Rest rest = rest_for(scene, 60, 9);
  EXPECT_LT(rest.sag, largest_sag);
  EXPECT_LT(rest.drift, 1e-3);
  EXPECT_LT(rest.speed, 0.01);
}

TEST(RigidRest, StackOfEqualBoxesStandsForAMinute) {
  expect_stack_stands(1, 1e-4);
}
TEST(RigidRest, StackOfSlightlyGrowingBoxesStandsForAMinute) {
  expect_stack_stands(std::pow(1.5, 1.0 / 9), 1e-4);
}
// The uppermost box has 125 times the mass of the lowest.
TEST(RigidRest, StackThatGrowsFiveToOneStandsForAMinute) {
  expect_stack_stands(std::pow(5, 1.0 / 9), 1e-4);
}
TEST(RigidRest, StackOfShrinkingBoxesStandsForAMinute) {
  expect_stack_stands(std::pow(5, -1.0 / 9), 1e-4);
}

/// Every other layer ends with half bricks. A whole one would stand over the end by more than half, and fall.
void build_wall(RigidScene& scene, int layers, int width) {
  constexpr double pitch = 0.402;
  for (int layer = 0; layer < layers; ++layer) {
    const double y = 0.1 + layer * 0.2;
    const int shift = layer % 2;
    for (int k = 0; k < width - shift; ++k) scene.box({0.2, 0.1, 0.1}, {(k + shift * 0.5) * pitch, y, 0});
    if (shift == 0) continue;
    for (const double x : {-0.1, (width - 1) * pitch + 0.1}) scene.box({0.0995, 0.1, 0.1}, {x, y, 0});
  }
  scene.plane();
}

void expect_wall_stands(int layers, int width, double seconds) {
  RigidScene scene;
  build_wall(scene, layers, width);
  const Rest rest = rest_for(scene, seconds, static_cast<std::uint32_t>(scene.bodies.size() - 2));
  EXPECT_LT(rest.sag, 1e-4);
  EXPECT_LT(rest.drift, 1e-4);
  EXPECT_LT(rest.speed, 2e-3);
}

TEST(RigidRest, WallOfBricksStands) {
  expect_wall_stands(10, 10, 4);
}

TEST(RigidRest, WallOfBricksStandsForAMinuteSlow) {
  expect_wall_stands(10, 10, 60);
}

TEST(RigidRest, WallOfTwoHundredBricksStands) {
  expect_wall_stands(10, 20, 2);
}

// 811 bricks, 4 m high.
TEST(RigidRest, WallOfTwentyLayersStandsSlow) {
  expect_wall_stands(20, 40, 3);
}

/// Cards of 14 cm lean against each other in pairs, on floors of cards.
void build_card_house(RigidScene& scene, int storeys) {
  constexpr double lean = 0.35, half = 0.07, thick = 0.001, depth = 0.05;
  const double sine = std::sin(lean), cosine = std::cos(lean);
  const double width = 4 * (half * sine + thick * cosine) + 0.004;
  double y = 0;
  for (int storey = storeys; storey > 0; --storey) {
    for (int k = 0; k < storey; ++k)
      for (const int side : {-1, 1})
        scene.box({thick, half, depth},
                  {(k - (storey - 1) / 2.0) * width + side * (half * sine + thick * cosine),
                   y + half * cosine + thick * sine, 0},
                  Quatd::from_axis_angle({0, 0, 1}, side * lean), 700);
    y += 2 * (half * cosine + thick * sine);
    for (int k = 0; k + 1 < storey; ++k)
      scene.box({width * 0.49, thick, depth}, {(k - (storey - 2) / 2.0) * width, y + thick, 0}, {}, 700);
    y += 2 * thick;
  }
  scene.plane();
}

TEST(RigidRest, CardHouseStands) {
  RigidScene scene;
  scene.material.friction = 0.6f;
  build_card_house(scene, 4);
  const Rest rest = rest_for(scene, 20, static_cast<std::uint32_t>(scene.bodies.size() - 2));
  EXPECT_LT(rest.sag, 1e-5);
  EXPECT_LT(rest.drift, 1e-5);
  EXPECT_LT(rest.speed, 1e-3);
}

TEST(RigidRest, CardHouseFallsWithoutFriction) {
  RigidScene scene;
  scene.material.friction = 0.1f;
  build_card_house(scene, 2);
  EXPECT_GT(rest_for(scene, 2, 5).drift, 0.05);
}

TEST(RigidRest, HeavyBoxLiesOnALightOne) {
  RigidScene scene;
  const double light = std::cbrt(1.0 / 1000);
  scene.box(Vec3d{1, 1, 1} * (light / 2), {0, light / 2, 0});
  scene.box({0.5, 0.5, 0.5}, {0, light + 0.5, 0});
  scene.plane();
  const Rest rest = rest_for(scene, 20, 1);
  EXPECT_LT(rest.sag, 0.002 * light);
  EXPECT_LT(rest.drift, 1e-4);
}

TEST(RigidRest, BodiesOfAllMassesAndSizesLie) {
  for (const double size : {1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0})
    for (const double mass : {1e-3, 1.0, 1e3, 1e6}) {
      RigidScene scene;
      scene.box(Vec3d{1, 1, 1} * (size / 2), {0, size / 2, 0}, {}, mass / (size * size * size));
      scene.plane();
      const Rest rest = rest_for(scene, 3, 0);
      EXPECT_TRUE(scene.finite());
      EXPECT_LT(std::abs(rest.sag), 1e-4) << "size " << size << " m, mass " << mass << " kg";
      EXPECT_LT(rest.drift, 1e-4) << "size " << size << " m, mass " << mass << " kg";
      EXPECT_LT(rest.speed, 0.01) << "size " << size << " m, mass " << mass << " kg";
    }
}

TEST(RigidRest, BodiesInsideEachOtherSeparateSlowly) {
  RigidScene scene;
  for (int i = 0; i < 3; ++i) {
    const double x = 0.02 * i;
    scene.box({0.1, 0.1, 0.1}, {x, 0.1 + 0.01 * i, 0.013 * i}, Quatd::from_axis_angle({0, 1, 0}, 0.3 * i));
    scene.ball(0.1, {x, 0.15, 0.01 * i});
    scene.capsule(0.05, 0.1, {x, 0.2, 0.01 * i});
  }
  scene.plane();
  double fastest = 0;
  for (int f = 0; f < 300; ++f) scene.step(), fastest = std::max(fastest, scene.fastest());
  EXPECT_TRUE(scene.finite());
  EXPECT_LT(fastest, 6);
  EXPECT_LT(scene.deepest(), 2e-3);
}

TEST(RigidRest, NeedlesThatFallIntoAHeapGainNoEnergy) {
  RigidScene scene;
  for (int i = 0; i < 30; ++i) {
    const double angle = 0.8 * i;
    scene.box({0.5, 0.005, 0.005}, {0.05 * std::sin(1.0 * i), 0.05 + 0.03 * i, 0.05 * std::cos(1.0 * i)},
              Quatd::from_axis_angle({0, 1, 0}, angle) *
                  Quatd::from_axis_angle({0, 0, 1}, 0.1 * std::sin(3.0 * i)));
  }
  scene.plane();
  const double energy = scene.energy();
  double fastest = 0, highest = energy;
  for (int f = 0; f < 120; ++f) {
    scene.step();
    fastest = std::max(fastest, scene.fastest()), highest = std::max(highest, scene.energy());
  }
  EXPECT_TRUE(scene.finite());
  EXPECT_LE(highest, energy * (1 + 1e-9));
  EXPECT_LT(fastest, 6);
}

}  // namespace souple::test::test_rigid_contacts_rest
