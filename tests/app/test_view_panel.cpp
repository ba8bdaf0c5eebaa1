#include "tests/app/view_fixture.h"

#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// The viewer as its user operates it, with a synthetic mouse and keyboard: the panel, and its picture in the manual.

namespace souple::viewer::test_app_view_panel {

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
  render::write_png(file, view.image(), 40);
  EXPECT_TRUE(view.viewer().mouse().grabbing());
  EXPECT_LT(std::filesystem::file_size(file), 150'000u);
}

}  // namespace souple::viewer::test_app_view_panel
