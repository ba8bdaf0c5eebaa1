#include "souple/souple.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_cloth {

constexpr double d = 0.02, g = 9.81, half = 0.25;  // m, m/s^2, m: half the width of a cloth

std::vector<std::uint32_t> rim_of(std::uint32_t n) {
  std::vector<std::uint32_t> rim;
  for (std::uint32_t i = 0; i < n * n; ++i)
    if (i / n == 0 || i / n == n - 1 || i % n == 0 || i % n == n - 1) rim.push_back(i);
  return rim;
}

std::size_t below(const World& world, ObjectId fluid, float y) {
  const auto at = world.positions(fluid);
  return static_cast<std::size_t>(
      std::count_if(at.begin(), at.end(), [&](const Vec3f& x) { return x.y < y; }));
}

/// A canvas that sags between its edges, which hang on springs, with water in it.
struct Bag {
  static constexpr std::uint32_t n = 21;
  static constexpr float compliance = 1e-3f;  // of a spring [m/N]
  World world{{.substeps = 20}};
  ObjectId cloth, water;
  std::vector<std::uint32_t> rim = rim_of(n);

  static double bottom(double x, double z) {
    return -0.12 * (1 - x * x / (half * half)) * (1 - z * z / (half * half));
  }
  Bag() {
    TriangleMesh mesh = grid(n, n, 2 * float(half));
    for (Vec3d& x : mesh.positions) x.y = bottom(x.x, x.z);
    cloth = world.add_cloth(mesh, {.areal_density = 2, .membrane_stiffness = 5e4f, .thickness = 0.002f});
    world.attach(cloth, vertices(rim), {}, compliance);
    std::vector<Vec3d> points;
    for (const Vec3d& x : fill(Vec3d{-0.2, -0.12, -0.2}, Vec3d{0.2, 0, 0.2}, d))
      if (x.y > bottom(x.x, x.z) + 0.012 && x.y < -0.02) points.push_back(x);
    water = world.add_fluid(points, {.spacing = float(d)});
  }
  /// Force of the springs [N].
  double pull() const {
    double sum = 0;
    for (const std::uint32_t i : rim) sum -= double{world.positions(cloth)[i].y} / double{compliance};
    return sum;
  }
};

TEST(FluidCloth, ACanvasHoldsWaterAndItsEdgesCarryTheWeight) {
  Bag bag;
  const double weight = g * (bag.world.total_mass(bag.water) + bag.world.total_mass(bag.cloth));
  double pull = 0, error = 0;
  constexpr int frames = 60;
  for (int frame = -90; frame < frames; ++frame) {
    ASSERT_TRUE(bag.world.step(1.0 / 60).ok());
    if (frame < 0) continue;
    pull += bag.pull() / frames;
    error = std::max(error, bag.world.report().fluid.mean_density_error);
  }
  float lowest = 0;
  for (const Vec3f& x : bag.world.positions(bag.cloth)) lowest = std::min(lowest, x.y);
  EXPECT_EQ(below(bag.world, bag.water, lowest), 0u);
  EXPECT_NEAR(pull / weight, 1, 0.02);
  EXPECT_LT(error, 0.01);
}

/// A grid of n x n vertices that keeps only every `pitch`th row and column of cells.
TriangleMesh net(std::uint32_t n, std::uint32_t pitch) {
  const TriangleMesh mesh = grid(static_cast<int>(n), static_cast<int>(n), 2 * float(half));
  constexpr std::uint32_t none = ~0u;
  std::vector<std::uint32_t> vertex(mesh.positions.size(), none);
  TriangleMesh result;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t corner = *std::min_element(t.begin(), t.end());
    if (corner / n % pitch != 0 && corner % n % pitch != 0) continue;
    Triangle& kept = result.triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      if (vertex[t[c]] == none) {
        vertex[t[c]] = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(mesh.positions[t[c]]);
      }
      kept[c] = vertex[t[c]];
    }
  }
  return result;
}

/// Water falls between walls on a sheet that is pinned at its edges. Returns the fraction of it below the
/// sheet a second later [-].
double passed(const TriangleMesh& sheet) {
  World world({.substeps = 20});
  for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
    world.add_collider(Plane{n, -0.17f});
  const ObjectId cloth =
      world.add_cloth(sheet, {.areal_density = 2, .membrane_stiffness = 5e4f, .thickness = 0.002f});
  const auto edge = static_cast<float>(half - 0.005);
  for (const auto& [lo, hi] : {std::array{Vec3f{-1, -1, -1}, Vec3f{1, 1, -edge}},
                               {Vec3f{-1, -1, edge}, {1, 1, 1}},
                               {Vec3f{-1, -1, -1}, {-edge, 1, 1}},
                               {Vec3f{edge, -1, -1}, {1, 1, 1}}})
    world.pin(cloth, in_box(lo, hi));
  const ObjectId water =
      world.add_fluid(fill(Vec3d{-0.16, 0.02, -0.16}, Vec3d{0.16, 0.12, 0.16}, d), {.spacing = float(d)});
  for (int frame = 0; frame < 60; ++frame) EXPECT_TRUE(world.step(1.0 / 60).ok());
  float lowest = 0;
  for (const Vec3f& x : world.positions(cloth)) lowest = std::min(lowest, x.y);
  return double(below(world, water, lowest)) / double(world.positions(water).size());
}

TEST(FluidCloth, ANetLetsWaterThroughThatASheetHolds) {
  EXPECT_EQ(passed(grid(26, 26, 2 * float(half))), 0);
  EXPECT_GT(passed(net(26, 6)), 0.95);  // holes of five spacings
}

}  // namespace souple::test_physics_fluid_cloth
