#include "tests/app/view_fixture.h"

#include <cstddef>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

// The viewer as its user operates it, with a synthetic mouse and keyboard: the mouse, the past, and what is added.

namespace souple::viewer::test_app_view_mouse {

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

TEST_F(View, ResettingAndGoingBackLetGo) {
  for (const char* key : {"b", "r"}) {
    view.pictures(30);  // two clicks soon after each other pin
    const ImVec2 start = view.seen(vertex(60));
    view.move(start.x, start.y);
    view.press();
    ASSERT_TRUE(view.viewer().mouse().grabbing()) << key;
    view.type(key);
    EXPECT_FALSE(view.viewer().mouse().grabbing()) << key;
    view.move(start.x + 50, start.y);
    view.release();
  }
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

}  // namespace souple::viewer::test_app_view_mouse
