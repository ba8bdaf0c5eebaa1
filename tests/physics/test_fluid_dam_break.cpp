#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

// A column of water, a wide and n^2 a high, collapses on a dry floor. J. C. Martin and W. J. Moyce 1952,
// "Part IV. An experimental study of the collapse of liquid columns on a rigid horizontal plane", Phil.
// Trans. R. Soc. A 244, 312-324, a = 2.25 in. The paper was not at hand. Its values are those of the validation scripts
// of other projects, which agree with each other (n^2 = 2: tables 2 and 6).

namespace souple::test_physics_fluid_dam_break {

constexpr double g = 9.81, a = 0.05715;  // m/s^2, m

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

}  // namespace souple::test_physics_fluid_dam_break
