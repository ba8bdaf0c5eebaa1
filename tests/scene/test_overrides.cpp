// --set path=value: with the checks and messages of a file.
#include "scene_test.h"

#include <chrono>

namespace souple::scene_test::test_scene_overrides {

SceneDescription changed(const std::vector<std::string>& overrides) {
  return parse_scene(small_scene, scenes_folder(), "test.json", overrides);
}

const ClothDescription& flag(const SceneDescription& scene) {
  return std::get<ClothDescription>(scene.objects.at(0));
}

TEST(Override, ChangesValuesAnywhere) {
  EXPECT_EQ(changed({"substeps=20"}).settings.substeps, 20);
  EXPECT_EQ(changed({"substeps=20", "substeps=30"}).settings.substeps, 30);
  EXPECT_EQ(changed({"mode=xpbd"}).settings.mode, Mode::xpbd);
  EXPECT_EQ(changed({"mode=\"xpbd\""}).settings.mode, Mode::xpbd);
  EXPECT_EQ(changed({"gravity=[0, -1.5, 0]"}).settings.gravity, Vec3f(0, -1.5f, 0));
  EXPECT_FLOAT_EQ(flag(changed({"objects.flag.material.bending_stiffness=1e-5"})).material.bending_stiffness,
                  1e-5f);
  EXPECT_FLOAT_EQ(flag(changed({"objects.0.material.damping=2"})).material.damping, 2);
  EXPECT_DOUBLE_EQ(flag(changed({"objects[0].transform.translate[1]=5"})).transform.translate.y, 5);
  EXPECT_FLOAT_EQ(
      std::get<Sphere>(changed({"colliders.ball.shape.sphere.radius=0.7"}).colliders[1].shape).radius, 0.7f);
}

TEST(Override, KeepsWhatItDoesNotName) {
  const SceneDescription scene = changed({"objects.flag.material.thickness=0.005"});
  EXPECT_FLOAT_EQ(flag(scene).material.damping, 0.25f);
  EXPECT_EQ(flag(scene).material.preset, "silk");
  EXPECT_EQ(scene.frames, 10u);
}

TEST(Override, MakesObjectsOnItsWay) {
  EXPECT_FLOAT_EQ(changed({"wind.gust=0.5"}).settings.wind.gust, 0.5f);
  const SceneDescription scene = changed({"objects.soft_body.material.young_modulus=7e4"});
  EXPECT_FLOAT_EQ(std::get<SoftBodyDescription>(scene.objects[1]).material.young_modulus, 7e4f);
}

TEST(Override, FindsUnnamedThingsByTheNameTheyWillHave) {
  EXPECT_EQ(std::get<RopeDescription>(changed({"objects.rope.segments=3"}).objects[2]).segments, 3u);
  EXPECT_FLOAT_EQ(changed({"colliders.collider.friction=0.9"}).colliders[0].friction, 0.9f);
}

TEST(Override, FailsAsAFileWould) {
  const auto said = [](const std::string& setting) { return error_message(small_scene, {setting}); };
  EXPECT_NE(said("substeps=0").find("test.json: substeps: expected a whole number from 1"),
            std::string::npos);
  EXPECT_NE(said("objects.flag.material.dampign=1").find("did you mean \"damping\""), std::string::npos);
  EXPECT_NE(said("objects.flga.velocity=[0,0,0]").find("did you mean \"flag\""), std::string::npos);
  EXPECT_NE(said("objects.7.velocity=[0,0,0]").find("has 4 entries"), std::string::npos);
  EXPECT_NE(said("substeps").find("PATH=VALUE"), std::string::npos);
  EXPECT_NE(said("=3").find("PATH=VALUE"), std::string::npos);
  EXPECT_NE(said("objects..velocity=3").find("empty part"), std::string::npos);
  EXPECT_NE(said("frames.x=3").find("\"frames\" is 10"), std::string::npos);
  EXPECT_NE(said("a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r=1").find("too many parts"), std::string::npos);
  EXPECT_NE(said("frame_rate=nan").find("frame_rate: expected a number"), std::string::npos);
}

// Their names, and a path that gives one of them, take time in proportion to their number.
TEST(Override, TenThousandUnnamedObjectsAreNamedInLinearTime) {
  const auto seconds_for = [](int count) {
    std::string objects;
    for (int i = 0; i < count; ++i)
      objects += std::string(i > 0 ? "," : "") + R"({"kind": "grains", "points": [[0, 0, 0]]})";
    const std::string last = "grains" + std::to_string(count);
    const std::vector<std::string> settings{"objects." + last + ".velocity=[0, 1, 0]"};
    const auto start = std::chrono::steady_clock::now();
    const SceneDescription scene =
        parse_scene(R"({"souple": 1, "objects": [)" + objects + "]}", ".", "test.json", settings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_EQ(std::get<GrainsDescription>(scene.objects.back()).name, last);
    EXPECT_EQ(std::get<GrainsDescription>(scene.objects.back()).velocity.y, 1);
    return seconds;
  };
  seconds_for(100);
  const double tenth = seconds_for(1000), all = seconds_for(10000);
  EXPECT_LT(all, 30 * tenth + 0.2);  // 10 times if linear, 100 if quadratic
  RecordProperty("seconds", std::to_string(all));
}

}  // namespace souple::scene_test::test_scene_overrides
