#include "app/view/additions.h"
#include "app/view/clock.h"
#include "app/view/keys.h"
#include "app/view/simulation.h"
#include "tests/expect_error.h"
#include "tests/paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::viewer::test_app_view_simulation {

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

/// The scene as it would be saved now.
SceneDescription copied(const Simulation& simulation) {
  return parse_scene(simulation.scene_text(), source_path(), "copy.json");
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
  Simulation again(copied(simulation), "again");
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
  Simulation again(copied(simulation), "again");
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
  Simulation copy(copied(simulation), "copy");
  for (int i = 0; i < 10; ++i) simulation.step_frame(), copy.step_frame();
  EXPECT_EQ(simulation.world().hash(), copy.world().hash());
}

// --- the past

std::vector<std::uint64_t> hashes_of(Simulation& simulation, int frames) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < frames; ++i) {
    simulation.step_frame();
    hashes.push_back(simulation.world().hash());
  }
  return hashes;
}

TEST(ViewerPast, TwoSecondsBackAndForthAreTheSameBits) {
  Simulation simulation(scene(falling), "falling");
  const std::vector<std::uint64_t> first = hashes_of(simulation, 130);
  const double end = simulation.time();
  for (int i = 0; i < 100; ++i) simulation.step_back();
  EXPECT_NEAR(simulation.time(), end - 2, 1e-9);
  EXPECT_EQ(simulation.world().hash(), first[29]);
  // Forth along the states, then by steps.
  simulation.rewind(50);
  EXPECT_EQ(simulation.world().hash(), first[49]);
  simulation.rewind(30);
  EXPECT_EQ(hashes_of(simulation, 100), std::vector<std::uint64_t>(first.begin() + 30, first.end()));
  EXPECT_EQ(simulation.time(), end);
}

TEST(ViewerPast, PlaysOnFromThere) {
  Simulation simulation(scene(falling), "falling");
  hashes_of(simulation, 20);
  for (int i = 0; i < 5; ++i) simulation.step_back();
  EXPECT_FALSE(simulation.playing());
  EXPECT_EQ(simulation.state_count(), 21u);
  simulation.set_playing(true);
  simulation.advance(1.01 / 50);
  EXPECT_EQ(simulation.frame(), 16u);
  EXPECT_EQ(simulation.state_count(), 17u);  // what came later is forgotten
  EXPECT_EQ(simulation.state(), 16u);
}

TEST(ViewerPast, ABallThrownMeanwhileWasNeverThere) {
  Simulation untouched(scene(falling), "falling"), simulation(scene(falling), "falling");
  const std::vector<std::uint64_t> without = hashes_of(untouched, 40);
  hashes_of(simulation, 20);
  simulation.add(thrown({0.1f, 2, 10}, {0, 1.8f, 1}, {0, 0, -1}), true);
  const std::vector<std::uint64_t> with = hashes_of(simulation, 20);
  EXPECT_EQ(simulation.scene().objects.size(), 4u);
  for (int i = 0; i < 30; ++i) simulation.step_back();
  EXPECT_EQ(simulation.scene().objects.size(), 3u);
  EXPECT_EQ(simulation.world().objects().size(), 3u);
  EXPECT_EQ(simulation.world().hash(), without[9]);
  // Forth, to where it flies.
  simulation.rewind(35);
  EXPECT_EQ(simulation.world().objects().size(), 4u);
  EXPECT_EQ(simulation.world().hash(), with[14]);
  EXPECT_EQ(hashes_of(simulation, 5).back(), with[19]);
  simulation.rewind(10);
  EXPECT_EQ(hashes_of(simulation, 30), std::vector<std::uint64_t>(without.begin() + 10, without.end()));
}

TEST(ViewerPast, ChangesAreTakenBack) {
  Simulation simulation(scene(falling), "falling");
  const ObjectId cloth = simulation.world().find_object("cloth");
  hashes_of(simulation, 10);
  const std::vector<std::uint64_t> first = hashes_of(simulation, 10);
  for (int i = 0; i < 10; ++i) simulation.step_back();
  Settings settings = simulation.scene().settings;
  settings.gravity = {0, -1, 0};
  simulation.set_settings(settings);
  auto material = std::get<ClothDescription>(simulation.scene().objects[0]).material;
  material.areal_density *= 3;
  simulation.set_material(0, material);
  simulation.toggle_pin(cloth, 19);
  EXPECT_NE(hashes_of(simulation, 10), first);
  for (int i = 0; i < 10; ++i) simulation.step_back();
  EXPECT_EQ(simulation.scene().settings.gravity.y, -9.81f);
  EXPECT_FALSE(simulation.is_pinned(simulation.world().find_object("cloth"), 19));
  EXPECT_EQ(hashes_of(simulation, 10), first);
}

TEST(ViewerPast, EndsAtTheStartOrAtTheLimitOfMemory) {
  Simulation simulation(scene(falling), "falling");
  expect_error([&] { simulation.step_back(); }, {"this is the start"});
  hashes_of(simulation, 3);
  for (int i = 0; i < 3; ++i) simulation.step_back();
  EXPECT_EQ(simulation.time(), 0);
  expect_error([&] { simulation.step_back(); }, {"this is the start"});

  const std::size_t bytes = simulation.world().snapshot().bytes.size();
  simulation.limit_past(10 * bytes + bytes / 2);
  const std::vector<std::uint64_t> hashes = hashes_of(simulation, 50);
  EXPECT_EQ(simulation.state_count(), 11u);
  for (int i = 0; i < 9; ++i) simulation.step_back();
  EXPECT_EQ(simulation.world().hash(), hashes[40]);
  expect_error([&] { simulation.step_back(); }, {"no state before 0.82 s", "0.18 s", "MB"});
  EXPECT_EQ(simulation.world().hash(), hashes[40]);
}

TEST(ViewerPast, LargeStatesAreKeptAtEverySecondStep) {
  Past past(std::size_t{100} << 20);
  const auto large = [](double time) {
    return PastState{time, {std::vector<std::byte>(3 << 19)}, {}, 3 << 19};
  };
  std::vector<double> kept;
  for (int step = 0; step < 10; ++step) {
    if (past.is_due()) past.add(large(step)), kept.push_back(step);
    past.move_on();
    past.count_step();
  }
  EXPECT_EQ(kept, (std::vector<double>{0, 2, 4, 6, 8}));
  EXPECT_EQ(past.bytes(), 5u * (3 << 19));
}

TEST(ViewerPast, TroubleIsPastToo) {
  Simulation simulation(scene(exploding), "exploding");
  for (int i = 0; i < 200 && simulation.playing(); ++i) simulation.advance(1 / 60.0);
  ASSERT_TRUE(simulation.failure().has_value());
  simulation.step_back();
  EXPECT_FALSE(simulation.failure().has_value());
}

// --- additions

TEST(ViewerAdditions, AThrownBallHasTheMassAndTheSpeedThatWereStated) {
  Simulation simulation(scene(R"({"souple": 1, "gravity": [0, 0, 0]})"), "empty");
  const ObjectId ball = simulation.add(thrown({0.2f, 3, 12}, {1, 2, 3}, {0, 0.6f, -0.8f}), true);
  EXPECT_EQ(simulation.world().name(ball), "ball");
  EXPECT_NEAR(simulation.world().total_mass(ball), 3, 1e-4);
  for (int i = 0; i < 30; ++i) simulation.step_frame();
  const Vec3d center = simulation.world().center_of_mass(ball),
              velocity = simulation.world().momentum(ball) / 3;
  EXPECT_LT(length(center - Vec3d{1, 2 + 3.6, 3 - 4.8}), 1e-3);
  EXPECT_LT(length(velocity - Vec3d{0, 7.2, -9.6}), 1e-3);
  for (const Vec3f& x : simulation.world().positions(ball)) EXPECT_LT(length(Vec3d(x) - center), 0.2001);
  EXPECT_EQ(simulation.world().name(simulation.add(thrown({}, {}, {1, 0, 0}), true)), "ball2");
}

TEST(ViewerAdditions, ABallSuitsTheView) {
  for (const float distance : {0.02f, 1.0f, 50.0f}) {
    const Ball ball = ball_for(distance, 9.81f);
    const float time = distance / ball.speed;
    EXPECT_LT(0.5f * 9.81f * time * time, 0.21f * distance);
    EXPECT_GT(ball.radius, 0.01f * distance);
    EXPECT_LT(ball.radius, 0.1f * distance);
    EXPECT_GT(ball_for(distance, 0).speed, distance);
  }
}

TEST(ViewerAdditions, ABallMeetsThePointItWasAimedAt) {
  for (const Vec3f& target : {Vec3f{0, 1, 0}, Vec3f{1, 2.5f, -1}, Vec3f{-2, 0, 1}}) {
    Simulation simulation(scene(R"({"souple": 1, "frame_rate": 500})"), "empty");
    const Vec3f from{0, 1, 4};
    const Ball ball = ball_for(4, 9.81f);
    const ObjectId id =
        simulation.add(thrown(ball, from, aim(from, target, ball.speed, {0, -9.81f, 0})), true);
    double nearest = 1;
    for (int i = 0; i < 500; ++i) {
      simulation.step_frame();
      nearest = std::min(nearest, length(simulation.world().center_of_mass(id) - Vec3d(target)));
    }
    EXPECT_LT(nearest, 0.02);
  }
  // Out of reach: straight.
  EXPECT_LT(length(aim({}, {100, 0, 0}, 1, {0, -9.81f, 0}) - Vec3f{1, 0, 0}), 1e-6f);
}

constexpr const char* floor_only = R"({
  "souple": 1, "frame_rate": 60, "colliders": [{"name": "floor", "shape": {"plane": {}}, "friction": 0.5}]
})";

TEST(ViewerAdditions, EachIsAddedFreelyAndFallsToRest) {
  for (const double size : {0.05, 0.5, 5.0})
    for (const Addition addition : all_additions) {
      SCOPED_TRACE(std::string(label(addition)) + " of " + std::to_string(size));
      Simulation simulation(scene(floor_only), "floor");
      const ObjectId id =
          simulation.add(placed_above({1, 0, 2}, simulation.world(), described(addition, size)));
      const Vec3d start = simulation.world().center_of_mass(id);
      EXPECT_NEAR(start.x, 1, 0.01 * size);
      EXPECT_NEAR(start.z, 2, 0.01 * size);
      for (const Vec3f& x : simulation.world().positions(id)) EXPECT_GT(x.y, 0);
      EXPECT_GT(simulation.world().total_mass(id), 0);
      for (int i = 0; i < (size == 0.5 ? 60 : 12); ++i) simulation.step_frame();
      EXPECT_FALSE(simulation.failure());
      const Vec3d end = simulation.world().center_of_mass(id);
      EXPECT_LT(end.y, start.y);
      EXPECT_GT(end.y, 0);
      EXPECT_LT(length(end - start), 2 * size);
    }
}

TEST(ViewerAdditions, OneLiesAboveAnother) {
  Simulation simulation(scene(floor_only), "floor");
  const auto add = [&] {
    return simulation.add(placed_above({0, 0, 0}, simulation.world(), described(Addition::stiff_box, 1)));
  };
  const ObjectId first = add(), second = add();
  EXPECT_EQ(simulation.world().name(second), "box2");
  float top = 0, bottom = 100;
  for (const Vec3f& x : simulation.world().positions(first)) top = std::max(top, x.y);
  for (const Vec3f& x : simulation.world().positions(second)) bottom = std::min(bottom, x.y);
  EXPECT_GT(bottom, top);
  EXPECT_LT(bottom, top + 1);
}

TEST(ViewerAdditions, StayAfterAResetButForThrownBalls) {
  Simulation simulation(scene(falling), "falling");
  simulation.step_frame();
  simulation.add(thrown({}, {0, 5, 0}, {1, 0, 0}), true);
  simulation.add(placed_above({0, 0, 0}, simulation.world(), described(Addition::rope, 1)));
  EXPECT_EQ(simulation.scene().objects.size(), 5u);
  EXPECT_EQ(copied(simulation).objects.size(), 4u);
  simulation.reset();
  ASSERT_EQ(simulation.scene().objects.size(), 4u);
  EXPECT_EQ(common(simulation.scene().objects[3]).name, "rope2");
  Simulation copy(copied(simulation), "copy");
  for (int i = 0; i < 10; ++i) simulation.step_frame(), copy.step_frame();
  EXPECT_EQ(simulation.world().hash(), copy.world().hash());
}

TEST(ViewerAdditions, OfAMeshFileDependOnItsSurface) {
  const auto file = [](const char* name, const std::string& text) {
    std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / name;
    std::ofstream(path) << text;
    return path;
  };
  const std::string corners = "v 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\n";
  const std::filesystem::path closed = file("a b.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"),
                              open = file("sheet.obj", corners + "f 1 3 2\nf 1 2 4\n");
  Simulation simulation(scene(floor_only), "floor");
  const ObjectId body = simulation.add(placed_above({0, 0, 0}, simulation.world(), described(closed)));
  const ObjectId sheet = simulation.add(placed_above({9, 0, 0}, simulation.world(), described(open)));
  EXPECT_EQ(simulation.world().kind(body), ObjectKind::soft_body);
  EXPECT_EQ(simulation.world().name(body), "a_b");
  EXPECT_EQ(simulation.world().kind(sheet), ObjectKind::cloth);
  EXPECT_LT(length(simulation.world().positions(sheet)[0] - Vec3f{8.5f, 0.4f, -0.5f}), 0.1f);
  Simulation copy(copied(simulation), "copy");
  EXPECT_EQ(copy.world().objects().size(), 2u);
  expect_error([&] { described(file("text.obj", "nothing")); }, {"text.obj"});
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

TEST(ViewerSimulation, ARefusedStepPausesAndSaysWhy) {
  Simulation simulation(scene(R"({"souple": 1, "solver": "dense", "objects": [
    {"name": "sheet", "kind": "cloth", "mesh": {"grid": {"columns": 30, "rows": 30, "size": 1}}}]})"),
                        "dense");
  for (int i = 0; i < 10 && simulation.playing(); ++i) simulation.advance(1 / 60.0);
  EXPECT_FALSE(simulation.playing());
  ASSERT_TRUE(simulation.failure().has_value());
  EXPECT_NE(simulation.failure()->message.find("the solver dense takes at most"), std::string::npos);
  EXPECT_EQ(simulation.failure()->object, "");
  EXPECT_EQ(simulation.history().size(), 0u);
  simulation.set_settings({});
  simulation.step_frame();
  EXPECT_FALSE(simulation.failure());
  EXPECT_GT(simulation.time(), 0);
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
    // A ball is added and taken back, and the frame repeated.
    const std::uint64_t hash = simulation.world().hash();
    simulation.add(thrown(ball_for(1, 9.81f), {0, 50, 0}, {1, 0, 0}), true);
    simulation.rewind(0);
    simulation.step_frame();
    EXPECT_EQ(simulation.world().hash(), hash);
  }
}

}  // namespace souple::viewer::test_app_view_simulation
