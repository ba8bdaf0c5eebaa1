// The keys of rigid bodies.
#include "scene_test.h"
#include "souple/world/world.h"
#include "tests/expect_error.h"

namespace souple::scene_test::test_scene_rigid_body {

World built(const std::string& keys) {
  return build_world(parse_scene(with_object(R"("name": "body", "kind": "rigid_body", )" + keys),
                                 scenes_folder(), "test.json"));
}

RigidBodyState state_of(const World& world) {
  return world.rigid_body(world.find_object("body"));
}

std::string message(const std::string& keys) {
  return error_message(with_object(R"("name": "body", "kind": "rigid_body", )" + keys));
}

const std::string ball = R"("shape": {"sphere": {"radius": 0.1}})";

TEST(SceneRigidBody, MassCenterAndInertiaAreGiven) {
  const RigidBodyState state = state_of(
      built(ball + R"(, "transform": {"translate": [1, 2, 3]}, "mass": 3, "center_of_mass": [0, -0.05, 0],
                             "inertia": [0.01, 0.02, 0.025])"));
  EXPECT_NEAR(state.mass, 3, 1e-12);
  EXPECT_LT(length(state.pose.translation - Vec3d{1, 1.95, 3}), 1e-9);
  EXPECT_NEAR(state.inertia.x, 0.01, 1e-12);
  EXPECT_NEAR(state.inertia.y, 0.02, 1e-12);
  EXPECT_NEAR(state.inertia.z, 0.025, 1e-12);
}

TEST(SceneRigidBody, SeveralShapesAreOneBody) {
  const RigidBodyState state = state_of(built(R"("shapes": [
      {"shape": {"box": {"half_extents": [0.1, 0.1, 0.1]}}, "density": 500},
      {"shape": {"box": {"half_extents": [0.1, 0.1, 0.1]}}, "transform": {"translate": [0.2, 0, 0]}}],
      "material": {"density": 1500})"));
  EXPECT_NEAR(state.mass, 4 + 12, 1e-5);
  EXPECT_NEAR(state.pose.translation.x, 0.15, 1e-7);
}

TEST(SceneRigidBody, KeyframesMoveAKinematicOne) {
  World world = built(ball + R"(, "kinematic": true,
      "keyframes": [{"time": 0, "translate": [0, 0, 0]}, {"time": 1, "translate": [2, 0, 0]}])");
  EXPECT_TRUE(world.is_kinematic(world.find_object("body")));
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  EXPECT_NEAR(state_of(world).pose.translation.x, 1, 1e-9);
  World stands = built(ball + R"(, "kinematic": true)");
  for (int frame = 0; frame < 30; ++frame) stands.step(1.0 / 60);
  EXPECT_EQ(state_of(stands).pose.translation.y, 0);
}

TEST(SceneRigidBody, WhatIsWrittenIsRead) {
  const std::string text =
      with_object(R"("name": "body", "kind": "rigid_body", "shapes": [{"shape": {"sphere": {"radius": 0.1}},
      "transform": {"translate": [1, 0, 0]}, "density": 20}], "mass": 2, "inertia": [1, 1, 1], "kinematic": true)");
  const std::string once = to_json(parse_scene(text, scenes_folder(), "test.json"));
  EXPECT_NE(once.find("\"shapes\""), std::string::npos);
  EXPECT_EQ(to_json(parse_scene(once, scenes_folder(), "test.json")), once);
}

TEST(SceneRigidBody, ErrorsNameTheKey) {
  const auto expect_words = [](const std::string& text, std::initializer_list<std::string> words) {
    for (const std::string& word : words)
      EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is missing in: " << text;
  };
  expect_words(message(ball + R"(, "keyframes": [{"time": 0}])"), {"kinematic"});
  expect_words(message(ball + R"(, "kinematic": false, "keyframes": [{"time": 0}])"), {"kinematic", "true"});
  expect_words(message(ball + R"(, "mass": 0)"), {"mass", "0"});
  expect_words(message(R"("shapes": [])"), {"shapes"});
  expect_words(message(ball + R"(, "shapes": [{"shape": {"sphere": {"radius": 1}}}])"), {"shape"});
  expect_error([&] { built(ball + R"(, "inertia": [1, 1, 5])"); }, {"body", "inertia"});
}

}  // namespace souple::scene_test::test_scene_rigid_body
