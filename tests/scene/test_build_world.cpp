// A world built from a scene matches its description.
#include "souple/world/world.h"
#include "tests/expect_error.h"
#include "tests/scene/scene_test.h"

#include <algorithm>
#include <cmath>

namespace souple::scene_test::test_scene_build_world {

World built(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return build_world(parse_scene(text, scenes_folder(), "test.json", overrides));
}

/// The error message of building a scene.
std::string build_error(const std::string& text) {
  return error_of([&] { built(text); });
}

TEST(BuildWorld, MakesWhatTheSceneSays) {
  const World world = built(small_scene, {"substeps=4"});
  EXPECT_EQ(world.settings().substeps, 4);
  ASSERT_EQ(world.objects().size(), 4u);
  const ObjectId flag = world.find_object("flag");
  EXPECT_EQ(world.kind(flag), ObjectKind::cloth);
  EXPECT_EQ(world.positions(flag).size(), 30u);
  EXPECT_EQ(world.pinned(flag), (std::vector<std::uint32_t>{0, 5}));
  EXPECT_FLOAT_EQ(world.cloth_material(flag).damping, 0.25f);
  // The sheet is in XZ with its first row at -Z; rotated 90 degrees about X, it hangs from its first row.
  EXPECT_NEAR(world.positions(flag)[0].y, 2 + 0.5 * 0.8, 1e-6);
  EXPECT_NEAR(world.positions(flag)[0].z, 0, 1e-6);
  // 0.2 x 0.1 x 0.1 m of 1000 kg/m^3
  EXPECT_NEAR(world.total_mass(world.find_object("soft_body")), 2, 1e-5);
  EXPECT_EQ(world.positions(world.find_object("rope")).size(), 9u);
  EXPECT_EQ(world.positions(world.find_object("grains")).size(), 24u);
  EXPECT_EQ(world.colliders().size(), 2u);
}

std::string with_field(const std::string& field) {
  return R"({"souple": 1, "colliders": [{"name": "ring", "shape": {"signed_distance_field": )" + field +
         "}, \"transform\": {\"translate\": [0, 5, 0]}}]}";
}

TEST(BuildWorld, ASignedDistanceFieldIsWhatItsMeshIs) {
  const World world = built(
      with_field(R"({"mesh": {"torus": {"major_radius": 1, "minor_radius": 0.25}}, "resolution": 50})"));
  const auto& field = std::get<SignedDistanceField>(world.shape(world.find_collider("ring")));
  EXPECT_NEAR(field.spacing(), 0.05, 1e-9);
  const Hit hit = world.ray_cast({1, 9, 0}, {0, -1, 0});
  ASSERT_TRUE(hit.found && hit.is_collider);
  EXPECT_NEAR(hit.point.y, 5.25f, 0.01f);
  EXPECT_FALSE(world.ray_cast({0, 9, 0}, {0, -1, 0}).found);
}

TEST(BuildWorld, AnOpenMeshMakesNoSignedDistanceField) {
  expect_words(
      build_error(with_field(R"({"mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}}, "spacing": 0.1})")),
      {"test.json: colliders[0]: signed distance field", "8 edges are open"});
  EXPECT_THROW(built(with_field(R"({"mesh": {"sphere": {"radius": 1}}, "spacing": 0.1, "resolution": 9})")),
               Error);
}

TEST(BuildWorld, ABallOfTetsIsWhatItSays) {
  const World world = built(R"({"souple": 1, "objects": [{"name": "ball", "kind": "soft_body",
    "mesh": {"tet_ball": {"radius": 0.1, "subdivisions": 1, "layers": 3}}, "transform": {"translate": [0, 1, 0]}}]})");
  const ObjectId ball = world.find_object("ball");
  ASSERT_EQ(world.positions(ball).size(), 42u * 3 + 1);
  for (std::size_t i = 0; i < 42; ++i)
    EXPECT_NEAR(length(Vec3d(world.positions(ball)[i]) - Vec3d{0, 1, 0}), 0.1, 1e-6);
  EXPECT_EQ(world.triangles(ball).size(), 80u);
}

TEST(BuildWorld, GrainsFillTheirBoxWithoutOverlap) {
  const World world = built(with_object(
      R"("kind": "grains", "box": {"lo": [0, 0, 0], "hi": [1, 0.5, 0.5], "jitter": 0.2}, "material": {"radius": 0.05})"));
  const auto centers = world.positions(world.objects()[0]);
  // Cells of 0.12 m: 8 x 4 x 4 of them, for any jitter.
  EXPECT_EQ(centers.size(), 8u * 4u * 4u);
  float nearest = 1;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(centers[i][axis], 0.05f);
      EXPECT_LE(centers[i][axis], (axis == 0 ? 1.0f : 0.5f) - 0.05f);
    }
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, length(centers[i] - centers[j]));
  }
  EXPECT_GE(nearest, 0.1f - 1e-6f);
  EXPECT_LT(nearest, 0.12f - 1e-4f) << "the jitter moved nothing";
}

TEST(BuildWorld, SeedMovesTheGrains) {
  const std::string scene = with_object(R"("kind": "grains", "grid": {"counts": 3, "jitter": 0.5})");
  const auto hash = [&](const std::string& seed) { return built(scene, {"seed=" + seed}).hash(); };
  EXPECT_EQ(hash("7"), hash("7"));
  EXPECT_NE(hash("7"), hash("8"));
}

TEST(BuildWorld, KeyframedPinsGoWhereTheyAreTold) {
  World world = built(R"({"souple": 1, "gravity": [0, 0, 0], "objects": [{"name": "flag", "kind": "cloth",
      "mesh": {"grid": {"columns": 3, "rows": 3, "size": 1}},
      "pins": [{"vertices": [0], "keyframes": [{"time": 0}, {"time": 0.5, "translate": [0, 0.2, 0]}]},
               {"vertices": [6, 8], "keyframes": [{"time": 0}, {"time": 0.5, "rotate": [0, 90, 0]}]}]}]})");
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  const auto x = world.positions(world.find_object("flag"));
  EXPECT_NEAR(x[0].x, -0.5, 1e-5);
  EXPECT_NEAR(x[0].y, 0.2, 1e-5);
  // Vertices 6 and 8 are at (-0.5, 0, 0.5) and (0.5, 0, 0.5); they rotate about their mean, (0, 0, 0.5).
  EXPECT_NEAR(x[6].x, 0, 1e-5);
  EXPECT_NEAR(x[6].z, 1, 1e-5);
  EXPECT_NEAR(x[8].z, 0, 1e-5);
}

TEST(BuildWorld, ConnectionHoldsARopeToACloth) {
  World world = built(R"({"souple": 1, "substeps": 20, "objects": [
      {"name": "cloth", "kind": "cloth", "mesh": {"grid": {"columns": 3, "rows": 3, "size": 0.2}}},
      {"name": "rope", "kind": "rope", "points": [[0, 1, 0], [0, 0, 0]], "segments": 10, "pins": [{"vertices": [0]}]}],
      "connections": [{"from": {"object": "cloth", "vertices": [4]}, "to": {"object": "rope", "vertices": [10]},
                       "rest_length": 0}]})");
  for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
  const Vec3f a = world.positions(world.find_object("cloth"))[4];
  const Vec3f b = world.positions(world.find_object("rope"))[10];
  EXPECT_LT(length(a - b), 0.01f);
  EXPECT_GT(a.y, -0.2f) << "the cloth fell";
}

TEST(BuildWorld, ErrorsNameTheirPlace) {
  const std::string cloth =
      R"("name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 4, "rows": 4, "size": 1}}, )";
  const auto expect = [](const std::string& text, const std::string& place, const char* word = "") {
    const std::string said = build_error(text);
    EXPECT_EQ(said.find("test.json: " + place + ": "), 0u) << said;
    expect_words(said, {word});
  };
  expect(with_object(cloth + R"("pins": [{"all": true}, {"vertices": [99]}])"), "objects[0].pins[1]", "99");
  expect(with_object(cloth + R"("pins": [{"group": "hem"}])"), "objects[0].pins[0]", "hem");
  expect(with_object(cloth + R"("maps": {"stiffness": {"color": "red", "value": 2}})"), "objects[0]");
  expect(with_object(cloth + R"("pressure": 10)"), "objects[0]");
  expect(R"({"souple": 1, "objects": [
      {"name": "a", "kind": "rope", "points": [[0, 0, 0], [1, 0, 0]]}],
      "connections": [{"from": {"object": "a", "vertices": [0, 1]}, "to": {"object": "a", "vertices": [2, 3, 4]}}]})",
         "connections[0]");
}

/// A normalized scene builds an identical world.
TEST(BuildWorld, WrittenSceneBuildsTheSameWorld) {
  for (const auto& file : shipped_scenes()) {
    SCOPED_TRACE(file.filename().string());
    const SceneDescription scene = load_scene(file);
    World first = build_world(scene),
          second = build_world(parse_scene(to_json(scene), scene.folder, "again.json"));
    first.step(1 / scene.frame_rate);
    second.step(1 / scene.frame_rate);
    EXPECT_EQ(first.hash(), second.hash());
  }
}

// The keys of rigid bodies.

std::string with_body(const std::string& keys) {
  return with_object(R"("name": "body", "kind": "rigid_body", )" + keys);
}

RigidBodyState state_of(const World& world) {
  return world.rigid_body(world.find_object("body"));
}

const std::string ball = R"("shape": {"sphere": {"radius": 0.1}})";

TEST(SceneRigidBody, MassCenterAndInertiaAreGiven) {
  const RigidBodyState state = state_of(built(
      with_body(ball + R"(, "transform": {"translate": [1, 2, 3]}, "mass": 3, "center_of_mass": [0, -0.05, 0],
                             "inertia": [0.01, 0.02, 0.025])")));
  EXPECT_NEAR(state.mass, 3, 1e-12);
  EXPECT_LT(length(state.pose.translation - Vec3d{1, 1.95, 3}), 1e-9);
  EXPECT_NEAR(state.inertia.x, 0.01, 1e-12);
  EXPECT_NEAR(state.inertia.y, 0.02, 1e-12);
  EXPECT_NEAR(state.inertia.z, 0.025, 1e-12);
}

TEST(SceneRigidBody, SeveralShapesAreOneBody) {
  const RigidBodyState state = state_of(built(with_body(R"("shapes": [
      {"shape": {"box": {"half_extents": [0.1, 0.1, 0.1]}}, "density": 500},
      {"shape": {"box": {"half_extents": [0.1, 0.1, 0.1]}}, "transform": {"translate": [0.2, 0, 0]}}],
      "material": {"density": 1500})")));
  EXPECT_NEAR(state.mass, 4 + 12, 1e-5);
  EXPECT_NEAR(state.pose.translation.x, 0.15, 1e-7);
}

TEST(SceneRigidBody, KeyframesMoveAKinematicOne) {
  World world = built(with_body(ball + R"(, "kinematic": true,
      "keyframes": [{"time": 0, "translate": [0, 0, 0]}, {"time": 1, "translate": [2, 0, 0]}])"));
  EXPECT_TRUE(world.is_kinematic(world.find_object("body")));
  for (int frame = 0; frame < 30; ++frame) world.step(1.0 / 60);
  EXPECT_NEAR(state_of(world).pose.translation.x, 1, 1e-9);
  World stands = built(with_body(ball + R"(, "kinematic": true)"));
  for (int frame = 0; frame < 30; ++frame) stands.step(1.0 / 60);
  EXPECT_EQ(state_of(stands).pose.translation.y, 0);
}

TEST(SceneRigidBody, WhatIsWrittenIsRead) {
  const std::string text = with_body(R"("shapes": [{"shape": {"sphere": {"radius": 0.1}},
      "transform": {"translate": [1, 0, 0]}, "density": 20}], "mass": 2, "inertia": [1, 1, 1], "kinematic": true)");
  const std::string once = to_json(parse_scene(text, scenes_folder(), "test.json"));
  EXPECT_NE(once.find("\"shapes\""), std::string::npos);
  EXPECT_EQ(to_json(parse_scene(once, scenes_folder(), "test.json")), once);
}

TEST(SceneRigidBody, ErrorsNameTheKey) {
  expect_words(error_message(with_body(ball + R"(, "keyframes": [{"time": 0}])")), {"kinematic"});
  expect_words(error_message(with_body(ball + R"(, "kinematic": false, "keyframes": [{"time": 0}])")),
               {"kinematic", "true"});
  expect_words(error_message(with_body(ball + R"(, "mass": 0)")), {"mass", "0"});
  expect_words(error_message(with_body(R"("shapes": [])")), {"shapes"});
  expect_words(error_message(with_body(ball + R"(, "shapes": [{"shape": {"sphere": {"radius": 1}}}])")),
               {"shape"});
  expect_error([&] { built(with_body(ball + R"(, "inertia": [1, 1, 5])")); }, {"body", "inertia"});
}

}  // namespace souple::scene_test::test_scene_build_world
