#include "souple/geometry/adjacency.h"
#include "tests/expect_error.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_materials {

// An object that was given another material, or came while others were there, moves as if the world had been built so.

constexpr double frame = 1.0 / 60;

ObjectId add_sheet(World& world, const ClothMaterial& material, double height, const std::string& name = {}) {
  // An irregular mesh: colors of a regular one leave nothing to improve.
  return world.add_cloth(sphere(3, 0.3), material,
                         {.name = name, .transform = {.translation = {0, height, 0}}});
}

/// Builds a world with an object of the first (false) or the second material, and changes it to the second.
struct Case {
  std::string name;
  std::function<ObjectId(World&, bool second)> add;
  std::function<void(World&, ObjectId)> change;
};

template <class M>
Case sheet_case(const std::string& name, const M& first, const M& second) {
  return {name,
          [=](World& world, bool is_second) { return add_sheet(world, is_second ? second : first, 0.6); },
          [=](World& world, ObjectId id) { world.set_material(id, second); }};
}

std::vector<Case> cases() {
  ClothMaterial springs, stiffer, membrane, dihedral, distance, with_friction, thick;
  stiffer.membrane_stiffness = 9000, stiffer.bending_stiffness = 3e-4f, stiffer.damping_time = 1e-3f;
  membrane.stretch = StretchModel::membrane, membrane.shear_stiffness = 500;
  dihedral.bending = BendingModel::dihedral;
  distance.bending = BendingModel::distance, distance.bending_stiffness = 1e-3f;
  with_friction.friction = 0.9f, with_friction.kinetic_friction = 0.5f;
  thick.thickness = 0.02f;
  ClothMaterial soft_membrane = membrane, no_bending = springs;
  soft_membrane.membrane_stiffness = 800, soft_membrane.poisson_ratio = 0.1f;
  no_bending.bending = BendingModel::none;
  std::vector<Case> all{sheet_case("springs", springs, stiffer),
                        sheet_case("springs to membrane", springs, membrane),
                        sheet_case("membrane to springs", soft_membrane, stiffer),
                        sheet_case("membrane", membrane, soft_membrane),
                        sheet_case("isometric to dihedral", springs, dihedral),
                        sheet_case("dihedral to distance", dihedral, distance),
                        sheet_case("distance to none", distance, no_bending),
                        sheet_case("none to isometric", no_bending, stiffer),
                        sheet_case("friction", springs, with_friction),
                        sheet_case("thickness", springs, thick)};
  const auto add_body = [&](const std::string& name, const SoftBodyMaterial& first,
                            const SoftBodyMaterial& second) {
    all.push_back({name,
                   [=](World& world, bool is_second) {
                     return world.add_soft_body(sphere(2, 0.3), is_second ? second : first, {.cells = 150},
                                                at(0, 0.6, 0));
                   },
                   [=](World& world, ObjectId id) { world.set_material(id, second); }});
  };
  SoftBodyMaterial soft, firm, tet_springs, region, loose_region;
  firm.young_modulus = 4e5f, firm.poisson_ratio = 0.3f;
  tet_springs.model = SoftBodyModel::springs;
  region.model = loose_region.model = SoftBodyModel::shape_matching;
  loose_region.young_modulus = 2e3f;
  add_body("tets", soft, firm);
  add_body("tets to springs", soft, tet_springs);
  add_body("springs to region", tet_springs, region);
  add_body("region", region, loose_region);
  add_body("region to tets", region, firm);
  RopeMaterial limp, stiff;
  stiff.bending_stiffness = 0.01f, stiff.young_modulus = 5e6f;
  const auto add_rope = [&](const std::string& name, const RopeMaterial& first, const RopeMaterial& second) {
    all.push_back({name,
                   [=](World& world, bool is_second) {
                     const std::vector<Vec3d> points{{-0.5, 0.5, 0}, {0.5, 0.6, 0.1}};
                     return world.add_rope(points, 40, is_second ? second : first);
                   },
                   [=](World& world, ObjectId id) { world.set_material(id, second); }});
  };
  add_rope("limp rope to stiff", limp, stiff);
  add_rope("stiff rope to limp", stiff, limp);
  return all;
}

/// With objects before and after the one that changes, of the same kinds of constraints.
World surroundings(const Case& of, bool second, ObjectId* id) {
  World world({.substeps = 3});
  world.add_collider(Plane{});
  add_sheet(world, {}, 1.3, "before");
  const ObjectId added = of.add(world, second);
  if (id != nullptr) *id = added;
  world.add_soft_body(sphere(2, 0.2), {}, {.cells = 100}, at(0.1, 2, 0));
  world.add_rope(std::vector<Vec3d>{{-0.5, 2.5, 0}, {0.5, 2.6, 0.1}}, 20, {});
  return world;
}

TEST(Changes, AnotherMaterialIsThatFromTheStart) {
  for (const Case& of : cases()) {
    ObjectId id{};
    World changed = surroundings(of, false, &id);
    static_cast<void>(changed.elastic_energy());  // builds the constraints of the first material
    of.change(changed, id);
    World from_start = surroundings(of, true, nullptr);
    for (int i = 0; i < 10; ++i) {
      changed.step(frame), from_start.step(frame);
      ASSERT_EQ(changed.hash(), from_start.hash()) << of.name << ", frame " << i;
    }
    EXPECT_EQ(changed.elastic_energy(), from_start.elastic_energy()) << of.name;
  }
}

TEST(Changes, AnotherMaterialInTheMiddleResumesBitwise) {
  for (const Case& of : cases()) {
    ObjectId id{};
    World changed = surroundings(of, false, &id);
    for (int i = 0; i < 15; ++i) changed.step(frame);
    of.change(changed, id);
    World resumed = surroundings(of, true, nullptr);
    resumed.restore(changed.snapshot());
    for (int i = 0; i < 6; ++i) {
      changed.step(frame), resumed.step(frame);
      ASSERT_EQ(changed.hash(), resumed.hash()) << of.name << ", frame " << i;
    }
  }
}

TEST(Changes, LevelsOfALargeClothTakeAnotherStiffness) {
  ClothMaterial first = material::cotton, second = material::cotton;
  second.membrane_stiffness = 300, second.bending_stiffness = 1e-3f;
  const auto make = [](const ClothMaterial& m, ObjectId* id) {
    World world;
    const ObjectId cloth = world.add_cloth(grid(40, 40, 1), m);
    world.pin(cloth, vertices({0, 39}));
    if (id != nullptr) *id = cloth;
    return world;
  };
  ObjectId id{};
  World changed = make(first, &id), from_start = make(second, nullptr);
  static_cast<void>(changed.elastic_energy());
  changed.set_material(id, second);
  for (int i = 0; i < 30; ++i) {
    changed.step(frame), from_start.step(frame);
    ASSERT_EQ(changed.hash(), from_start.hash()) << "frame " << i;
  }
}

TEST(Changes, OthersDoNotChangeTheOrderInWhichAnObjectIsSolved) {
  World alone({.substeps = 3}), together({.substeps = 3});
  const ObjectId one = add_sheet(alone, {}, 1);
  alone.pin(one, vertices({0}));
  const ObjectId other = add_sheet(together, {}, 1);
  together.pin(other, vertices({0}));
  for (int i = 0; i < 5; ++i) together.add_cloth(grid(7, 7, 0.3f), {}, at(5, i + 1.0, 0));
  for (int i = 0; i < 30; ++i) {
    alone.step(frame), together.step(frame);
    const auto x = alone.positions(one), y = together.positions(other);
    for (std::size_t v = 0; v < x.size(); ++v)
      ASSERT_EQ(length(x[v] - y[v]), 0) << "frame " << i << ", " << v;
  }
}

TEST(Changes, RemovedAndAddedObjectsLeaveNoTrace) {
  const auto rest = [](World& world) {
    add_sheet(world, {}, 0.6, "sheet");
    world.add_rope(std::vector<Vec3d>{{-0.5, 2.5, 0}, {0.5, 2.6, 0.1}}, 20, {}, {.name = "rope"});
  };
  World changed({.substeps = 3}), from_start({.substeps = 3});
  const ObjectId first = add_sheet(changed, {}, 3);
  rest(changed);
  static_cast<void>(changed.elastic_energy());
  changed.remove(first);
  static_cast<void>(changed.elastic_energy());
  const ObjectId short_lived = add_sheet(changed, {}, 3);
  changed.add_soft_body(sphere(2, 0.2), {}, {.cells = 100},
                        {.name = "body", .transform = {.translation = {0, 2, 0}}});
  changed.set_material(short_lived, material::denim);
  changed.remove(short_lived);
  rest(from_start);
  from_start.add_soft_body(sphere(2, 0.2), {}, {.cells = 100},
                           {.name = "body", .transform = {.translation = {0, 2, 0}}});
  for (int i = 0; i < 30; ++i) {
    changed.step(frame), from_start.step(frame);
    ASSERT_EQ(changed.hash(), from_start.hash()) << "frame " << i;
  }
}

// Comparison of the bending models at the level of the API: from a material to energies and motion.

constexpr double stiffness = 0.01;  // D [N m]
constexpr double side = 0.3;        // m
const double height = std::sqrt(0.75) * side;

/// Two equilateral triangles with a common edge along X, the second folded up by theta.
std::vector<Vec3f> folded(double theta) {
  return {{0, 0, 0},
          {static_cast<float>(side), 0, 0},
          {static_cast<float>(side / 2), 0, static_cast<float>(-height)},
          {static_cast<float>(side / 2), static_cast<float>(height * std::sin(theta)),
           static_cast<float>(height * std::cos(theta))}};
}

TriangleMesh hinge() {
  TriangleMesh mesh;
  for (const Vec3f& x : folded(0)) mesh.positions.emplace_back(x);
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

/// Energy relative to that of a hinge, D/2 |e|^2 / (A2 + A3) theta^2.
double relative_energy(BendingModel model, double theta) {
  World world;
  const ObjectId cloth = world.add_cloth(
      hinge(),
      {.membrane_stiffness = 100, .bending_stiffness = static_cast<float>(stiffness), .bending = model});
  world.set_positions(cloth, folded(theta));
  return world.elastic_energy() / (0.5 * stiffness * side * side / (height * side) * theta * theta);
}

TEST(Bending, ModelsStoreTheSameEnergyAtOneRadian) {
  EXPECT_NEAR(relative_energy(BendingModel::dihedral, 1), 1, 1e-3);
  EXPECT_NEAR(relative_energy(BendingModel::isometric, 1), 1, 0.1);
  EXPECT_NEAR(relative_energy(BendingModel::distance, 1), 1, 0.1);
}

TEST(Bending, AcrossEdgesIsLimpWhileFlat) {
  EXPECT_NEAR(relative_energy(BendingModel::distance, 0.1), 0.01, 0.001);
  EXPECT_GT(relative_energy(BendingModel::distance, 1.8), 2);
}

TEST(Bending, DistancesAreOneKindWithTheEdges) {
  World world({.substeps = 1});
  const TriangleMesh mesh = grid(20, 20, 1);
  world.add_cloth(mesh, {.bending = BendingModel::distance});
  const StepReport& report = world.step(0.01);
  ASSERT_EQ(report.kinds.size(), 1u);
  EXPECT_EQ(report.kinds[0].kind, "distance");
  EXPECT_EQ(report.kinds[0].count,
            unique_edges(mesh.triangles).size() + interior_edges(mesh.triangles).size());
}

/// The first triangle is pinned: largest drop of the tip of the second within a second.
double fall(const ClothMaterial& material) {
  World world({.substeps = 50});
  const ObjectId cloth = world.add_cloth(hinge(), material);
  world.pin(cloth, vertices({0, 1, 2}));
  double lowest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(1.0 / 60);
    lowest = std::min(lowest, static_cast<double>(world.positions(cloth)[3].y));
  }
  EXPECT_LT(world.report().largest_strain, 1e-4);
  return -lowest;
}

TEST(Bending, RigidDistancesHoldAFlapUp) {
  ClothMaterial material;
  material.bending = BendingModel::distance;
  material.membrane_stiffness = material.bending_stiffness = rigid;
  EXPECT_LT(fall(material), 0.05 * height);
  material.bending_stiffness = 0;
  EXPECT_GT(fall(material), 0.9 * height);
}

TEST(Bending, OnlyDistancesCanBeRigid) {
  World world;
  const auto add = [&](const ClothMaterial& material) { world.add_cloth(grid(3, 3, 1), material); };
  expect_error([&] { add({.bending_stiffness = rigid}); }, {"bending_stiffness", "inf"});
  expect_error([&] { add({.membrane_stiffness = rigid, .stretch = StretchModel::membrane}); },
               {"membrane_stiffness", "inf"});
  EXPECT_TRUE(world.objects().empty());
}

// ObjectReport: how far the forces of an object are out of balance, and Flag::not_converged.

constexpr double dt = 1.0 / 60;
constexpr int measured_every = 16;  // steps

/// 1 m of cotton that hangs by its upper row.
World hanging(int n, const Settings& settings) {
  World world(settings);
  TriangleMesh mesh = grid(n, n, 1.0);
  for (Vec3d& x : mesh.positions) x = {x.x, -x.z, 0};
  const ObjectId cloth = world.add_cloth(mesh, material::cotton, {.name = "sheet"});
  std::vector<std::uint32_t> row(static_cast<std::size_t>(n));
  std::iota(row.begin(), row.end(), 0u);
  world.pin(cloth, vertices(row));
  return world;
}

/// A bar of 3 x 12 x 3 cells, 1 m long, that hangs by its upper end.
World hanging_bar(float young_modulus, const Settings& settings) {
  World world(settings);
  const TetMesh mesh = tet_bar(3, 12, 3, {0.25, 1, 0.25});
  const ObjectId bar = world.add_soft_body(mesh, {.young_modulus = young_modulus, .poisson_ratio = 0.3f});
  std::vector<std::uint32_t> top;
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
    if (mesh.positions[i].y > 0.499) top.push_back(i);
  world.pin(bar, vertices(top));
  return world;
}

/// Largest `unbalanced` of any object after any step, and the number of flagged steps.
struct Watched {
  double unbalanced = 0;
  int flagged = 0;

  Watched(World& world, int steps) {
    for (int i = 0; i < steps; ++i) {
      const StepReport& report = world.step(dt);
      EXPECT_FALSE(report.objects.empty());
      for (const ObjectReport& object : report.objects) unbalanced = std::max(unbalanced, object.unbalanced);
      flagged += report.has(Flag::not_converged) ? 1 : 0;
    }
  }
};

constexpr SolverSettings plain{.kind = SolverKind::gauss_seidel};

// Plain sweeps leave it 13 % too long: 700 times the strain that its weight explains.
TEST(Balance, AClothThatHasNotConvergedIsNamed) {
  World world = hanging(100, {.solver = plain, .threads = 2});
  for (int i = 0; i < 4 * measured_every; ++i) world.step(dt);
  const StepReport& report = world.report();
  ASSERT_EQ(report.objects.size(), 1u);
  EXPECT_EQ(report.objects[0].name, "sheet");
  EXPECT_GT(report.objects[0].unbalanced, 0.9);
  EXPECT_GT(report.objects[0].stretch, 0.01);
  EXPECT_TRUE(report.has(Flag::not_converged));
  EXPECT_NE(report.message.find("sheet: the solver has not converged"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find("automatic"), std::string::npos);
}

TEST(Balance, TheDefaultSolverConverges) {
  World world = hanging(100, {.threads = 2});
  EXPECT_EQ(Watched(world, 4 * measured_every).flagged, 0);
  EXPECT_LT(world.report().objects[0].unbalanced, 0.6);
  EXPECT_LT(world.report().objects[0].stretch, 5e-4);
}

// A soft bar falls into its load, stretches threefold and swings: each substep is solved nearly exactly.
TEST(Balance, AConvergedBodyIsInBalanceInMotion) {
  World world = hanging_bar(1e4f, {.threads = 2});
  EXPECT_LT(Watched(world, 60).unbalanced, 0.002);
}

TEST(Balance, AStiffBarIsSweptTooLittle) {
  World few = hanging_bar(1e7f, {.solver = plain, .threads = 2});
  EXPECT_GT(Watched(few, 64).flagged, 20);  // hangs three times as far as it should
  EXPECT_GT(few.report().objects[0].unbalanced, 0.3);
  World enough = hanging_bar(1e7f, {.threads = 2});
  const Watched watched(enough, 64);
  EXPECT_EQ(watched.flagged, 0);
  EXPECT_LT(watched.unbalanced, 0.05);
}

// The floor carries the block: what contacts move is no elastic force.
TEST(Balance, ContactsDoNotCountAsElasticForces) {
  World world({.threads = 2});
  world.add_soft_body(tet_bar(4, 4, 4, {0.5, 0.5, 0.5}), {.young_modulus = 1e5f, .damping = 5},
                      {.transform = {.translation = {0, 0.26, 0}}});
  world.add_collider(Plane{});
  for (int i = 0; i < 150; ++i) world.step(dt);
  ASSERT_GT(world.report().contacts, 0u);
  EXPECT_LT(world.report().objects[0].unbalanced, 0.05);
  EXPECT_GT(world.report().objects[0].unbalanced, 0);
}

TEST(Balance, IsMeasuredOnRequestOnlyAndNeverInfluencesTheWorld) {
  World with = hanging(30, {.threads = 2}), without = hanging(30, {.measure_residuals = false, .threads = 2});
  World pbd = hanging(10, {.mode = Mode::pbd});
  for (int i = 0; i < 40; ++i) {
    with.step(dt);
    without.step(dt);
    pbd.step(dt);
  }
  EXPECT_EQ(with.report().objects.size(), 1u);
  EXPECT_TRUE(without.report().objects.empty());
  EXPECT_TRUE(pbd.report().objects.empty());
  EXPECT_EQ(with.hash(), without.hash());
}

TEST(Balance, ObjectsComeAndGo) {
  World world = hanging(12, {.threads = 1});
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 2, 0}, {1, 2, 0}, {2, 2, 0}}, 20);
  world.add_grains(std::vector<Vec3d>{{0, 9, 0}});
  for (int i = 0; i < 20; ++i) world.step(dt);
  ASSERT_EQ(world.report().objects.size(), 2u);
  EXPECT_EQ(world.report().objects[1].name, world.name(rope));
  world.remove(rope);
  for (int i = 0; i < 20; ++i) world.step(dt);
  ASSERT_EQ(world.report().objects.size(), 1u);
}

}  // namespace souple::test_world_materials
