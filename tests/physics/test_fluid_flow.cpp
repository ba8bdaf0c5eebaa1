#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

// Flows that friction and the stiffness of the particles' packing would slow down: out of a hole, and to and
// fro in a tube.

namespace souple::test_physics_fluid_flow {

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

}  // namespace souple::test_physics_fluid_flow
