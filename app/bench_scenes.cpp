#include "app/bench_scenes.h"

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/fill.h"
#include "souple/scene/nearest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace souple::app {

namespace {

constexpr double side = 2;          // m, of every cloth
constexpr double cell = 0.02;       // m, of every tet mesh
constexpr int small_side = 32;      // vertices along each side of each of many cloths
constexpr int cube_cells = 5;       // along each side of each of many cubes
constexpr double push = 0.5;        // m/s, normal to the sheet: hanging cloths do not stay flat
constexpr double taper_part = 0.2;  // fraction of the height over which stretch_cloths reaches its full width

/// Rigid along edges and across them, by distance constraints alone.
ClothMaterial rigid_material() {
  ClothMaterial material;
  material.membrane_stiffness = rigid;
  material.bending_stiffness = rigid;
  material.bending = BendingModel::distance;
  material.pbd_bending = 1;
  return material;
}

ClothMaterial bending_material(BendingModel bending) {
  ClothMaterial material;
  material.membrane_stiffness = rigid;
  material.bending = bending;
  return material;
}

/// A cloth whose upper row is pinned.
ObjectId add_hanging_cloth(World& world, int size, const ClothMaterial& material, const Vec3d& where = {}) {
  ObjectOptions options;
  options.transform.translation = where;
  options.velocity = {0, 0, static_cast<float>(push)};
  const ObjectId cloth = world.add_cloth(hanging_grid(size), material, options);
  std::vector<std::uint32_t> row(static_cast<std::size_t>(size));
  std::iota(row.begin(), row.end(), 0u);
  world.pin(cloth, vertices(row));
  return cloth;
}

/// Adds the other diagonal of every cell: vertices that lie across the mesh's own diagonal. Other engines
/// call this a shear constraint.
void add_second_diagonals(World& world, ObjectId cloth, int size) {
  const auto n = static_cast<std::uint32_t>(size);
  std::vector<std::pair<VertexRef, VertexRef>> pairs;
  for (const Hinge& hinge : interior_edges(world.triangles(cloth))) {
    const bool diagonal = hinge[0] / n != hinge[1] / n && hinge[0] % n != hinge[1] % n;
    if (diagonal) pairs.push_back({{cloth, hinge[2]}, {cloth, hinge[3]}});
  }
  world.connect(pairs, -1);
}

void build_cloth(World& world, int size) {
  add_hanging_cloth(world, size, rigid_material());
}

// The sheet falls on its edge and folds over itself; measurement starts when it lies in a heap.
void build_heap(World& world, int size) {
  ClothMaterial material;
  material.thickness = 0.35f * static_cast<float>(side) / static_cast<float>(size);
  ObjectOptions options;
  options.self_collision = SelfCollision::surfaces;
  options.transform.rotation = Quatd::from_axis_angle({0, 0, 1}, 1.48);
  options.transform.translation = {0, 0.5 * side + 0.02, 0};
  world.add_cloth(grid(size, size, static_cast<float>(side)), material, options);
  world.add_collider(Plane{});
  for (int frame = 0; frame < 48; ++frame) world.step(1.0 / 60);
}

/// Position of the i-th of `count` objects in rows and columns, `spacing` apart.
Vec3d row_position(int i, int count, double spacing) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(count))), row = i / columns;
  return {spacing * (i % columns), 0, spacing * row};
}

void build_dihedral(World& world, int size) {
  add_second_diagonals(world, add_hanging_cloth(world, size, bending_material(BendingModel::dihedral)), size);
}

void build_isometric(World& world, int size) {
  add_second_diagonals(world, add_hanging_cloth(world, size, bending_material(BendingModel::isometric)),
                       size);
}

void build_membrane(World& world, int size) {
  ClothMaterial material;
  material.stretch = StretchModel::membrane;
  add_hanging_cloth(world, size, material);
}

void build_cloths(World& world, int count) {
  for (int i = 0; i < count; ++i)
    add_hanging_cloth(world, small_side, rigid_material(), row_position(i, count, 1.5 * side));
}

SoftBodyMaterial rubbery() {
  SoftBodyMaterial material;
  material.young_modulus = 1e6f;
  return material;
}

/// A bar of square cross-section, five times as long as thick, pinned at one end.
void build_tets(World& world, int count) {
  const double cells = count / 5.0;
  const int thick = std::max(1, static_cast<int>(std::lround(std::cbrt(cells / 5))));
  const int length = std::max(1, static_cast<int>(std::lround(cells / (thick * thick))));
  const Vec3d size{length * cell, thick * cell, thick * cell};
  const ObjectId bar = world.add_soft_body(tet_bar(length, thick, thick, size), rubbery());
  const auto end = static_cast<float>(-size.x / 2);
  world.pin(bar, in_box({end - 1e-3f, -1e3f, -1e3f}, {end + 1e-3f, 1e3f, 1e3f}));
}

/// Cubes pinned at their upper sides.
void build_cubes(World& world, int count) {
  constexpr double width = cube_cells * cell;
  const TetMesh mesh = tet_bar(cube_cells, cube_cells, cube_cells, {width, width, width});
  for (int i = 0; i < count; ++i) {
    ObjectOptions options;
    options.transform.translation = row_position(i, count, 2 * width);
    const ObjectId cube = world.add_soft_body(mesh, rubbery(), options);
    constexpr float top = static_cast<float>(width / 2);
    world.pin(cube, in_box({-1e4f, top - 1e-3f, -1e4f}, {1e4f, top + 1e-3f, 1e4f}));
  }
}

constexpr double fluid_spacing = 0.05;  // m
constexpr double fluid_step = 0.002;    // s: usual time step of SPH programs at this spacing
constexpr double collapsing = 0.2;      // s: simulated before the measurement starts

void prepare_dam(Settings& settings) {
  settings.substeps = 1;
  settings.fluid.iterations = 5;                     // of Jacobi, after the coarse level
  settings.fluid.kernel = SmoothingShape::wendland;  // the fastest
}

/// A block of water, about n x 2 n x n spacings, at one end of a tank 4 n long. Measurement starts when the front is
/// already moving.
void build_dam(World& world, int particles) {
  const double n = std::max(1.0, std::round(std::cbrt(particles / 2.0)));
  const double a = n * fluid_spacing, height = std::max(1.0, std::round(particles / (n * n))) * fluid_spacing;
  world.add_fluid(fill(Vec3d{0, 0, 0}, Vec3d{a, height, a}, fluid_spacing),
                  {.spacing = static_cast<float>(fluid_spacing), .density = 1000});
  const auto wall = [&](const Vec3f& normal, double offset) {
    world.add_collider(Plane{normal, static_cast<float>(offset)});
  };
  wall({0, 1, 0}, 0);
  wall({1, 0, 0}, 0);
  wall({-1, 0, 0}, -4 * a);
  wall({0, 0, 1}, 0);
  wall({0, 0, -1}, -a);
  for (int i = 0; i < std::lround(collapsing / fluid_step); ++i) world.step(fluid_step);
}

constexpr std::array all_bench_scenes{
    BenchScene{"cloth", "a rigid cloth: distances along its edges and across them", "vertices along a side",
               200, 2, 4000, build_cloth},
    BenchScene{"cloth-dihedral", "a cloth with rigid edges and both diagonals, dihedral bending",
               "vertices along a side", 200, 2, 4000, build_dihedral},
    BenchScene{"cloth-isometric", "a cloth with rigid edges and both diagonals, isometric bending",
               "vertices along a side", 200, 2, 4000, build_isometric},
    BenchScene{"cloth-membrane", "a cloth of membrane triangles with isometric bending",
               "vertices along a side", 200, 2, 4000, build_membrane},
    BenchScene{"tets", "a neo-Hookean bar pinned at one end", "tets, about", 43200, 5, 20000000, build_tets},
    BenchScene{"cloths", "many rigid cloths of 32 x 32 vertices", "cloths", 1000, 1, 10000, build_cloths},
    BenchScene{"cubes", "many neo-Hookean cubes of 5 x 5 x 5 cells", "cubes", 400, 1, 20000, build_cubes},
    BenchScene{"heap", "a cloth of 2 m that fell on its edge and lies in folds", "vertices along a side", 60,
               4, 1000, build_heap, true},
    BenchScene{"dam-break", "a block of water collapses in a tank: steps of 2 ms, 5 iterations", "particles",
               97336, 1000, 4000000, build_dam, false, prepare_dam, fluid_step},
};

/// Stretches one cloth of `size` rows and columns.
void stretch(World& world, ObjectId cloth, double strain) {
  const auto now = world.positions(cloth);
  std::vector<Vec3f> x(now.begin(), now.end());
  const auto size = static_cast<std::size_t>(std::lround(std::sqrt(x.size())));
  const Vec3d middle = (Vec3d(x[0]) + Vec3d(x[size - 1])) * 0.5;
  const double height = length(Vec3d(x[0]) - Vec3d(x[x.size() - size]));
  for (Vec3f& vertex : x) {
    const Vec3d d = Vec3d(vertex) - middle;  // x across, y down from the upper row
    const double across = strain * std::min(1.0, -d.y / (taper_part * height));
    vertex = Vec3f(middle + Vec3d{d.x * (1 + across), d.y * (1 + strain), d.z});
  }
  world.set_positions(cloth, x);
  world.set_velocities(cloth, std::vector<Vec3f>(x.size()));
}

}  // namespace

std::span<const BenchScene> bench_scenes() {
  return all_bench_scenes;
}

const BenchScene& find_bench_scene(const std::string& name) {
  std::vector<std::string> names;
  for (const BenchScene& scene : all_bench_scenes) {
    if (scene.name == name) return scene;
    names.emplace_back(scene.name);
  }
  throw Error("unknown benchmark \"" + name + "\"" + scene_format::suggestion(name, names) +
              "; `souple bench` lists them");
}

TriangleMesh hanging_grid(int size) {
  TriangleMesh mesh = grid(size, size, side);
  for (Vec3d& x : mesh.positions) x = {x.x, -x.z, x.y};
  return mesh;
}

void stretch_cloths(World& world, double strain) {
  for (const ObjectId object : world.objects()) {
    if (world.kind(object) != ObjectKind::cloth)
      throw Error("--residual: " + world.name(object) + " is not a cloth; the residual is its mean strain");
    stretch(world, object, strain);
  }
}

}  // namespace souple::app
