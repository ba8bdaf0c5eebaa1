#include "app/view/window.h"
#include "souple/io/recorder.h"
#include "tests/app/offscreen_viewer.h"
#include "tests/expect_error.h"
#include "tests/paths.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

// The viewer as its user operates it, with a synthetic mouse and keyboard.

namespace souple::viewer {
namespace {

constexpr const char* cloth = R"({
  "souple": 1, "description": "A cloth that hangs by its upper edge.", "frame_rate": 60, "substeps": 5,
  "camera": {"from": [0, 1, 4], "to": [0, 1, 0], "fov": 40},
  "objects": [
    {"name": "cloth", "kind": "cloth", "mesh": {"grid": {"columns": 11, "rows": 11, "size": 1}},
     "transform": {"translate": [0, 1, 0], "rotate": [90, 0, 0]},
     "material": {"preset": "cotton", "damping": 1}, "pins": [{"vertices": [0, 5, 10]}]}
  ]
})";

constexpr const char* grains = R"({
  "souple": 1, "description": "Grains.",
  "objects": [{"name": "sand", "kind": "grains", "points": [[0, 1, 0], [1, 1, 0]], "material": {"radius": 0.1}}]
})";

// A drag too strong for explicit integration: speeds grow sixteenfold each substep.
constexpr const char* exploding = R"({
  "souple": 1, "drag": 10000, "integrator": "explicit_euler",
  "objects": [{"name": "sand", "kind": "grains", "points": [[0, 1, 0], [1, 1, 0]]}],
  "wind": {"velocity": [2, 0, 0]}
})";

/// A folder with the scenes above, for a scene list.
struct Scenes {
  TestFolder folder;
  std::vector<app::ShippedScene> list{
      {"cloth", folder.write("cloth.json", cloth)},
      {"grains", folder.write("grains.json", grains)},
      {"broken", folder.write("broken.json", "{ \"souple\": 1, \"objets\": [] }")}};
};

class View : public ::testing::Test {
 protected:
  Scenes scenes;
  OffscreenViewer view{scenes.list[0].file, {}, scenes.list};

  Vec3f vertex(std::size_t i) { return world().positions(world().find_object("cloth"))[i]; }
  World& world() { return view.simulation().world(); }
  bool said(const std::string& words) {
    const std::vector<std::string> notices = view.viewer().notices();
    return std::any_of(notices.begin(), notices.end(),
                       [&](const std::string& notice) { return notice.find(words) != std::string::npos; });
  }
  void pause() {
    if (view.viewer().session().playing()) view.type(" ");
  }
  std::vector<std::string> files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(view.folder().path()))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

// --- keys

TEST_F(View, RunsAtOnceAndPauses) {
  view.pictures(6);
  EXPECT_NEAR(view.viewer().session().time(), 0.1, 0.02);
  view.type(" ");
  EXPECT_FALSE(view.viewer().session().playing());
  const double time = view.viewer().session().time();
  view.pictures(3);
  EXPECT_EQ(view.viewer().session().time(), time);
  view.type(" ");
  view.picture();
  EXPECT_GT(view.viewer().session().time(), time);
}

TEST_F(View, StepsAndResets) {
  pause();
  view.type("r");
  EXPECT_EQ(view.viewer().session().time(), 0);
  view.type(".");
  EXPECT_NEAR(view.viewer().session().time(), 1 / 60.0, 1e-9);
  view.type(",");
  EXPECT_NEAR(view.viewer().session().time(), 1.2 / 60.0, 1e-9);
  view.type("R");  // with shift or caps lock it is the same key
  EXPECT_EQ(view.viewer().session().time(), 0);
}

TEST_F(View, AKeyThatIsHeldStepsOnButPausesOnce) {
  pause();
  view.type("r");
  OffscreenViewer::io().KeysDown[65] = true;
  view.type("....");
  EXPECT_EQ(view.viewer().session().frame(), 4u);
  view.type("    ");
  EXPECT_TRUE(view.viewer().session().playing());
  OffscreenViewer::io().KeysDown[65] = false;
  view.picture();
  view.type("  ");  // pressed twice
  EXPECT_TRUE(view.viewer().session().playing());
}

TEST_F(View, KeysChooseWhatIsShown) {
  for (int i = 0; i < 9; ++i) {
    view.type(std::to_string(i + 1).c_str());
    EXPECT_EQ(static_cast<int>(view.viewer().display().display), i);
  }
  view.type("w");
  EXPECT_TRUE(view.viewer().display().wireframe);
  view.type("w");
  EXPECT_FALSE(view.viewer().display().wireframe);
  std::set<render::ConstraintDisplay> seen;
  for (std::size_t i = 0; i < render::constraint_display_count; ++i) {
    seen.insert(view.viewer().display().constraints);
    view.type("c");
  }
  EXPECT_EQ(seen.size(), render::constraint_display_count);
  EXPECT_EQ(view.viewer().display().constraints, render::ConstraintDisplay::none);
}

TEST_F(View, EveryDisplayLooksDifferent) {
  pause();
  view.type("h");
  std::vector<render::Image> pictures;
  const auto look = [&](const std::string& keys) {
    view.type(keys.c_str());
    view.picture();
    const render::Image picture = view.image();
    EXPECT_EQ(std::count(pictures.begin(), pictures.end(), picture), 0) << keys;
    pictures.push_back(picture);
  };
  for (const char* key : {"1", "2", "3", "4", "5", "6", "8"}) look(key);
  for (int i = 0; i < 4; ++i) look("c");
}

TEST_F(View, HidesItsPanels) {
  view.pictures(2);
  const ViewArea before = view.viewer().area();
  EXPECT_GT(before.x, 0);
  view.type("h");
  view.picture();
  EXPECT_EQ(view.viewer().area().x, 0);
  EXPECT_EQ(view.viewer().area().width, 200);
  EXPECT_EQ(view.viewer().area().height, 400);
  view.type("h");
  view.picture();
  EXPECT_EQ(view.viewer().area().x, before.x);
  EXPECT_EQ(view.viewer().area().height, before.height);
}

TEST_F(View, FramesAll) {
  view.viewer().camera().zoom(30);
  view.type("f");
  const ImVec2 corner = view.seen(vertex(0)), opposite = view.seen(vertex(120));
  EXPECT_GT(std::hypot(corner.x - opposite.x, corner.y - opposite.y), 250);
  for (const ImVec2& at : {corner, opposite}) {
    EXPECT_GT(at.x, 350);
    EXPECT_LT(at.x, 1000);
  }
}

TEST_F(View, EscapeQuitsWhenItIsPressedTwice) {
  view.picture();
  view.type("\x1b");
  EXPECT_FALSE(view.viewer().done());
  EXPECT_TRUE(said("Esc again quits"));
  view.picture(5);  // later it is a first press again
  view.type("\x1b");
  EXPECT_FALSE(view.viewer().done());
  view.type("\x1b");
  EXPECT_TRUE(view.viewer().done());
}

TEST_F(View, TheNextSceneShowsNoConstraintsThatWereChosenForThisOne) {
  view.type("c");
  EXPECT_NE(view.viewer().display().constraints, render::ConstraintDisplay::none);
  view.type("n");
  EXPECT_EQ(view.viewer().display().constraints, render::ConstraintDisplay::none);
}

TEST(ViewWindow, FitsOnTheScreen) {
  const WindowArea small = fitted({1440, 900}, {1280, 720});
  EXPECT_EQ(small.width, 1280);
  EXPECT_LT(small.height, 720);
  EXPECT_GT(small.height, 600);
  EXPECT_EQ(fitted({1440, 900}, {2560, 1440}).height, 900);
  EXPECT_EQ(fitted({1440, 900}, {}).width, 1440);
}

TEST_F(View, GoesThroughTheScenes) {
  view.type("n");
  EXPECT_EQ(view.viewer().session().name(), "grains");
  view.type("p");
  EXPECT_EQ(view.viewer().session().name(), "cloth");
  view.type("p");  // wraps around to the broken scene
  EXPECT_EQ(view.viewer().session().name(), "cloth");
  EXPECT_TRUE(said("objets"));
  view.type("p");  // and past it
  EXPECT_EQ(view.viewer().session().name(), "grains");
}

/// The image of the scene alone at its start.
render::Image at_the_start(OffscreenViewer& view) {
  if (view.viewer().session().playing()) view.type(" ");
  view.type("3");
  if (view.viewer().panels_shown()) view.type("h");
  view.pictures(2);
  return view.image();
}

TEST(ViewScenes, ASceneAfterAnotherLooksAsItDoesAlone) {
  Scenes scenes;
  std::string coarse = cloth;
  coarse.replace(coarse.find("11"), 2, "5");
  const std::filesystem::path file = scenes.folder.write("coarse.json", coarse);
  const WindowSize size{600, 400, 0.5f};
  render::Image alone, after;
  {
    OffscreenViewer view(file, size);
    alone = at_the_start(view);
  }
  {
    OffscreenViewer view(scenes.list[0].file, size);
    EXPECT_NE(at_the_start(view), alone);
    view.viewer().open(file);
    after = at_the_start(view);
  }
  EXPECT_EQ(after, alone);
}

// --- the mouse

TEST_F(View, AGrabbedClothFollowsTheMouseAndIsReleased) {
  view.pictures(5);
  const ImVec2 start = view.seen(vertex(115));
  view.move(start.x, start.y - 4);
  view.press();
  ASSERT_TRUE(view.viewer().mouse().grabbing());
  for (int i = 1; i <= 20; ++i) view.move(start.x, start.y - 4 - 6.0f * static_cast<float>(i));
  view.pictures(30);
  EXPECT_NEAR(view.seen(view.viewer().mouse().grabbed_point()).y, start.y - 124, 20);
  EXPECT_NEAR(view.seen(vertex(115)).y, start.y - 120, 40);
  const render::Camera camera = view.viewer().camera();
  view.release();
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.pictures(90);
  EXPECT_NEAR(view.seen(vertex(115)).y, start.y, 30);  // it hangs as before
  EXPECT_EQ(view.viewer().camera().from, camera.from);
  EXPECT_FALSE(view.viewer().session().failure());
}

TEST_F(View, PullingFarAndFastBreaksNothing) {
  view.pictures(2);
  const ImVec2 start = view.seen(vertex(60));
  view.move(start.x, start.y);
  view.press();
  ASSERT_TRUE(view.viewer().mouse().grabbing());
  for (int i = 0; i < 60; ++i) view.move(i % 2 == 0 ? 990 : 360, i % 3 == 0 ? 10 : 1700);
  EXPECT_FALSE(view.viewer().session().failure());
  view.release();
  view.pictures(5);
  EXPECT_TRUE(is_finite(vertex(60)));
  EXPECT_LT(length(vertex(60)), 3);
}

TEST_F(View, WhatIsPinnedCannotBeGrabbed) {
  view.pictures(2);
  const ImVec2 pin = view.seen(vertex(5));
  view.move(pin.x, pin.y + 6);
  view.press();
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.release();
}

TEST_F(View, ResettingLetsGo) {
  view.pictures(2);
  const ImVec2 start = view.seen(vertex(60));
  view.move(start.x, start.y);
  view.press();
  ASSERT_TRUE(view.viewer().mouse().grabbing());
  view.type("r");
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.move(start.x + 50, start.y);
  view.type("n");
  view.release();
  EXPECT_EQ(view.viewer().session().name(), "grains");
}

TEST_F(View, EmptySpaceOrbitsRightPansWheelZooms) {
  pause();
  const render::Camera start = view.viewer().camera();
  view.move(420, 100);
  view.press();
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.move(520, 100);
  view.release();
  render::Camera now = view.viewer().camera();
  EXPECT_NEAR(now.distance(), start.distance(), 1e-3);
  EXPECT_EQ(now.to, start.to);
  EXPECT_LT(now.from.x, start.from.x - 0.5f);  // the scene rotates with the mouse
  view.press(1);
  view.move(560, 100);
  view.release(1);
  EXPECT_NEAR(length(view.viewer().camera().to - now.to),
              40 * now.pixel_size(now.distance(), view.viewer().area().height) * 0.2f, 0.02);
  now = view.viewer().camera();
  OffscreenViewer::io().MouseWheel = 2;
  view.picture();
  EXPECT_LT(view.viewer().camera().distance(), 0.85f * now.distance());
}

TEST_F(View, ThePanelKeepsItsMouse) {
  pause();
  const render::Camera start = view.viewer().camera();
  view.move(20, 1700);
  view.press();
  view.move(200, 1500);
  view.release();
  OffscreenViewer::io().MouseWheel = 1;
  view.picture();
  EXPECT_EQ(view.viewer().camera().from, start.from);
}

TEST_F(View, DoubleClickPinsAndUnpins) {
  pause();
  const ObjectId object = world().find_object("cloth");
  const ImVec2 at = view.seen(vertex(60));
  view.double_click(at.x, at.y);
  EXPECT_TRUE(view.simulation().is_pinned(object, 60)) << ::testing::PrintToString(world().pinned(object));
  const Vec3f held = vertex(60);
  view.type(" ");
  view.pictures(20);
  EXPECT_EQ(vertex(60), held);
  view.double_click(at.x, at.y);
  EXPECT_FALSE(view.simulation().is_pinned(object, 60));
  EXPECT_EQ(world().pinned(object).size(), 3u);
}

// --- the past, and additions

TEST_F(View, BGoesBackInTimeAndSpaceGoesOnFromThere) {
  pause();
  view.type("r");
  view.type("b");
  EXPECT_TRUE(said("this is the start"));
  view.type("....");
  const std::uint64_t hash = world().hash();
  view.type(".");
  view.type(" ");
  view.picture();
  view.type("b");
  EXPECT_FALSE(view.viewer().session().playing());
  while (view.viewer().session().frame() > 4) view.type("B");
  EXPECT_EQ(world().hash(), hash);
  view.type("bb..");
  EXPECT_EQ(world().hash(), hash);
  view.type(" ");
  view.pictures(3);
  EXPECT_GT(view.viewer().session().frame(), 5u);
}

TEST_F(View, BReleasesWhatIsGrabbed) {
  view.pictures(5);
  const ImVec2 start = view.seen(vertex(60));
  view.move(start.x, start.y);
  view.press();
  ASSERT_TRUE(view.viewer().mouse().grabbing());
  view.type("b");
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.release();
}

TEST_F(View, TheRewindSliderGoesAnywhere) {
  view.pictures(20);
  const double end = view.viewer().session().time();
  const ImVec2 slider = view.control("##rewind");
  ASSERT_GT(slider.x, 0);
  view.click(20, slider.y);
  EXPECT_FALSE(view.viewer().session().playing());
  EXPECT_EQ(view.viewer().session().time(), 0);
  view.click(300, slider.y);
  EXPECT_GE(view.viewer().session().time(), end);
  view.click(150, slider.y);
  EXPECT_LT(view.viewer().session().time(), end);
  EXPECT_GT(view.viewer().session().time(), 0);
}

TEST_F(View, ABallIsThrownAlongTheCursor) {
  view.pictures(5);
  const Vec3f aim = vertex(82);
  const ImVec2 cursor = view.seen(aim);
  view.move(cursor.x, cursor.y);
  view.type("t");
  EXPECT_TRUE(said("ball: radius 0.1 m, 2.09 kg, 9.9 m/s")) << view.viewer().notices().back();
  const ObjectId ball = world().find_object("ball");
  const Vec3f from(world().center_of_mass(ball)), way = view.viewer().camera().from - from;
  EXPECT_LT(length(way), 0.5f);
  EXPECT_GT(dot(normalized(Vec3f(world().momentum(ball))), normalized(aim - from)), 0.97f);
  const double depth = world().center_of_mass(world().find_object("cloth")).z;
  view.pictures(30);
  EXPECT_FALSE(view.viewer().session().failure());
  EXPECT_LT(world().center_of_mass(world().find_object("cloth")).z, depth - 0.1);  // the cloth is hit
  view.type("t");
  EXPECT_EQ(world().objects().size(), 3u);
  view.type("r");
  EXPECT_EQ(world().objects().size(), 1u);
}

TEST_F(View, ABallNeedsRoom) {
  pause();
  view.viewer().camera().from = vertex(60) + Vec3f{0, 0, 0.2f};
  view.viewer().camera().to = vertex(60);
  view.type("t");
  EXPECT_TRUE(said("no room for a ball"));
  EXPECT_EQ(world().objects().size(), 1u);
}

/// Chooses from the menu that the key A opens.
void choose(OffscreenViewer& view, const char* item) {
  view.type("a");
  view.pictures(2);
  const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
  ASSERT_EQ(open.size(), 1);
  ASSERT_NE(open.back().Window, nullptr);
  const ImGuiWindow& menu = *open.back().Window;
  const ImVec2 at = view.control(item, menu.Name, menu.Pos.x + 20);
  ASSERT_GT(at.x, 0) << item;
  view.click(at.x, at.y);
}

TEST_F(View, TheMenuAddsAtTheCursor) {
  pause();
  const std::vector<std::pair<const char*, ObjectKind>> items{{"Cloth", ObjectKind::cloth},
                                                              {"Soft ball", ObjectKind::soft_body},
                                                              {"Stiff box", ObjectKind::soft_body},
                                                              {"Rope", ObjectKind::rope},
                                                              {"Grains", ObjectKind::grains}};
  std::size_t objects = 1;
  for (const auto& [item, kind] : items) {
    const ImVec2 cursor = view.seen(vertex(5));
    view.move(cursor.x, cursor.y + 2);
    choose(view, item);
    ASSERT_EQ(world().objects().size(), ++objects) << item;
    const ObjectId added = world().objects().back();
    EXPECT_EQ(world().kind(added), kind) << item;
    const Vec3f center(world().center_of_mass(added));
    EXPECT_NEAR(center.x, vertex(5).x, 0.05f) << item;
    EXPECT_NEAR(center.z, vertex(5).z, 0.05f) << item;
    EXPECT_GT(center.y, vertex(5).y) << item;
    EXPECT_TRUE(said("added " + world().name(added)));
  }
  view.type("a");
  view.pictures(2);
  view.type("\x1b");  // closes the menu
  view.pictures(2);
  EXPECT_TRUE(ImGui::GetCurrentContext()->OpenPopupStack.empty());
  EXPECT_EQ(world().objects().size(), objects);
}

TEST_F(View, ADroppedMeshIsAdded) {
  pause();
  view.viewer().open(scenes.folder.write("kite.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"));
  EXPECT_EQ(world().kind(world().find_object("kite")), ObjectKind::cloth);
  EXPECT_EQ(view.viewer().session().name(), "cloth");
  view.viewer().open(scenes.folder.write("bad.obj", "v 0 0\n"));
  EXPECT_TRUE(said("bad.obj"));
  EXPECT_EQ(world().objects().size(), 2u);
}

// --- the panel

TEST_F(View, SlidersActAtOnce) {
  pause();
  const ImVec2 substeps = view.control("##substeps");
  ASSERT_GT(substeps.x, 0);
  view.click(substeps.x + 60, substeps.y);
  const int set = view.simulation().scene().settings.substeps;
  EXPECT_GT(set, 15);
  view.type(".");
  EXPECT_EQ(view.simulation().report().substeps, set);

  const ImVec2 stiffness = view.control("##membrane_stiffness");
  view.click(stiffness.x - 80, stiffness.y);
  const ObjectId object = world().find_object("cloth");
  EXPECT_LT(world().cloth_material(object).membrane_stiffness, 100);
  EXPECT_GE(world().cloth_material(object).membrane_stiffness, 1);

  const ImVec2 density = view.control("##areal_density");
  const double mass = world().total_mass(object);
  view.click(density.x + 60, density.y);
  EXPECT_GT(world().total_mass(object), 2 * mass);

  const ImVec2 gusts = view.control("##gust");
  view.click(gusts.x, gusts.y);
  EXPECT_NEAR(world().settings().wind.gust, 0.5, 0.2);
}

TEST_F(View, TinyValuesHaveSlidersToo) {
  pause();
  const ImVec2 bending = view.control("##bending_stiffness");
  view.click(bending.x - 85, bending.y);
  const float bent = world().cloth_material(world().find_object("cloth")).bending_stiffness;
  EXPECT_LT(bent, 1e-6f);
  EXPECT_GE(bent, 1e-8f);
}

TEST_F(View, ANumberCanBeTyped) {
  pause();
  const ImVec2 stiffness = view.control("##membrane_stiffness");
  OffscreenViewer::io().KeyCtrl = true;
  view.click(stiffness.x, stiffness.y);
  OffscreenViewer::io().KeyCtrl = false;
  view.pictures(2);
  view.type("1234");  // digits typed into a field select no display
  OffscreenViewer::io().KeysDown[257] = true;
  view.picture();
  OffscreenViewer::io().KeysDown[257] = false;
  view.picture();
  EXPECT_EQ(world().cloth_material(world().find_object("cloth")).membrane_stiffness, 1234);
  EXPECT_EQ(view.viewer().display().display, render::Display::shaded);
}

TEST_F(View, ButtonsDoWhatTheKeysDo) {
  view.picture();
  const ImVec2 play = view.control("###play", "##panel", 50);
  ASSERT_GT(play.x, 0);
  view.click(play.x, play.y);
  EXPECT_FALSE(view.viewer().session().playing());
  const double time = view.viewer().session().time();
  const ImVec2 frame = view.control("###frame", "##panel", 220);
  view.click(frame.x, frame.y);
  EXPECT_NEAR(view.viewer().session().time(), time + 1 / 60.0, 1e-9);
  const ImVec2 reset = view.control("###reset", "##panel", 300);
  view.click(reset.x, reset.y);
  EXPECT_EQ(view.viewer().session().time(), 0);
  const ImVec2 next = view.control("##next", "##panel", 318);
  view.click(next.x, next.y);
  EXPECT_EQ(view.viewer().session().name(), "grains");
}

TEST_F(View, TheCopiedSceneIsTheOneOnScreen) {
  pause();
  view.type("r");
  const ImVec2 substeps = view.control("##substeps");
  view.click(substeps.x + 60, substeps.y);
  view.viewer().camera().orbit(0.5f, 0.1f);
  const ImVec2 copy = view.control("###copy");
  ASSERT_GT(copy.x, 0);
  view.click(copy.x, copy.y);
  const std::string text = ImGui::GetClipboardText();
  const SceneDescription scene = parse_scene(text, scenes.folder.path(), "clipboard");
  EXPECT_EQ(scene.settings.substeps, view.simulation().scene().settings.substeps);
  EXPECT_LT(length(Vec3f(scene.camera.from) - view.viewer().camera().from), 1e-5f);
  Simulation copied(scene, "copied");
  for (int i = 0; i < 3; ++i) {
    copied.step_frame();
    view.type(".");
  }
  EXPECT_EQ(copied.world().hash(), world().hash());
}

TEST_F(View, EveryKindOfMaterialHasItsSliders) {
  const std::vector<std::string> objects{
      R"("name": "body", "kind": "soft_body", "mesh": {"tet_bar": {"cells": [1, 1, 1], "size": [1, 1, 1]}})",
      R"("name": "rope", "kind": "rope", "points": [[0, 1, 0], [1, 1, 0]], "segments": 3)",
      R"("name": "sand", "kind": "grains", "points": [[0, 1, 0]])"};
  for (const std::string& object : objects) {
    view.viewer().open(scenes.folder.write(std::to_string(&object - objects.data()) + ".json",
                                           "{\"souple\": 1, \"objects\": [{" + object + "}]}"));
    pause();
    view.invalidate_layout();
    const ImVec2 friction = view.control("##friction");
    ASSERT_GT(friction.x, 0) << object;
    const std::string before = view.simulation().scene_text();
    view.click(friction.x + 50, friction.y);
    EXPECT_NE(view.simulation().scene_text(), before) << object;
  }
}

// --- pictures

TEST_F(View, ScreenshotsAreWrittenAndNeverOverwritten) {
  view.pictures(2);
  view.type("s");
  EXPECT_TRUE(said("souple-cloth-0001.png"));
  EXPECT_EQ(files(), (std::vector<std::string>{"souple-cloth-0001.png"}));
  const render::Image first = render::read_png(view.folder().path() / "souple-cloth-0001.png");
  EXPECT_EQ(first.width, view.viewer().area().width);
  EXPECT_EQ(first.height, view.viewer().area().height);
  view.viewer().camera().orbit(1, 0);
  view.type("s");
  EXPECT_EQ(files(), (std::vector<std::string>{"souple-cloth-0001.png", "souple-cloth-0002.png"}));
  EXPECT_EQ(render::read_png(view.folder().path() / "souple-cloth-0001.png"), first);
}

TEST_F(View, AScreenshotThatCannotBeWrittenIsSaid) {
  view.picture();
  std::filesystem::remove_all(view.folder().path());
  view.type("s");
  EXPECT_TRUE(said("souple-cloth-0001.png"));
  view.pictures(2);
}

TEST_F(View, FilmsHaveEveryFrame) {
  pause();
  view.type("r");
  view.type("v");
  if (!render::has_ffmpeg()) {
    EXPECT_TRUE(said("ffmpeg"));
    EXPECT_FALSE(view.viewer().filming());
    return;
  }
  ASSERT_TRUE(view.viewer().filming());
  view.type(" ");
  for (int i = 0; i < 9; ++i) view.picture(0.2);  // drawing is slow, but no frame is missing
  view.type("v");
  EXPECT_FALSE(view.viewer().filming());
  EXPECT_TRUE(said("souple-cloth-0001.mp4, " + std::to_string(view.viewer().session().frame()) + " frames"))
      << view.viewer().notices().back();
  EXPECT_EQ(files(), (std::vector<std::string>{"souple-cloth-0001.mp4"}));
}

// --- errors

TEST_F(View, ABrokenFileLeavesTheRunningScene) {
  view.pictures(3);
  const double time = view.viewer().session().time();
  for (const char* name : {"broken.json", "missing.json", "cloth.obj"}) {
    view.viewer().open(scenes.folder.path() / name);
    view.picture();
    EXPECT_EQ(view.viewer().session().name(), "cloth");
    EXPECT_TRUE(said(name));
  }
  EXPECT_GT(view.viewer().session().time(), time);
  view.viewer().open(scenes.folder.path());  // a folder that is not a run's
  EXPECT_TRUE(said("run.json"));
  EXPECT_EQ(view.viewer().session().name(), "cloth");
}

TEST_F(View, TroublePausesAndIsNamed) {
  view.viewer().open(scenes.folder.write("exploding.json", exploding));
  for (int i = 0; i < 200 && view.viewer().session().playing(); ++i) view.picture();
  EXPECT_FALSE(view.viewer().session().playing());
  EXPECT_TRUE(said("object \"sand\", particle"));
  const render::Image marked = view.image();
  view.pictures(2);
  view.type("r");
  EXPECT_FALSE(view.viewer().session().failure());
}

TEST_F(View, SmallAndMinimisedWindowsSurvive) {
  view.pictures(2);
  for (const WindowSize& size :
       {WindowSize{1, 1, 1}, WindowSize{0, 0, 1}, WindowSize{2, 300, 1}, WindowSize{300, 2, 1},
        WindowSize{33, 17, 1}, WindowSize{0, 100, 1}, WindowSize{400, 300, 1}}) {
    const double time = view.viewer().session().time();
    view.resize(size);
    view.pictures(3);
    view.click(0, 0);
    view.type("hsfh");
    EXPECT_GT(view.viewer().session().time(), time);
  }
  EXPECT_GT(view.viewer().area().width, 100);
}

TEST(ViewResolution, OfHalfFillsTheSameWindow) {
  const Scenes scenes;
  const WindowSize size{641, 403, 1};
  const auto shown = [&](bool half) {
    OffscreenViewer view(scenes.list[0].file, size, {}, half);
    view.type("hr ");
    view.picture();
    return view.image();
  };
  const render::Image full = shown(false), half = shown(true);
  ASSERT_EQ(full.pixels.size(), half.pixels.size());
  double difference = 0;
  for (std::size_t i = 0; i < full.pixels.size(); ++i)
    difference += std::abs(int(full.pixels[i]) - int(half.pixels[i]));
  difference /= static_cast<double>(full.pixels.size());
  EXPECT_GT(difference, 0);
  EXPECT_LT(difference, 4);  // of 255
}

/// Text is as large and as sharp as at full resolution: the same pixels, where the legend lies over nothing else.
TEST(ViewResolution, OfHalfHasTheSameLegends) {
  const Scenes scenes;
  const auto legend = [&](bool half) {
    OffscreenViewer view(scenes.list[0].file, {641, 403, 1}, {}, half);
    view.type("hr 4");  // strain
    view.picture();
    render::Image image = view.image();
    std::vector<std::uint8_t> title;  // the first line of the legend, on its own background
    for (int y = 16; y < 28; ++y) title.insert(title.end(), image.at(18, y), image.at(18 + 50, y));
    return title;
  };
  const std::vector<std::uint8_t> full = legend(false), half = legend(true);
  int different = 0;
  for (std::size_t i = 0; i < full.size(); ++i) different += std::abs(full[i] - half[i]) > 24 ? 1 : 0;
  EXPECT_LT(different, static_cast<int>(full.size()) / 50);
}

TEST(ViewFont, OfImGuiServesWhereNoneIsInstalled) {
  const TestFolder folder;
  const render::OffscreenContext context(render::Api::gl33);
  const Ui ui(1,
              {folder.path() / "missing.ttf", folder.write("broken.ttf", "this is no font"), folder.path()});
  EXPECT_EQ(ui.font(), "built in");
  ImGui::GetIO().DisplaySize = {300, 200};
  ViewTarget window;
  window.resize(300, 200);
  SceneList scenes({});
  std::unique_ptr<Session> session = scenes.open(folder.write("cloth.json", cloth));
  Viewer viewer(std::move(scenes), std::move(session), {folder.path(), false});
  for (int i = 0; i < 3; ++i) viewer.frame(1 / 60.0, window.framebuffer());
  EXPECT_GT(viewer.session().frame(), 0u);
}

// --- recordings

class ViewRecording : public View {
 protected:
  void SetUp() override {
    World recorded = build_world(load_scene(scenes.list[0].file));
    RecorderOptions options;
    options.scene = cloth;
    options.frames = 30;
    Recorder recorder(recorded, scenes.folder.path() / "run", options);
    for (int frame = 0; frame < 30; ++frame) {
      recorded.step(1 / 60.0);
      recorder.capture();
      last = recorded.positions(recorded.find_object("cloth"))[115];
    }
    recorder.finish();
    view.viewer().open(scenes.folder.path() / "run");
    ASSERT_NE(view.viewer().recording(), nullptr) << view.viewer().notices().back();
  }
  Vec3f shown(std::size_t i) { return view.viewer().session().subject().bodies[0].positions[i]; }
  Vec3f last{};
};

TEST_F(ViewRecording, PlaysToItsEndAndAgain) {
  EXPECT_EQ(view.viewer().session().frame(), 1u);
  view.pictures(40);
  EXPECT_EQ(view.viewer().session().frame(), 30u);
  EXPECT_FALSE(view.viewer().session().playing());
  EXPECT_EQ(shown(115), last);
  view.type(" ");
  view.pictures(3);
  EXPECT_LT(view.viewer().session().frame(), 10u);
  EXPECT_TRUE(view.viewer().session().playing());
}

TEST_F(ViewRecording, KeysGoFrameByFrame) {
  view.pictures(5);
  view.type(".");
  const std::uint64_t frame = view.viewer().session().frame();
  view.type(".");
  EXPECT_EQ(view.viewer().session().frame(), frame + 1);
  view.type(",");
  EXPECT_EQ(view.viewer().session().frame(), frame);
  view.type("r,,");
  EXPECT_EQ(view.viewer().session().frame(), 1u);
}

TEST_F(ViewRecording, GoesBackButTakesNoBalls) {
  view.type(".r..b");
  EXPECT_EQ(view.viewer().session().frame(), 2u);
  view.type("bb");
  EXPECT_TRUE(said("this is the first frame"));
  EXPECT_EQ(view.viewer().session().frame(), 1u);
  for (const char* key : {"t", "a"}) {
    view.type(key);
    EXPECT_TRUE(said("a recording cannot be changed"));
  }
}

TEST_F(ViewRecording, TheSliderGoesAnywhere) {
  view.pictures(2);
  const ImVec2 slider = view.control("##frame_shown", "##time", 670);
  ASSERT_GT(slider.x, 0);
  view.click(970, slider.y);
  EXPECT_GE(view.viewer().session().frame(), 29u);
  EXPECT_FALSE(view.viewer().session().playing());
  view.click(380, slider.y);
  EXPECT_LE(view.viewer().session().frame(), 2u);
}

TEST_F(ViewRecording, CannotBeGrabbedButCanBeTurned) {
  view.type(".");
  const ImVec2 at = view.seen(shown(60));
  const Vec3f from = view.viewer().camera().from;
  view.move(at.x, at.y);
  view.press();
  EXPECT_FALSE(view.viewer().mouse().grabbing());
  view.move(at.x + 100, at.y);
  view.release();
  EXPECT_NE(view.viewer().camera().from, from);
  for (const char* key : {"1", "4", "5", "7", "9", "c", "c", "w"}) view.type(key);
}

// --- the manual's picture; SOUPLE_VIEWER_PICTURE=docs/pictures/viewer.png replaces it

TEST(ViewPicture, OfTheManual) {
  const TestFolder folder;
  const char* wish = std::getenv("SOUPLE_VIEWER_PICTURE");
  const std::filesystem::path file = wish != nullptr ? wish : folder.path() / "viewer.png";
  // Small while time passes and a corner is pulled; then in full size.
  const WindowSize size{1120, 720, 1};
  OffscreenViewer view(source_path("scenes/curtain.json"), {size.width, size.height, 0.1f});
  view.pictures(125);
  const ImVec2 at = view.seen(view.viewer().session().subject().bodies[0].positions[std::size_t{39} * 46]);
  view.move(at.x + 12, at.y - 12);
  view.press();
  for (float i = 1; i <= 10; ++i) view.move(at.x - 14 * i, at.y - 9 * i);
  view.pictures(10);
  view.viewer().rendering().shadows = view.viewer().rendering().ambient_occlusion = true;
  view.resize(size);
  view.pictures(2);
  render::write_png(file, view.image(), 96);
  EXPECT_TRUE(view.viewer().mouse().grabbing());
  EXPECT_LT(std::filesystem::file_size(file), 150'000u);
}

}  // namespace
}  // namespace souple::viewer
