#include "souple/geometry/measures.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

// Meshes with holes, as scanners and artists make them: whatever needs their inside closes the holes alike.

namespace souple::test_world_open_meshes {

void append(TriangleMesh& mesh, const TriangleMesh& part, const Vec3d& shift) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& x : part.positions) mesh.positions.push_back(x + shift);
  for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

template <class Remove>
void open(TriangleMesh& mesh, const Remove& remove) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return remove((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0);
  });
}

/// A ring and a ball above it, each with a hole at its bottom, turned inside out.
struct Figure {
  TriangleMesh mesh;
  double volume = 0;  // of the closed pieces [m^3]

  Figure() {
    TriangleMesh ring = torus(0.2, 0.08, 48, 24), ball = sphere(3, 0.1);
    volume =
        enclosed_volume(ring.positions, ring.triangles) + enclosed_volume(ball.positions, ball.triangles);
    open(ring, [](const Vec3d& x) { return x.y < -0.065 && x.x > 0.18 && std::abs(x.z) < 0.03; });
    open(ball, [](const Vec3d& x) { return x.y < -0.093; });
    append(mesh, ring, {});
    append(mesh, ball, {0, 0.3, 0});
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
};

/// A world that remembers its log.
struct Heard {
  std::string words;
  World world;

  explicit Heard(const Settings& settings = {}) : world(settings) {
    world.set_log([this](LogLevel, std::string_view line) { words += line, words += '\n'; });
  }
  void expect(std::string_view line) const { EXPECT_NE(words.find(line), std::string::npos) << words; }
};

TEST(OpenMeshes, SoftBodiesFillThem) {
  Heard heard;
  const Figure figure;
  const ObjectId body = heard.world.add_soft_body(figure.mesh, {.density = 500});
  EXPECT_NEAR(heard.world.total_mass(body), 500 * figure.volume, 0.02 * 500 * figure.volume);
  heard.expect("Closed 2 holes (");
}

TEST(OpenMeshes, DistanceFieldsHaveTheirInside) {
  Heard heard;
  const SignedDistanceField field(Figure().mesh, 0.01);
  EXPECT_NEAR(field.at({0.2, 0, 0}).distance, -0.08, 0.015);  // above the ring's hole
  EXPECT_NEAR(field.at({-0.2, 0, 0}).distance, -0.08, 0.003);
  EXPECT_NEAR(field.at({0, 0.3, 0}).distance, -0.1, 0.015);
  EXPECT_NEAR(field.at({0, 0, 0}).distance, 0.12, 0.003);
  heard.world.add_collider(field, {.name = "figure"});
  heard.expect("figure: Closed 2 holes (");
}

TEST(OpenMeshes, RigidBodiesHaveTheirMass) {
  Heard heard;
  const Figure figure;
  const ObjectId body = heard.world.add_rigid_body(figure.mesh, {.density = 500});
  EXPECT_NEAR(heard.world.rigid_body(body).mass, 500 * figure.volume, 0.02 * 500 * figure.volume);
  heard.expect("Closed 2 holes (");
}

TEST(OpenMeshes, FluidsFillThem) {
  Heard heard;
  const Figure figure;
  const ObjectId water = heard.world.add_fluid(figure.mesh, {.spacing = 0.01f});
  EXPECT_NEAR(double(heard.world.positions(water).size()) * 1e-6, figure.volume, 0.03 * figure.volume);
  heard.expect("Closed 2 holes (");
}

/// Number of points of water that lie in a body.
std::size_t left_out(World& world, float spacing) {
  const ObjectId water =
      world.add_fluid(fill(Vec3d{-0.4, -0.2, -0.4}, Vec3d{0.4, 0.5, 0.4}, static_cast<double>(spacing)),
                      {.spacing = spacing});
  const std::size_t before = world.positions(water).size();
  world.leave_out_covered();
  return before - world.positions(water).size();
}

TEST(OpenMeshes, NoWaterBeginsInBodiesOrInObstaclesWithSmallHoles) {
  const Figure figure;
  const auto obstacle = [&](float spacing) {
    World world;
    world.add_obstacle(figure.mesh);
    return left_out(world, spacing);
  };
  World world;
  world.add_rigid_body(figure.mesh);
  const float d = 0.035f;  // the holes are 0.08 m wide
  const double inside = figure.volume / (double(d) * double(d) * double(d));
  EXPECT_NEAR(double(left_out(world, d)), inside, 0.03 * inside);
  EXPECT_NEAR(double(obstacle(d)), inside, 0.03 * inside);
  EXPECT_EQ(obstacle(0.02f), 0u);  // water enters a hole of several spacings
}

// Pressure acts on the covers of the holes too, which pass it on to their rims: a leak would be a jet engine.
TEST(OpenMeshes, PressureInflatesAndDoesNotDrive) {
  Heard heard({.gravity = {}, .wind = {.air_density = 0}, .drag = 2});
  World& world = heard.world;
  TriangleMesh ball = sphere(3, 0.5);
  open(ball, [](const Vec3d& x) { return x.y < -0.4; });
  const ObjectId balloon = world.add_cloth(ball, {.membrane_stiffness = 100});
  const Vec3d center = world.center_of_mass(balloon);
  world.set_pressure(balloon, 50);
  world.set_pressure(balloon, 60);
  run(world, 1.5);
  EXPECT_GT(length(Vec3d(world.positions(balloon)[0]) - world.center_of_mass(balloon)), 0.52);
  EXPECT_LT(length(world.center_of_mass(balloon) - center), 1e-3);
  EXPECT_EQ(heard.words.find("Closed 1 hole ("), heard.words.rfind("Closed 1 hole (")) << heard.words;
  heard.expect("Closed 1 hole (");
}

TEST(OpenMeshes, ABowlHasNoInside) {
  TriangleMesh bowl = sphere(3, 0.5);
  open(bowl, [](const Vec3d& x) { return x.y > 0; });
  World world;
  const auto refused = [&](const auto& use) { expect_error(use, {"closed surface", "1 hole (", "Remesh"}); };
  refused([&] { world.add_soft_body(bowl); });
  refused([&] { world.add_fluid(bowl); });
  refused([&] { SignedDistanceField(bowl, 0.1); });
  const ObjectId cloth = world.add_cloth(bowl);
  refused([&] { world.set_pressure(cloth, 10); });
  refused([&] { world.set_enclosed_volume(cloth, 1); });
  EXPECT_NO_THROW(world.add_rigid_body(bowl));
  EXPECT_NO_THROW(world.add_obstacle(bowl));
}

// A crate with a flat label beside it: the label has no hull.
TEST(OpenMeshes, AFlatPieceIsLeftOutOfTheHulls) {
  TriangleMesh crate = box({0.2, 0.2, 0.2}, 1);
  append(crate, grid(2, 2, 0.1), {0, 0.15, 0});
  Heard heard;
  World& world = heard.world;
  world.add_collider(Plane{});
  const ObjectId body = world.add_rigid_body(crate, {.density = 500}, at(0, 0.12, 0));
  heard.expect("1 of its 2 pieces is flat");
  EXPECT_NEAR(world.rigid_body(body).mass, 4, 1e-6);
  run(world, 1);
  EXPECT_NEAR(world.center_of_mass(body).y, 0.1, 2e-3);

  TriangleMesh sheets = grid(2, 2, 0.1);
  append(sheets, grid(2, 2, 0.1), {0, 0.15, 0});
  expect_error([&] { world.add_rigid_body(sheets); }, {"each of the 2 pieces", "flat", "thickness"});
  expect_error([&] { world.add_rigid_body(grid(3, 3, 1)); }, {"lie in a plane"});
}

}  // namespace souple::test_world_open_meshes
