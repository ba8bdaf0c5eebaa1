#include "souple/objects/kind_functions.h"
#include "souple/souple.h"
#include "tests/expect_error.h"

#include <vector>

#include <gtest/gtest.h>

namespace souple::test_world_kinds {

std::vector<ObjectKind> all_kinds() {
  std::vector<ObjectKind> kinds;
  kinds.reserve(std::variant_size_v<Material>);
  for (std::size_t k = 0; k < std::variant_size_v<Material>; ++k) kinds.push_back(static_cast<ObjectKind>(k));
  return kinds;
}

TEST(Kinds, AreFoundByTheirNames) {
  for (const ObjectKind kind : all_kinds()) EXPECT_EQ(find_kind(kind_name(kind)), kind);
  EXPECT_EQ(kind_name(ObjectKind::cloth), "cloth");
  EXPECT_EQ(kind_name(ObjectKind::fluid), "fluid");
  EXPECT_FALSE(find_kind("fog"));
}

TEST(Kinds, HaveAValidDefaultMaterialOfTheirOwn) {
  for (const ObjectKind kind : all_kinds()) {
    const Material material = functions_of(kind).default_material();
    EXPECT_EQ(kind_of(material), kind);
    EXPECT_NO_THROW(validate(material, "default"));
    EXPECT_GT(contact_radius(material), 0);
    EXPECT_GT(particle_radius(material), 0);
  }
}

TEST(Kinds, EachPresetBelongsToOne) {
  for (const std::string& name : material::names()) {
    std::size_t found = 0;
    for (const ObjectKind kind : all_kinds()) {
      const auto find = functions_of(kind).find_preset;
      if (find == nullptr || !find(name)) continue;
      ++found;
      EXPECT_EQ(kind_of(*find(name)), kind) << name;
    }
    EXPECT_EQ(found, 1u) << name;
  }
}

TEST(Kinds, AWorldTakesAndGivesMaterialsOfAnyKind) {
  World world;
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0}};
  const ObjectId cloth = world.add_cloth(grid(3, 3, 1)), rope = world.add_rope(points, 4);
  const Material silk = material::silk;
  world.set_material(cloth, silk);
  EXPECT_EQ(std::get<ClothMaterial>(world.material(cloth)).areal_density, material::silk.areal_density);
  EXPECT_EQ(world.cloth_material(cloth).thickness, material::silk.thickness);
  EXPECT_TRUE(std::holds_alternative<RopeMaterial>(world.material(rope)));
  expect_error([&] { world.set_material(rope, silk); }, {"rope", "kind"});
}

}  // namespace souple::test_world_kinds
