#include "tests/intersections/crossings.h"
#include "tests/physics/collision_cases.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

// Overlaps at the start leave alike at every size. If lengths are `scale` times as long, and stiffness and time step
// follow, motions are `scale` times as long and take sqrt(scale) times the time.

namespace souple::test_physics_overlaps {

constexpr double g = 9.81;
constexpr double scales[] = {1, 0.01, 100};

/// Separation of objects that overlap, in units of a scene of scale 1.
struct Separation {
  double time = -1;  // until nothing overlaps [s]
  double fall = 0;   // the largest g times height plus half the square of the speed of a vertex, over g [m]
  double depth = 0;  // of the deepest vertex below the floor, in the end [m]
};

/// Steps 2 s; `overlaps` tells whether objects still overlap.
template <class Overlaps>
Separation separate(World& world, double scale, const Overlaps& overlaps) {
  Separation result;
  for (int frame = 1; frame <= 120; ++frame) {
    EXPECT_TRUE(world.step(std::sqrt(scale) / 60).ok());
    if (overlaps()) result.time = -1;
    if (result.time < 0 && !overlaps()) result.time = frame / 60.0;
    result.depth = 0;
    for (const ObjectId id : world.objects()) {
      const auto x = world.positions(id), v = world.velocities(id);
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double height = static_cast<double>(x[i].y) + static_cast<double>(dot(v[i], v[i])) / (2 * g);
        result.fall = std::max(result.fall, height / scale);
        result.depth = std::max(result.depth, -static_cast<double>(x[i].y) / scale);
      }
    }
  }
  return result;
}

Settings gravity_of(double down) {
  return {.gravity = {0, static_cast<float>(-down), 0}};
}

// A cube of 0.3 m, which begins in another by a third.
Separation cubes(double scale, double gravity) {
  World world(gravity_of(gravity));
  const auto s = static_cast<float>(scale);
  if (gravity > 0) world.add_collider(Plane{});
  const SoftBodyMaterial jelly{.young_modulus = 1e5f * s, .thickness = 0.01f * s};
  for (const double x : {0.0, 0.2}) {
    world.add_soft_body(tet_bar(4, 4, 4, {0.3 * scale, 0.3 * scale, 0.3 * scale}), jelly,
                        {.transform = {.translation = Vec3d{x, 0.155 + 0.1 * x, 0.15 * x} * scale}});
  }
  return separate(world, scale, [&] { return test::crossings(world) > 0; });
}

// 27 grains of a radius of 5 cm, each in its neighbors by 2 cm.
Separation grains(double scale) {
  World world;
  world.add_collider(Plane{});
  std::vector<Vec3d> points(27);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t column = i % 3, row = i / 3 % 3, layer = i / 9;
    const Vec3d cell{static_cast<double>(column), static_cast<double>(layer), static_cast<double>(row)};
    points[i] = (Vec3d{0, 0.051, 0} + cell * 0.08 + Vec3d{0.001 * static_cast<double>(i), 0, 0}) * scale;
  }
  const ObjectId heap = world.add_grains(points, {.radius = static_cast<float>(0.05 * scale)});
  return separate(world, scale, [&] {
    const auto x = world.positions(heap);
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (static_cast<double>(length(x[i] - x[j])) < 0.095 * scale) return true;
    return false;
  });
}

// A sheet of 1 m that begins 30 cm below the ground.
Separation sheet(double scale) {
  World world;
  const auto s = static_cast<float>(scale);
  world.add_collider(Plane{});
  ObjectOptions at{.transform = {.translation = {0, -0.3 * scale, 0}}};
  const ClothMaterial cotton{
      .areal_density = 0.15f * s, .membrane_stiffness = 4000 * s * s, .thickness = 0.01f * s};
  const ObjectId cloth = world.add_cloth(grid(20, 20, s), cotton, at);
  return separate(world, scale, [&] {
    const auto x = world.positions(cloth);
    return std::any_of(x.begin(), x.end(), [&](const Vec3f& p) { return p.y < 0; });
  });
}

void expect_alike(const std::string& name, const std::string& what, const Separation& at,
                  const Separation& one) {
  validate(name, what + ": until they are apart [s]", at.time, one.time, std::max(0.1 * one.time, 1.01 / 60));
  validate_relative(name, what + ": highest vertex, with what its speed carries it [m]", at.fall, one.fall,
                    0.1);
  EXPECT_LT(at.depth, 0.02) << what;
}

template <class Scene>
void compare(const std::string& name, const Scene& scene) {
  Separation one;
  for (const double scale : scales) {
    const Separation at = scene(scale);
    if (scale == 1) {
      one = at;
      state(name, "until they are apart [s]", at.time);
      state(name, "highest vertex, with what its speed carries it [m]", at.fall);
      EXPECT_GT(at.time, 0);
      EXPECT_LT(at.time, 1);
    } else {
      expect_alike(name, detail::number(scale) + " times the size", at, one);
    }
  }
}

TEST(Overlaps, OfCubesLeaveAlikeAtEverySize) {
  compare("overlapping cubes of 0.3 m", [](double scale) { return cubes(scale, g); });
}

// Without gravity, as fast as if there were.
TEST(Overlaps, OfCubesWithoutGravityLeave) {
  const Separation with = cubes(1, g), without = cubes(1, 0);
  EXPECT_GT(without.time, 0);
  EXPECT_NEAR(without.time, with.time, 0.5 * with.time);
}

TEST(Overlaps, OfGrainsLeaveAlikeAtEverySize) {
  compare("overlapping grains of 5 cm", grains);
}

TEST(Overlaps, OfASheetAndTheGroundLeaveAlikeAtEverySize) {
  compare("sheet of 1 m below the ground", sheet);
}

// Three sheets at one place, turned in space.
TEST(Overlaps, SheetsAtOnePlaceSeparateInTheOrderOfTheirAddition) {
  World world;
  const Transform pose{.translation = {0.1, 1.3, 0.2},
                       .rotation = Quatd::from_axis_angle({0.6, 0.8, 0}, 0.7)};
  std::array<ObjectId, 3> sheets;
  for (ObjectId& sheet : sheets)
    sheet = world.add_cloth(grid(20, 20, 1), material::cotton, {.transform = pose});
  const Vec3f normal(pose.direction({0, 1, 0}));
  for (int frame = 1; frame <= 10; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    ASSERT_TRUE(report.ok()) << report.message;
    EXPECT_LT(report.largest_strain, 0.02) << "frame " << frame;
    EXPECT_EQ(test::crossings(world), 0u) << "frame " << frame;
  }
  double last = -1;
  for (const ObjectId sheet : sheets) {
    double height = 0;
    for (const Vec3f& x : world.positions(sheet)) height += static_cast<double>(dot(normal, x));
    height /= static_cast<double>(world.positions(sheet).size());
    if (last > -1) {
      EXPECT_GT(height, last + 0.5e-3);
    }
    last = height;
  }
}

}  // namespace souple::test_physics_overlaps
