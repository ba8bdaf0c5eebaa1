#include "souple/souple.h"
#include "tests/physics/validation.h"

#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Kelvin-Voigt damping does not soften a material that one iteration per substep does not solve.

namespace souple::test_physics_damping {

// Cotton hung by a row, one iteration a substep: the elongation does not depend on the damping.
TEST(Damping, DampedClothHangsAsLongAsAnUndampedOne) {
  const std::string name = "elongation of damped cloth";
  const int n = 30;
  double undamped = 0;
  for (const double tau : {0.0, 0.001, 0.005, 0.05}) {
    World world;
    ClothMaterial cotton = material::cotton;
    cotton.damping_time = static_cast<float>(tau);
    cotton.damping = 3;  // the undamped cloth would still bounce
    TriangleMesh sheet = grid(n, n, 1);
    for (Vec3d& x : sheet.positions) x = {x.x, -x.z, 0};
    const ObjectId cloth = world.add_cloth(sheet, cotton);
    std::vector<std::uint32_t> row(n);
    std::iota(row.begin(), row.end(), 0u);
    world.pin(cloth, vertices(row));
    for (int frame = 0; frame < 360; ++frame) world.step(1.0 / 60);
    const auto x = world.positions(cloth);
    const double elongation = static_cast<double>(x[n / 2].y - x[n * (n - 1) + n / 2].y) - 1;
    if (tau == 0) {
      undamped = elongation;
    } else {
      validate_relative(name,
                        "tau = " + std::to_string(static_cast<int>(1000 * tau)) + " ms, against none [m]",
                        elongation, undamped, 0.02);
    }
  }
}

// Five cubes of 20 cm that stand without damping also stand with it.
TEST(Damping, StackOfDampedCubesStands) {
  World world;
  world.add_collider(Plane{});
  TetMesh cube = tet_bar(4, 4, 4, {0.2, 0.2, 0.2});
  for (Vec3d& x : cube.positions) x.y += 0.102;
  std::vector<ObjectId> cubes;
  for (int i = 0; i < 5; ++i) {
    cubes.push_back(
        world.add_soft_body(cube, {.young_modulus = 1e6f, .density = 1000, .damping_time = 0.005f}));
    for (Vec3d& x : cube.positions) x.y += 0.202;
  }
  for (int frame = 0; frame < 240; ++frame) world.step(1.0 / 60);
  for (std::size_t i = 0; i < 5; ++i) {
    double height = 0;
    const auto x = world.positions(cubes[i]);
    for (const Vec3f& p : x) height += static_cast<double>(p.y) / static_cast<double>(x.size());
    EXPECT_NEAR(height, 0.1 + 0.2 * static_cast<double>(i), 0.01) << "cube " << i;
  }
}

}  // namespace souple::test_physics_damping
