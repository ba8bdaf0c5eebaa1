// Glass: refraction against Snell's law, layers, and shadows.
#include "gl_test.h"
#include "render/wall.h"
#include "souple/geometry/builders.h"

#include <array>
#include <cmath>
#include <vector>

namespace souple::render::test_render_glass {

constexpr int width = 400, height = 300;

double brightness(const Image& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return p[0] + p[1] + p[2];
}

/// A box as a surface, which this object stores.
class Block : Solid {
 public:
  explicit Block(const Vec3d& half_extents) : Solid(box(half_extents * 2)), key_(++blocks_) {}
  Surface surface(const Vec3d& at, double turn, const Color& color, bool glass) const {
    Surface result = Solid::surface(key_, false, at, color);
    result.pose.rotation = Quatd::from_axis_angle({0, 1, 0}, turn);
    result.look.glass = glass;
    return result;
  }

 private:
  std::uint64_t key_;
  static inline std::uint64_t blocks_ = 0;  // the renderer keeps the buffers of a key
};

class GlassTest : public GlTest {
 protected:
  /// From far away: rays are parallel within 2 degrees. A pixel is 1 / `pixels_per_meter` wide at the origin.
  static Camera far_camera() { return camera_at({0, 0, 30}, {}, 4); }
  /// A white wall at x < 0 and a black one at x > 0, behind the origin.
  DrawList edge() const {
    DrawList list = without_ground();
    list.surfaces.push_back(white_.surface({-2, 0, -1}, 0, srgb(0xffffff), false));
    list.surfaces.push_back(black_.surface({2, 0, -1}, 0, srgb(0x000000), false));
    return list;
  }
  /// Where the row through the middle turns from white to black [pixels from the middle].
  static double edge_in(const Image& image) {
    const double bright = brightness(image, 40, height / 2), dark = brightness(image, width - 40, height / 2);
    int x = 40;
    while (x < width - 40 && brightness(image, x, height / 2) > 0.5 * (bright + dark)) ++x;
    constexpr int middle = width / 2;
    return x - middle;
  }
  /// Displacement across of a ray along -z by a plate of this thickness whose normal is turned by `angle`.
  static double displacement(double thickness, double angle) {
    const double sine = std::sin(angle), cosine = std::cos(angle), n = 1.5;
    return thickness * sine * (1 - cosine / std::sqrt(n * n - sine * sine));
  }

  Block white_{{2, 3, 0.1}}, black_{{2, 3, 0.1}};
  const double pixels_per_meter_ = height / (2 * 30 * std::tan(2 * pi / 180));
};

TEST_F(GlassTest, AnEdgeBehindAPlateIsDisplacedBySnellsLaw) {
  const double bare = edge_in(renderer().picture(edge(), far_camera(), plain(), width, height));
  EXPECT_NEAR(bare, 0, 1);
  constexpr double thickness = 0.4;
  const Block plate({1.5, 1.5, thickness / 2});
  for (const double degrees : {0.0, 20.0, 35.0, 50.0, -50.0}) {
    const double angle = degrees * pi / 180;
    DrawList list = edge();
    list.surfaces.push_back(plate.surface({0, 0, 2}, angle, srgb(0xffffff), true));
    const double seen = edge_in(renderer().picture(list, far_camera(), plain(), width, height));
    // The normal (sin, 0, cos) bends rays to -x: the edge is seen at +x.
    EXPECT_NEAR(seen - bare, displacement(thickness, angle) * pixels_per_meter_, 1.5) << degrees;
  }
}

TEST_F(GlassTest, PlatesBehindEachOtherDisplaceTogether) {
  constexpr double thickness = 0.3, angle = 0.8;
  const Block first({1.5, 1.5, thickness / 2}), second({1.5, 1.5, thickness / 2});
  DrawList list = edge();
  list.surfaces.push_back(first.surface({0, 0, 2}, angle, srgb(0xffffff), true));
  list.surfaces.push_back(second.surface({0, 0, 5}, angle, srgb(0xffffff), true));
  const double seen = edge_in(renderer().picture(list, far_camera(), plain(), width, height));
  EXPECT_NEAR(seen, 2 * displacement(thickness, angle) * pixels_per_meter_, 2);
}

TEST_F(GlassTest, EachWallTintsAndALiquidShowsGlassBehindIt) {
  const Block plate({1, 1, 0.05}), other({1, 1, 0.05});
  const auto middle = [&](DrawList& list) {
    RenderOptions options = plain();
    options.tone_curve = false;
    const Image image = renderer().picture(list, far_camera(), options, width, height);
    constexpr int x = width / 4, y = height / 2;
    return Vec3f{float(image.at(x, y)[0]), float(image.at(x, y)[1]), 0};
  };
  DrawList list = edge();
  const Vec3f bare = middle(list);
  const Color green{0.4f, 1, 0.4f, 1};
  list.surfaces.push_back(plate.surface({0, 0, 1}, 0, green, true));
  const Vec3f one = middle(list);
  list.surfaces.push_back(other.surface({0, 0, 2}, 0, green, true));
  const Vec3f two = middle(list);
  EXPECT_LT(one.x / one.y, 0.9f * bare.x / bare.y);
  EXPECT_LT(two.x / two.y, 0.9f * one.x / one.y);

  list = edge();
  std::vector<Vec3f> centers;
  for (float x = -1; x < 1; x += 0.05f)
    for (float y = -0.5f; y < 0.5f; y += 0.05f)
      for (float z = 2; z < 2.2f; z += 0.05f) centers.push_back({x, y, z});
  list.liquids.push_back(
      {.key = 9, .centers = centers, .radius = 0.0375f, .spacing = 0.05f, .look = {.absorption = {}}});
  const Vec3f wet = middle(list);
  list.surfaces.push_back(plate.surface({0, 0, 1}, 0, green, true));
  const Vec3f behind = middle(list);
  EXPECT_LT(behind.x / behind.y, 0.9f * wet.x / wet.y);
  list.surfaces.back().pose.translation = {0, 0, 4};
  const Vec3f before = middle(list);
  EXPECT_NEAR(before.x / before.y, behind.x / behind.y, 0.1f);
}

TEST_F(GlassTest, ThrowsALightShadow) {
  const Block plate({0.6, 0.02, 0.6});
  DrawList list;
  list.ground = Ground{.height = 0, .tile = 100};
  list.light.to_sun = {0, 1, 0.01f};
  const Camera camera = camera_at({0, 3, 6}, {0, 0.3f, 0}, 30);
  RenderOptions options;
  options.ambient_occlusion = false;
  options.tone_curve = false;
  const auto at_point = [&](const Image& image, const Vec3f& point) {
    const auto at = camera.project(point, width, height);
    return brightness(image, int(at->x), int(at->y));
  };
  list.surfaces.push_back(plate.surface({0, 0.7, 0}, 0, srgb(0xc8d8e0), true));
  const Image clear = renderer().picture(list, camera, options, width, height);
  list.surfaces[0].look.glass = false;
  const Image solid = renderer().picture(list, camera, options, width, height);
  const Vec3f below{0, 0, 0.35f}, aside{1.2f, 0, 0.35f};
  EXPECT_LT(at_point(clear, below), 0.98 * at_point(clear, aside));
  EXPECT_GT(at_point(clear, below), 0.7 * at_point(clear, aside));
  EXPECT_LT(at_point(solid, below), 0.7 * at_point(clear, below));
}

TEST_F(GlassTest, PicturesAreTheSameEachTime) {
  const Block plate({1.5, 1.5, 0.2});
  DrawList list = edge();
  list.surfaces.push_back(plate.surface({0, 0, 2}, 0.5, srgb(0xffffff), true));
  const RenderOptions options{.samples = 4};
  EXPECT_EQ(renderer().picture(list, far_camera(), options, 160, 120).pixels,
            renderer().picture(list, far_camera(), options, 160, 120).pixels);
}

TEST(Walls, OfSolidsHaveAThickness) {
  const auto wall = [](const TriangleMesh& mesh) { return wall_of(Solid(mesh).positions(), mesh.triangles); };
  // A plate of 2 x 2 x 0.02 m: 2 V / A = 0.16 / 8.16.
  const Wall plate = wall(box({2, 2, 0.02}));
  EXPECT_TRUE(plate.closed);
  EXPECT_NEAR(plate.thickness, 0.16 / 8.16, 1e-4);
  EXPECT_FALSE(wall(grid(4, 4, 1.0)).closed);
  const std::array<Vec3f, 2> few{};
  const std::array<Triangle, 1> outside{Triangle{0, 1, 7}};
  EXPECT_FALSE(wall_of(few, outside).closed);
}

}  // namespace souple::render::test_render_glass
