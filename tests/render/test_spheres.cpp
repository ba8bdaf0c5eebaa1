#include "gl_test.h"
#include "ray_balls.h"

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <vector>

namespace souple::render {

namespace {

constexpr int width = 200, height = 150;

class SpheresTest : public GlTest {
 protected:
  /// Pixels at which the pictures with and without the list's balls differ.
  static std::vector<bool> drawn(const DrawList& list, const Camera& camera) {
    DrawList empty = list;
    empty.spheres.clear();
    const Image with = renderer().picture(list, camera, plain(), width, height);
    const Image without = renderer().picture(empty, camera, plain(), width, height);
    std::vector<bool> mask;
    for (std::size_t i = 0; i < with.pixels.size(); i += 4) {
      mask.push_back(!std::equal(&with.pixels[i], &with.pixels[i] + 4, &without.pixels[i]));
    }
    return mask;
  }
};

Spheres one_ball(const Vec3f& center, float radius) {
  static std::uint64_t version = 0;
  static Vec3f place;
  place = center;
  Spheres spheres;
  spheres.key = 1;
  spheres.version = ++version;
  spheres.centers = {&place, 1};
  spheres.radius = radius;
  spheres.look.color = srgb(0x803010);
  spheres.pick = 7;
  return spheres;
}

std::vector<Ball> random_balls(std::size_t count, unsigned seed, std::vector<Vec3f>& centers,
                               std::vector<float>& radii) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1, 1), size(0.05f, 0.45f);
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < count; ++i) {
    centers.push_back({place(random), 0.7f * place(random), place(random)});
    radii.push_back(size(random));
    balls.push_back({Vec3d(centers.back()), double(radii.back())});
  }
  return balls;
}

}  // namespace

TEST_F(SpheresTest, SilhouetteIsWhereTheConeOfTangentsCutsThePicture) {
  struct Case {
    Vec3f center;
    float radius, fov, distance;
  };
  // At the center; off it, where the outline is an ellipse; across the edge of the picture; near; small and
  // far.
  for (const Case& c : {Case{{0, 0, 0}, 0.4f, 40, 3}, Case{{0.9f, 0.6f, 0.2f}, 0.3f, 40, 3},
                        Case{{-2.4f, 1.6f, 0.3f}, 0.7f, 100, 3}, Case{{1.5f, -0.2f, 0.1f}, 0.5f, 40, 3},
                        Case{{3.6f, 0.3f, 1.9f}, 0.6f, 120, 3}, Case{{0.6f, 0.1f, 2.0f}, 0.7f, 80, 3},
                        Case{{0.3f, -0.2f, 0}, 0.01f, 1, 60}}) {
    const Camera camera = camera_at({0.1f, 0.2f, c.distance}, {}, c.fov);
    const std::array<Ball, 1> ball{Ball{Vec3d(c.center), double(c.radius)}};
    DrawList list = without_ground();
    list.spheres.push_back(one_ball(c.center, c.radius));
    const std::vector<bool> mask = drawn(list, camera);
    const PickImage picked = renderer().pick_image(list, camera, width, height);
    int inside = 0, wrong = 0, wrong_picks = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto i = std::size_t(y * width + x);
        // Pictures have soft edges, picks have hard ones.
        const std::optional<int> seen = unambiguous_ball(ball, camera, x, y, width, height, 1);
        const std::optional<int> hit = unambiguous_ball(ball, camera, x, y, width, height, 0.1);
        if (seen) wrong += (*seen == 0) != mask[i];
        if (!hit) continue;
        inside += *hit == 0;
        wrong_picks += (*hit == 0) != (picked.pick[i] == 7);
      }
    }
    EXPECT_EQ(wrong, 0) << "fov " << c.fov << ", center " << c.center.x;
    EXPECT_EQ(wrong_picks, 0) << "fov " << c.fov << ", center " << c.center.x;
    EXPECT_GT(inside, 4) << "fov " << c.fov << ", center " << c.center.x;
  }
}

TEST_F(SpheresTest, WideAngleStretchesABallIntoItsEllipse) {
  // On the horizontal axis, 1 rad (57.3 degrees) off the view direction: edges at tan(1 -+ asin(r / d)).
  const Camera camera = camera_at({0, 0, 2}, {}, 110);
  const float radius = 0.5f, distance = 4;
  DrawList list = without_ground();
  list.spheres.push_back(one_ball({distance * std::sin(1.0f), 0, 2 - distance * std::cos(1.0f)}, radius));
  const std::vector<bool> mask = drawn(list, camera);
  int left = width, right = -1, top = height, bottom = -1;
  for (int i = 0; i < width * height; ++i) {
    if (!mask[std::size_t(i)]) continue;
    left = std::min(left, i % width);
    right = std::max(right, i % width + 1);
    top = std::min(top, i / width);
    bottom = std::max(bottom, i / width + 1);
  }
  const double per_tangent = height / (2 * std::tan(55 * pi / 180));
  const double half = std::asin(double(radius / distance));
  EXPECT_NEAR(left, width / 2.0 + per_tangent * std::tan(1 - half), 1);
  EXPECT_NEAR(right, std::min(double(width), width / 2.0 + per_tangent * std::tan(1 + half)), 1);
  EXPECT_GT(double(right - left), 1.4 * (bottom - top)) << "not a circle";
}

TEST_F(SpheresTest, NearestOfInterpenetratingBallsIsSeenAtEveryPixel) {
  std::vector<Vec3f> centers;
  std::vector<float> radii;
  const std::vector<Ball> balls = random_balls(40, 3, centers, radii);
  DrawList list = without_ground();
  list.spheres.push_back({.key = 2, .centers = centers, .radii = radii, .pick = 9});
  const Camera camera = camera_at({0.5f, 0.8f, 3}, {}, 45);
  const PickImage image = renderer().pick_image(list, camera, width, height);
  int wrong = 0, seen = 0;
  float worst = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::optional<int> hit = unambiguous_ball(balls, camera, x, y, width, height, 0.05);
      const auto i = std::size_t(y * width + x);
      if (!hit || *hit < 0) continue;
      ++seen;
      wrong += image.pick[i] != 9 || image.element[i] != std::uint32_t(*hit);
      const double depth = cast(balls, camera, x + 0.5, y + 0.5, width, height).depth;
      worst = std::max(worst, float(std::abs(double(image.depth[i]) - depth)));
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(seen, width * height / 4);
  EXPECT_LT(worst, 1e-3f) << "m";
}

TEST_F(SpheresTest, CutASurfaceWhereTheyMeetIt) {
  // A ball partly sunk into the plane z = 0, seen from the front. Its visible part is the disc of its radius in that
  // plane, smaller than its silhouette.
  const std::array<Vec3f, 4> corners{Vec3f{-9, -9, 0}, Vec3f{9, -9, 0}, Vec3f{9, 9, 0}, Vec3f{-9, 9, 0}};
  const std::array<Triangle, 2> triangles{Triangle{0, 1, 2}, Triangle{0, 2, 3}};
  DrawList list = without_ground();
  list.surfaces.push_back({.key = 1, .positions = corners, .triangles = triangles, .pick = 1});
  list.spheres.push_back(one_ball({0.2f, 0.1f, -0.3f}, 0.5f));
  const Camera camera = camera_at({0, 0, 2}, {}, 40);
  const PickImage image = renderer().pick_image(list, camera, width, height);
  const float rim = 0.4f;  // sqrt(0.5^2 - 0.3^2)
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.ray(float(x) + 0.5f, float(y) + 0.5f, width, height);
      const Vec3f on_wall = ray.origin - ray.direction * (ray.origin.z / ray.direction.z);
      const float off = length(on_wall - Vec3f{0.2f, 0.1f, 0}) - rim;
      if (std::abs(off) < camera.pixel_size(2, height)) continue;
      ASSERT_EQ(image.pick[std::size_t(y * width + x)], off < 0 ? 7u : 1u) << x << " " << y;
    }
  }
}

TEST_F(SpheresTest, EachHasItsOwnColor) {
  const std::array<Vec3f, 3> centers{Vec3f{-0.8f, 0, 0}, Vec3f{0, 0, 0}, Vec3f{0.8f, 0, 0}};
  const std::array<PackedColor, 3> colors{0xff0000c0, 0xff00c000, 0xffc00000};
  Spheres spheres;
  spheres.key = 3;
  spheres.centers = centers;
  spheres.radius = 0.3f;
  spheres.colors = colors;
  DrawList list = without_ground();
  list.spheres.push_back(spheres);
  const Camera camera = camera_at({0, 0, 3}, {}, 45);
  const Image image = renderer().picture(list, camera, plain(), width, height);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = camera.project(centers[i], width, height);
    const std::uint8_t* pixel = image.at(int(at->x), int(at->y));
    for (std::size_t c = 0; c < 3; ++c) {
      if (c != i) {
        EXPECT_GT(pixel[i], pixel[c] + 40) << i << " " << c;
      }
    }
  }
}

TEST_F(SpheresTest, AreSeenFromInside) {
  const Camera camera = camera_at({0, 0, 0.1f}, {}, 60);
  DrawList list = without_ground();
  list.spheres.push_back(one_ball({}, 0.5f));
  const PickImage image = renderer().pick_image(list, camera, width, height);
  EXPECT_EQ(std::count(image.pick.begin(), image.pick.end(), 7u), width * height);
  EXPECT_NEAR(image.depth[std::size_t(height / 2 * width + width / 2)], 0.6, 1e-2);
}

TEST_F(SpheresTest, BadOnesAreNotDrawn) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Camera camera = camera_at({0, 0, 3}, {}, 45);
  for (const auto& [center, radius] :
       {std::pair{Vec3f{nan, 0, 0}, 0.3f}, std::pair{Vec3f{0, infinity, 0}, 0.3f}, std::pair{Vec3f{}, 0.0f},
        std::pair{Vec3f{}, -1.0f}, std::pair{Vec3f{}, nan}, std::pair{Vec3f{0, 0, 5}, 0.5f}}) {
    DrawList list = without_ground();
    list.spheres.push_back(one_ball(center, radius));
    const std::vector<bool> mask = drawn(list, camera);
    EXPECT_EQ(std::count(mask.begin(), mask.end(), true), 0) << radius;
  }
  DrawList list = without_ground();
  list.spheres.emplace_back();
  EXPECT_NO_THROW(renderer().picture(list, camera, plain(), 8, 8));
}

TEST_F(SpheresTest, FollowTheirVersion) {
  std::vector<Vec3f> centers{{0, 0, 0}};
  Spheres spheres;
  spheres.key = 4;
  spheres.radius = 0.2f;
  spheres.pick = 1;
  const Camera camera = camera_at({0, 0, 3}, {}, 45);
  const auto middle = [&] {
    DrawList list = without_ground();
    spheres.centers = centers;
    list.spheres.push_back(spheres);
    return renderer().pick(list, camera, width / 2, height / 2, width, height).pick;
  };
  EXPECT_EQ(middle(), 1u);
  centers[0].x = 1;
  ++spheres.version;
  EXPECT_EQ(middle(), 0u);
  centers.push_back({0, 0, 0});
  ++spheres.version;
  EXPECT_EQ(middle(), 1u);
  centers.clear();
  ++spheres.version;
  EXPECT_EQ(middle(), 0u);
}

}  // namespace souple::render
