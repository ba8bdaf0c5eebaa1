#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_free_fall {

// --- free fall -----------------------------------------------------------------------------------

struct Fall {
  double x_error = 0, v_error = 0;  // maxima over the fall, relative to the distance and speed of the fall
};

// Closed form of the scheme, v_n = -g n h and x_n = -g h^2 n (n + 1) / 2.
Fall fall(int steps, double h, Curves& curves) {
  World world({.substeps = 1});
  const Vec3d origin[] = {Vec3d{}};
  const ObjectId stone = world.add_grains(origin, grain_of_mass(1));
  const double g = -static_cast<double>(world.settings().gravity.y);
  const std::string series = "h = 1/" + std::to_string(std::lround(1 / h)) + " s";
  Fall result;
  for (int n = 1; n <= steps; ++n) {
    world.step(h);
    const double v = -g * n * h;
    const double x = -g * h * h * n * (n + 1) / 2;
    const double x_error = std::fabs(world.center_of_mass(stone).y - x) / std::fabs(x);
    const double v_error = std::fabs(world.momentum(stone).y - v) / std::fabs(v);
    result.x_error = std::max(result.x_error, x_error);
    result.v_error = std::max(result.v_error, v_error);
    if (n % (steps / 100) == 0) curves.add(series, n * h, std::max(x_error, 1e-9));
  }
  return result;
}

TEST(FreeFall, FollowsTheDiscreteClosedForm) {
  const std::string name = "free fall";
  Curves curves(name, "time [s]", "relative error of the fallen height (log)");
  const Fall long_steps = fall(1000, 1.0 / 60, curves);
  validate_below(name, "1000 x 1/60 s: x", long_steps.x_error, 1e-4);
  validate_below(name, "1000 x 1/60 s: v", long_steps.v_error, 1e-4);
  const Fall short_steps = fall(10000, 1.0 / 600, curves);
  validate_below(name, "10,000 x 1/600 s: x", short_steps.x_error, 1e-4);
  validate_below(name, "10,000 x 1/600 s: v", short_steps.v_error, 1e-4);
}

// --- a free body ---------------------------------------------------------------------------------

enum class Make { links, springs, solid };
std::string words(Make make) {
  return make == Make::links ? "rigid links" : make == Make::springs ? "tet springs" : "neo-Hookean";
}

std::vector<Vec3d> lattice_points(double spacing) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) points.push_back({i * spacing, j * spacing, k * spacing});
  return points;
}

// 5 x 5 x 5 particles, 0.4 m wide, thrown at 1 m/s without gravity. They have rigid links along the edges of the
// lattice, or are an elastic solid of E = 1e5 Pa.
struct Lattice {
  World world;
  ObjectId body;

  Lattice(Make make, int substeps, const Vec3d& at = {}, float spin = 0)
      : world({.substeps = substeps, .gravity = {}}) {
    const ObjectOptions thrown{
        .transform = {.translation = at}, .velocity = {0.8f, 0.6f, 0}, .angular_velocity = {0, 0, spin}};
    if (make == Make::links) {
      const std::vector<Vec3d> points = lattice_points(0.1);
      body = world.add_grains(points, grain_of_mass(0.01), thrown);
      std::vector<std::pair<VertexRef, VertexRef>> links;
      for (std::uint32_t a = 0; a < points.size(); ++a)
        for (std::uint32_t b = a + 1; b < points.size(); ++b)
          if (length(points[a] - points[b]) < 0.11) links.push_back({{body, a}, {body, b}});
      world.connect(links, -1);
    } else {
      const auto model = make == Make::springs ? SoftBodyModel::springs : SoftBodyModel::neo_hookean;
      body = world.add_soft_body(tet_bar(4, 4, 4, {0.4, 0.4, 0.4}),
                                 {.young_modulus = 1e5f, .poisson_ratio = 0.3f, .model = model}, thrown);
    }
  }
};

// Maximum over the run. All particles move alike, so sum m|v| is the momentum itself.
double momentum_error(Make make, int substeps, Curves& curves) {
  Lattice lattice(make, substeps);
  const Vec3d start = lattice.world.momentum(lattice.body);
  const std::string series = words(make) + ", " + std::to_string(substeps) + " substeps";
  double worst = 0;
  for (int frame = 1; frame <= 600; ++frame) {
    if (!lattice.world.step(1.0 / 60).ok()) return std::nan("");
    const double error = length(lattice.world.momentum(lattice.body) - start) / length(start);
    worst = std::max(worst, error);
    if (frame % 10 == 0) curves.add(series, frame / 60.0, std::max(error, 1e-9));
  }
  return worst;
}

TEST(FreeLattice, KeepsItsMomentum) {
  const std::string name = "free 5 x 5 x 5 lattice";
  Curves curves(name, "time [s]", "lost momentum, relative to sum m|v| (log)");
  const auto error = [&](Make make, int substeps) { return momentum_error(make, substeps, curves); };
  for (const int substeps : {10, 50}) {
    const std::string at = ", " + std::to_string(substeps) + " substeps";
    validate_below(name, "rigid links" + at, error(Make::links, substeps), 1e-5);
    validate_below(name, "tet springs" + at, error(Make::springs, substeps), 1e-5);
  }
  validate_below(name, "neo-Hookean, 10 substeps", error(Make::solid, 10), 1e-5);
  // The noise of 320 tets' strains over 30,000 substeps.
  validate_below(name, "neo-Hookean, 50 substeps", error(Make::solid, 50), 1.2e-5);
}

// --- far from the origin, and at other rates -----------------------------------------------------

struct Trajectory {
  std::vector<std::vector<Vec3d>> frames;  // at 30 Hz, relative to the start [m]
  double fastest = 0;                      // m/s
};

Trajectory trajectory(const Vec3d& at, int rate) {
  Lattice lattice(Make::solid, 600 / rate, at, 1);  // rotating, hence strained
  Trajectory result;
  for (int frame = 1; frame <= 5 * rate; ++frame) {
    EXPECT_TRUE(lattice.world.step(1.0 / rate).ok());
    if (frame % (rate / 30) != 0) continue;
    result.frames.emplace_back();
    for (const Vec3f& x : lattice.world.positions(lattice.body))
      result.frames.back().push_back(Vec3d(x) - at);
    for (const Vec3f& v : lattice.world.velocities(lattice.body))
      result.fastest = std::max(result.fastest, static_cast<double>(length(v)));
  }
  return result;
}

double largest_difference(const Trajectory& a, const Trajectory& b, const std::string& series,
                          Curves& curves) {
  double worst = 0;
  EXPECT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t frame = 0; frame < a.frames.size(); ++frame) {
    double here = 0;
    for (std::size_t i = 0; i < a.frames[frame].size(); ++i)
      here = std::max(here, length(a.frames[frame][i] - b.frames[frame][i]));
    worst = std::max(worst, here);
    if (frame % 3 == 0) curves.add(series, static_cast<double>(frame + 1) / 30, std::max(here, 1e-9));
  }
  return worst;
}

TEST(FreeLattice, MovesAlikeEverywhere) {
  const std::string name = "the same lattice far from the origin";
  Curves curves(name, "time [s]", "distance to the run at the origin [m] (log)");
  curves.add("bound", {0, 5}, {1e-4, 1e-4});
  const Trajectory here = trajectory({}, 60);
  for (const double distance : {10.0, 1000.0}) {
    const Trajectory there = trajectory({distance, 0, 0}, 60);
    const std::string at = std::to_string(std::lround(distance)) + " m";
    const double difference = largest_difference(here, there, at, curves);
    validate_below(name, at + ": difference [m]", difference, 1e-4);
    validate_below(name, at + ": fastest particle [m/s]", there.fastest, 2);
  }
}

TEST(FreeLattice, MovesAlikeAtEveryFrameRate) {
  const std::string name = "the same lattice at other frame rates";
  Curves curves(name, "time [s]", "distance to the run at 60 Hz [m], 1e-9 is 0 (log)");
  curves.add("bound", {0, 5}, {1e-4, 1e-4});
  const Trajectory reference = trajectory({}, 60);
  for (const int rate : {30, 120}) {
    const std::string at = std::to_string(rate) + " Hz";
    const double difference = largest_difference(reference, trajectory({}, rate), at, curves);
    validate_below(name, at + ": difference to 60 Hz [m]", difference, 1e-4);
  }
}

}  // namespace souple::test_physics_free_fall
