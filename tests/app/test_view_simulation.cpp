#include "app/view/clock.h"
#include "app/view/keys.h"
#include "app/view/simulation.h"
#include "tests/expect_error.h"
#include "tests/paths.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace souple::viewer {
namespace {

constexpr const char* falling = R"({
  "souple": 1, "description": "A cloth on two pins, and a grain that falls.",
  "frame_rate": 50, "substeps": 5,
  "objects": [
    {"name": "cloth", "kind": "cloth", "mesh": {"grid": {"columns": 5, "rows": 4, "size": 1}},
     "transform": {"translate": [0, 2, 0]}, "pins": [{"vertices": [0, 4]}]},
    {"name": "grain", "kind": "grains", "points": [[0, 100, 0]], "material": {"radius": 0.1}},
    {"name": "rope", "kind": "rope", "points": [[3, 1, 0], [4, 1, 0]], "segments": 4,
     "pins": [{"in_box": [[2, 0, -1], [3.3, 2, 1]]}]}
  ]
})";

// A drag too strong for explicit integration: speeds grow sixteenfold each substep.
constexpr const char* exploding = R"({
  "souple": 1, "drag": 10000, "integrator": "explicit_euler",
  "objects": [{"name": "sand", "kind": "grains", "points": [[0, 1, 0], [1, 1, 0]]}],
  "wind": {"velocity": [2, 0, 0]}
})";

SceneDescription scene(const char* text) {
  return parse_scene(text, source_path("scenes"), "test.json");
}

Vec3f at(const Simulation& simulation, const char* object, std::size_t vertex) {
  return simulation.world().positions(simulation.world().find_object(object))[vertex];
}

TEST(ViewerClock, KeepsRealTimeWhateverTheRateOfPictures) {
  for (const double picture : {1 / 144.0, 1 / 60.0, 1 / 59.94, 1 / 23.0}) {
    Clock clock;
    double real = 0;
    int steps = 0;
    while (real < 10) {
      real += picture;
      clock.tick(picture);
      while (clock.consume(1 / 60.0)) ++steps;
      ASSERT_NEAR(steps / 60.0, real, 1 / 60.0);
    }
    EXPECT_NEAR(clock.speed(), 1, 0.05);
  }
}

TEST(ViewerClock, SaysHowMuchSlowerItIsThanRealTime) {
  Clock clock;
  for (int picture = 0; picture < 100; ++picture) {
    clock.tick(0.04);  // only one step of 0.01 s is made meanwhile
    if (clock.consume(0.01)) clock.drop();
  }
  EXPECT_NEAR(clock.speed(), 0.25, 0.03);
}

TEST(ViewerKeys, StandInTheManualAndInTheHelp) {
  std::ifstream file(source_path("docs/viewer.md"));
  const std::string page(std::istreambuf_iterator<char>(file), {});
  std::string wanted = "| key | what it does |\n|---|---|\n";
  for (const Key& key : keys)
    wanted += "| `" + std::string(key.key) + "` | " + std::string(key.does) + " |\n";
  wanted += "\n| mouse | what it does |\n|---|---|\n";
  for (const Gesture& gesture : gestures)
    wanted += "| " + std::string(gesture.gesture) + " | " + std::string(gesture.does) + " |\n";
  EXPECT_NE(page.find(wanted), std::string::npos) << "docs/viewer.md should hold\n" << wanted;
  for (const Key& key : keys) EXPECT_NE(keys_text().find(key.does), std::string::npos);
}

TEST(ViewerKeys, NoKeyMeansTwoThings) {
  std::set<char> characters;
  for (const Key& key : keys) {
    if (key.character == 0) continue;
    EXPECT_TRUE(characters.insert(key.character).second) << key.key;
  }
}

TEST(ViewerSimulation, FallsInRealTime) {
  Simulation simulation(scene(falling), "falling");
  for (int picture = 0; picture < 60; ++picture) simulation.advance(1 / 60.0);
  EXPECT_NEAR(simulation.time(), 1, 0.021);
  EXPECT_EQ(simulation.frame(), static_cast<std::uint64_t>(std::lround(simulation.time() * 50)));
  EXPECT_NEAR(at(simulation, "grain", 0).y, 100 - 0.5 * 9.81 * simulation.time() * simulation.time(), 0.05);
}

TEST(ViewerSimulation, NoSpiralOfDeathAfterALongPicture) {
  Simulation simulation(scene(falling), "falling");
  simulation.advance(1000);
  EXPECT_LE(simulation.time(), 0.41);
  EXPECT_LT(simulation.speed(), 0.01);
  const double before = simulation.time();
  simulation.advance(0.0001);  // no time is due
  EXPECT_EQ(simulation.time(), before);
}

TEST(ViewerSimulation, PausesAndStepsByFramesAndSubsteps) {
  Simulation simulation(scene(falling), "falling");
  simulation.set_playing(false);
  simulation.advance(1);
  EXPECT_EQ(simulation.time(), 0);
  simulation.set_playing(true);
  simulation.step_frame();
  EXPECT_FALSE(simulation.playing());
  EXPECT_NEAR(simulation.time(), 0.02, 1e-12);
  EXPECT_EQ(simulation.frame(), 1u);
  simulation.step_fine();
  EXPECT_NEAR(simulation.time(), 0.024, 1e-12);
  EXPECT_EQ(simulation.frame(), 1u);
  for (int i = 0; i < 4; ++i) simulation.step_fine();
  EXPECT_EQ(simulation.frame(), 2u);
  // Ten single substeps are two frames: the motion must be equal.
  Simulation whole(scene(falling), "falling");
  whole.step_frame(), whole.step_frame();
  EXPECT_NEAR(at(simulation, "grain", 0).y, at(whole, "grain", 0).y, 1e-5);
}

TEST(ViewerSimulation, GoesBackToTheStartWithItsChanges) {
  Simulation simulation(scene(falling), "falling");
  Settings settings = simulation.scene().settings;
  settings.gravity = {0, -1, 0};
  simulation.set_settings(settings);
  const Vec3f start = at(simulation, "cloth", 12);
  for (int i = 0; i < 20; ++i) simulation.step_frame();
  EXPECT_GT(length(at(simulation, "cloth", 12) - start), 0.01);
  const std::uint64_t before = simulation.generation();
  simulation.reset();
  EXPECT_NE(simulation.generation(), before);
  EXPECT_EQ(simulation.time(), 0);
  EXPECT_EQ(at(simulation, "cloth", 12), start);
  EXPECT_TRUE(simulation.history().empty());
  for (int i = 0; i < 50; ++i) simulation.step_frame();
  EXPECT_NEAR(at(simulation, "grain", 0).y, 100 - 0.5, 0.02);  // gravity is still the changed one
}

TEST(ViewerSimulation, SettingsActAtOnce) {
  Simulation simulation(scene(falling), "falling");
  Settings settings = simulation.scene().settings;
  settings.substeps = 7, settings.iterations = 3, settings.mode = Mode::xpbd;
  simulation.set_settings(settings);
  simulation.step_frame();
  EXPECT_EQ(simulation.report().substeps, 7);
  EXPECT_EQ(simulation.report().iterations, 3);
  settings.substeps = 0;
  expect_error([&] { simulation.set_settings(settings); }, {"substeps"});
  EXPECT_EQ(simulation.scene().settings.substeps, 7);
  simulation.step_frame();
  EXPECT_EQ(simulation.report().substeps, 7);
}

TEST(ViewerSimulation, MaterialsActAtOnce) {
  Simulation simulation(scene(falling), "falling");
  const ObjectId cloth = simulation.world().find_object("cloth");
  const std::size_t index = simulation.index_of(cloth);
  auto material = std::get<ClothDescription>(simulation.scene().objects[index]).material;
  const double mass = simulation.world().total_mass(cloth);
  material.areal_density *= 3;
  simulation.set_material(index, material);
  EXPECT_NEAR(simulation.world().total_mass(cloth), 3 * mass, 1e-4 * mass);
  material.poisson_ratio = 2;
  expect_error([&] { simulation.set_material(index, material); }, {"poisson_ratio"});
  EXPECT_EQ(std::get<ClothDescription>(simulation.scene().objects[index]).material.poisson_ratio, 0.3f);
}

TEST(ViewerSimulation, ASofterClothSagsMore) {
  const auto sag = [](float stiffness) {
    Simulation simulation(scene(falling), "falling");
    auto material = std::get<ClothDescription>(simulation.scene().objects[0]).material;
    material.membrane_stiffness = stiffness, material.damping = 5;
    simulation.set_material(0, material);
    for (int i = 0; i < 200; ++i) simulation.step_frame();
    return 2 - at(simulation, "cloth", 17).y;
  };
  EXPECT_GT(sag(10), sag(1e4) + 0.02);
}

TEST(ViewerSimulation, PinsHoldAndLetGo) {
  Simulation simulation(scene(falling), "falling");
  const ObjectId cloth = simulation.world().find_object("cloth");
  EXPECT_TRUE(simulation.is_pinned(cloth, 0));
  EXPECT_TRUE(simulation.toggle_pin(cloth, 19));
  EXPECT_FALSE(simulation.toggle_pin(cloth, 0));
  const Vec3f held = at(simulation, "cloth", 19), freed = at(simulation, "cloth", 0);
  for (int i = 0; i < 30; ++i) simulation.step_frame();
  EXPECT_EQ(at(simulation, "cloth", 19), held);
  EXPECT_GT(length(at(simulation, "cloth", 0) - freed), 0.05);
  // Pins are part of the scene file, and restored from it.
  Simulation again(parse_scene(simulation.scene_text(), source_path(), "copy.json"), "again");
  EXPECT_EQ(again.world().pinned(again.world().find_object("cloth")), (std::vector<std::uint32_t>{4, 19}));
  simulation.reset();
  EXPECT_EQ(simulation.world().pinned(simulation.world().find_object("cloth")),
            (std::vector<std::uint32_t>{4, 19}));
}

TEST(ViewerSimulation, OneVertexOfABoxOfPinsLetsGo) {
  Simulation simulation(scene(falling), "falling");
  const ObjectId rope = simulation.world().find_object("rope");
  ASSERT_EQ(simulation.world().pinned(rope), (std::vector<std::uint32_t>{0, 1}));
  for (int i = 0; i < 3; ++i) simulation.step_frame();
  simulation.toggle_pin(rope, 0);
  Simulation again(parse_scene(simulation.scene_text(), source_path(), "copy.json"), "again");
  EXPECT_EQ(again.world().pinned(again.world().find_object("rope")), (std::vector<std::uint32_t>{1}));
}

TEST(ViewerSimulation, TheCopiedSceneIsWhatRuns) {
  Simulation simulation(scene(falling), "falling");
  Settings settings = simulation.scene().settings;
  settings.gravity = {0, -3, 0}, settings.wind.velocity = {1, 2, 3}, settings.substeps = 8;
  simulation.set_settings(settings);
  auto material = std::get<RopeDescription>(simulation.scene().objects[2]).material;
  material.young_modulus = 3e6f;
  simulation.set_material(2, material);
  simulation.reset();  // pins and settings of a world that was built with them
  Simulation copy(parse_scene(simulation.scene_text(), source_path(), "copy.json"), "copy");
  for (int i = 0; i < 10; ++i) simulation.step_frame(), copy.step_frame();
  EXPECT_EQ(simulation.world().hash(), copy.world().hash());
}

TEST(ViewerSimulation, TroublePausesAndNamesTheParticle) {
  Simulation simulation(scene(exploding), "exploding");
  for (int i = 0; i < 200 && simulation.playing(); ++i) simulation.advance(1 / 60.0);
  EXPECT_FALSE(simulation.playing());
  ASSERT_TRUE(simulation.failure().has_value());
  EXPECT_EQ(simulation.failure()->object, "sand");
  EXPECT_LT(simulation.failure()->vertex, 2u);
  EXPECT_TRUE(is_finite(simulation.failure()->position));
  EXPECT_NE(simulation.failure()->message.find("\"sand\", particle"), std::string::npos);
  simulation.reset();
  EXPECT_FALSE(simulation.failure().has_value());
}

TEST(ViewerSimulation, ABrokenSceneSaysSo) {
  expect_error([] { Simulation simulation(std::filesystem::path("no/such/file.json")); },
               {"no/such/file.json"});
}

TEST(ViewerSimulation, EveryShippedSceneRunsAndCopies) {
  for (const auto& entry : std::filesystem::directory_iterator(source_path("scenes"))) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path().string());
    Simulation simulation(entry.path());
    simulation.step_frame();
    EXPECT_TRUE(simulation.report().ok());
    EXPECT_FALSE(simulation.failure());
    EXPECT_EQ(simulation.frame(), 1u);
    EXPECT_NO_THROW(parse_scene(simulation.scene_text(), source_path("scenes"), "copy.json"));
  }
}

}  // namespace
}  // namespace souple::viewer
