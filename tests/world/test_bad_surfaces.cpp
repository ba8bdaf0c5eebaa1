// Defective meshes: non-finite values are refused with one clear sentence. Flat, duplicated, flipped or
// coincident elements run with all collisions on, and nothing explodes.
#include "souple/error.h"
#include "souple/geometry/builders.h"
#include "souple/world/world.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace souple::test_world_bad_surfaces {

constexpr double frame_time = 1.0 / 60;
constexpr float speed_limit = 15;  // m/s
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

ObjectOptions with_self_collision(double height = 0) {
  ObjectOptions options;
  options.self_collision = SelfCollision::surfaces;
  options.transform.translation = {0, height, 0};
  return options;
}

/// A defect of a mesh.
struct Spoilt {
  const char* what;
  bool refused;  // otherwise it runs
  std::function<void(TriangleMesh&)> spoil;
};

const Spoilt spoilt_meshes[] = {
    {"sound", false, [](TriangleMesh&) {}},
    {"a position that is no number", true, [](TriangleMesh& mesh) { mesh.positions[7].y = not_a_number; }},
    {"a position at infinity", true, [](TriangleMesh& mesh) { mesh.positions[3].x = infinity; }},
    {"a vertex that is not there", true, [](TriangleMesh& mesh) { mesh.triangles[2][1] = 1000000; }},
    {"a triangle with a repeated corner", false,
     [](TriangleMesh& mesh) {
       mesh.triangles.push_back({4, 4, 5});
     }},
    {"flat triangles", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions)
         if (x.x > 0.1) x.x = 0.1;
     }},
    {"a triangle twice", false, [](TriangleMesh& mesh) { mesh.triangles.push_back(mesh.triangles[5]); }},
    {"a triangle twice, once turned round", false,
     [](TriangleMesh& mesh) {
       const Triangle t = mesh.triangles[5];
       mesh.triangles.push_back({t[1], t[0], t[2]});
     }},
    {"half of it turned round", false,
     [](TriangleMesh& mesh) {
       for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)
         std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
     }},
    {"all of it twice", false,
     [](TriangleMesh& mesh) {
       const auto n = static_cast<std::uint32_t>(mesh.positions.size());
       const TriangleMesh copy = mesh;
       mesh.positions.insert(mesh.positions.end(), copy.positions.begin(), copy.positions.end());
       for (const Triangle& t : copy.triangles) mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
     }},
    {"vertices in one place", false, [](TriangleMesh& mesh) { mesh.positions[8] = mesh.positions[9]; }},
    {"all vertices in one place", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {0.1, 0.2, 0.3};
     }},
    {"all vertices on one line", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {x.x, 0.2, 0.3};
     }},
    {"all vertices in one plane, folded over one another", false,
     [](TriangleMesh& mesh) {
       for (Vec3d& x : mesh.positions) x = {std::abs(x.x), 0, std::abs(x.z)};
     }},
    {"all vertices shuffled", false,
     [](TriangleMesh& mesh) {
       for (std::size_t i = 0; i < mesh.positions.size(); ++i)
         std::swap(mesh.positions[i], mesh.positions[(i * 37) % mesh.positions.size()]);
     }},
    {"no triangles", false, [](TriangleMesh& mesh) { mesh.triangles.clear(); }},
    {"nothing at all", true, [](TriangleMesh& mesh) { mesh = {}; }},
};

/// Expects one sentence that describes the defect.
void expect_clear(const std::string& message, const char* what) {
  EXPECT_GT(message.size(), 10u) << what;
  EXPECT_EQ(message.find('\n'), std::string::npos) << what << ": " << message;
}

void expect_calm(World& world, const char* what) {
  for (int frame = 0; frame < 60; ++frame) {
    const StepReport& report = world.step(frame_time);
    ASSERT_TRUE(report.ok()) << what << ", frame " << frame << ": " << report.message;
    for (const ObjectId id : world.objects())
      for (const Vec3f& v : world.velocities(id))
        ASSERT_LT(length(v), speed_limit) << what << ", " << world.name(id) << ", frame " << frame;
  }
}

/// Adds a defective mesh to a world above a sheet and drops it there.
void expect_refused_or_calm(const Spoilt& spoilt, const std::function<void(World&)>& add) {
  World world;
  world.add_collider(Plane{.offset = -0.5f});
  std::string error;
  try {
    add(world);
  } catch (const Error& e) {
    error = e.what();
    expect_clear(error, spoilt.what);
  }
  EXPECT_TRUE(!spoilt.refused || !error.empty()) << spoilt.what << " was taken";
  world.add_cloth(grid(8, 8, 0.8), {.thickness = 0.02f}, with_self_collision(0.05));
  expect_calm(world, spoilt.what);
}

TEST(BadSurfaces, AClothIsRefusedOrCalm) {
  for (const Spoilt& spoilt : spoilt_meshes) {
    TriangleMesh mesh = grid(6, 6, 0.5);
    spoilt.spoil(mesh);
    expect_refused_or_calm(
        spoilt, [&](World& world) { world.add_cloth(mesh, {.thickness = 0.02f}, with_self_collision()); });
  }
}

TEST(BadSurfaces, AnObstacleIsRefusedOrCalm) {
  for (const Spoilt& spoilt : spoilt_meshes) {
    TriangleMesh mesh = sphere(1, 0.2);
    spoilt.spoil(mesh);
    expect_refused_or_calm(spoilt, [&](World& world) { world.add_obstacle(mesh, {.thickness = 0.02f}); });
  }
}

TEST(BadSurfaces, ASoftBodyIsRefusedOrCalm) {
  struct SpoiltTets {
    Spoilt as;
    std::function<void(TetMesh&)> spoil;
  };
  const SpoiltTets all[] = {
      {{"sound", false, {}}, [](TetMesh&) {}},
      {{"no number", true, {}}, [](TetMesh& mesh) { mesh.positions[3].z = not_a_number; }},
      {{"inside out", true, {}}, [](TetMesh& mesh) { std::swap(mesh.tets[1][0], mesh.tets[1][1]); }},
      {{"flat", true, {}},
       [](TetMesh& mesh) {
         for (Vec3d& x : mesh.positions) x.y = 0;
       }},
      {{"a tet twice", false, {}}, [](TetMesh& mesh) { mesh.tets.push_back(mesh.tets[2]); }},
      {{"a repeated corner", true, {}}, [](TetMesh& mesh) { mesh.tets[0][2] = mesh.tets[0][1]; }},
      {{"in one place", true, {}},
       [](TetMesh& mesh) {
         for (Vec3d& x : mesh.positions) x = {0, 0, 0};
       }},
      {{"nothing at all", true, {}}, [](TetMesh& mesh) { mesh = {}; }},
  };
  for (const SpoiltTets& spoilt : all) {
    TetMesh mesh = tet_bar(2, 2, 2, {0.3, 0.3, 0.3});
    spoilt.spoil(mesh);
    expect_refused_or_calm(spoilt.as, [&](World& world) {
      world.add_soft_body(mesh, {.thickness = 0.02f}, with_self_collision());
    });
  }
}

TEST(BadSurfaces, PositionsThatAreNoNumbersAreRefused) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(4, 4, 1), {}, with_self_collision());
  std::vector<Vec3f> positions(16);
  positions[5].x = std::numeric_limits<float>::quiet_NaN();
  try {
    world.set_positions(cloth, positions);
    FAIL() << "they were taken";
  } catch (const Error& error) {
    expect_clear(error.what(), "set_positions");
  }
  // All vertices at one point: accepted.
  world.set_positions(cloth, std::vector<Vec3f>(16, Vec3f{0.1f, 0.2f, 0.3f}));
  for (int frame = 0; frame < 60; ++frame) EXPECT_TRUE(world.step(frame_time).ok());
}

}  // namespace souple::test_world_bad_surfaces
