#include "souple/host/material_tunables.h"
#include "souple/scene/scene.h"

#include <cmath>
#include <set>
#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace souple::host::test_host_material_tunables {

template <class Description>
class MaterialTunables : public testing::Test {};

struct Cloth {
  using Description = ClothDescription;
  static constexpr const char* object =
      R"("kind": "cloth", "mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}})";
};
struct SoftBody {
  using Description = SoftBodyDescription;
  static constexpr const char* object = R"("kind": "soft_body", "mesh": {"sphere": {"radius": 1}})";
};
struct Rope {
  using Description = RopeDescription;
  static constexpr const char* object = R"("kind": "rope", "points": [[0, 0, 0], [1, 0, 0]])";
};
struct Grains {
  using Description = GrainsDescription;
  static constexpr const char* object = R"("kind": "grains", "grid": {"counts": 2})";
};
struct Obstacle {
  using Description = ObstacleDescription;
  static constexpr const char* object = R"("kind": "obstacle", "mesh": {"sphere": {"radius": 1}})";
};
using Kinds = testing::Types<Cloth, SoftBody, Rope, Grains, Obstacle>;
TYPED_TEST_SUITE(MaterialTunables, Kinds, );

/// Each turns the number that scene files call by its name.
TYPED_TEST(MaterialTunables, AreNamedAsInSceneFiles) {
  using Description = typename TypeParam::Description;
  std::set<std::string> names;
  for (const auto& tunable : tunables(Description{}.material)) {
    SCOPED_TRACE(tunable.name);
    EXPECT_TRUE(names.insert(tunable.name).second);
    const float value = 0.7f * tunable.range.most;
    const std::string text = std::string(R"({"souple": 1, "objects": [{)") + TypeParam::object +
                             R"(, "material": {")" + tunable.name + "\": " + std::to_string(value) + "}}]}";
    const SceneDescription scene = parse_scene(text, ".", "tunables");
    const auto& material = std::get<Description>(scene.objects[0]).material;
    EXPECT_NEAR(material.*tunable.field, value, 1e-6f * value);
  }
}

TYPED_TEST(MaterialTunables, SpanWhatIsUsual) {
  const typename TypeParam::Description description{};
  for (const auto& tunable : tunables(description.material)) {
    SCOPED_TRACE(tunable.name);
    EXPECT_LT(tunable.range.least, tunable.range.most);
    EXPECT_TRUE(!tunable.range.logarithmic || tunable.range.least > 0);
    const float value = description.material.*tunable.field;
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
