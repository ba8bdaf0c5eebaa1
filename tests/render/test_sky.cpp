#include "gl_test.h"
#include "render/display.h"
#include "render/looks.h"
#include "render/sky.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <cmath>

namespace souple::render::test_render_sky {

constexpr int width = 120, height = 80;

Vec3f color_at(const Image& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return Vec3f(Vec3d{linear(p[0]), linear(p[1]), linear(p[2])});
}

/// Irradiance / pi at a normal, by summing a fine grid of directions.
Vec3f summed_irradiance(const Sky& sky, const Vec3f& normal) {
  constexpr int rings = 200, sectors = 200;
  Vec3f sum{};
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const float y = (static_cast<float>(i) + 0.5f) * 2 / rings - 1, r = std::sqrt(1 - y * y);
      const float angle = (static_cast<float>(j) + 0.5f) * 2 * static_cast<float>(pi) / sectors;
      const Vec3f direction{r * std::cos(angle), y, r * std::sin(angle)};
      sum = sum + sky_radiance(sky, direction) * std::max(dot(direction, normal), 0.0f);
    }
  return sum * (4.0f / (rings * sectors));
}

class SkyPicture : public GlTest {};

/// Spherical harmonics of order 2 represent irradiance within a few per cent (Ramamoorthi and Hanrahan 2001).
TEST(Sky, LightsSurfacesAsItsRadianceSummedOverAllDirections) {
  const Sky sky = sky_of({}, {});
  const SkyIrradiance irradiance = sky_irradiance(sky);
  for (const Vec3f& n : {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{1, 0, 0}, normalized(Vec3f{-1, 1, 0.5f})}) {
    const Vec3f expected = summed_irradiance(sky, n), found = irradiance_at(irradiance, n);
    EXPECT_LT(length(found - expected), 0.06f * length(expected)) << n.x << ' ' << n.y << ' ' << n.z;
  }
}

TEST(Sky, IsWarmAtTheHorizonBlueAboveAndFourTimesDarkerThanTheSun) {
  const Light light;
  const Sky sky = sky_of(light, {});
  const Vec3f low = sky_radiance(sky, {1, 0, 0}), high = sky_radiance(sky, {0, 1, 0});
  EXPECT_GT(low.x, low.z);
  EXPECT_GT(high.z, 2 * high.x);
  EXPECT_GT(low.y, 2 * high.y);
  const float key = light.sun * normalized(light.to_sun).y / static_cast<float>(pi);
  const float fill = irradiance_at(sky_irradiance(sky), {0, 1, 0}).y;
  EXPECT_NEAR((key + fill) / fill, 4, 1);
}

TEST_F(SkyPicture, ShowsTheRadianceOfEachDirection) {
  const DrawList list = without_ground();
  const Sky sky = sky_of(list.light, list.ground);
  RenderOptions options = plain();
  options.tone_curve = false;
  for (const Vec3f& direction :
       {Vec3f{0, 0, -1}, Vec3f{1, 0.3f, 0}, Vec3f{0.2f, 1, 0.4f}, Vec3f{1, -0.5f, 1}}) {
    const Image image =
        renderer().picture(list, camera_at({}, direction, 40), options, width + 1, height + 1);
    const Vec3f seen = color_at(image, width / 2, height / 2),
                expected = sky_radiance(sky, normalized(direction));
    EXPECT_LT(length(seen - expected), 0.02f) << direction.x << ' ' << direction.y << ' ' << direction.z;
  }
}

TEST_F(SkyPicture, BlacksAreBlackAndMiddleGrayStays) {
  DrawList list = without_ground();
  const auto shown = [&](float radiance) {
    list.light.sky = list.light.horizon = list.light.floor = {radiance, radiance, radiance};
    return static_cast<double>(
        color_at(renderer().picture(list, camera_at({}, {0, 0.1f, 1}, 40), plain(), 9, 9), 4, 4).y);
  };
  EXPECT_EQ(shown(0), 0);
  EXPECT_LT(shown(0.01f), 0.007) << "a toe";
  EXPECT_NEAR(shown(0.18f), 0.18, 0.02);
  EXPECT_LT(shown(1), 0.8) << "a shoulder";
  EXPECT_GT(shown(5), 0.98);
}

/// A pane before a red ball: the ball is seen through it, dimmer, and the pane itself reflects.
TEST_F(SkyPicture, GlassShowsWhatIsBehindIt) {
  DrawList list = without_ground();
  const Vec3f center{0, 0, -2};
  list.spheres.push_back({.key = 1, .centers = {&center, 1}, .radius = 1, .look = {.color = srgb(0xc02020)}});
  const Solid pane(box({1.0, 1.0, 0.05}));
  const auto middle = [&] {
    return color_at(renderer().picture(list, camera_at({0, 0, 4}, {}, 40), plain(), width, height), width / 2,
                    height / 2);
  };
  const Vec3f bare = middle();
  list.surfaces.push_back(pane.surface(2, false, {}, srgb(0xd0e8e0)));
  const Vec3f hidden = middle();
  EXPECT_LT(hidden.x, 2 * hidden.y) << "an opaque pane is not red";
  list.surfaces[0].look.glass = true;
  const Vec3f seen = middle();
  EXPECT_GT(seen.x, 0.7f * bare.x);
  EXPECT_LT(seen.x, bare.x);
  EXPECT_GT(seen.x, 2 * seen.y);
}

/// Where the sun only grazes a surface and beyond, a translucent one is lighter.
TEST_F(SkyPicture, TranslucentBodiesAreLitBeyondTheTerminator) {
  DrawList list = without_ground();
  list.light.to_sun = {1, 0, 0};
  const Solid jelly(sphere(4, 1.0));
  list.surfaces.push_back(jelly.surface(3, true, {}, srgb(0xd0d0d0)));
  const auto brightness = [&](int x) {
    return color_at(renderer().picture(list, camera_at({0, 0, 6}, {}, 40), plain(), width, height), x,
                    height / 2)
        .y;
  };
  const float beyond = brightness(width / 2 - 3), facing = brightness(width / 2 + 15);
  list.surfaces[0].look.translucency = 1;
  EXPECT_GT(brightness(width / 2 - 3), 1.3f * beyond);
  EXPECT_NEAR(brightness(width / 2 + 15), facing, 0.35f * facing);
}

/// A ball in each fabric, lit from the eye: velvet is bright at its rim, satin has a highlight in the middle.
TEST_F(SkyPicture, VelvetShinesAtTheRimAndSatinInTheMiddle) {
  DrawList list = without_ground();
  list.light.to_sun = {0, 0, 1};
  list.light.sky = list.light.horizon = list.light.floor = {0, 0, 0, 1};
  const Solid ball(sphere(4, 1.0));
  list.surfaces.push_back(ball.surface(31, true, {}, {}));
  struct Seen {
    float middle, side, rim;
  };
  const auto seen = [&](Fabric fabric) {
    list.surfaces[0].look = finished(body_look(ObjectKind::cloth, 0, srgb(0x803040)), fabric, Print::plain);
    list.surfaces[0].look.checker_size = 0;
    const Image image = renderer().picture(list, camera_at({0, 0, 6}, {}, 40), plain(), width, height);
    int right = width - 1;
    while (right > width / 2 && color_at(image, right, height / 2).x < 0.01f) --right;
    const int radius = right - width / 2;
    const auto at = [&](float part) {
      return color_at(image, width / 2 + int(part * float(radius)), height / 2).x;
    };
    return Seen{at(0), at(0.5f), at(0.94f)};
  };
  const Seen woven = seen(Fabric::woven), velvet = seen(Fabric::velvet), satin = seen(Fabric::satin);
  EXPECT_GT(velvet.rim / velvet.middle, 1.3f * woven.rim / woven.middle);
  EXPECT_GT(satin.middle / satin.side, 1.3f * woven.middle / woven.side);
}

TEST(Looks, ClothsAreWovenAndPrintedByTheirPlaceAndRigidBodiesPlain) {
  World world;
  for (int i = 0; i < 4; ++i) world.add_cloth(grid(5, 5, 1.0));
  world.add_rigid_body(box({0.2, 0.2, 0.2}));
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {});
  ASSERT_EQ(list.surfaces.size(), 5u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(list.surfaces[i].look.weave, 0);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_NE(list.surfaces[i].look.pattern, list.surfaces[j].look.pattern);
  }
  EXPECT_EQ(list.surfaces[4].look.checker_size, 0);
  EXPECT_EQ(list.surfaces[4].look.color, list.surfaces[4].look.second);
}

}  // namespace souple::render::test_render_sky
