#include "gl_test.h"
#include "render/font.h"
#include "render/gl/framebuffer.h"
#include "render/passes/labels.h"
#include "souple/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace souple::render {

namespace {

namespace fs = std::filesystem;

constexpr int width = 240, height = 160;

/// The rectangle of all pixels that differ: [left, right) x [top, bottom).
struct Box {
  int left = 100000, top = 100000, right = -1, bottom = -1;
  bool empty() const { return right < 0; }
};

bool same(const Image& a, const Image& b, int x, int y) {
  return std::equal(a.at(x, y), a.at(x, y) + 4, b.at(x, y));
}

Box difference(const Image& a, const Image& b) {
  Box box;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      if (same(a, b, x, y)) continue;
      box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x + 1),
             std::max(box.bottom, y + 1)};
    }
  }
  return box;
}

/// A view along -z at a plane through the origin, where one unit is `height` pixels high.
Camera front() {
  return camera_at({0, 0, 2}, {}, float(2 * std::atan(0.25) * 180 / pi));
}

/// The point of that plane under a position in the picture.
Vec3f under(float x, float y) {
  return {(x - float(width) / 2) / float(height), 0.5f - y / float(height), 0};
}

class OverlayTest : public GlTest {
 protected:
  static Image picture(const DrawList& list) {
    return renderer().picture(list, front(), plain(), width, height);
  }
  /// The mean of many samples, whose edges are not smoothed afterwards.
  static Image fine_picture(const DrawList& list) {
    RenderOptions options = plain();
    options.samples = 16;
    return renderer().picture(list, front(), options, width, height);
  }
  static Image background() { return picture(without_ground()); }
};

/// Coverage of a pixel by an element of this color, from the light in its red channel.
float coverage(const Image& with, const Image& without, int x, int y, float red) {
  const auto light = [&](const Image& image) { return float(linear(image.at(x, y)[0])); };
  return (light(with) - light(without)) / (red - light(without));
}

/// A wall in the plane z = 0.
Solid wall() {
  TriangleMesh mesh;
  mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return Solid(mesh);
}

/// Labels alone, over black.
class Page {
 public:
  explicit Page(const fs::path& font = Font::default_file())
      : color_(GL_RGBA8, width, height), framebuffer_("a page", {&color_}, nullptr), pass_(font) {}

  Image draw(const std::vector<Label>& labels) {
    framebuffer_.bind();
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    pass_.draw(labels, width, height);
    return read_framebuffer(framebuffer_.id(), width, height);
  }
  Box box(const std::vector<Label>& labels) { return difference(draw(labels), draw({})); }

 private:
  gl::Texture color_;
  gl::Framebuffer framebuffer_;
  LabelsPass pass_;
};

Label label(std::string text, float x, float y, float size = 16) {
  Label result;
  result.text = std::move(text);
  result.x = x;
  result.y = y;
  result.size = size;
  return result;
}

}  // namespace

TEST_F(OverlayTest, LinesHaveTheirWidth) {
  const Image without = fine_picture(without_ground());
  for (const float line_width : {0.5f, 1.0f, 1.5f, 2.0f, 3.3f, 8.0f}) {
    for (const float rise : {0.0f, 0.3f, 37.6f, 90.0f}) {  // pixels, over the picture's width
      DrawList list = without_ground();
      list.lines.push_back({under(-50, 60.2f), under(width + 50, 60.2f + rise), 0xff000000, line_width});
      const Image with = fine_picture(list);
      const float slope = rise / float(width + 100);
      for (int x = 20; x < width; x += 40) {
        float covered = 0;
        for (int y = 0; y < height; ++y) covered += coverage(with, without, x, y, 0);
        EXPECT_NEAR(covered, line_width * std::sqrt(1 + slope * slope), 0.08f + 0.03f * line_width)
            << "width " << line_width << ", rise " << rise << ", column " << x;
      }
    }
  }
}

TEST_F(OverlayTest, LinesLieWhereTheyAre) {
  const Image without = fine_picture(without_ground());
  DrawList list = without_ground();
  list.lines.push_back({under(30, 40), under(200, 100), 0xff000000, 3});
  const Image with = fine_picture(list);
  for (int x = 31; x < 200; x += 13) {
    float moment = 0, sum = 0;
    for (int y = 0; y < height; ++y) {
      const float part = coverage(with, without, x, y, 0);
      moment += part * (float(y) + 0.5f);
      sum += part;
    }
    EXPECT_NEAR(moment / sum, 40 + (float(x) + 0.5f - 30) * 60 / 170, 0.1f) << x;
  }
  const Box box = difference(with, without);
  EXPECT_NEAR(box.left, 28, 1);
  EXPECT_NEAR(box.right, 202, 1);
}

TEST_F(OverlayTest, LinesKeepTheirColor) {
  const Solid solid = wall();
  for (const std::uint32_t hex : {0xff0000u, 0xffffffu, 0x3366ccu, 0x102030u, 0xf0f921u}) {
    DrawList list = without_ground();
    list.surfaces.push_back(solid.surface(1, false, {0, 0, double(-0.1f)}, Look().color));
    list.lines.push_back({under(0, 80), under(width, 80), pack(srgb(hex)), 6});
    const std::uint8_t* pixel = picture(list).at(width / 2, 80);
    const std::uint32_t seen = std::uint32_t(pixel[0]) << 16 | std::uint32_t(pixel[1]) << 8 | pixel[2];
    for (int shift = 0; shift < 24; shift += 8) {
      EXPECT_NEAR(double((seen >> shift) & 0xff), double((hex >> shift) & 0xff), 1) << std::hex << hex;
    }
  }
}

TEST_F(OverlayTest, LinesAreHiddenByWhatLiesBeforeThemAndTopLinesAreNot) {
  const Solid solid = wall();
  const auto changed = [&](float wall_z, bool top) {
    DrawList list = without_ground();
    list.surfaces.push_back(solid.surface(1, false, {0, 0, double(wall_z)}, Look().color));
    const Image without = picture(list);
    (top ? list.top_lines : list.lines).push_back({under(20, 30), under(220, 130), 0xff2020ff, 2});
    const Box box = difference(picture(list), without);
    return box.empty() ? 0 : box.right - box.left;
  };
  EXPECT_EQ(changed(0.2f, false), 0);
  EXPECT_NEAR(changed(0.2f, true), 202, 3);
  EXPECT_NEAR(changed(-0.2f, false), 202, 3);
  EXPECT_NEAR(changed(0, false), 202, 3) << "a line on a surface shows";
}

TEST_F(OverlayTest, ALineOnASlantedSurfaceShowsAllAlong) {
  const Solid solid = wall();
  DrawList list = without_ground();
  Surface slanted = solid.surface(1, false, {0, 0, double(0)}, Look().color);
  slanted.pose.rotation = Quatd::from_axis_angle({0, 1, 0}, 1.2);
  list.surfaces.push_back(slanted);
  const Image without = picture(list);
  const auto on_wall = [&](double u, double v) { return Vec3f(slanted.pose.point({u, v, 0})); };
  list.lines.push_back({on_wall(-1.5, -0.2), on_wall(1.5, 0.25), 0xff000000, 2});
  const Image with = picture(list);
  const auto a = front().project(list.lines[0].a, width, height),
             b = front().project(list.lines[0].b, width, height);
  for (int x = std::max(0, int(a->x) + 1); x < std::min(width, int(b->x)); ++x) {
    float covered = 0;
    for (int y = 0; y < height; ++y) covered += coverage(with, without, x, y, 0);
    EXPECT_GT(covered, 1.9f) << "half of it lies behind the surface, at column " << x;
  }
}

TEST_F(OverlayTest, LinesAreCutAtTheNearPlane) {
  const Image without = background();
  DrawList list = without_ground();
  // From in front of the camera to far behind it, on the right.
  list.lines.push_back({{0.1f, -0.05f, 0}, {0.4f, -0.3f, 40}, 0xff000000, 2});
  const Image with = picture(list);
  const Box box = difference(with, without);
  ASSERT_FALSE(box.empty());
  const auto start = front().project(list.lines[0].a, width, height);
  EXPECT_NEAR(box.left, start->x, 3);
  EXPECT_EQ(box.right, width) << "it extends to the edge of the picture";
  EXPECT_NEAR(box.top, start->y, 3);
  list.lines[0] = {{-1, 0.1f, 2.5f}, {1, 0.1f, 40}, 0xff000000, 2};
  EXPECT_TRUE(difference(picture(list), without).empty()) << "behind the eye";
}

TEST_F(OverlayTest, BadLinesAreNotDrawn) {
  const float nan = std::nanf("");
  const Image without = background();
  for (const Line& line :
       {Line{{nan, 0, 0}, {1, 0, 0}, 0xff000000, 2}, Line{{0, 0, 0}, {0, nan, 0}, 0xff000000, 2},
        Line{{-1, 0, 0}, {1, 0, 0}, 0xff000000, 0}, Line{{-1, 0, 0}, {1, 0, 0}, 0xff000000, nan},
        Line{{-1, 0, 0}, {1, 0, 0}, 0xff000000, -3}}) {
    DrawList list = without_ground();
    list.lines.push_back(line);
    EXPECT_TRUE(difference(picture(list), without).empty());
  }
  DrawList list = without_ground();
  list.lines.push_back({under(50, 50), under(50, 50), 0xff000000, 5});
  const Box dot = difference(picture(list), without);
  EXPECT_NEAR(dot.right - dot.left, 6, 2) << "a point is a dot";
}

TEST_F(OverlayTest, TextIsWhereItWasAsked) {
  Page page;
  for (const float size : {10.0f, 16.0f, 33.0f}) {
    const Box box = page.box({label("Hgx", 40, 30, size)});
    ASSERT_FALSE(box.empty());
    EXPECT_GE(box.left, 40);
    EXPECT_LE(float(box.left), 40 + 0.2f * size);
    EXPECT_GE(box.top, 30);
    EXPECT_LE(float(box.bottom), 30 + size);
    EXPECT_GT(float(box.bottom - box.top), 0.6f * size);  // from the top of H to below g
    EXPECT_GT(float(box.right - box.left), 1.2f * size);
  }
  EXPECT_TRUE(page.box({label("", 40, 30)}).empty());
  EXPECT_TRUE(page.box({label("   ", 40, 30)}).empty());
}

TEST_F(OverlayTest, TextIsTheSameAtEveryWholePixelAndSnapsToIt) {
  Page page;
  const Image here = page.draw({label("Souple 0.1", 40, 30)}),
              there = page.draw({label("Souple 0.1", 57, 71)});
  Image moved(width, height);
  paste(page.draw({}), moved, 0, 0);
  paste(here, moved, 17, 41);
  for (int y = 60; y < 100; ++y) {
    for (int x = 50; x < width; ++x) ASSERT_TRUE(same(moved, there, x, y)) << x << " " << y;
  }
  EXPECT_EQ(page.draw({label("Souple 0.1", 39.6f, 30.4f)}), here);
}

TEST_F(OverlayTest, TextIsCrisp) {
  // The stems of an H cover some pixel nearly completely: they are not blurred over two pixels.
  Page page;
  for (const float size : {13.0f, 16.0f, 24.0f}) {
    const Image image = page.draw({label("H", 10, 10, size)});
    EXPECT_GT(int(*std::max_element(image.pixels.begin(), image.pixels.end())), 240);
    int brightest = 0;
    for (int x = 0; x < width; ++x)
      brightest = std::max(brightest, int(image.at(x, 10 + int(0.6f * size))[0]));
    EXPECT_GT(brightest, 140) << size;
  }
}

TEST_F(OverlayTest, LinesOfTextFollowEachOther) {
  Page page;
  const Box one = page.box({label("HHH", 10, 10, 20)}), two = page.box({label("HHH\nH", 10, 10, 20)});
  EXPECT_EQ(two.top, one.top);
  EXPECT_EQ(two.right, one.right);
  EXPECT_EQ(two.bottom, one.bottom + 20);
}

TEST_F(OverlayTest, ABoxLiesBehindTheWholeText) {
  Page page;
  Label boxed = label("words\nmore words", 50, 40);
  const Box text = page.box({boxed});
  boxed.background = srgb(0x2060a0, 0.5f);
  const Image image = page.draw({boxed});
  const Box box = difference(image, page.draw({}));
  EXPECT_LT(box.left, text.left);
  EXPECT_LT(box.top, text.top);
  EXPECT_GT(box.right, text.right);
  EXPECT_GT(box.bottom, text.bottom);
  const std::array<int, 3> half{0x10, 0x30, 0x50};
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.at(box.left, box.top)[c], half[c], 1);
}

TEST_F(OverlayTest, TextHasItsColor) {
  Page page;
  Label colored = label("█", 20, 20, 30);  // U+2588
  colored.color = srgb(0x4080c0);
  const Image image = page.draw({colored});
  const std::array<int, 3> color{0x40, 0x80, 0xc0};
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(image.at(28, 35)[c], color[c], 1);
}

TEST_F(OverlayTest, WhatTheFontLacksIsAQuestionMark) {
  Page page;
  const Image expected = page.draw({label("a?b", 20, 20)});
  EXPECT_EQ(page.draw({label("a漢b", 20, 20)}), expected);
  EXPECT_EQ(page.draw({label("a\xf0\x9d\x84\x9e"
                             "b",
                             20, 20)}),
            expected);
  EXPECT_EQ(page.draw({label("a\xff"
                             "b",
                             20, 20)}),
            expected);
  EXPECT_NE(page.draw({label("aéb", 20, 20)}), expected);
}

TEST_F(OverlayTest, ThereIsTextWithoutAFontFile) {
  std::string pattern = (fs::temp_directory_path() / "souple_font_XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  std::ofstream(folder / "text.ttf") << "no font";
  // One table extends beyond the end of the file.
  std::ofstream(folder / "cut.ttf", std::ios::binary) << std::string(
      "\0\1\0\0\0\1\0\0\0\0\0\0"
      "glyf\0\0\0\0\0\0\1\0\0\0\1\0",
      28);
  std::string empty(400, '\0');  // a table of zeros
  empty.replace(0, 28,
                std::string("\0\1\0\0\0\1\0\0\0\0\0\0"
                            "glyf\0\0\0\0\0\0\0\100\0\0\0\100",
                            28));
  std::ofstream(folder / "empty.ttf", std::ios::binary) << empty;
  for (const char* name : {"missing.ttf", "text.ttf", "cut.ttf", "empty.ttf"}) {
    Page page(folder / name);
    const Box box = page.box({label("Hgx 12 ms é", 40, 30, 20)});
    ASSERT_FALSE(box.empty()) << name;
    EXPECT_GE(box.left, 40) << name;
    EXPECT_GE(box.top, 30) << name;
    EXPECT_LE(box.bottom, 52) << name;
  }
  fs::remove_all(folder);
}

TEST_F(OverlayTest, AnySizeCanBeAskedFor) {
  Page page;
  for (float size = -3; size < 60; size += 3.7f)
    EXPECT_FALSE(page.box({label("x", 10, 10, size)}).empty()) << size;
  EXPECT_FALSE(page.box({label("x", 10, 10, 1e9f)}).empty());
  EXPECT_FALSE(page.box({label("x", 10, 10, std::nanf(""))}).empty());
}

TEST(CodePoints, FollowUtf8) {
  const auto points = [](std::string_view text) {
    const std::vector<char32_t> all = code_points(text);
    return std::u32string(all.begin(), all.end());
  };
  EXPECT_EQ(points("aé漢\n"), U"aé漢\n");
  EXPECT_EQ(points("\xc0\xaf"), U"?") << "an overlong form";
  EXPECT_EQ(points("\xed\xa0\x80"), U"?") << "half a surrogate pair";
  EXPECT_EQ(points("\xe6\xbc"), U"?") << "cut off";
  EXPECT_EQ(points("\xe6x"), U"?x");
  EXPECT_EQ(points("\x80"), U"?");
}

TEST_F(OverlayTest, TheSameListIsTheSamePictureInAnyRenderer) {
  std::vector<Vec3f> centers;
  centers.reserve(50);
  for (int i = 0; i < 50; ++i)
    centers.push_back({0.01f * float(i * 7 % 50) - 0.25f, 0.008f * float(i) - 0.2f, 0.01f * float(i % 9)});
  DrawList list;
  list.ground.height = -0.3f;
  list.spheres.push_back({.key = 1, .centers = centers, .radius = 0.03f});
  list.lines.push_back({under(3, 7), under(200, 140), 0xff00ff00, 1.5f});
  list.top_lines.push_back({under(3, 140), under(200, 7), 0xff0000ff, 1.5f});
  list.labels.push_back(label("twice the same", 5, 5));
  list.labels.back().background = srgb(0, 0.5f);
  const RenderOptions options{.samples = 4};
  const Image first = renderer().picture(list, front(), options, width, height);
  EXPECT_EQ(renderer().picture(list, front(), options, width, height), first);
  Renderer other;
  other.picture(DrawList{}, front(), options, 31, 17);
  EXPECT_EQ(other.picture(list, front(), options, width, height), first);
}

}  // namespace souple::render
