#include "app/view/window.h"
#include "tests/app/view_fixture.h"
#include "tests/expect_error.h"

#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

// The viewer as its user operates it, with a synthetic mouse and keyboard: keys, pictures, errors.

namespace souple::viewer::test_app_view {

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

TEST(ViewScenes, AreGoneThrough) {
  const TestScenes scenes;
  OffscreenViewer view(scenes.list[0].file, {}, scenes.list);
  view.type("n");
  EXPECT_EQ(view.viewer().session().name(), "grains");
  view.type("p");
  EXPECT_EQ(view.viewer().session().name(), "cloth");
  view.type("p");  // wraps around to the broken scene
  EXPECT_EQ(view.viewer().session().name(), "cloth");
  EXPECT_NE(view.viewer().notices().back().find("objets"), std::string::npos);
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
  TestScenes scenes;
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

/// Water, glass, cloth and shadows: the picture on screen, of one sample and coarse, against the screenshot of eight.
TEST(ViewerPicture, IsCloseToTheScreenshot) {
  constexpr const char* everything = R"({
    "souple": 1, "camera": {"from": [1.1, 0.9, 1.6], "to": [0, 0.15, 0], "fov": 34},
    "objects": [
      {"name": "pool", "kind": "fluid", "box": {"lo": [-0.36, 0, -0.26], "hi": [0.36, 0.16, 0.26]},
       "material": {"preset": "water", "spacing": 0.02}},
      {"name": "cloth", "kind": "cloth", "mesh": {"grid": {"columns": 11, "rows": 11, "size": 0.4}},
       "transform": {"translate": [-0.7, 0.3, -0.3], "rotate": [60, 20, 0]}}
    ],
    "colliders": [
      {"name": "floor", "shape": {"plane": {}}},
      {"name": "front", "shape": {"box": {"half_extents": [0.4, 0.15, 0.02]}}, "transform": {"translate": [0, 0.15, 0.29]},
       "color": "#cfe3ea", "look": "glass"},
      {"name": "back", "shape": {"box": {"half_extents": [0.4, 0.15, 0.02]}}, "transform": {"translate": [0, 0.15, -0.29]},
       "color": "#cfe3ea", "look": "glass"},
      {"name": "ball", "shape": {"sphere": {"radius": 0.12}}, "transform": {"translate": [0.1, 0.2, 0]}}
    ]
  })";
  const TestFolder folder;
  OffscreenViewer view(folder.write("everything.json", everything));
  view.simulation().set_playing(false);
  view.resize({480, 360, 1});
  view.type("h");
  view.picture();
  const render::Image seen = view.image();
  view.type("s");
  const render::Image still = render::read_png(view.folder().path() / "souple-everything-0001.png");
  ASSERT_EQ(still.width, seen.width);
  ASSERT_EQ(still.height, seen.height);
  double sum = 0;
  int count = 0;
  for (int y = 60; y < seen.height; ++y)  // below the line of text
    for (int x = 0; x < seen.width; ++x)
      for (int c = 0; c < 3; ++c, ++count) {
        const double off = (seen.at(x, y)[c] - still.at(x, y)[c]) / 255.0;
        sum += off * off;
      }
  EXPECT_LT(std::sqrt(sum / count), 0.03) << "root mean square, of the range";
  EXPECT_GT(std::sqrt(sum / count), 0) << "the screenshot has more samples";
}

TEST_F(View, AScreenshotThatCannotBeWrittenIsSaid) {
  view.picture();
  std::filesystem::remove_all(view.folder().path());
  view.type("s");
  EXPECT_TRUE(said("souple-cloth-0001.png"));
  view.pictures(2);
  std::filesystem::create_directory(view.folder().path());
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

/// Text is as large and as sharp as at full resolution: the same pixels, where the legend lies over nothing else.
TEST(ViewResolution, OfHalfFillsTheSameWindowAndHasTheSameLegends) {
  const TestScenes scenes;
  const auto shown = [&](bool half) {
    OffscreenViewer view(scenes.list[0].file, {641, 403, 1}, {}, half);
    view.type("hr 4");  // strain
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
  EXPECT_LT(difference, 4);                            // of 255
  const auto title = [](const render::Image& image) {  // the first line of the legend, on its own background
    std::vector<std::uint8_t> pixels;
    for (int y = 16; y < 28; ++y) pixels.insert(pixels.end(), image.at(18, y), image.at(18 + 50, y));
    return pixels;
  };
  const std::vector<std::uint8_t> sharp = title(full), same = title(half);
  int different = 0;
  for (std::size_t i = 0; i < sharp.size(); ++i) different += std::abs(sharp[i] - same[i]) > 24 ? 1 : 0;
  EXPECT_LT(different, static_cast<int>(sharp.size()) / 50);
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
  for (int i = 0; i < 3; ++i) viewer.frame(1 / 60.0, window.framebuffer().id());
  EXPECT_GT(viewer.session().frame(), 0u);
}

}  // namespace souple::viewer::test_app_view
