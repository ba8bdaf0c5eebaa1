// Every kind of mistake has a one-line message: file, path inside it, the value, the expected value.
#include "scene_test.h"

#include <chrono>
#include <string>

namespace souple::scene_test::test_scene_messages {

struct Mistake {
  const char* what;
  std::string text;
  std::vector<std::string> expected;  ///< parts of the message, besides the file's name
};

std::string cloth(const std::string& more) {
  return with_object(
      R"("name": "flag", "kind": "cloth", "mesh": {"grid": {"columns": 4, "rows": 4, "size": 1}})" + more);
}

std::string nested(int depth) {
  return std::string(static_cast<std::size_t>(depth), '[') +
         std::string(static_cast<std::size_t>(depth), ']');
}

std::vector<Mistake> mistakes() {
  return {
      {"empty file", "", {"test.json:1:1: not JSON"}},
      {"not an object", "[1]", {"test.json: expected an object", "[1]"}},
      {"syntax", "{\"souple\": 1,\n \"frames\": }", {"test.json:2:", "not JSON"}},
      {"comment", "{\"souple\": 1} // hello", {"test.json:1:", "not JSON"}},
      {"trailing garbage", "{\"souple\": 1} }", {"test.json:1:", "not JSON"}},
      {"not UTF-8", "{\"souple\": 1, \"description\": \"\xff\"}", {"test.json:1:", "not JSON"}},
      {"deep nesting", R"({"souple": 1, "objects": )" + nested(5000) + "}", {"nested deeper than 64"}},
      {"duplicate key",
       cloth(R"(, "velocity": [0, 0, 0], "velocity": [1, 0, 0])"),
       {"objects[0].velocity", "twice"}},
      {"NaN", R"({"souple": 1, "frame_rate": NaN})", {"test.json:1:", "not JSON"}},
      {"too large for a double", R"({"souple": 1, "frame_rate": 1e999})", {"test.json:1:", "1e999"}},
      {"no version", R"({"frames": 1})", {"\"souple\"", "missing"}},
      {"other version", R"({"souple": 2})", {"souple: ", "2", "version"}},
      {"unknown key",
       R"({"souple": 1, "substep": 5})",
       {"substep:", "unknown key", "(its value is 5)", "\"substeps\""}},
      {"unknown key inside",
       cloth(R"(, "material": {"densty": 0.3})"),
       {"objects[0].material.densty", "0.3", "did you mean \"areal_density\""}},
      {"key of an older version",
       R"({"souple": 1, "form": "displacement"})",
       {"form:", "unknown key", "belongs to older versions", "always moves displacements"}},
      {"unknown key like nothing",
       R"({"souple": 1, "xyzzy": {"a": 1}})",
       {"xyzzy", "{\"a\": 1}", "known: ", "frames"}},
      {"key of another kind",
       cloth(R"(, "lattice": {"cells": 10})"),
       {"objects[0].lattice", "belongs to a soft_body"}},
      {"wrong type", R"({"souple": 1, "substeps": "ten"})", {"substeps: ", "whole number", "\"ten\""}},
      {"fraction", R"({"souple": 1, "substeps": 2.5})", {"substeps: ", "whole number", "2.5"}},
      {"out of range", R"({"souple": 1, "substeps": 0})", {"substeps: ", "from 1 to 10000", "found 0"}},
      {"negative density",
       cloth(R"(, "material": {"areal_density": -0.1})"),
       {"objects[0].material.areal_density", "> 0", "-0.1"}},
      {"vanishes as a float",
       cloth(R"(, "material": {"areal_density": 1e-300})"),
       {"objects[0].material.areal_density", "> 0", "1e-300"}},
      {"huge",
       cloth(R"(, "transform": {"translate": [0, 1e300, 0]})"),
       {"objects[0].transform.translate[1]", "1e+300", "1000000"}},
      {"vector of two", cloth(R"(, "velocity": [1, 2])"), {"objects[0].velocity", "[x, y, z]", "[1, 2]"}},
      {"list of one",
       with_object(R"("kind": "rope", "points": [[0, 0, 0]])"),
       {"objects[0].points", "expected a list of 2 to 1000000 entries, found 1"}},
      {"renamed key", cloth(R"(, "colour": "#fff")"), {"objects[0].colour", "renamed to \"color\""}},
      {"renamed setting",
       R"({"souple": 1, "fluid": {"foam": {"spray_neighbours": 9}}})",
       {"fluid.foam.spray_neighbours", "renamed to \"spray_neighbors\""}},
      {"unknown word", R"({"souple": 1, "mode": "xpdb"})", {"mode: ", "\"xpdb\"", "did you mean \"xpbd\""}},
      {"unknown preset",
       cloth(R"(, "material": {"preset": "sikl"})"),
       {"objects[0].material.preset", "\"sikl\"", "did you mean \"silk\""}},
      {"preset of another kind",
       cloth(R"(, "material": {"preset": "steel_wire"})"),
       {"objects[0].material.preset", "steel_wire", "cotton"}},
      {"no kind", with_object(R"("name": "a")"), {"objects[0]", "\"kind\"", "soft_body"}},
      {"unknown kind",
       with_object(R"("kind": "clothe")"),
       {"objects[0].kind", "clothe", "did you mean \"cloth\""}},
      {"no mesh", with_object(R"("kind": "cloth")"), {"objects[0]", "\"mesh\"", "missing"}},
      {"two meshes",
       with_object(R"("kind": "cloth", "mesh": {"disk": {}, "sphere": {}})"),
       {"objects[0].mesh", "disk", "sphere", "exclude"}},
      {"no source of a mesh",
       with_object(R"("kind": "cloth", "mesh": {})"),
       {"objects[0].mesh", "\"grid\"", "\"file\""}},
      {"scale of a grid",
       with_object(R"("kind": "cloth", "mesh": {"sphere": {"radius": 1}, "scale": 2})"),
       {"objects[0].mesh.scale", "\"file\""}},
      {"missing file",
       with_object(R"("kind": "cloth", "mesh": {"file": "meshes/no_such.obj"})"),
       {"objects[0].mesh.file", "meshes/no_such.obj"}},
      {"folder as file",
       with_object(R"("kind": "cloth", "mesh": {"file": "."})"),
       {"objects[0].mesh.file", "folder"}},
      {"too many vertices",
       with_object(R"("kind": "cloth", "mesh": {"grid": {"columns": 9999, "rows": 9999, "size": 1}})"),
       {"objects[0].mesh.grid", "99980001"}},
      {"upside down box",
       cloth(R"(, "pins": [{"in_box": [[1, 0, 0], [0, 1, 1]]}])"),
       {"objects[0].pins[0].in_box", "lower"}},
      {"two selectors",
       cloth(R"(, "pins": [{"all": true, "vertices": [1]}])"),
       {"objects[0].pins[0]", "exclude"}},
      {"no selector", cloth(R"(, "pins": [{}])"), {"objects[0].pins[0]", "\"vertices\"", "\"nearest\""}},
      {"keyframes out of order",
       cloth(R"(, "pins": [{"all": true, "keyframes": [{"time": 1}, {"time": 1}]}])"),
       {"objects[0].pins[0].keyframes[1].time", "later"}},
      {"duplicate name",
       R"({"souple": 1, "colliders": [{"name": "a", "shape": {"plane": {}}}, {"name": "a", "shape": {"plane": {}}}]})",
       {"colliders[1].name", "\"a\"", "unique"}},
      {"name as a path", with_object(R"("kind": "cloth", "name": "../etc")"), {"objects[0].name", "../etc"}},
      {"pair with an unknown name",
       R"({"souple": 1, "colliders": [{"name": "floor", "shape": {"plane": {}}}], "pairs": [{"between": ["floor", "flor"], "friction": 1}]})",
       {"pairs[0].between[1]", "\"flor\"", "did you mean \"floor\""}},
      {"pair without a value",
       R"({"souple": 1, "colliders": [{"name": "floor", "shape": {"plane": {}}}], "pairs": [{"between": ["floor", "floor"]}]})",
       {"pairs[0]", "friction", "collide"}},
      {"kinetic friction of a pair without friction",
       R"({"souple": 1, "colliders": [{"name": "floor", "shape": {"plane": {}}}], "pairs": [{"between": ["floor", "floor"], "collide": false, "kinetic_friction": 1}]})",
       {"pairs[0].kinetic_friction", "friction"}},
      {"kinetic friction above friction",
       cloth(R"(, "material": {"friction": 0.2, "kinetic_friction": 0.3})"),
       {"objects[0].material.kinetic_friction", "above \"friction\""}},
      {"group out of range",
       cloth(R"(, "collision_groups": [0, 32])"),
       {"objects[0].collision_groups[1]", "31", "32"}},
      {"wind from the other side",
       cloth(R"(, "wind_exposure": -0.5)"),
       {"objects[0].wind_exposure", "0", "-0.5"}},
      {"an obstacle that wind does not move",
       with_object(R"("kind": "obstacle", "mesh": {"sphere": {"radius": 1}}, "wind_exposure": 0)"),
       {"objects[0].wind_exposure", "unknown key"}},
      {"layer below none", cloth(R"(, "layer": -1)"), {"objects[0].layer", "0", "-1"}},
      {"half a layer", cloth(R"(, "layer": 1.5)"), {"objects[0].layer", "whole number", "1.5"}},
      {"self-collision of a word that is none",
       cloth(R"(, "self_collision": "balls")"),
       {"objects[0].self_collision", "true, false, \"surfaces\" or \"particles\"", "balls"}},
      {"self-collision as a number",
       cloth(R"(, "self_collision": 1)"),
       {"objects[0].self_collision", "\"particles\"", "1"}},
      {"a rope with self-collision of particles",
       with_object(R"("kind": "rope", "points": [[0, 0, 0], [1, 0, 0]], "self_collision": "particles")"),
       {"objects[0].self_collision", "true, false or \"surfaces\"", "particles"}},
      {"mask as a number",
       cloth(R"(, "collision_mask": 3)"),
       {"objects[0].collision_mask", "list of group numbers", "\"all\""}},
      {"connection to an unknown object",
       R"({"souple": 1, "connections": [{"from": {"object": "a", "all": true}, "to": {"object": "b", "all": true}}]})",
       {"connections[0].from.object", "\"a\""}},
      {"connection until before the start",
       R"({"souple": 1, "connections": [{"from": {"object": "a", "all": true}, "to": {"object": "b", "all": true}, "until": -1}]})",
       {"connections[0].until", "0", "-1"}},
      {"flat camera",
       R"({"souple": 1, "camera": {"from": [1, 1, 1], "to": [1, 1, 1]}})",
       {"camera", "same point"}},
      {"color by name", cloth(R"(, "color": "red")"), {"objects[0].color", "\"red\"", "#d04a3f"}},
      {"color with a letter too far", cloth(R"(, "color": "#d04a3g")"), {"objects[0].color", "#d04a3g"}},
      {"plane without direction",
       R"({"souple": 1, "colliders": [{"shape": {"plane": {"normal": [0, 0, 0]}}}]})",
       {"colliders[0].shape.plane.normal", "zero"}},
      {"two poses",
       R"({"souple": 1, "colliders": [{"shape": {"plane": {}}, "transform": {}, "keyframes": []}]})",
       {"colliders[0]", "transform", "keyframes", "exclude"}},
  };
}

class Message : public testing::TestWithParam<Mistake> {};

TEST_P(Message, NamesPlaceAndValue) {
  const std::string said = error_message(GetParam().text);
  EXPECT_EQ(said.find("test.json"), 0u) << said;
  for (const std::string& part : GetParam().expected) {
    EXPECT_NE(said.find(part), std::string::npos) << "missing: " << part << "\nin: " << said;
  }
  EXPECT_EQ(said.find('\n'), std::string::npos) << "more than one line: " << said;
  EXPECT_LT(said.size(), 700u) << said;
}

INSTANTIATE_TEST_SUITE_P(Scene, Message, testing::ValuesIn(mistakes()), [](const auto& each) {
  std::string name;
  for (const char c : std::string(each.param.what)) {
    if (c != ' ' && c != '-') name += c;
  }
  return name;
});

TEST(Message, KeysWithLineFeedsStayOnOneLine) {
  const std::string said = error_message("{\"souple\": 1, \"a\\nb\": 1}");
  EXPECT_NE(said.find("a?b"), std::string::npos) << said;
  EXPECT_EQ(said.find('\n'), std::string::npos) << said;
}

// JSON Schema's maxLength counts characters, so a name of 64 characters of two bytes is as good as one of 64 letters.
TEST(Message, LengthsCountCharactersAsTheSchemaDoes) {
  const auto repeated = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += "\u00e9";
    return text;
  };
  const auto named = [&](int count) {
    return R"({"souple": 1, "colliders": [{"name": ")" + repeated(count) + R"(", "shape": {"plane": {}}}]})";
  };
  EXPECT_EQ(error_message(named(64)), "");
  EXPECT_NE(error_message(named(65)).find("1 to 64 characters"), std::string::npos);
  const auto described = [&](int count) {
    return R"({"souple": 1, "description": ")" + repeated(count) + "\"}";
  };
  EXPECT_EQ(error_message(described(1000)), "");
  EXPECT_NE(error_message(described(1001)).find("1000 characters"), std::string::npos);
}

TEST(Message, ManyKeysDoNotTakeForever) {
  std::string text = R"({"souple": 1)";
  for (int i = 0; i < 200000; ++i) text += ", \"k" + std::to_string(i) + "\": 0";
  EXPECT_NE(error_message(text + "}").find("more than 1000 keys"), std::string::npos);
}

TEST(Message, SceneFileThatIsNotThere) {
  EXPECT_EQ(error_of([] { load_scene("no/such/scene.json"); }).find("no/such/scene.json: "), 0u);
  EXPECT_THROW(load_scene(scenes_folder()), Error);
}

TEST(Messages, RefuseAMegabyteOfNestingAtOnce) {
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& text :
       {nested(500000), std::string(1000000, '['), R"({"souple": 1, "objects": )" + nested(500000) + "}"})
    EXPECT_NE(error_message(text).find("nested deeper than 64"), std::string::npos);
  std::string objects;
  for (int i = 0; i < 200000; ++i) objects += "{\"a\":";
  EXPECT_NE(error_message(objects).find("nested deeper than 64"), std::string::npos);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 4.0);
}

// --set path=value: with the checks and messages of a file.

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

}  // namespace souple::scene_test::test_scene_messages
