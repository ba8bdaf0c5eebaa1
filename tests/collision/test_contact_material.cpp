#include "souple/collision/contact_material.h"
#include "souple/error.h"

#include <vector>

#include <gtest/gtest.h>

namespace souple {
namespace {

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

TEST(ContactMaterial, BadCoefficientsAreRefused) {
  PairOverrides table;
  EXPECT_THROW(validate(ContactMaterial{-1, std::nullopt, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, 0.3f, 0}, "cloth"), Error);
  EXPECT_THROW(validate(ContactMaterial{0.2f, std::nullopt, 1.5f}, "cloth"), Error);
  EXPECT_THROW(table.set("a", "b", {0.1f, 0.2f, 0}), Error);
  EXPECT_NO_THROW(validate(ContactMaterial{0.2f, 0.1f, 1}, "cloth"));
}

}  // namespace
}  // namespace souple
