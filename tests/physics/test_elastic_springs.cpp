#include "tests/physics/elastic_case.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <array>
#include <string>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <gtest/gtest.h>

// Sheet properties of a cloth of edge springs, k = Y (A0 + A1) / l^2. Its boundary is stretched uniformly,
// its interior relaxes, and the energy gives the plane stiffness S (3 x 3, of exx, ezz, 2 exz). S^-1 gives
// Young's modulus and Poisson's ratio of a strip cut in any direction. These are measured, not chosen:
// docs/materials.md has the table.

namespace souple::test_physics_elastic_springs {

const std::string sheet_of_springs = "cloth of edge springs as a sheet";
constexpr double Y = 1000, side = 0.2;
constexpr int cells = 12;

enum class Cut { one_diagonal, alternating, irregular };
const char* cut_name(Cut cut) {
  return cut == Cut::one_diagonal ? "one diagonal" : cut == Cut::alternating ? "alternating" : "irregular";
}

/// Irregular: inner vertices moved by up to 0.3 of a cell, each cell split along its shorter diagonal.
TriangleMesh sheet(Cut cut) {
  TriangleMesh mesh = grid(cells + 1, cells + 1, side,
                           cut == Cut::one_diagonal ? Diagonals::one_way : Diagonals::alternating);
  if (cut != Cut::irregular) return mesh;
  std::uint64_t state = 1;
  const auto random = [&] {  // in [-1, 1), Knuth's generator
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 33) / 1073741824.0 - 1;
  };
  mesh.triangles.clear();
  for (Vec3d& x : mesh.positions) {
    const double move = 0.3 * side / cells, a = random(), b = random();
    if (std::max(std::fabs(x.x), std::fabs(x.z)) < side / 2 - 1e-9) x = x + Vec3d{a * move, 0, b * move};
  }
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, d = a + cells + 1, c = d + 1;
      const auto& x = mesh.positions;
      if (length(x[a] - x[c]) < length(x[b] - x[d])) {
        mesh.triangles.push_back({a, d, c}), mesh.triangles.push_back({a, c, b});
      } else {
        mesh.triangles.push_back({a, d, b}), mesh.triangles.push_back({b, d, c});
      }
    }
  return mesh;
}

/// Energy per area of the sheet under the strain (exx, ezz, 2 exz), 0.2 % large.
double energy_density(const TriangleMesh& mesh, const std::array<double, 3>& strain) {
  const double cell = side / cells, density = 0.1, speed = std::sqrt(Y / density);
  World world(static_case(20, 2, 3 * speed / side));
  const ObjectId cloth = world.add_cloth(mesh, {.areal_density = static_cast<float>(density),
                                                .membrane_stiffness = static_cast<float>(Y),
                                                .bending = BendingModel::none});
  std::vector<Vec3f> moved;
  std::vector<std::uint32_t> boundary;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d& x = mesh.positions[v];
    moved.push_back(Vec3f(
        Vec3d{x.x + strain[0] * x.x + strain[2] / 2 * x.z, 0, x.z + strain[1] * x.z + strain[2] / 2 * x.x}));
    if (std::max(std::fabs(x.x), std::fabs(x.z)) > side / 2 - 1e-9) boundary.push_back(v);
  }
  world.set_positions(cloth, moved);
  world.pin(cloth, vertices(boundary));
  return settle(world, 20 * 0.1 * cell / speed, 2, [&] { return world.elastic_energy(); }) / (side * side);
}

struct Modulus {
  double young, poisson;
};

struct Sheet {
  Eigen::Matrix3d compliance;  // of (exx, ezz, 2 exz)

  Modulus at(double degrees) const {
    const double c = std::cos(degrees * pi / 180), s = std::sin(degrees * pi / 180);
    const Eigen::Vector3d along(c * c, s * s, c * s), across(s * s, c * c, -c * s);
    const double stretch = along.dot(compliance * along);
    return {1 / stretch, -across.dot(compliance * along) / stretch};
  }
};

Sheet measure(Cut cut) {
  const TriangleMesh mesh = sheet(cut);
  const double e = 0.002;
  Eigen::Matrix3d stiffness;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      // W(a + b) - W(a) - W(b) = a S b; with both signs of the strain, so that the springs' third order
      // cancels.
      double sum = 0;
      for (const double sign : {1.0, -1.0}) {
        std::array<double, 3> a{}, b{}, both{};
        a[static_cast<std::size_t>(i)] = b[static_cast<std::size_t>(j)] = sign * e;
        for (std::size_t k = 0; k < 3; ++k) both[k] = a[k] + b[k];
        sum += i == j ? 2 * energy_density(mesh, a)
                      : energy_density(mesh, both) - energy_density(mesh, a) - energy_density(mesh, b);
      }
      stiffness(i, j) = stiffness(j, i) = sum / (2 * e * e);
    }
  return {stiffness.inverse()};
}

// The grids are sums of springs along a few directions, so their S is exact:
//   one diagonal  S = Y (5/4 1/4 1/4; 1/4 5/4 1/4; 1/4 1/4 1/4), the diagonal at 45 degrees;
//   alternating   S = Y (5/4 1/4 0; 1/4 5/4 0; 0 0 1/4).
struct Expected {
  Cut cut;
  double degrees, young, poisson;  // Young's modulus over Y
};
constexpr Expected grids[] = {
    {Cut::one_diagonal, 0, 1, 0},      {Cut::one_diagonal, 90, 1, 0},
    {Cut::one_diagonal, 45, 1, 1},     {Cut::one_diagonal, 135, 1. / 3, 1. / 3},
    {Cut::alternating, 0, 1.2, 0.2},   {Cut::alternating, 90, 1.2, 0.2},
    {Cut::alternating, 45, 0.75, 0.5}, {Cut::alternating, 135, 0.75, 0.5},
};

Sheet exact(Cut cut) {
  Eigen::Matrix3d stiffness;
  if (cut == Cut::one_diagonal) {
    stiffness << 1.25, 0.25, 0.25, 0.25, 1.25, 0.25, 0.25, 0.25, 0.25;
  } else {
    stiffness << 1.25, 0.25, 0, 0.25, 1.25, 0, 0, 0, 0.25;
  }
  return {stiffness.inverse() / Y};
}

/// Young's modulus over Y, in all directions.
void draw(const std::string& series, const Sheet& sheet, int every, Curves& curves) {
  for (int degrees = 0; degrees <= 180; degrees += every)
    curves.add(series, degrees, sheet.at(degrees).young / Y);
}
Curves curves_of_sheets() {
  return {sheet_of_springs, "direction of the pull [degrees]", "Young's modulus / Y"};
}

TEST(Springs, GridsAreStiffAsTheirDirectionsSay) {
  const Sheet one = measure(Cut::one_diagonal), alternating = measure(Cut::alternating);
  Curves curves = curves_of_sheets();
  draw("theory: one diagonal", exact(Cut::one_diagonal), 2, curves);
  draw("theory: alternating", exact(Cut::alternating), 2, curves);
  draw("one diagonal", one, 10, curves);
  draw("alternating", alternating, 10, curves);
  for (const Expected& expected : grids) {
    const Modulus modulus = (expected.cut == Cut::one_diagonal ? one : alternating).at(expected.degrees);
    const std::string of = fmt::format(" at {:g} degrees, {}", expected.degrees, cut_name(expected.cut));
    validate(sheet_of_springs, "Young's modulus over Y" + of, modulus.young / Y, expected.young, 0.01);
    validate(sheet_of_springs, "Poisson's ratio" + of, modulus.poisson, expected.poisson, 0.01);
  }
}

// Irregular meshes are closer to the sheet of the formula, Y and 1/3, than alternating ones: within a third
// in every direction.
TEST(Springs, IrregularMeshesAreNearlyIsotropic) {
  const Sheet sheet = measure(Cut::irregular);
  Curves curves = curves_of_sheets();
  draw("irregular", sheet, 10, curves);
  for (const double degrees : {0.0, 45.0, 90.0, 135.0}) {
    const Modulus modulus = sheet.at(degrees);
    const std::string of = fmt::format(" at {:g} degrees, irregular", degrees);
    validate(sheet_of_springs, "Young's modulus over Y" + of, modulus.young / Y, 1, 1. / 3);
    validate(sheet_of_springs, "Poisson's ratio" + of, modulus.poisson, 1. / 3, 0.2);
  }
}

}  // namespace souple::test_physics_elastic_springs
