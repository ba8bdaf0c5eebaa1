#include "souple/souple.h"
#include "validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_physics_fluid_vessels {

constexpr double d = 0.02, half = 6 * d, depth = 10 * d, rim = 16 * d;

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

}  // namespace souple::test_physics_fluid_vessels
