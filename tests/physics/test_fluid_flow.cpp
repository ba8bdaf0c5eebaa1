#include "souple/souple.h"
#include "souple/world/memory.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_flow {

// Flows that friction and the stiffness of the particles' packing would slow down: out of a hole, and to and
// fro in a tube.

constexpr double g = 9.81;

void add_walls(World& world, double half_x, double half_z) {
  for (const float side : {1.0f, -1.0f}) {
    world.add_collider(Plane{{side, 0, 0}, static_cast<float>(-half_x)});
    world.add_collider(Plane{{0, 0, side}, static_cast<float>(-half_z)});
  }
}

/// A square plate at y = 0 with a square hole in its middle.
TriangleMesh plate_with_hole(double half, double half_hole) {
  TriangleMesh plate;
  for (const double a : {half, half_hole})
    for (const Vec3d& x : {Vec3d{-a, 0, -a}, Vec3d{a, 0, -a}, Vec3d{a, 0, a}, Vec3d{-a, 0, a}})
      plate.positions.push_back(x);
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    plate.triangles.push_back({k, next, 4 + next});
    plate.triangles.push_back({k, 4 + next, 4 + k});
  }
  return plate;
}

struct Outflow {
  double speed = 0;      // at the jet's core, over sqrt(2 g h) with h the depth below the surface
  double discharge = 0;  // over A sqrt(2 g H), H the depth of the hole
};

// A tank 36 spacings wide and 30 deep, with a hole of 12 spacings in a plate without thickness. Means over
// 0.2 s, from 0.4 s on.
Outflow outflow() {
  constexpr double d = 0.02, half = 18 * d, hole = 12 * d;
  constexpr int first = 24, frames = 12;
  World world({.substeps = 8});
  add_walls(world, half, half);
  world.add_obstacle(plate_with_hole(half + d, hole / 2));
  const ObjectId water = world.add_fluid(fill({-half, 0, -half}, {half, 30 * d, half}, d),
                                         {.spacing = float(d), .density = 1000});
  Outflow result;
  double head = 0;
  std::ptrdiff_t out = 0;
  for (int frame = 0; frame < first + frames; ++frame) {
    world.step(1.0 / 60);
    const auto x = world.positions(water), v = world.velocities(water);
    const auto below = std::count_if(x.begin(), x.end(), [](const Vec3f& p) { return p.y < 0; });
    if (frame < first) out = -below;
    if (frame < first) continue;
    // The surface, outside the dip above the hole.
    std::vector<float> heights;
    for (const Vec3f& p : x)
      if (std::max(std::fabs(p.x), std::fabs(p.z)) > hole && p.y > 0) heights.push_back(p.y);
    std::sort(heights.begin(), heights.end());
    const double surface = double{heights[heights.size() - (36 * 36 - 24 * 24) / 2]} + d / 2;
    // The jet's core where it is narrowest, half a width below the hole.
    double speed = 0;
    int count = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double y = double{x[i].y};
      if (std::fabs(y + hole / 2) > 2 * d || std::max(std::fabs(x[i].x), std::fabs(x[i].z)) > hole / 4)
        continue;
      speed -= double{v[i].y} / std::sqrt(2 * g * (surface - y));
      ++count;
    }
    result.speed += speed / count / frames;
    head += surface / frames;
    if (frame == first + frames - 1) out += below;
  }
  const double seconds = frames / 60.0;
  result.discharge = static_cast<double>(out) * d * d * d / seconds / (hole * hole * std::sqrt(2 * g * head));
  return result;
}

// Torricelli: v = sqrt(2 g h). A jet from a sharp-edged hole contracts to 0.61 of the hole's area.
TEST(FluidFlow, LeavesAHoleAtTorricellisSpeed) {
  const Outflow flow = outflow();
  const std::string name = "outflow through a sharp hole of 12 spacings";
  validate(name, "speed at the jet's core / sqrt(2 g h)", flow.speed, 1, 0.07);
  validate(name, "discharge / A sqrt(2 g H)", flow.discharge, 0.625, 0.075);
}

// A tube with two legs joined by a channel, of the same width, 0.16 m: L along its middle. The water oscillates
// with a period of 2 pi sqrt(L / 2 g). Walls slip, as XSPH would otherwise act like 1.2 Pa s.
double period_in_tube(const FluidSettings& settings) {
  constexpr double d = 0.02, width = 8 * d, middle = 0.2, L = 1.2, raised = 0.1;
  constexpr double level = (L - 2 * middle + width) / 2, outer = middle + width / 2,
                   inner = middle - width / 2;
  World world({.substeps = 8, .fluid = settings});
  world.add_collider(Plane{});
  add_walls(world, outer, width / 2);
  world.add_collider(Box{.center = {0, float(width + 0.5), 0}, .half_extents = {float(inner), 0.5f, 1}});
  std::vector<Vec3d> points;
  for (const Vec3d& x : fill(Vec3d{-outer, 0, -width / 2}, Vec3d{outer, level + raised + d, width / 2}, d))
    if ((x.y < width || std::fabs(x.x) > inner) && x.y < level + (x.x > 0 ? raised : -raised))
      points.push_back(x);
  const ObjectId water = world.add_fluid(points, {.spacing = float(d), .density = 1000, .friction = 0});
  std::vector<double> crossings;
  for (double t = 0, before = world.center_of_mass(water).x; t < 3 && crossings.size() < 2; t += 1.0 / 60) {
    world.step(1.0 / 60);
    const double now = world.center_of_mass(water).x;
    if (before * now < 0) crossings.push_back(t + before / (before - now) / 60);
    before = now;
  }
  return crossings.size() < 2 ? 0 : 2 * (crossings[1] - crossings[0]);
}

TEST(FluidFlow, SwingsInATubeWithItsPeriodInTheWideKernel) {
  const double period = 2 * pi * std::sqrt(1.2 / (2 * g));
  validate_relative("water in a U-tube", "period, wide_wendland [s]",
                    period_in_tube({.kernel = SmoothingShape::wide_wendland}), period, 0.04);
  state("water in a U-tube", "period, wendland [s]", period_in_tube({.kernel = SmoothingShape::wendland}));
}

// A column of water, a wide and n^2 a high, collapses on a dry floor. J. C. Martin and W. J. Moyce 1952,
// "Part IV. An experimental study of the collapse of liquid columns on a rigid horizontal plane", Phil.
// Trans. R. Soc. A 244, 312-324, a = 2.25 in. The paper was not at hand. Its values are those of the validation scripts
// of other projects, which agree with each other (n^2 = 2: tables 2 and 6).

constexpr double a = 0.05715;  // m

using Points = std::vector<std::pair<double, double>>;

struct Experiment {
  int ratio;      // n^2
  Points front;   // (T = t sqrt(n^2 g / a), Z = front / a)
  Points height;  // (tau = t sqrt(g / a), H = height at the wall / n^2 a)
};

const Experiment square{
    1,
    {{0.43, 1.11}, {0.62, 1.22}, {0.80, 1.44}, {0.97, 1.67}, {1.14, 1.89}, {1.29, 2.11}, {1.45, 2.33},
     {1.62, 2.56}, {1.76, 2.78}, {1.93, 3.00}, {2.07, 3.22}, {2.24, 3.44}, {2.40, 3.67}, {2.54, 3.89},
     {2.71, 4.11}, {2.87, 4.33}, {3.04, 4.56}, {3.21, 4.78}, {3.29, 4.89}, {3.32, 5.00}},
    {{0.80, 0.89}, {1.29, 0.78}, {1.74, 0.67}, {2.15, 0.56}, {2.57, 0.44}, {3.08, 0.33}}};

const Experiment tall{2,
                      {{0.41, 1.11},
                       {0.84, 1.22},
                       {1.19, 1.44},
                       {1.43, 1.67},
                       {1.63, 1.89},
                       {1.83, 2.11},
                       {1.98, 2.33},
                       {2.20, 2.56},
                       {2.32, 2.78},
                       {2.51, 3.00},
                       {2.65, 3.22},
                       {2.83, 3.44},
                       {2.98, 3.67},
                       {3.11, 3.89},
                       {3.33, 4.11}},
                      {{0.56, 0.94},
                       {0.77, 0.89},
                       {0.93, 0.83},
                       {1.08, 0.78},
                       {1.28, 0.72},
                       {1.46, 0.67},
                       {1.66, 0.61},
                       {1.84, 0.56},
                       {2.00, 0.50},
                       {2.21, 0.44},
                       {2.45, 0.39},
                       {2.70, 0.33},
                       {3.06, 0.28}}};

// The experiment's diaphragm does not vanish instantly as ours does. One delay for both columns and all
// spacings, in units of T: 8 ms for the square column, 5 ms for the tall one.
constexpr double release = 0.1;

/// The collapse, in units of the experiment.
class DamBreak {
 public:
  DamBreak(int ratio, int across, int thick, const FluidMaterial& material = material::water)
      : d_(a / across), ratio_(ratio), thick_(thick), world_({.substeps = substeps(ratio, across)}) {
    const double w = thick * d_;
    FluidMaterial water = material;
    water.spacing = static_cast<float>(d_);
    water_ = world_.add_fluid(fill(Vec3d{0, 0, 0}, Vec3d{a, ratio * a, w}, d_), water);
    world_.add_collider(Plane{});
    world_.add_collider(Plane{{1, 0, 0}, 0.0f});
    world_.add_collider(Plane{{0, 0, 1}, 0.0f});
    world_.add_collider(Plane{{0, 0, -1}, static_cast<float>(-w)});
  }
  void run(double tau) {
    while (world_.time() < tau * std::sqrt(a / g)) {
      world_.step(dt);
      error_ = std::max(error_, double{world_.report().fluid.mean_density_error});
      const double now = world_.time() * std::sqrt(g / a);
      front_.emplace_back(now * std::sqrt(ratio_), farthest() / a);
      height_.emplace_back(now, top() / (ratio_ * a));
    }
  }
  const Points& front() const { return front_; }
  const Points& height() const { return height_; }
  double error() const { return error_; }
  /// Kinetic and potential energy, with the floor at level 0 [J].
  double energy() const { return world_.kinetic_energy(water_) + world_.potential_energy(water_); }

 private:
  static constexpr double dt = 0.0025;  // s

  /// h max(sqrt(p / rho), v / 1.5) / d <= 0.33 with v = 2 sqrt(g H), the speed of a dam's front.
  static int substeps(int ratio, int across) {
    return static_cast<int>(std::ceil(dt * 2 / 1.5 * std::sqrt(g * ratio * a) / (0.33 * a / across)));
  }
  /// Position beyond which only the foremost 0.2 % of the particles lie, plus half a spacing [m].
  double farthest() const {
    std::vector<float> x;
    for (const Vec3f& p : world_.positions(water_)) x.push_back(p.x);
    const auto at = x.end() - 1 - static_cast<std::ptrdiff_t>(x.size() / 500);
    std::nth_element(x.begin(), at, x.end());
    return double{*at} + d_ / 2;
  }
  /// Water height two to four spacings from the wall, beyond the film that sticks to it [m].
  double top() const {
    std::vector<float> y;
    for (const Vec3f& p : world_.positions(water_))
      if (double{p.x} > 2 * d_ && double{p.x} < 4 * d_) y.push_back(p.y);
    std::sort(y.begin(), y.end());
    return double{y[y.size() - static_cast<std::size_t>(thick_)]} + d_ / 2;  // of about 2 * thick in a layer
  }

  double d_;
  int ratio_, thick_;
  World world_;
  ObjectId water_;
  Points front_{{0, 1}}, height_{{0, 1}};
  double error_ = 0;
};

/// Value of a curve at a time, by linear interpolation.
double at(const Points& curve, double time) {
  for (std::size_t i = 1; i < curve.size(); ++i)
    if (curve[i].first >= time) {
      const auto& [t0, y0] = curve[i - 1];
      const auto& [t1, y1] = curve[i];
      return y0 + (y1 - y0) * std::max(0.0, time - t0) / (t1 - t0);
    }
  return NAN;
}

/// Largest deviation from measured points up to a time, relative to the measured values; the simulation
/// started at `start`.
double deviation(const Points& simulated, const Points& measured, double start, double until = 1e30) {
  double worst = 0;
  for (const auto& [t, y] : measured)
    if (t <= until) worst = std::max(worst, std::fabs(at(simulated, t - start) / y - 1));
  return worst;
}

TEST(FluidDamBreak, TheFrontRunsAsMeasured) {
  DamBreak dam(2, 16, 8);
  dam.run(3.4 / std::sqrt(2));
  EXPECT_LT(deviation(dam.front(), tall.front, release), 0.1);
  EXPECT_LT(deviation(dam.front(), tall.front, 0), 0.15);
  EXPECT_LT(deviation(dam.height(), tall.height, 0, 1.8), 0.1);
  EXPECT_LT(dam.error(), 0.01);
}

void add(Curves& curves, const std::string& series, const Points& points, double start = 0) {
  for (const auto& [t, y] : points) curves.add(series, t + start, y);
}

class FluidDamBreakOf : public ::testing::TestWithParam<const Experiment*> {};

TEST_P(FluidDamBreakOf, MartinAndMoyceSlow) {
  const Experiment& measured = *GetParam();
  const std::string name = "dam break, n^2 = " + std::to_string(measured.ratio);
  const std::string front = name + ", front", height = name + ", height";
  Curves fronts(front, "T = t sqrt(n^2 g / a), simulations begin at 0.1", "Z = front / a");
  Curves heights(height, "tau = t sqrt(g / a)", "H = height at the wall / n^2 a");
  add(fronts, "experiment", measured.front);
  add(heights, "experiment", measured.height);
  for (const int across : {16, 24, 32}) {
    DamBreak dam(measured.ratio, across, 16);
    dam.run(3.45);
    const std::string series = std::to_string(across) + " spacings wide";
    add(fronts, series, dam.front(), release);
    add(heights, series, dam.height());
    validate_below(front, series + ": largest deviation", deviation(dam.front(), measured.front, release),
                   0.1);
    validate_below(front, series + ": largest deviation, simulation started at 0",
                   deviation(dam.front(), measured.front, 0), 0.15);
    validate_below(front, series + ": mean density error, largest of all steps", dam.error(), 0.01);
    validate_below(height, series + ": largest deviation up to tau = 1.8",
                   deviation(dam.height(), measured.height, 0, 1.8), 0.1);
    state(height, series + ": largest deviation", deviation(dam.height(), measured.height, 0));
  }
  FluidMaterial slippery = material::water;
  slippery.friction = 0;
  DamBreak dam(measured.ratio, 24, 16, slippery);
  const double energy = dam.energy();
  dam.run(3.45);
  const std::string series = "24 wide, walls that slip";
  add(fronts, series, dam.front(), release);
  add(heights, series, dam.height());
  validate_below(front, series + ": fraction of energy lost by tau = 3.45", 1 - dam.energy() / energy, 0.07);
  state(front, series + ": largest deviation", deviation(dam.front(), measured.front, release));
  state(height, series + ": largest deviation", deviation(dam.height(), measured.height, 0));
}

INSTANTIATE_TEST_SUITE_P(Column, FluidDamBreakOf, ::testing::Values(&square, &tall),
                         [](const auto& test) { return test.param == &square ? "Square" : "Tall"; });

constexpr double d = 0.04;  // m
constexpr std::uint32_t most = 2000;

struct Flow {
  std::size_t emitted = 0, drained = 0, held_back = 0, max_alive = 0;
  double fastest = 0, mean_error = 0;
};

// A jet rises from the middle of a table, falls beside itself, runs over the table's edges and is drained.
Flow play(World& world, ObjectId fluid, int frames) {
  Flow run;
  for (int frame = 0; frame < frames; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    EXPECT_TRUE(report.ok()) << frame << ": " << report.message;
    run.emitted += report.fluid.emitted;
    run.drained += report.fluid.drained;
    run.held_back += report.fluid.held_back;
    run.fastest = std::max(run.fastest, report.fluid.fastest);
    run.mean_error += report.fluid.mean_density_error / frames;
    run.max_alive = std::max(run.max_alive, world.positions(fluid).size());
  }
  return run;
}

std::size_t bytes(World& world) {
  std::size_t sum = 0;
  const MemoryReport report = world.memory();
  for (const auto& part : report.simulation) sum += part.bytes;
  for (const auto& part : report.objects) sum += part.bytes;
  return sum;
}

TEST(FluidFountain, RunsForAMinuteWithoutGrowingSlow) {
  World world({.substeps = 8});
  const ObjectId fluid =
      world.add_fluid(std::vector<Vec3d>{}, {.spacing = float(d)}, {.max_particles = most});
  world.add_emitter(fluid,
                    {.position = {0, 0.12f, 0}, .direction = {0.12f, 1, 0}, .radius = 0.041f, .speed = 2.5f});
  world.add_collider(Box{{0, -0.05f, 0}, {0.4f, 0.05f, 0.4f}});
  world.add_drain({.shape = Plane{{0, 1, 0}, -1}});
  const Flow first = play(world, fluid, 600);
  const std::size_t held = bytes(world);
  const Flow rest = play(world, fluid, 3000);
  EXPECT_EQ(first.emitted + rest.emitted - first.drained - rest.drained, world.positions(fluid).size());
  EXPECT_LE(std::max(first.max_alive, rest.max_alive), most);
  EXPECT_GT(rest.max_alive, 250u);
  EXPECT_NEAR(double(rest.drained), double(rest.emitted), 0.02 * double(rest.emitted));  // steady state
  EXPECT_LE(double(rest.held_back), 0.02 * double(rest.emitted));
  EXPECT_LT(rest.fastest, 8);  // 2.5 m/s up, then a fall of 1.3 m: 5.7 m/s
  EXPECT_LT(rest.mean_error, 0.01);
  EXPECT_LE(double(bytes(world)), 1.1 * double(held));
}

// A horizontal jet falls like a stone from the end of its inflow zone (two spacings) on.
TEST(FluidFountain, AJetIsAParabola) {
  World world({.substeps = 8});
  const ObjectId fluid =
      world.add_fluid(std::vector<Vec3d>{}, {.spacing = float(d)}, {.max_particles = most});
  world.add_emitter(fluid, {.position = {0, 0, 0}, .direction = {1, 0, 0}, .radius = 0.081f, .speed = 2});
  play(world, fluid, 24);
  const double t = 24 / 60.0, s = t - 2 * d / 2;
  Vec3d front;  // of the first layer
  for (std::size_t i = 0; i < 13; ++i) front += Vec3d(world.positions(fluid)[i]) / 13.0;
  EXPECT_NEAR(front.x, 2 * t, 0.02);
  EXPECT_NEAR(front.y, -9.81 * s * s / 2, 0.03);  // XSPH slows it slightly
  EXPECT_NEAR(front.z, 0, 0.005);
}

// Water runs into a closed vessel until it is full, then comes to rest.
TEST(FluidFountain, AClosedVesselFillsAndRests) {
  constexpr double side = 0.2, spacing = 0.02;
  struct Case {
    bool of_mesh;
    float speed;
    int frames;
  };
  for (const auto& [of_mesh, speed, frames] :
       {Case{false, 1.6f, 240}, Case{true, 2, 200}, Case{true, 0.7f, 300}}) {
    World world;
    if (of_mesh) {
      TriangleMesh vessel = box({side, side, side}, 1);
      for (Triangle& t : vessel.triangles) std::swap(t[1], t[2]);
      world.add_obstacle(vessel);
    } else {
      add_walls(world, side / 2, side / 2);
      for (const float up : {1.0f, -1.0f})
        world.add_collider(Plane{{0, up, 0}, static_cast<float>(-side / 2)});
    }
    const ObjectId fluid =
        world.add_fluid(std::vector<Vec3d>{}, {.spacing = float(spacing)}, {.max_particles = 2000});
    world.add_emitter(fluid, {.position = {0, 0.08f, 0}, .radius = 0.05f, .speed = speed});
    double error = 0, energy = 0;
    for (int frame = 0; frame < frames; ++frame) {
      const StepReport& report = world.step(1.0 / 60);
      if (frame < frames - 10) continue;
      error = std::max(error, report.fluid.mean_density_error);
      energy = std::max(energy, world.kinetic_energy(fluid));
    }
    EXPECT_NEAR(double(world.positions(fluid).size()), 1000, 50);
    EXPECT_LT(error, 0.01);
    EXPECT_LT(energy, 0.01);
  }
}

}  // namespace souple::test_physics_fluid_flow
