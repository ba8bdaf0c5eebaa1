#include "souple/host/material_knobs.h"
#include "souple/scene/scene.h"

#include <cmath>
#include <set>
#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace souple::host {
namespace {

template <class Description>
class MaterialKnobs : public testing::Test {};

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
TYPED_TEST_SUITE(MaterialKnobs, Kinds, );

/// Each turns the number that scene files call by its name.
TYPED_TEST(MaterialKnobs, AreNamedAsInSceneFiles) {
  using Description = typename TypeParam::Description;
  std::set<std::string> names;
  for (const auto& knob : knobs(Description{}.material)) {
    SCOPED_TRACE(knob.name);
    EXPECT_TRUE(names.insert(knob.name).second);
    const float value = 0.7f * knob.range.most;
    const std::string text = std::string(R"({"souple": 1, "objects": [{)") + TypeParam::object +
                             R"(, "material": {")" + knob.name + "\": " + std::to_string(value) + "}}]}";
    const SceneDescription scene = parse_scene(text, ".", "knobs");
    const auto& material = std::get<Description>(scene.objects[0]).material;
    EXPECT_NEAR(material.*knob.field, value, 1e-6f * value);
  }
}

TYPED_TEST(MaterialKnobs, SpanWhatIsUsual) {
  const typename TypeParam::Description description{};
  for (const auto& knob : knobs(description.material)) {
    SCOPED_TRACE(knob.name);
    EXPECT_LT(knob.range.least, knob.range.most);
    EXPECT_TRUE(!knob.range.logarithmic || knob.range.least > 0);
    const float value = description.material.*knob.field;
    EXPECT_TRUE(value == 0 || (value >= knob.range.least && value <= knob.range.most)) << value;
  }
}

TEST(MaterialKnobsOfCloth, AreShownWhenTheyTurnSomething) {
  ClothMaterial plain, membrane;
  membrane.stretch = StretchModel::membrane;
  for (const Knob<ClothMaterial>& knob : knobs(plain)) {
    const std::string name = knob.name;
    const bool of_pbd = name.rfind("pbd_", 0) == 0;
    const bool of_membrane = name == "weft_stiffness" || name == "shear_stiffness" || name == "poisson_ratio";
    for (const bool pbd : {false, true}) {
      EXPECT_EQ(is_used(knob, plain, pbd), !of_membrane && (pbd || !of_pbd)) << name;
      EXPECT_EQ(is_used(knob, membrane, pbd), pbd || !of_pbd) << name;
    }
  }
}

}  // namespace
}  // namespace souple::host
