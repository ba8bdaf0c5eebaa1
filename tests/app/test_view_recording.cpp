#include "souple/io/recorder.h"
#include "tests/app/view_fixture.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

// The viewer as its user operates it, with a synthetic mouse and keyboard: recordings.

namespace souple::viewer::test_app_view_recording {

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

TEST_F(ViewRecording, PlaysToItsEndAndAgainAndGoesFrameByFrame) {
  EXPECT_EQ(view.viewer().session().frame(), 1u);
  view.pictures(40);
  EXPECT_EQ(view.viewer().session().frame(), 30u);
  EXPECT_FALSE(view.viewer().session().playing());
  EXPECT_EQ(shown(115), last);
  view.type(" ");
  view.pictures(3);
  EXPECT_LT(view.viewer().session().frame(), 10u);
  EXPECT_TRUE(view.viewer().session().playing());
  view.type(".");
  const std::uint64_t frame = view.viewer().session().frame();
  view.type(".");
  EXPECT_EQ(view.viewer().session().frame(), frame + 1);
  view.type(",");
  EXPECT_EQ(view.viewer().session().frame(), frame);
  view.type("r,,");
  EXPECT_EQ(view.viewer().session().frame(), 1u);
}

TEST_F(ViewRecording, TheSliderGoesAnywhere) {
  view.pictures(2);
  const ImVec2 slider = view.control("##frame_shown", "##time", 670);
  ASSERT_GT(slider.x, 0);
  view.click(970, slider.y);
  EXPECT_EQ(view.viewer().session().frame(), 30u);
  EXPECT_FALSE(view.viewer().session().playing());
  view.click(380, slider.y);
  EXPECT_LE(view.viewer().session().frame(), 2u);
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

}  // namespace souple::viewer::test_app_view_recording
