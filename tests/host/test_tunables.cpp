#include "souple/host/material_tunables.h"
#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace souple::host::test_host_tunables {

TEST_F(LargeCloth, ParametersAreThoseOfTheMaterial) {
  const std::vector<Parameter> parameters = s.parameters(cloth);
  ASSERT_FALSE(parameters.empty());
  for (const Parameter& p : parameters) {
    EXPECT_LT(p.least, p.most) << p.name;
    EXPECT_TRUE(!p.logarithmic || p.least > 0) << p.name;
    EXPECT_TRUE(p.value == 0 || (p.value >= p.least * 0.999 && p.value <= p.most)) << p.name;
    s.set_parameter(cloth, p.name, std::sqrt(std::max(p.least, 1e-6) * p.most));
  }
  EXPECT_EQ(parameters[0].name, "areal_density");
  EXPECT_EQ(parameters[0].unit, "kg/m\xc2\xb2");
  const auto has = [&](const char* name) {
    const std::vector<Parameter> now = s.parameters(cloth);
    return std::any_of(now.begin(), now.end(), [&](const Parameter& p) { return p.name == name; });
  };
  EXPECT_FALSE(has("pbd_stretch"));
  s.set_mode("pbd");
  EXPECT_TRUE(has("pbd_stretch"));
  s.set_preset(cloth, "denim");
  EXPECT_FLOAT_EQ(static_cast<float>(s.parameters(cloth)[0].value), material::denim.areal_density);
  const std::vector<std::string> presets = s.presets(cloth);
  EXPECT_NE(std::find(presets.begin(), presets.end(), "cotton"), presets.end());
  EXPECT_EQ(std::find(presets.begin(), presets.end(), "jelly"), presets.end());
  expect_error([&] { s.set_parameter(cloth, "areal_densty", 1); }, {"areal_densty", "areal_density"});
  expect_error([&] { s.set_parameter(cloth, "areal_density", -1); }, {"cloth", "areal_density"});
  expect_error([&] { s.set_parameter(cloth, "friction", std::nan("")); }, {"cloth", "friction"});
  expect_error([&] { s.set_preset(cloth, "jelly"); }, {"jelly", "cloth"});
  expect_error([&] { s.set_mode("xpdb"); }, {"xpdb", "xpbd"});
  expect_error([&] { s.set_substeps(0); }, {"substeps"});
  EXPECT_EQ(s.substeps(), 10);
}

TEST(Session, SettingsAreThoseThatWereSet) {
  Session s;
  s.set_substeps(7);
  s.set_iterations(3);
  s.set_gravity(1, -2, 3);
  for (const std::string& mode : Session::modes()) {
    s.set_mode(mode);
    EXPECT_EQ(s.mode(), mode);
  }
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(s.substeps(), 7);
    EXPECT_EQ(s.iterations(), 3);
    EXPECT_EQ(s.gravity(), (std::array<float, 3>{1, -2, 3}));
    EXPECT_EQ(s.mode(), Session::modes().back());
    s.reset();
  }
  expect_error([&] { s.set_gravity(nan, 0, 0); }, {"gravity"});
  expect_error([&] { s.set_iterations(0); }, {"iterations"});
  EXPECT_EQ(s.gravity()[0], 1);
  s.clear();
  EXPECT_EQ(s.substeps(), 10);
}

TEST(Session, StatisticsAreOfTheLastStep) {
  Player host;
  host.session.open_scene(scenes + "sand_pile.json");
  host.play(2);
  const Statistics statistics = host.session.statistics();
  EXPECT_EQ(statistics.steps, 2u);
  EXPECT_NEAR(statistics.time, 2 * dt, 1e-12);
  EXPECT_GT(statistics.particles, 100u);
  EXPECT_GT(statistics.milliseconds, 0);
  EXPECT_EQ(statistics.stages.size(), stage_count);
  EXPECT_NE(statistics.text().find("step 2"), std::string::npos);
}

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

}  // namespace souple::host::test_host_tunables
