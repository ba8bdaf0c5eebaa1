#include "souple/host/material_tunables.h"

#include <string>

#include <gtest/gtest.h>

namespace souple::host::test_host_material_tunables {

template <class Material>
class MaterialTunables : public testing::Test {};

using Materials = testing::Types<ClothMaterial, SoftBodyMaterial, RopeMaterial, GrainsMaterial, FluidMaterial,
                                 ObstacleMaterial, RigidBodyMaterial>;
TYPED_TEST_SUITE(MaterialTunables, Materials, );

TYPED_TEST(MaterialTunables, SpanWhatIsUsual) {
  const TypeParam material;
  for (const auto& tunable : tunables(material)) {
    SCOPED_TRACE(tunable.name);
    EXPECT_LT(tunable.range.least, tunable.range.most);
    EXPECT_TRUE(!tunable.range.logarithmic || tunable.range.least > 0);
    const float value = material.*tunable.field;
    EXPECT_TRUE(value == 0 || (value >= tunable.range.least && value <= tunable.range.most)) << value;
  }
}

TEST(MaterialTunablesOfCloth, AreShownWhenTheyTurnSomething) {
  ClothMaterial plain, membrane;
  membrane.stretch = StretchModel::membrane;
  for (const Tunable<ClothMaterial>& tunable : tunables(plain)) {
    const std::string name = tunable.name;
    const bool of_pbd = name.rfind("pbd_", 0) == 0;
    const bool of_membrane = name == "weft_stiffness" || name == "shear_stiffness" || name == "poisson_ratio";
    for (const bool pbd : {false, true}) {
      EXPECT_EQ(is_used(tunable, plain, pbd), !of_membrane && (pbd || !of_pbd)) << name;
      EXPECT_EQ(is_used(tunable, membrane, pbd), pbd || !of_pbd) << name;
    }
  }
}

}  // namespace souple::host::test_host_material_tunables
