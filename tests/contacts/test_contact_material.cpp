#include "souple/contacts/contact_material.h"
#include "souple/error.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test_contacts_contact_material {

TEST(ContactMaterial, GeometricMeanOfFrictionsAndLargerRestitution) {
  const ContactMaterialPair pair = combine({0.9f, 0.4f, 0.1f}, {0.4f, std::nullopt, 0.7f});
  EXPECT_FLOAT_EQ(pair.static_friction, 0.6f);
  EXPECT_FLOAT_EQ(pair.kinetic_friction, 0.4f);
  EXPECT_FLOAT_EQ(pair.restitution, 0.7f);
  EXPECT_EQ(combine({0, std::nullopt, 0}, {5, std::nullopt, 0}).static_friction, 0);
}

TEST(ContactMaterial, PairOverridesComeFirstInEitherOrder) {
  PairOverrides table;
  table.set("ice", "skate", {0.02f, 0.01f, 0.0f});
  const std::vector<NamedContactMaterial> rows{{"skate", {1, std::nullopt, 0}},
                                               {"shoe", {1, std::nullopt, 0}}};
  const std::vector<NamedContactMaterial> columns{{"ice", {0.25f, std::nullopt, 0.5f}}};
  const ContactMaterialTable matrix(rows, columns, table);
  EXPECT_EQ(matrix.rows(), 2u);
  EXPECT_FLOAT_EQ(matrix.at(0, 0).kinetic_friction, 0.01f);
  EXPECT_FLOAT_EQ(matrix.at(1, 0).static_friction, 0.5f);
}

TEST(ContactMaterial, ATableOfManyObjectsHoldsOnlyPairsThatDeviate) {
  std::vector<std::string> names;
  names.reserve(40);
  for (int k = 0; k < 40; ++k) names.push_back("object" + std::string(1, static_cast<char>('0' + k)));
  std::vector<NamedContactMaterial> all;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const float friction = 0.1f * static_cast<float>(k % 7);
    all.push_back(
        {names[k],
         {friction, k % 3 == 0 ? std::optional(friction / 2) : std::nullopt, k % 5 == 0 ? 0.5f : 0.0f},
         {1u << k % 3, k % 4 == 0 ? 1u : ~0u}});
  }
  PairOverrides overrides;
  overrides.set(names[3], names[17], {0.9f, 0.8f, 0.1f});
  overrides.set(names[5], names[5], {0.7f, 0.6f, 0});
  overrides.set_collide(names[3], names[17], false);
  overrides.set_collide(names[8], names[2], false);
  overrides.set_collide(names[9], names[9], false);
  const ContactMaterialTable table(all, all, overrides);
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = 0; b < all.size(); ++b) {
      const ContactMaterialPair expected = overrides.resolve(all[a], all[b]), pair = table.at(a, b);
      EXPECT_EQ(pair.static_friction, expected.static_friction);
      EXPECT_EQ(pair.kinetic_friction, expected.kinetic_friction);
      EXPECT_EQ(pair.restitution, expected.restitution);
      EXPECT_EQ(table.collide(a, b), overrides.collide(all[a], all[b])) << a << ", " << b;
    }
  std::vector<std::uint32_t> ignored;
  table.for_each_ignored(17, [&](std::uint32_t b) { ignored.push_back(b); });
  EXPECT_EQ(ignored, std::vector<std::uint32_t>{3});
}

TEST(ContactMaterial, BadCoefficientsAreRefused) {
  PairOverrides table;
  EXPECT_THROW(validate(ContactMaterial{-1, std::nullopt, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, 0.3f, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, std::nullopt, 1.5f}, "cloth"), Error);
  EXPECT_THROW(table.set("a", "b", {0.1f, 0.2f, 0}), Error);
  EXPECT_NO_THROW(validate(ContactMaterial{0.2f, 0.1f, 1}, "cloth"));
}

}  // namespace souple::test_contacts_contact_material
