// Pictures printed on surfaces: each texel is where the UVs say.
#include "gl_test.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace souple::render::test_render_print {

constexpr int side = 100;

using Bytes = std::array<std::uint8_t, 3>;
constexpr Bytes red{255, 0, 0}, green{0, 255, 0}, blue{0, 0, 255}, white{255, 255, 255};

/// Red and green above, blue and white below.
std::shared_ptr<const Image> four_colors(std::uint8_t alpha = 255) {
  auto image = std::make_shared<Image>(2, 2);
  const auto set = [&](int x, int y, const Bytes& c) {
    std::uint8_t* pixel = image->at(x, y);
    pixel[0] = c[0], pixel[1] = c[1], pixel[2] = c[2], pixel[3] = alpha;
  };
  set(0, 0, red), set(1, 0, green), set(0, 1, blue), set(1, 1, white);
  return image;
}

class Printed : public GlTest {
 protected:
  Printed() {
    list_ = without_ground();
    // Light from all sides: a white surface is white.
    list_.light.sun = 0;
    list_.light.sky = list_.light.horizon = list_.light.floor = {0.9f, 0.9f, 0.9f};
    Surface square;
    square.key = 1;
    square.version = square.topology = ++version_;
    square.positions = positions_;
    square.triangles = triangles_;
    square.look.color = square.look.second = srgb(0x000000);
    square.look.roughness = 1;
    square.print = four_colors();
    list_.surfaces.push_back(square);
  }
  static Camera front() { return camera_at({0.5f, 0.5f, 3}, {0.5f, 0.5f, 0}, 22); }
  /// The color at a point of the square, as the nearest of the four and black.
  Bytes seen(float x, float y) {
    const Camera camera = front();
    list_.surfaces[0].uvs = uvs_;
    list_.surfaces[0].topology = ++version_;
    const Image image = renderer().picture(list_, camera, plain(), side, side);
    const auto at = camera.project({x, y, 0}, side, side);
    const std::uint8_t* pixel = image.at(int(at->x), int(at->y));
    Bytes nearest{};
    for (std::size_t c = 0; c < 3; ++c) nearest[c] = pixel[c] > 128 ? 255 : 0;
    return nearest;
  }

  DrawList list_;
  std::uint64_t version_ = 0;
  std::vector<Vec3f> positions_{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  std::vector<Triangle> triangles_{{0, 1, 2}, {0, 2, 3}};
  std::vector<CornerUvs> uvs_{{{{0, 0}, {1, 0}, {1, 1}}}, {{{0, 0}, {1, 1}, {0, 1}}}};
};

TEST_F(Printed, ShowsEachTexelWhereTheUvsSay) {
  EXPECT_EQ(seen(0.25f, 0.75f), red);
  EXPECT_EQ(seen(0.75f, 0.75f), green);
  EXPECT_EQ(seen(0.25f, 0.25f), blue);
  EXPECT_EQ(seen(0.75f, 0.25f), white);
}

TEST_F(Printed, RepeatsBeyondItsEdge) {
  uvs_ = {{{{0, 0}, {2, 0}, {2, 2}}}, {{{0, 0}, {2, 2}, {0, 2}}}};
  for (const float x : {0.125f, 0.625f})
    for (const float y : {0.125f, 0.625f}) {
      EXPECT_EQ(seen(x, y), blue) << x << ' ' << y;
      EXPECT_EQ(seen(x + 0.25f, y + 0.25f), green) << x << ' ' << y;
    }
}

/// Corners of two triangles at one vertex may have different UVs, as at a seam.
TEST_F(Printed, CornersAtASeamHaveUvsOfTheirOwn) {
  const std::array<float, 2> in_red{0.25f, 0.75f}, in_white{0.75f, 0.25f};
  uvs_ = {{in_red, in_red, in_red}, {in_white, in_white, in_white}};
  EXPECT_EQ(seen(0.6f, 0.4f), red);
  EXPECT_EQ(seen(0.4f, 0.6f), white);
}

TEST_F(Printed, ShowsTheColorBelowWhereItIsTransparent) {
  list_.surfaces[0].print = four_colors(0);
  EXPECT_EQ(seen(0.25f, 0.75f), Bytes{});
  list_.surfaces[0].print = four_colors();
  EXPECT_EQ(seen(0.25f, 0.75f), red) << "another picture is uploaded";
  list_.surfaces[0].print = nullptr;
  EXPECT_EQ(seen(0.25f, 0.75f), Bytes{});
}

TEST_F(Printed, IsAveragedWhereTexelsAreSmallerThanPixels) {
  auto fine = std::make_shared<Image>(1024, 1024);
  for (int y = 0; y < 1024; ++y)
    for (int x = 0; x < 1024; ++x)
      for (int c = 0; c < 4; ++c) fine->at(x, y)[c] = c == 3 || (x + y) % 2 == 0 ? 255 : 0;
  list_.surfaces[0].print = fine;
  list_.surfaces[0].uvs = uvs_;
  RenderOptions options = plain();
  options.tone_curve = false;
  const Image image = renderer().picture(list_, front(), options, side, side);
  for (int x = 40; x < 60; ++x) EXPECT_NEAR(image.at(x, 50)[1], 180, 8) << "half of 0.9, as sRGB";
}

}  // namespace souple::render::test_render_print
