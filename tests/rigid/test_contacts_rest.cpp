#include "tests/count_allocations.h"
#include "tests/rigid/rigid_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test::test_rigid_contacts_rest {

// Contacts of rigid bodies at rest: lying, standing.

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

// In the third one the uppermost box has 125 times the mass of the lowest.
TEST(RigidRest, StacksOfBoxesStandForAMinute) {
  for (const double growth : {1.0, 1.5, 5.0, 0.2}) {
    RigidScene scene;
    stack(scene, std::pow(growth, 1.0 / 9));
    const Rest rest = rest_for(scene, 60, 9);
    EXPECT_LT(rest.sag, 1e-4) << growth;
    EXPECT_LT(rest.drift, 1e-3) << growth;
    EXPECT_LT(rest.speed, 0.01) << growth;
  }
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

// Many rigid bodies: the same with any number of threads, and what holds of all of them.

constexpr int dominoes = 200;

bool fallen(const BodyPose& pose) {
  return pose.direction({0, 1, 0}).y < 0.8;
}

void add_dominoes(RigidScene& scene) {
  for (int i = 0; i < dominoes; ++i) scene.box({0.01, 0.1, 0.05}, {i * 0.08, 0.1, 0}, {}, 600);
  scene.bodies.velocity[0] = {{0.3, 0, 0}, {0, 0, -3}};
  scene.plane();
}

/// Steps until all dominoes have fallen, for 20 s at most; appends them in the order in which they fall.
class Fall {
 public:
  explicit Fall(RigidScene& scene) : scene_(scene), is_down_(dominoes, false) { add_dominoes(scene); }
  void run(int frames) {
    for (int f = 0; f < frames && order_.size() < dominoes; ++f) {
      scene_.step();
      for (std::size_t i = 0; i < dominoes; ++i)
        if (!is_down_[i] && fallen(scene_.bodies.pose[i])) order_.push_back(i), is_down_[i] = true;
    }
  }
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  RigidScene& scene_;
  std::vector<bool> is_down_;
  std::vector<std::size_t> order_;
};

TEST(ManyRigidBodies, DominoesFallInOneOrderWithAnyNumberOfThreadsSlow) {
  RigidScene one(1), eight(8);
  Fall fall(one), fall_of_eight(eight);
  fall.run(1200), fall_of_eight.run(1200);
  EXPECT_TRUE(same_bits(eight.bodies, one.bodies));
  EXPECT_EQ(fall_of_eight.order(), fall.order());
  ASSERT_EQ(fall.order().size(), std::size_t{dominoes});
  EXPECT_TRUE(std::is_sorted(fall.order().begin(), fall.order().end()));
}

/// Boxes of 20 cm, turned at random, above a plane.
void drop_boxes(RigidScene& scene, int count) {
  std::mt19937 random(1);
  const auto uniform = [&random] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  const int side = static_cast<int>(std::cbrt(count / 2.0));
  for (int i = 0; i < count; ++i) {
    Quatd q;
    q.x = uniform(), q.y = uniform(), q.z = uniform(), q.w = uniform();
    const int layer = i / side / side, row = i / side % side;
    Vec3d x{i % side - side / 2.0, layer + 1.0, row - side / 2.0};
    x.x += 0.1 * uniform(), x.z += 0.1 * uniform();
    scene.box({0.1, 0.1, 0.1}, x * 0.4, normalized(q));
  }
  scene.plane();
}

TEST(ManyRigidBodies, HeapOfBoxesComesToRest) {
  RigidScene scene(2);
  drop_boxes(scene, 300);
  const double energy = scene.energy();
  double highest = energy;
  for (int f = 1; f <= 240; ++f) {
    scene.step();
    highest = std::max(highest, scene.energy());
  }
  double lowest = 1;
  for (std::size_t i = 0; i < 300; ++i) lowest = std::min(lowest, scene.bodies.pose[i].position.y);
  EXPECT_LE(highest, energy);
  EXPECT_LT(scene.deepest(), 0.02 * 0.2);
  EXPECT_GT(lowest, 0.095);
}

TEST(ManyRigidBodies, WarmStepAllocatesNothing) {
  RigidScene scene(2);
  drop_boxes(scene, 60);
  scene.run(4);
  const long before = allocations();
  scene.run(1);
  EXPECT_EQ(allocations() - before, 0);
}

}  // namespace souple::test::test_rigid_contacts_rest
