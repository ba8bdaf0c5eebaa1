#include "souple/scene/scene.h"
#include "souple/souple.h"
#include "tests/paths.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_bodies {

constexpr double water_density = 1000;

/// A basin of water with a box in it.
struct Basin {
  double d, side, depth, edge;
  World world;
  ObjectId water, body;

  Basin(double spacing, int across, int layers, int substeps, const FluidSettings& settings = {})
      : d(spacing),
        side(across * d),
        depth(layers * d),
        edge(0),
        world({.substeps = substeps, .fluid = settings}) {
    const double w = 0.5 * side;
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-w)});
  }
  /// Adds a cube of so many spacings with its lowest point at `bottom`, and the water, with a hole for the
  /// cube.
  void put(int spacings, double density, double bottom, SoftBodyModel model) {
    edge = spacings * d;
    const auto half = 0.5 * edge;
    std::vector<Vec3d> points;
    for (const Vec3d& x : fill(Vec3d{-side / 2, 0, -side / 2}, Vec3d{side / 2, depth, side / 2}, d))
      if (std::fabs(x.x) > half || std::fabs(x.z) > half || x.y < bottom || x.y > bottom + edge)
        points.push_back(x);
    water = world.add_fluid(points, {.spacing = static_cast<float>(d), .density = float(water_density)});
    SoftBodyMaterial material{.young_modulus = model == SoftBodyModel::shape_matching ? 1e10f : 1e6f,
                              .poisson_ratio = 0.3f,
                              .density = static_cast<float>(density),
                              .thickness = 0,
                              .model = model};
    body =
        world.add_soft_body(box(Vec3d{edge, edge, edge}, {8, 8, 8}), material, LatticeOptions{.cells = 3000},
                            {.transform = {.translation = {0, bottom + half, 0}}});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) world.step(1.0 / 60);
  }
  double lowest() const {
    double y = 1e30;
    for (const Vec3f& x : world.positions(body)) y = std::min(y, double{x.y});
    return y;
  }
  /// Water level far from the body.
  double level() const {
    // The volumes of the water and of the submerged part fill the basin up to here.
    const double water_volume = double(world.positions(water).size()) * d * d * d;
    const double y = lowest();
    return (water_volume - edge * edge * y) / (side * side - edge * edge);
  }
};

/// Released slightly above its equilibrium: submerged depth at rest over its height [-].
double sunk(double density, SoftBodyModel model, int across = 36, int layers = 26,
            const FluidSettings& settings = {}) {
  Basin basin(0.02, across, layers, 8, settings);
  basin.put(20, density, basin.depth - density / water_density * 20 * basin.d + 0.01, model);
  basin.run(2.5);
  double sum = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    sum += (basin.level() - basin.lowest()) / frames;
  }
  EXPECT_LT(basin.world.report().fluid.mean_density_error, 0.01);
  return sum / basin.edge;
}

TEST(FluidBuoyancy, AStiffCubeFloatsAsDeepAsItsDensitySlow) {
  EXPECT_NEAR(sunk(600, SoftBodyModel::shape_matching), 0.6, 0.03);
}

TEST(FluidBuoyancy, LightAndSoftCubesAtTheirDepthSlow) {
  EXPECT_NEAR(sunk(300, SoftBodyModel::shape_matching), 0.3, 0.03);
  EXPECT_NEAR(sunk(600, SoftBodyModel::neo_hookean), 0.6, 0.03);
}

TEST(FluidBuoyancy, ALightSoftCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(300, SoftBodyModel::neo_hookean), 0.3, 0.03);
}

// Water behaves as a fluid in channels wide enough to avoid an ordered packing. In a basin of 36 spacings this cube
// floats 5 % of its height too high.
TEST(FluidBuoyancy, AHeavyCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::shape_matching, 46, 32), 0.9, 0.03);
}

// With more neighbors the same channel shows less order.
TEST(FluidBuoyancy, AHeavyCubeInANarrowBasinSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::shape_matching, 36, 26, {.kernel = SmoothingShape::wide_wendland}),
              0.9, 0.015);
}

TEST(FluidBuoyancy, AHeavySoftCubeFloatsAtItsDepthSlow) {
  EXPECT_NEAR(sunk(900, SoftBodyModel::neo_hookean, 46, 32), 0.9, 0.03);
}

// Two layers of water stay below it: its remaining weight does not displace them.
TEST(FluidBuoyancy, WhatIsHeavierThanWaterSinksSlow) {
  Basin basin(0.02, 46, 32, 8);
  basin.put(20, 1200, 0.2, SoftBodyModel::shape_matching);
  basin.run(2);
  EXPECT_LT(basin.lowest(), 3 * basin.d);
}

// It has ten seconds to rise or sink. Water that is only nearly at rest pushes it slightly.
TEST(FluidBuoyancy, WhatIsAsDenseAsWaterHoversSlow) {
  Basin basin(0.02, 40, 36, 8);
  const double bottom = (basin.depth - 20 * basin.d) / 2;
  basin.put(20, water_density, bottom, SoftBodyModel::shape_matching);
  double farthest = 0;
  for (int frame = 0; frame < 600; ++frame) {
    basin.run(1.0 / 60);
    const double low = basin.lowest(), high = low + basin.edge;
    ASSERT_GT(low, basin.d) << frame;
    ASSERT_LT(high, basin.depth - basin.d) << frame;
    farthest = std::max(farthest, std::fabs(low - bottom));
  }
  state("cube of the density of water, 20 spacings wide, left at mid-depth",
        "farthest drift in 10 s [spacings]", farthest / basin.d);
}

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

// A film with strong friction at bodies: nu = 0.01 m^2/s.
constexpr FluidMaterial syrup{.spacing = 0.02f, .density = 1000, .viscosity = 10, .xsph = 0};

/// A block of fluid on a sheet of cloth, without gravity or walls.
struct Layers {
  World world{{.substeps = 8, .gravity = {}}};
  ObjectId fluid, cloth;

  explicit Layers(const FluidMaterial& material, float areal_density = 0.2f, float size = 0.6f) {
    constexpr float half_thickness = 0.0005f;
    fluid = world.add_fluid(
        fill(Vec3d{-0.2, half_thickness, -0.2}, Vec3d{0.2, 0.16 + half_thickness, 0.2}, d), material);
    cloth = world.add_cloth(grid(31, 31, size),
                            {.areal_density = areal_density, .thickness = 2 * half_thickness});
  }
  Vec3d mean_velocity(ObjectId object) const { return world.momentum(object) / world.total_mass(object); }
  Vec3d momentum() const { return world.momentum(fluid) + world.momentum(cloth); }
  void set_velocity(ObjectId object, const Vec3f& velocity) {
    world.set_velocities(object, std::vector<Vec3f>(world.positions(object).size(), velocity));
  }
};

// A sheet that is pulled through a fluid moves it and is slowed by it; together they conserve momentum.
TEST(FluidFriction, ASheetAndWhatFlowsAlongItComeToOneSpeed) {
  Layers layers(syrup);
  layers.set_velocity(layers.fluid, {1, 0, 0.5f});
  const Vec3d before = layers.momentum();
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_TRUE(layers.world.step(1.0 / 60).ok());
    ASSERT_LT(length(layers.momentum() - before), 1e-5 * length(before)) << frame;
  }
  const Vec3d fluid = layers.mean_velocity(layers.fluid), cloth = layers.mean_velocity(layers.cloth);
  EXPECT_GT(fluid.x, 0.9);
  EXPECT_NEAR(cloth.x / fluid.x, 1, 0.02);
  EXPECT_NEAR(cloth.z / fluid.z, 1, 0.02);
}

// The layer at d/2 from the sheet feels mu v / (d/2), before larger motion.
TEST(FluidFriction, ASheetFeelsTheShearOfTheLayersNextToIt) {
  Layers layers(syrup, 200);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  constexpr double h = 5e-4;
  Settings settings = layers.world.settings();
  settings.substeps = 1;
  layers.world.set_settings(settings);
  layers.world.step(h);
  const double stress = 10 * 1.0 / (d / 2), area = 0.4 * 0.4;
  EXPECT_NEAR(layers.world.momentum(layers.cloth).x / (stress * area * h), 1, 0.05);
}

TEST(FluidFriction, AFluidThatSlipsLeavesASheetAlone) {
  FluidMaterial slips = syrup;
  slips.friction = 0;
  Layers layers(slips);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  layers.world.step(1.0 / 60);
  EXPECT_LT(std::fabs(layers.mean_velocity(layers.cloth).x), 1e-3);
}

// Ten times the viscosity limit of an explicit step, and a sheet of a hundredth of its layer's mass.
TEST(FluidFriction, ALightSheetInStiffHoneyStaysCalm) {
  FluidMaterial stiff = syrup;
  stiff.viscosity = 1000;
  Layers layers(stiff, 0.02f, 0.4f);
  layers.set_velocity(layers.fluid, {1, 0, 0});
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(layers.world.step(1.0 / 60).ok());
    for (const Vec3f& v : layers.world.velocities(layers.cloth)) ASSERT_LT(length(v), 1.5f) << frame;
  }
  EXPECT_NEAR(layers.mean_velocity(layers.cloth).x, 1, 0.02);
}

// A film on an obstacle that is pulled away moves with it.
TEST(FluidFriction, AnObstacleTakesTheFluidOnItAlong) {
  World world({.substeps = 8});
  world.add_obstacle(grid(2, 2, 4.0f), {.thickness = 0.002f},
                     ObstacleMotion{.pose = ColliderMotion::callback([](double t) {
                                      return Transform{.translation = {0.2 * t, 0, 0}};
                                    })});
  const ObjectId fluid = world.add_fluid(fill(Vec3d{-0.1, 0.001, -0.1}, Vec3d{0.1, 0.041, 0.1}, d), syrup);
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_NEAR(world.momentum(fluid).x / world.total_mass(fluid), 0.2, 0.01);
}

// Adhesion: both pull at each other, without external forces.
TEST(FluidFriction, ADropClingsToASheetAndMomentumStays) {
  World world({.substeps = 8, .gravity = {}, .wind = {.air_density = 0}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-0.1, 0.001, -0.1}, Vec3d{0.1, 0.1, 0.1}, d)) points.push_back(x);
  const ObjectId fluid =
      world.add_fluid(points, {.spacing = 0.02f, .density = 1000, .surface_tension = 1, .contact_angle = 40});
  const ObjectId cloth = world.add_cloth(grid(21, 21, 0.4f), {.areal_density = 1, .thickness = 0.001f});
  world.set_velocities(fluid, std::vector<Vec3f>(points.size(), Vec3f{0, 0.05f, 0}));
  const double mass = world.total_mass(fluid);
  const Vec3d before = world.momentum(fluid) + world.momentum(cloth);
  for (int frame = 0; frame < 120; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  const Vec3d after = world.momentum(fluid) + world.momentum(cloth);
  EXPECT_LT(length(after - before), 1e-5 * mass);
  EXPECT_GT(world.momentum(cloth).y / world.total_mass(cloth), 0.02);
}

/// Winding number of a surface around a point: 1 inside, 0 outside; hair-thin seams change little. Computed from the
/// solid angles of its triangles (Van Oosterom and Strackee 1983).
double winding(const World& world, ObjectId surface, const Vec3f& point) {
  const auto x = world.positions(surface);
  double sum = 0;
  for (const Triangle& t : world.triangles(surface)) {
    const Vec3d a(x[t[0]] - point), b(x[t[1]] - point), c(x[t[2]] - point);
    const double la = length(a), lb = length(b), lc = length(c);
    sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(a, c) * lb);
  }
  return sum / 6.283185307179586;
}

std::size_t outside(const World& world, ObjectId water, ObjectId balloon) {
  std::size_t count = 0;
  for (const Vec3f& point : world.positions(water))
    if (!(std::fabs(winding(world, balloon, point)) > 0.5)) ++count;
  return count;
}

// The shipped scene: the seams hold all water for 0.8 s, and none of it half a second later.
TEST(FluidBalloon, HoldsWaterUntilItsSeamsOpenSlow) {
  const std::filesystem::path file = source_path("scenes/water_balloon.json");
  World world = build_world(load_scene(file));
  const ObjectId water = world.find_object("water"), balloon = world.find_object("balloon");
  const std::size_t particles = world.positions(water).size();
  for (int frame = 1; frame <= 48; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    if (frame % 12 != 0) continue;
    EXPECT_EQ(outside(world, water, balloon), 0u) << "frame " << frame;
  }
  for (int frame = 49; frame <= 78; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_GT(outside(world, water, balloon), particles * 9 / 10);
}

constexpr double depth = 0.3;  // m

/// A basin of water.
struct GrainBasin {
  World world{{.substeps = 8}};
  ObjectId water;

  explicit GrainBasin(const Vec3d& size = {0.3, depth, 0.16}) {
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}})
      world.add_collider(Plane{n, static_cast<float>(-size.x / 2)});
    for (const Vec3f& n : {Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-size.z / 2)});
    water =
        world.add_fluid(fill(Vec3d{-size.x / 2, 0, -size.z / 2}, Vec3d{size.x / 2, size.y, size.z / 2}, d),
                        {.spacing = float(d), .density = 1000});
  }
  ObjectId add_grain(double radius, double density, const Vec3d& at) {
    return world.add_grains(std::array{at}, {.radius = float(radius), .density = float(density)});
  }
  /// A rope of a quarter of a meter, along x.
  ObjectId add_rope(double density, double y, double z) {
    return world.add_rope(std::array{Vec3d{-0.12, y, z}, Vec3d{0.12, y, z}}, 12,
                          {.radius = 0.006f, .density = float(density)});
  }
  void run(double seconds) {
    for (int frame = 0; frame < seconds * 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  }
  double height(ObjectId object) const { return world.center_of_mass(object).y; }
};

// Grains far smaller than a particle's spacing, and about as large.
TEST(FluidGrains, HeavyOnesSinkLightOnesFloatEvenOnesStay) {
  struct Trial {
    double radius;
    ObjectId heavy, even, light;
  };
  GrainBasin basin;
  std::vector<Trial> trials;
  for (const double radius : {0.003, 0.015}) {
    const double z = radius > 0.01 ? 0.03 : -0.03;
    trials.push_back({radius, basin.add_grain(radius, 2500, {-0.1, 0.2, z}),
                      basin.add_grain(radius, 1000, {0, 0.15, z}),
                      basin.add_grain(radius, 500, {0.1, 0.1, z})});
  }
  basin.run(2);
  for (const Trial& trial : trials) {
    EXPECT_NEAR(basin.height(trial.heavy), trial.radius, 0.1 * d);
    EXPECT_NEAR(basin.height(trial.even), 0.15, d);
    EXPECT_NEAR(basin.height(trial.light), depth, d / 2);
  }
}

// Five spacings in diameter: half of it should be submerged.
TEST(FluidGrains, ALargeBallFloatsAboutAsDeepAsItsDensity) {
  GrainBasin basin({0.3, 0.2, 0.3});
  constexpr double radius = 0.05;
  const ObjectId ball = basin.add_grain(radius, 500, {0, 0.19, 0});
  basin.run(2);
  // It still bobs by a centimeter, and rolls along the walls that it touches: the mean counts.
  constexpr int frames = 90;
  double mean = 0;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    mean += basin.height(ball) / frames;
  }
  EXPECT_NEAR(mean, 0.2, 0.4 * radius);
}

TEST(FluidGrains, RopesSinkAndFloat) {
  GrainBasin basin;
  const ObjectId light = basin.add_rope(500, 0.1, -0.04), heavy = basin.add_rope(2000, 0.2, 0.04);
  basin.run(2);
  EXPECT_NEAR(basin.height(light), depth, d / 2);
  EXPECT_LT(basin.height(heavy), 0.006 + d / 2);
}

// The weight of a grain on a spring in water is reduced by that of the displaced water.
TEST(FluidGrains, AGrainInWaterWeighsLess) {
  GrainBasin basin({0.2, 0.2, 0.16});
  constexpr double radius = 0.008, density = 3000, compliance = 0.01;
  const ObjectId grain = basin.add_grain(radius, density, {0, 0.1, 0});
  basin.world.attach(grain, vertices({0}), {}, float(compliance));
  basin.run(1);
  double pull = 0;
  constexpr int frames = 30;
  for (int frame = 0; frame < frames; ++frame) {
    basin.run(1.0 / 60);
    pull += (0.1 - basin.height(grain)) / compliance / frames;
  }
  const double weight = 9.81 * basin.world.total_mass(grain);
  EXPECT_NEAR(pull / weight, 1 - 1000 / density, 0.02);
}

// rho / 2 C pi r^2 v^2 = (rho_b - rho) V g, half a second after its release.
TEST(FluidGrains, AGrainSinksAsFastAsItsDragAllows) {
  GrainBasin basin;
  constexpr double radius = 0.005, density = 2500;
  const ObjectId grain = basin.add_grain(radius, density, {0, 0.29, 0});
  basin.run(0.25);
  const double begin = basin.height(grain);
  basin.run(0.1);
  const double speed = (begin - basin.height(grain)) / 0.1;
  const double terminal = std::sqrt((density / 1000 - 1) * 9.81 * radius * 8 / 3 / 0.47);
  EXPECT_NEAR(speed / terminal, 1, 0.15);
}

// A cube of water with grains and a rope in it, without gravity: they fly through the water and accelerate
// it.
TEST(FluidGrains, MomentumStays) {
  World world({.substeps = 8, .gravity = {}});
  const ObjectId water = world.add_fluid(fill(Vec3d{-0.1, -0.1, -0.1}, Vec3d{0.1, 0.1, 0.1}, d),
                                         {.spacing = float(d), .viscosity = 0.5f});
  const ObjectId grains = world.add_grains(fill(Vec3d{-0.05, -0.05, -0.05}, Vec3d{0.05, 0.05, 0.05}, 0.025),
                                           {.radius = 0.008f, .density = 2000}, {.velocity = {1, 0, 0}});
  const ObjectId rope = world.add_rope(std::array{Vec3d{-0.08, 0.075, 0}, Vec3d{0.08, 0.075, 0}}, 8,
                                       {.radius = 0.005f, .density = 300}, {.velocity = {0, 0, -2}});
  const auto momentum = [&] { return world.momentum(water) + world.momentum(grains) + world.momentum(rope); };
  const Vec3d before = momentum();
  for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
  EXPECT_LT(length(momentum() - before), 1e-5 * length(before));
  EXPECT_GT(world.momentum(water).x, 0.1 * before.x);
}

TEST(FluidGrains, RainOfGrainsIntoWaterStaysCalm) {
  for (const float density : {100.0f, 2000.0f}) {
    GrainBasin basin({0.2, 0.16, 0.16});
    const auto points = fill(Vec3d{-0.08, 0.25, -0.06}, Vec3d{0.08, 0.45, 0.06}, 0.02);
    const ObjectId grains =
        basin.world.add_grains(points, {.radius = 0.008f, .density = density}, {.velocity = {0, -3, 0}});
    for (int frame = 0; frame < 120; ++frame) {
      ASSERT_TRUE(basin.world.step(1.0 / 60).ok());
      for (const Vec3f& v : basin.world.velocities(basin.water)) ASSERT_LT(length(v), 6) << frame;
      for (const Vec3f& v : basin.world.velocities(grains)) ASSERT_LT(length(v), 6) << frame;
    }
    EXPECT_EQ(basin.height(grains) > 0.14, density < 1000) << basin.height(grains);
    EXPECT_EQ(basin.height(grains) < 0.1, density > 1000);
  }
}

/// Level of the water in a basin of this area [m^2], from what is above the bed. Particles lie in layers, so it is a mean
/// over cuts through two of them.
double level(const World& world, ObjectId water, double spacing, double area) {
  std::vector<float> y;
  for (const Vec3f& x : world.positions(water)) y.push_back(x.y);
  std::sort(y.begin(), y.end());
  const double top = static_cast<double>(y[y.size() * 9 / 10]);
  double sum = 0;
  constexpr int cuts = 100;
  for (int k = 0; k < cuts; ++k) {
    const double cut = top - 2 * spacing * k / cuts;
    const auto above = y.end() - std::upper_bound(y.begin(), y.end(), static_cast<float>(cut));
    sum += cut + static_cast<double>(above) * spacing * spacing * spacing / area;
  }
  return sum / cuts;
}

// A bed of gravel lifts the water by its own volume, whether it is a layer or a heap with little water between.
TEST(FluidGrains, GravelLiftsTheWaterByItsVolume) {
  constexpr double side = 0.15, high = 0.075, spacing = 0.0125, radius = 0.01;
  for (const int layers : {1, 4}) {
    World world;
    world.add_collider(Plane{});
    for (const Vec3f& n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}})
      world.add_collider(Plane{n, static_cast<float>(-side / 2)});
    const ObjectId water =
        world.add_fluid(fill(Vec3d{-side / 2, 0, -side / 2}, Vec3d{side / 2, high, side / 2}, spacing),
                        {.spacing = float(spacing)});
    const std::vector<Vec3d> centers =
        fill(Vec3d{-side / 2, 0.08, -side / 2}, Vec3d{side / 2, 0.08 + 0.0205 * layers, side / 2}, 0.0205);
    world.add_grains(centers, {.radius = float(radius), .density = 5000});
    const double volume = static_cast<double>(centers.size()) * 4 / 3 * pi * radius * radius * radius;
    for (int frame = 0; frame < 75; ++frame) ASSERT_TRUE(world.step(1.0 / 60).ok());
    EXPECT_NEAR((level(world, water, spacing, side * side) - high) / (volume / (side * side)), 1, 0.1)
        << layers;
    EXPECT_LT(world.report().fluid.mean_density_error, 0.005) << layers;
  }
}

}  // namespace souple::test_physics_fluid_bodies
