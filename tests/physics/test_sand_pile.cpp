#include "tests/physics/collision_cases.h"
#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_sand_pile {

// The plate of Zhou, Xu, Yu and Zulli 2002, "An experimental and numerical study of the angle of repose of coarse
// spheres" (Powder Technology 125). Spheres fill a box 20 diameters thick, and its side walls vanish. Spheres beyond
// the plate fall off, and the rest is a heap between front and rear wall. Their fit has lengths in mm and equal
// friction of grains and walls. mu_s is the coefficient of sliding; the moment arm of rolling friction is mu_r r:
//   angle = 68.61 mu_s^(0.27 + 0.22) (mu_r r)^(0.06 + 0.12) d^-0.2 degrees
constexpr double diameter = 0.01;

double angle_of_zhou(double mu, double mu_r) {
  const double mm = 1000;
  return 68.61 * std::pow(mu, 0.49) * std::pow(mu_r * diameter / 2 * mm, 0.18) *
         std::pow(diameter * mm, -0.2);
}

struct Repose {
  double mu, mu_r;
  int layers, substeps;
};

struct Plate {
  static constexpr int half_width = 16, thickness = 20;  // diameters
  World world;
  ObjectId grains;

  explicit Plate(const Repose& repose) : world({.substeps = repose.substeps, .iterations = 2}) {
    constexpr double half = half_width * diameter, front = thickness * diameter / 2;
    const ColliderOptions rough{.friction = float(repose.mu)};
    const auto size = [](double x) { return float(x); };
    world.add_collider(Box{.center = {0, -0.02f, 0}, .half_extents = {size(half), 0.02f, size(front)}},
                       rough);
    world.add_collider(Plane{.normal = {0, 0, 1}, .offset = -size(front)}, rough);
    world.add_collider(Plane{.normal = {0, 0, -1}, .offset = -size(front)}, rough);
    world.add_collider(Plane{.offset = -0.16f}, {.friction = 1});
    const ColliderId sides[] = {
        world.add_collider(Plane{.normal = {1, 0, 0}, .offset = -size(half)}, rough),
        world.add_collider(Plane{.normal = {-1, 0, 0}, .offset = -size(half)}, rough)};
    grains = world.add_grains(lattice(repose.layers), {.radius = float(diameter / 2),
                                                       .density = 2500,
                                                       .friction = float(repose.mu),
                                                       .rolling_friction = float(repose.mu_r)});
    EXPECT_TRUE(run(world, 40, 1.0 / 60));
    for (const ColliderId side : sides) world.remove(side);
    EXPECT_TRUE(run(world, 150, 1.0 / 60));
  }

  // A loose lattice, disturbed so that it becomes a random packing.
  static std::vector<Vec3d> lattice(int layers) {
    constexpr int half_thickness = thickness / 2;
    constexpr double spacing = 1.12 * diameter, half = (half_width - 0.6) * diameter,
                     front = (half_thickness - 0.6) * diameter;
    std::uint32_t state = 1;
    const auto noise = [&] {
      state = state * 1664525u + 1013904223u;
      return 0.1 * diameter * (double(state >> 8) / (1 << 24) - 0.5);
    };
    std::vector<Vec3d> centers;
    for (int y = 0; y < layers; ++y)
      for (double x = -half; x <= half; x += spacing)
        for (double z = -front; z <= front; z += spacing)
          centers.push_back({x + noise(), diameter * 0.6 + y * spacing + noise(), z + noise()});
    return centers;
  }

  // Slope of the line through the tops of columns one diameter wide and a quarter of the thickness deep, without the
  // summit and the foot.
  double angle() const {
    constexpr int columns = half_width, slices = 4, slots = 2 * columns * slices;
    std::vector<double> top(slots, 0.0);
    for (const Vec3f& x : world.positions(grains)) {
      if (x.y < 0 || std::fabs(double(x.x)) >= columns * diameter) continue;
      const int column = int(std::floor(double(x.x) / diameter)) + columns;
      const int slice = std::clamp(int((double(x.z) / (thickness * diameter) + 0.5) * slices), 0, slices - 1);
      double& highest = top[std::size_t(column * slices + slice)];
      highest = std::max(highest, double(x.y) + diameter / 2);
    }
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t k = 0; k < top.size(); ++k) {
      const std::size_t column = k / slices;
      const double x = std::fabs(double(column) + 0.5 - columns) * diameter;
      if (x < 0.2 * columns * diameter || x > 0.85 * columns * diameter) continue;
      n += 1, sx += x, sy += top[k], sxx += x * x, sxy += x * top[k];
    }
    return std::atan((sx * sy - n * sxy) / (n * sxx - sx * sx)) * 180 / pi;
  }
};

void expect_angle_of_repose(const Repose& repose) {
  const std::string name = "angle of repose", rolling = "rolling friction " + detail::number(repose.mu_r);
  Curves curves(name, "coefficient of sliding friction", "angle of repose [degrees]");
  const double angle = Plate(repose).angle();
  validate(name,
           "friction " + detail::number(repose.mu) + ", " + rolling + ", " + std::to_string(repose.substeps) +
               " substeps [degrees]",
           angle, angle_of_zhou(repose.mu, repose.mu_r), 4);
  curves.add(rolling + ", " + std::to_string(repose.substeps) + " substeps", repose.mu, angle);
}

TEST(SandPile, AngleOfRepose) {
  Curves curves("angle of repose", "coefficient of sliding friction", "angle of repose [degrees]");
  for (const double mu_r : {0.1, 0.2})
    for (int k = 3; k <= 14; ++k)
      curves.add("theory: Zhou et al. 2002, rolling friction " + detail::number(mu_r), 0.05 * k,
                 angle_of_zhou(0.05 * k, mu_r));
  expect_angle_of_repose({0.4, 0.2, 13, 10});
}

class AngleOfRepose : public ::testing::TestWithParam<Repose> {};

TEST_P(AngleOfRepose, OfSpheresSlow) {
  expect_angle_of_repose(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Everything, AngleOfRepose,
                         ::testing::Values(Repose{0.2, 0.1, 10, 20}, Repose{0.2, 0.2, 10, 20},
                                           Repose{0.4, 0.1, 12, 20}, Repose{0.6, 0.2, 16, 20}));

// Columns of regular packings fall, whatever the friction: grains that could not roll stood at 80 degrees.
TEST(SandPile, RegularPackingsFall) {
  constexpr double d = 0.02;
  for (const bool hexagonal : {false, true})
    for (const float mu : {0.3f, 0.6f, 1.0f}) {
      World world({.iterations = 2});
      world.add_collider(Plane{}, {.friction = 1});
      std::uint32_t state = 1;
      const auto noise = [&] {
        state = state * 1664525u + 1013904223u;
        return 0.01 * d * (double(state >> 8) / (1 << 24) - 0.5);
      };
      std::vector<Vec3d> centers;
      for (int y = 0; y < 15; ++y)
        for (int x = 0; x < 6; ++x)
          for (int z = 0; z < 6; ++z) {
            const double shift = 0.5 * (z % 2) + 0.5 * (y % 2), third = (y % 2) / 3.0;
            const Vec3d at = hexagonal
                                 ? Vec3d{x + shift, y * std::sqrt(2.0 / 3), (z + third) * std::sqrt(0.75)}
                                 : Vec3d{double(x), double(y), double(z)};
            centers.push_back(Vec3d{at.x - 3, at.y + 0.5, at.z - 3} * d + Vec3d{noise(), 0, noise()});
          }
      const ObjectId grains = world.add_grains(centers, {.radius = float(d / 2), .friction = mu});
      EXPECT_GT(std::atan(test::slope_of_heap(world, grains, d / 2)) * 180 / pi, 79);
      EXPECT_TRUE(run(world, 180, 1.0 / 60));
      validate_below("regular packings of grains fall",
                     std::string(hexagonal ? "hexagonal" : "cubic") + ", friction " +
                         detail::number(double(mu)) + ": slope after 3 s [degrees]",
                     std::atan(test::slope_of_heap(world, grains, d / 2)) * 180 / pi, 20);
    }
}

// Test of the measure: points throughout a cone.
TEST(SandPile, SlopeIsThatOfACone) {
  std::vector<Vec3d> cone;
  for (int x = -40; x <= 40; ++x)
    for (int y = 0; y <= 40; ++y)
      for (int z = -40; z <= 40; ++z)
        if (y + 0.5 <= 0.5 * (40 - std::hypot(x, z))) cone.push_back({0.01 * x, 0.01 * (y + 0.5), 0.01 * z});
  World world;
  const ObjectId grains = world.add_grains(cone, {.radius = 0.001f});
  EXPECT_NEAR(test::slope_of_heap(world, grains, 0), 0.5, 0.02);
}

}  // namespace souple::test_physics_sand_pile
