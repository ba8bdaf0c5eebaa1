// Properties of pictures that do not depend on their exact appearance: positions of shadows, repeatability.
#include "render/context.h"
#include "render/renderer.h"
#include "souple/error.h"
#include "studio.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

namespace souple::render::test_render_picture {

constexpr int width = 240, height = 180;

double brightness(const Image& image, float x, float y) {
  const std::uint8_t* p = image.at(int(x), int(y));
  return (p[0] + p[1] + p[2]) / 3.0;
}

double brightness(const Image& image, const Camera& camera, const Vec3f& point) {
  const std::optional<ScreenPoint> at = camera.project(point, image.width, image.height);
  const bool seen =
      at && at->x >= 0 && at->y >= 0 && at->x < float(image.width) && at->y < float(image.height);
  if (!seen) throw Error("the test looks at a point outside its picture");
  return brightness(image, at->x, at->y);
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(a.pixels[i] - b.pixels[i]);
  return sum / double(a.pixels.size());
}

// Any OpenGL error in a test fails it.
class Picture : public testing::Test {
 protected:
  void SetUp() override { watch_gl_errors(); }
  void TearDown() override { EXPECT_NO_THROW(throw_gl_errors()); }

  OffscreenContext context_;
};

class PictureOfBall : public Picture {
 protected:
  PictureOfBall() {
    camera_.from = {0, 3.5f, 4};
    camera_.to = {0, 0.2f, 0};
    camera_.fov = 40;
  }
  // A ball of radius 0.3 one meter above the floor, without the floor's pattern, and the center of its
  // shadow.
  DrawList list(bool as_mesh) const {
    DrawList list;
    if (as_mesh) {
      list.surfaces.push_back(mesh_.surface(1, true, {center_.x, center_.y, center_.z}, srgb(0xcc8844)));
    } else {
      list.spheres.push_back({.key = 1, .centers = {&center_, 1}, .radius = 0.3f});
    }
    list.ground.second = list.ground.color;
    list.light.to_sun = {0.7f, 1, 0.1f};
    return list;
  }
  Vec3f shadow_of(const Light& light) const { return center_ - light.to_sun * (center_.y / light.to_sun.y); }

  Camera camera_{{0, 3.5f, 4}, {0, 0.2f, 0}, 40};
  Vec3f center_{0.5f, 1, 0};
  Solid mesh_{sphere(4, 0.3)};
};

TEST_F(PictureOfBall, ThrowsItsShadowWhereTheSunPutsIt) {
  for (const bool as_mesh : {true, false}) {
    for (const int samples : {1, 8}) {
      Renderer renderer;
      const DrawList scene = list(as_mesh);
      const RenderOptions options{.ambient_occlusion = false, .samples = samples};
      const Image image = renderer.picture(scene, camera_, options, width, height);
      const Vec3f middle = shadow_of(scene.light);
      const double dark = brightness(image, camera_, middle);
      const double lit = brightness(image, camera_, {-1.2f, 0, 0.8f});
      EXPECT_LT(dark, 0.8 * lit) << "mesh " << as_mesh << ", samples " << samples;
      // Perpendicular to the sun's direction the shadow is as wide as the ball, plus or minus the penumbra of
      // 2.5 degrees over 1.2 m.
      const Vec3f across = normalized(cross(scene.light.to_sun, Vec3f{0, 1, 0}));
      for (const float side : {-1.0f, 1.0f}) {
        EXPECT_NEAR(brightness(image, camera_, middle + across * (side * 0.22f)), dark, 6);
        EXPECT_NEAR(brightness(image, camera_, middle + across * (side * 0.40f)), lit, 12);
      }
    }
  }
}

TEST_F(PictureOfBall, HasNoShadowWithoutTheOption) {
  Renderer renderer;
  const DrawList scene = list(true);
  const Image with = renderer.picture(scene, camera_, {}, width, height);
  const Image without = renderer.picture(scene, camera_, {.shadows = false}, width, height);
  EXPECT_GT(brightness(without, camera_, shadow_of(scene.light)),
            1.2 * brightness(with, camera_, shadow_of(scene.light)));
}

TEST_F(PictureOfBall, LeavesOutWhatCastsNoShadow) {
  Renderer renderer;
  DrawList scene = list(true);
  scene.surfaces[0].casts_shadow = false;
  const Image image = renderer.picture(scene, camera_, {.ambient_occlusion = false}, width, height);
  EXPECT_NEAR(brightness(image, camera_, shadow_of(scene.light)),
              brightness(image, camera_, {-1.2f, 0, 0.8f}), 12);
}

// The penumbra's width is the ball's distance from the floor times the sun's apparent size.
TEST_F(PictureOfBall, SoftensShadowsWithTheSizeOfTheSun) {
  Renderer renderer;
  DrawList scene = list(true);
  const auto half_lit = [&](float sun_size, int samples) {
    scene.light.sun_size = sun_size;
    const RenderOptions options{.ambient_occlusion = false, .samples = samples};
    const Image image = renderer.picture(scene, camera_, options, width, height);
    const Vec3f middle = shadow_of(scene.light);
    const double dark = brightness(image, camera_, middle),
                 lit = brightness(image, camera_, {-1.2f, 0, 0.8f});
    const Vec3f across = normalized(cross(scene.light.to_sun, Vec3f{0, 1, 0}));
    int count = 0;
    for (int i = 0; i < 200; ++i) {
      const double b = brightness(image, camera_, middle + across * (0.003f * float(i)));
      if (b > dark + 0.2 * (lit - dark) && b < dark + 0.8 * (lit - dark)) ++count;
    }
    return count;
  };
  EXPECT_GT(half_lit(6, 16), 2 * half_lit(0.5f, 16));
  EXPECT_GT(half_lit(6, 1), half_lit(0.5f, 1));
}

TEST_F(Picture, IsTheSameTwice) {
  const Studio studio(20, 24);
  const DrawList list = studio.list();
  for (const int samples : {1, 4}) {
    const RenderOptions options{.samples = samples};
    Image first, second, fresh;
    {
      Renderer renderer;
      first = renderer.picture(list, Studio::camera(), options, width, height);
      renderer.picture(list, Studio::camera(), options, 64, 100);
      second = renderer.picture(list, Studio::camera(), options, width, height);
    }
    {
      Renderer renderer;
      fresh = renderer.picture(list, Studio::camera(), options, width, height);
    }
    EXPECT_EQ(first, second);
    EXPECT_EQ(first, fresh);
  }
}

TEST(PictureOfContexts, IsTheSameInAnotherContext) {
  const Studio studio(20, 24);
  const auto picture = [&] {
    const OffscreenContext context;
    Renderer renderer;
    return renderer.picture(studio.list(), Studio::camera(), {.samples = 2}, width, height);
  };
  EXPECT_EQ(picture(), picture());
}

TEST(PictureOfContexts, IsTheSameInBoth) {
  const Studio studio(20, 24);
  const auto picture = [&](Api api, int samples) {
    const OffscreenContext context(api);
    watch_gl_errors();
    Renderer renderer;
    DrawList list = studio.list();
    Liquid liquid;  // the grains again, as a liquid
    liquid.key = 1;
    liquid.centers = list.spheres[0].centers;
    liquid.radius = 0.05f;
    liquid.spacing = 0.07f;
    list.liquids.push_back(liquid);
    list.foams.push_back({.key = 1, .centers = liquid.centers});
    Image image = renderer.picture(list, Studio::camera(), {.samples = samples}, width, height);
    EXPECT_NO_THROW(throw_gl_errors());
    return image;
  };
  for (const int samples : {1, 3}) {
    EXPECT_LT(mean_difference(picture(Api::es3, samples), picture(Api::gl33, samples)), 0.5);
  }
}

// Where a box stands on the floor, less of the sky is visible.
TEST_F(Picture, IsDarkerInCornersWithAmbientOcclusion) {
  const Solid box_mesh(box({0.5, 0.5, 0.5}));
  DrawList list;
  list.surfaces.push_back(box_mesh.surface(1, false, {0, 0.25, 0}, srgb(0xcccccc)));
  list.ground.second = list.ground.color;
  const Camera camera{{0.8f, 1, 2}, {0, 0.2f, 0}};
  Renderer renderer;
  const Image with = renderer.picture(list, camera, {.shadows = false}, width, height);
  const Image without =
      renderer.picture(list, camera, {.shadows = false, .ambient_occlusion = false}, width, height);
  const Vec3f corner{0.05f, 0, 0.27f}, open{-0.8f, 0, 0.4f};
  EXPECT_LT(brightness(with, camera, corner), brightness(without, camera, corner) - 4);
  EXPECT_NEAR(brightness(with, camera, open), brightness(without, camera, open), 1.5);
}

// A scene gives similar pictures at the scales 1, 0.01 and 64.
TEST_F(Picture, DoesNotDependOnTheScale) {
  const auto picture = [](float scale) {
    const Solid box_mesh(box({0.5, 0.5, 0.5})), ball_mesh(sphere(4, 0.3));
    DrawList list;
    list.surfaces.push_back(box_mesh.surface(1, false, Vec3d{0, 0.25, 0} * double(scale), srgb(0x4a7fb5)));
    list.surfaces.push_back(ball_mesh.surface(2, true, Vec3d{0.6, 0.3, 0.1} * double(scale), srgb(0xcc6644)));
    for (Surface& surface : list.surfaces) surface.pose.scale = double(scale);
    list.ground.tile *= scale;
    const Camera camera{Vec3f{1, 1, 2} * scale, Vec3f{0, 0.2f, 0} * scale};
    Renderer renderer;
    return renderer.picture(list, camera, {.samples = 4}, width, height);
  };
  const Image meter = picture(1);
  EXPECT_LT(mean_difference(meter, picture(0.01f)), 1.0);
  EXPECT_LT(mean_difference(meter, picture(64.0f)), 1.0);
}

// Both sides of a triangle are lit as the side towards the eye: the winding order must not be visible.
TEST_F(Picture, DoesNotDependOnTheWinding) {
  const Studio studio(40, 24);
  DrawList list = studio.list();
  list.surfaces.resize(1);
  const std::vector<Triangle> triangles(list.surfaces[0].triangles.begin(), list.surfaces[0].triangles.end());
  std::vector<Triangle> turned = triangles;
  for (Triangle& triangle : turned) std::swap(triangle[1], triangle[2]);
  Renderer renderer;
  const Image as_it_is = renderer.picture(list, Studio::camera(), {}, width, height);
  list.surfaces[0].triangles = turned;
  list.surfaces[0].topology = 1;
  EXPECT_LT(mean_difference(as_it_is, renderer.picture(list, Studio::camera(), {}, width, height)), 0.05);
}

TEST_F(Picture, FollowsVersionsAndTopology) {
  std::vector<Vec3f> corners{{-0.5f, 0.2f, 0}, {0.5f, 0.2f, 0}, {0.5f, 1.2f, 0}, {-0.5f, 1.2f, 0}};
  std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
  Surface surface;
  surface.positions = corners;
  surface.triangles = triangles;
  surface.look.color = srgb(0xcc0000);
  DrawList list;
  list.surfaces.push_back(surface);
  const Camera camera{{0, 0.7f, 4}, {0, 0.7f, 0}};
  Renderer renderer;
  const auto is_red = [&](const Vec3f& point) {
    const Image image = renderer.picture(list, camera, {}, width, height);
    const ScreenPoint at = *camera.project(point, width, height);
    const std::uint8_t* p = image.at(int(at.x), int(at.y));
    return p[0] > 2 * p[1];
  };
  EXPECT_TRUE(is_red({0.3f, 1.1f, 0}));
  EXPECT_TRUE(is_red({-0.3f, 1.1f, 0}));
  // One triangle less.
  triangles.pop_back();
  list.surfaces[0].triangles = triangles;
  list.surfaces[0].topology = 1;
  EXPECT_FALSE(is_red({-0.3f, 1.1f, 0}));
  EXPECT_TRUE(is_red({0.3f, 0.6f, 0}));
  // Shifted.
  for (Vec3f& corner : corners) corner.x += 1;
  list.surfaces[0].version = 1;
  EXPECT_FALSE(is_red({0.3f, 0.6f, 0}));
  EXPECT_TRUE(is_red({1.3f, 0.6f, 0}));
  // More vertices than before.
  corners.push_back({-2, 0.2f, 0});
  corners.push_back({-1, 0.2f, 0});
  corners.push_back({-1, 1.2f, 0});
  triangles.push_back({4, 5, 6});
  list.surfaces[0].positions = corners;
  list.surfaces[0].triangles = triangles;
  list.surfaces[0].topology = 2;
  EXPECT_TRUE(is_red({-1.2f, 0.6f, 0}));
  EXPECT_TRUE(is_red({1.3f, 0.6f, 0}));
}

TEST_F(Picture, HasWireframesThatComeAndGo) {
  const Studio studio(0, 12);
  DrawList list = studio.list();
  Renderer renderer;
  const Image plain = renderer.picture(list, Studio::camera(), {}, width, height);
  list.surfaces[0].wireframe = true;
  const Image wires = renderer.picture(list, Studio::camera(), {}, width, height);
  EXPECT_GT(mean_difference(plain, wires), 0.2);
  list.surfaces[0].wireframe = false;
  EXPECT_EQ(plain, renderer.picture(list, Studio::camera(), {}, width, height));
}

TEST_F(Picture, OfNothingIsGroundAndSky) {
  Renderer renderer;
  DrawList list;
  list.ground.second = list.ground.color;
  const Camera camera{{0, 1, 5}, {0, 1, 0}};
  const Image image = renderer.picture(list, camera, {}, width, height);
  list.ground.shown = false;
  const Image sky = renderer.picture(list, camera, {}, width, height);
  EXPECT_NEAR(brightness(image, 120, 5), brightness(sky, 120, 5), 1);
  EXPECT_GT(std::abs(brightness(image, 120, 170) - brightness(sky, 120, 170)), 5);
}

TEST_F(Picture, FromBelowTheFloorStillShowsThings) {
  const Solid box_mesh(box({0.5, 0.5, 0.5}));
  DrawList list;
  list.surfaces.push_back(box_mesh.surface(1, false, {0, 0.25, 0}, srgb(0xcc0000)));
  const Camera camera{{0, -1, 2}, {0, 0.2f, 0}};
  Renderer renderer;
  const Image image = renderer.picture(list, camera, {}, width, height);
  const std::uint8_t* p = image.at(width / 2, height / 2);
  EXPECT_GT(p[0], 2 * p[1]);
}

TEST_F(Picture, MayBeSmallButNotOutOfRange) {
  const Studio studio(0, 8);
  const DrawList list = studio.list();
  Renderer renderer;
  for (const int samples : {1, 2}) {
    EXPECT_EQ(renderer.picture(list, Studio::camera(), {.samples = samples}, 1, 1).pixels.size(), 4U);
    EXPECT_EQ(renderer.picture(list, Studio::camera(), {.samples = samples}, 3, 1).pixels[3], 255);
  }
  for (const auto& [w, h] : {std::pair{0, 10}, {10, 0}, {-1, 10}, {10, 8193}}) {
    EXPECT_THROW(renderer.picture(list, Studio::camera(), {}, w, h), Error);
  }
  EXPECT_NO_THROW(renderer.draw(list, Studio::camera(), {}, 0, 100));
  EXPECT_NO_THROW(renderer.draw(list, Studio::camera(), {}, 100, 0));
}

TEST_F(Picture, SurvivesBrokenGeometry) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, nan, 0}, {0, infinity, 0}, {1, 1, 1}};
  const std::vector<Vec3f> normals{{0, 1, 0}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {1, 2, 3}, {0, 0, 0}}, out_of_range{{0, 1, 4}};
  DrawList list;
  for (const std::vector<Triangle>* faces : {&triangles, &out_of_range}) {
    for (const bool wireframe : {false, true}) {
      list.surfaces.push_back({.key = list.surfaces.size(),
                               .positions = positions,
                               .normals = normals,
                               .triangles = *faces,
                               .wireframe = wireframe});
    }
  }
  list.surfaces.emplace_back().key = 99;
  Renderer renderer;
  EXPECT_NO_THROW(renderer.picture(list, Camera{}, {.samples = 2}, width, height));
}

}  // namespace souple::render::test_render_picture
