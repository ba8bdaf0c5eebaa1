#include "souple/souple.h"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// An object that was given another material, or came while others were there, moves as if the world had been built so.

namespace souple::test_world_changes {

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
                                                {.transform = {.translation = {0, 0.6, 0}}});
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
  world.add_soft_body(sphere(2, 0.2), {}, {.cells = 100}, {.transform = {.translation = {0.1, 2, 0}}});
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
  for (int i = 0; i < 5; ++i)
    together.add_cloth(grid(7, 7, 0.3f), {}, {.transform = {.translation = {5, i + 1.0, 0}}});
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

}  // namespace souple::test_world_changes
