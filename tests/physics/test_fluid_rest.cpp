#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_rest {

constexpr double g = 9.81, density = 1000, d = 0.02;

/// A column of water between four walls, on a floor.
struct Column {
  double d, width, height;
  World world;
  ObjectId water;
  ColliderId floor;

  Column(double spacing, int across, int layers, int substeps, const FluidSettings& settings = {})
      : d(spacing), width(across * d), height(layers * d), world({.substeps = substeps, .fluid = settings}) {
    const double w = 0.5 * width;
    water = world.add_fluid(fill(Vec3d{-w, 0, -w}, Vec3d{w, height, w}, d),
                            {.spacing = static_cast<float>(d), .density = static_cast<float>(density)});
    floor = world.add_collider(Plane{});
    const auto offset = static_cast<float>(-w);
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, offset});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  }
  /// Mean pressure of the particles whose center lies within d/2 of a height, over the hydrostatic pressure
  /// [-].
  double pressure_at(double y) const {
    const std::vector<float> pressures = world.pressures(water);
    double sum = 0, expected = 0;
    for (std::size_t i = 0; i < pressures.size(); ++i) {
      const double at = double{world.positions(water)[i].y};
      if (std::fabs(at - y) > d / 2) continue;
      sum += double{pressures[i]};
      expected += density * g * (height - at);
    }
    return sum / expected;
  }
  /// Height of the centers of the topmost layer, plus half a spacing [m].
  double top() const {
    std::vector<float> y;
    for (const Vec3f& x : world.positions(water)) y.push_back(x.y);
    std::sort(y.begin(), y.end());
    const auto layer = static_cast<std::size_t>(std::lround(width / d * width / d));
    return double{y[y.size() - layer / 2]} + d / 2;
  }
};

// The floor supports the weight; the pressure at the bottom is rho g H, at half the height half of it.
/// `calm`: limit of the speed after three and a half seconds [m/s].
void expect_rest(int substeps, double calm, const FluidSettings& settings) {
  Column column(0.02, 10, 50, substeps, settings);
  column.run(3);
  const double early = column.world.kinetic_energy(column.water);
  double floor = 0, bottom = 0, middle = 0, error = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    column.run(1.0 / 60);
    floor += column.world.fluid_force(column.floor).y / frames;
    bottom += column.pressure_at(column.d / 2) / frames;
    middle += column.pressure_at(column.height / 2) / frames;
    error = std::max(error, column.world.report().fluid.mean_density_error);
  }
  const double weight = column.world.total_mass(column.water) * g;
  EXPECT_NEAR(-floor / weight, 1, 0.02);
  EXPECT_NEAR(bottom, 1, 0.02);
  EXPECT_NEAR(middle, 1, 0.02);
  EXPECT_NEAR(column.top() / column.height, 1, 0.02);
  EXPECT_LT(error, 0.01);
  const double late = column.world.kinetic_energy(column.water);
  EXPECT_LT(late, 1.2 * early);
  EXPECT_LT(std::sqrt(2 * late / column.world.total_mass(column.water)), calm);
  EXPECT_FALSE(column.world.report().has(Flag::coarse_substeps));
}

TEST(FluidColumn, RestsUnderItsOwnWeight) {
  expect_rest(8, 0.003, {});
}

TEST(FluidColumn, RestsWithTheWideKernelToo) {
  expect_rest(9, 0.005, {.kernel = SmoothingShape::wide_wendland});
}

struct Case {
  double spacing;  // m
  int layers, substeps;
};

class FluidColumnOf : public ::testing::TestWithParam<Case> {};

// Three spacings, three depths; substeps by the rule of docs/fluids.md.
TEST_P(FluidColumnOf, RestsUnderItsOwnWeightSlow) {
  const Case& param = GetParam();
  Column column(param.spacing, 10, param.layers, param.substeps);
  column.run(1);
  const double early = column.world.kinetic_energy(column.water);
  column.run(2.5);
  double floor = 0, bottom = 0, height = 0, error = 0, late = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    column.run(1.0 / 60);
    floor -= column.world.fluid_force(column.floor).y / frames;
    bottom += column.pressure_at(column.d / 2) / frames;
    height += column.top() / column.height / frames;
    error = std::max(error, column.world.report().fluid.mean_density_error);
    late += column.world.kinetic_energy(column.water) / frames;
  }
  const double mass = column.world.total_mass(column.water);
  const std::string name = "water column at rest, spacing " + detail::number(1000 * param.spacing) + " mm";
  const std::string layers = std::to_string(param.layers) + " layers: ";
  validate_relative(name, layers + "force on the floor / weight", floor / (mass * g), 1, 0.02);
  validate_relative(name, layers + "pressure at the bottom / rho g H", bottom, 1, 0.02);
  validate_relative(name, layers + "height / H", height, 1, 0.02);
  validate_below(name, layers + "mean density error", error, 0.01);
  validate_below(name, layers + "speed after 4 s, rms [m/s]", std::sqrt(2 * late / mass), 0.005);
  EXPECT_LT(late, 0.5 * early);
}

INSTANTIATE_TEST_SUITE_P(Columns, FluidColumnOf,
                         ::testing::Values(Case{0.02, 25, 6}, Case{0.02, 50, 8}, Case{0.02, 75, 10},
                                           Case{0.01, 25, 8}, Case{0.01, 50, 12}, Case{0.01, 75, 14},
                                           Case{0.005, 25, 12}, Case{0.005, 50, 16}, Case{0.005, 75, 20}));

// A compressible fluid is denser at its bottom, independent of substeps and iterations. Its energy V C^2 / (2
// kappa) per particle gives kappa p = C (1 + C)^2; the reported pressure is C / kappa. With p linear in the
// mass above, P = rho_0 g H,
//   mean C = (c^2 / 2 + 4 c^3 / 3 + 3 c^4 / 4) / kappa P,   lower by (c^2 / 2 + c^3) / kappa P of its height
// where c is C at the bottom. It oscillates with a period of 4 H sqrt(kappa rho): means are over two periods.
TEST(FluidColumn, GivesWayAsItsCompressibilitySays) {
  constexpr double kappa = 2e-5, pressure = density * g * 25 * d, x = kappa * pressure;
  double c = x;
  for (int i = 0; i < 50; ++i) c = x / ((1 + c) * (1 + c));
  const double mean = (c * c / 2 + 4 * c * c * c / 3 + 3 * c * c * c * c / 4) / x,
               lower = (c * c / 2 + c * c * c) / x;
  std::vector<double> fallen;
  for (const auto& [substeps, iterations] :
       {std::pair(6, 1), std::pair(12, 1), std::pair(8, 4), std::pair(8, 0)}) {
    Column column(d, 8, 25, substeps,
                  {.iterations = iterations, .compressibility = static_cast<float>(kappa)});
    column.run(2);
    double top = 0, error = 0, bottom = 0;
    constexpr int frames = 34;
    for (int frame = 0; frame < frames; ++frame) {
      column.run(1.0 / 60);
      top += column.top() / frames;
      error += column.world.report().fluid.mean_density_error / frames;
      bottom += column.pressure_at(d / 2) / frames;
    }
    fallen.push_back(1 - top / column.height);
    EXPECT_NEAR(error / mean, 1, 0.05) << substeps << " substeps, " << iterations;
    EXPECT_NEAR(bottom * (1 + c) * (1 + c), 1, 0.05) << substeps << " substeps, " << iterations;
    // 0.003 is its drop without compressibility; the packing's sums underestimate the compression.
    EXPECT_NEAR((fallen.back() - 0.003) / lower, 1.1, 0.1) << substeps << " substeps, " << iterations;
    EXPECT_NEAR(fallen.back() / fallen[0], 1, 0.03) << substeps << " substeps, " << iterations;
  }
}

constexpr int across = 12, layers = 20;

/// Ten layers of a lighter fluid under ten of water, in disorder, with a wavy interface. Returns the height
/// of its center after some seconds over the total height: a quarter at the start, three quarters at
/// equilibrium.
double risen(float lighter, SmoothingShape kernel, double seconds) {
  World world({.substeps = 8, .fluid = {.kernel = kernel}});
  constexpr double w = 0.5 * across * d, height = layers * d;
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> shift(-0.25 * d, 0.25 * d);
  std::vector<Vec3d> light, heavy;
  for (const Vec3d& x : fill(Vec3d{-w, 0, -w}, Vec3d{w, height, w}, d)) {
    const double border = height / 2 + 2 * d * std::cos(pi * x.x / w);
    const double dx = shift(generator), dy = shift(generator), dz = shift(generator);
    (x.y < border ? light : heavy).push_back(x + Vec3d{dx, dy, dz});
  }
  const ObjectId below = world.add_fluid(light, {.spacing = float(d), .density = lighter});
  world.add_fluid(heavy, {.spacing = float(d), .density = 1000});
  world.add_collider(Plane{});
  for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
    world.add_collider(Plane{n, static_cast<float>(-w)});
  for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  return world.center_of_mass(below).y / height;
}

// The lighter fluid rises. Particles under pressure resist rearrangement, less so with more neighbors.
TEST(FluidLayers, ALighterFluidRisesInTheWideKernel) {
  const double wide = risen(850, SmoothingShape::wide_wendland, 3);
  EXPECT_GT(wide, 0.34);
  const double usual = risen(850, SmoothingShape::wendland, 3);
  EXPECT_GT(usual, 0.25);
  EXPECT_GT(wide, usual + 0.05);
  state("ten layers of 850 kg/m^3 under ten of 1000, after 3 s",
        "center of the lighter fluid, in heights, wide_wendland", wide);
  state("ten layers of 850 kg/m^3 under ten of 1000, after 3 s",
        "center of the lighter fluid, in heights, wendland", usual);
}

constexpr double half = 6 * d, depth = 10 * d, rim = 16 * d;

/// A mesh of polygons that share vertices.
class Polygons {
 public:
  void add(const std::vector<Vec3d>& corners) {
    std::vector<std::uint32_t> at;
    at.reserve(corners.size());
    for (const Vec3d& corner : corners) at.push_back(vertex(corner));
    for (std::size_t k = 1; k + 1 < at.size(); ++k) mesh_.triangles.push_back({at[0], at[k], at[k + 1]});
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  std::uint32_t vertex(const Vec3d& p) {
    std::vector<Vec3d>& known = mesh_.positions;
    for (std::size_t i = 0; i < known.size(); ++i)
      if (length(known[i] - p) < 1e-9) return static_cast<std::uint32_t>(i);
    known.push_back(p);
    return static_cast<std::uint32_t>(known.size() - 1);
  }
  TriangleMesh mesh_;
};

const Vec3d up{0, rim, 0};

/// An open vessel over a convex or L-shaped floor.
TriangleMesh prism(const std::vector<Vec3d>& floor) {
  Polygons vessel;
  vessel.add(floor);
  for (std::size_t k = 0; k < floor.size(); ++k) {
    const Vec3d &a = floor[k], &b = floor[(k + 1) % floor.size()];
    vessel.add({a, b, b + up, a + up});
  }
  return vessel.mesh();
}

std::vector<Vec3d> square(double a) {
  return {{-a, 0, -a}, {a, 0, -a}, {a, 0, a}, {-a, 0, a}};
}

std::vector<Vec3d> regular_polygon(int corners, double radius) {
  std::vector<Vec3d> result;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * pi * (k + 0.5) / corners;
    result.push_back({radius * std::cos(angle), 0, radius * std::sin(angle)});
  }
  return result;
}

/// A tank with walls of two spacings, closed around them.
TriangleMesh thick_tank() {
  Polygons tank;
  const Vec3d below{0, -2 * d, 0};
  const std::vector<Vec3d> in = square(half), out = square(half + 2 * d);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    tank.add({in[k], in[next], in[next] + up, in[k] + up});
    tank.add({out[next] + below, out[k] + below, out[k] + up, out[next] + up});
    tank.add({in[k] + up, in[next] + up, out[next] + up, out[k] + up});
  }
  tank.add({in[3], in[2], in[1], in[0]});
  tank.add({out[0] + below, out[1] + below, out[2] + below, out[3] + below});
  return tank.mesh();
}

/// Divides each triangle into three at a point that differs from triangle to triangle, `rounds` times.
TriangleMesh split_unevenly(TriangleMesh mesh, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<Triangle> divided;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      const auto [a, b, c] = mesh.triangles[k];
      const double p = 0.15 + 0.6 * std::fmod(0.618 * static_cast<double>(k), 1), q = 0.4 * (1 - p);
      const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(mesh.positions[a] * p + mesh.positions[b] * q +
                               mesh.positions[c] * (1 - p - q));
      for (const Triangle& t : {Triangle{a, b, middle}, Triangle{b, c, middle}, Triangle{c, a, middle}})
        divided.push_back(t);
    }
    mesh.triangles = divided;
  }
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, double angle, double height) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec3d& x : mesh.positions) x = {c * x.x + s * x.z, x.y + height, c * x.z - s * x.x};
  return mesh;
}

/// Lattice points of a vessel's lower part.
std::vector<Vec3d> water_where(const std::function<bool(const Vec3d&)>& inside, double angle = 0) {
  TriangleMesh points;
  for (const Vec3d& x : fill(Vec3d{-half * 2, 0, -half * 2}, Vec3d{half * 2, depth, half * 2}, d))
    if (inside(x)) points.positions.push_back(x);
  return moved(points, angle, 0).positions;
}

bool in_box(const Vec3d& x) {
  return std::max(std::fabs(x.x), std::fabs(x.z)) < half;
}

bool in_polygon(const Vec3d& x, int corners, double radius) {
  double out = -radius;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * pi * (k + 1) / corners;
    out = std::max(out, x.x * std::cos(angle) + x.z * std::sin(angle) - radius * std::cos(pi / corners));
  }
  return out < -0.45 * d;
}

struct Rest {
  double speed = 0;  // rms of the fourth second [m/s]
  double density_error = 0, lowest = 1e30;
};

using Build = std::function<void(World&)>;

Rest rest_in(const Build& build, const std::vector<Vec3d>& water) {
  World world({.substeps = 6});
  build(world);
  const ObjectId fluid = world.add_fluid(water, {.spacing = static_cast<float>(d), .density = 1000});
  Rest rest;
  double energy = 0;
  for (int frame = 0; frame < 240; ++frame) {
    world.step(1.0 / 60);
    if (frame < 180) continue;
    energy += world.kinetic_energy(fluid) / 60;
    rest.density_error = std::max(rest.density_error, world.report().fluid.mean_density_error);
  }
  rest.speed = std::sqrt(2 * energy / world.total_mass(fluid));
  for (const Vec3f& x : world.positions(fluid)) rest.lowest = std::min(rest.lowest, double{x.y});
  return rest;
}

Build obstacle(const TriangleMesh& mesh) {
  return [mesh](World& world) { world.add_obstacle(mesh); };
}

/// Planes around a regular polygon, and a floor.
Build planes(int corners, double radius) {
  return [=](World& world) {
    world.add_collider(Plane{});
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * pi * (k + 1) / corners;
      world.add_collider(Plane{Vec3f(Vec3d{-std::cos(angle), 0, -std::sin(angle)}),
                               static_cast<float>(-radius * std::cos(pi / corners))});
    }
  };
}

void expect_as_calm(const std::string& name, const Rest& rest, const Rest& between_planes) {
  validate_below("water at rest in a mesh", name + ": rms speed after 3 to 4 s over that between planes",
                 rest.speed / between_planes.speed, 2);
  EXPECT_LT(rest.density_error, 0.005) << name;
  EXPECT_GT(rest.lowest, 0.25 * d) << name;  // nothing gets through the floor
}

Rest at_rest_between_planes(const std::vector<Vec3d>& water) {
  const Rest reference = rest_in(planes(4, half * std::sqrt(2)), water);
  EXPECT_LT(reference.speed, 0.004);
  return reference;
}

// Each of these vessels is one mesh. Where faces meet in a concave edge, each of them is a wall.
TEST(FluidVessels, AMeshIsAsCalmAsPlanes) {
  const std::vector<Vec3d> water = water_where(in_box);
  const Rest reference = at_rest_between_planes(water);
  expect_as_calm("box of 10 triangles", rest_in(obstacle(prism(square(half))), water), reference);
  expect_as_calm("L",
                 rest_in(obstacle(prism({{-half, 0, -half},
                                         {half, 0, -half},
                                         {half, 0, 0},
                                         {0, 0, 0},
                                         {0, 0, half},
                                         {-half, 0, half}})),
                         water_where([](const Vec3d& x) { return in_box(x) && (x.x < 0 || x.z < 0); })),
                 reference);
}

TEST(FluidVessels, BoxesOfOtherMeshesAreAsCalmAsPlanesSlow) {
  const std::vector<Vec3d> water = water_where(in_box);
  const Rest reference = at_rest_between_planes(water);
  const TriangleMesh open = prism(square(half));
  const TriangleMesh closed = moved(box({2 * half, rim, 2 * half}), 0, rim / 2);
  expect_as_calm("box of 810 uneven triangles", rest_in(obstacle(split_unevenly(open, 4)), water), reference);
  expect_as_calm("closed box, from within", rest_in(obstacle(closed), water), reference);
  expect_as_calm("thick tank", rest_in(obstacle(thick_tank()), water), reference);
  expect_as_calm("box turned by 0.5 rad",
                 rest_in(obstacle(moved(split_unevenly(open, 1), 0.5, 0)), water_where(in_box, 0.5)),
                 reference);
}

// Folds of 135, 169 and more degrees, narrower and wider than a spacing.
TEST(FluidVessels, ARoundMeshIsAsCalmAsPlanesSlow) {
  constexpr double radius = 7 * d, bowl = 10 * d;
  const std::vector<Vec3d> water = water_where([](const Vec3d& x) { return in_polygon(x, 8, radius); });
  const Rest reference = rest_in(planes(8, radius), water);
  EXPECT_LT(reference.speed, 0.006);
  const TriangleMesh octagon = prism(regular_polygon(8, radius));
  expect_as_calm("octagon of 378 uneven triangles", rest_in(obstacle(split_unevenly(octagon, 3)), water),
                 reference);
  expect_as_calm("cylinder of 32 sides",
                 rest_in(obstacle(prism(regular_polygon(32, radius))),
                         water_where([](const Vec3d& x) { return in_polygon(x, 32, radius); })),
                 reference);
  const auto in_bowl = [](const Vec3d& x) { return length(x - Vec3d{0, bowl, 0}) < bowl - d; };
  expect_as_calm("bowl", rest_in(obstacle(moved(sphere(3, bowl), 0, bowl)), water_where(in_bowl)), reference);
}

}  // namespace souple::test_physics_fluid_rest
