#include "render/camera.h"
#include "render/extreme_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render {

namespace {

float distance_between(const Vec3f& a, const Vec3f& b) {
  return length(a - b);
}

Vec4 point4(const Vec3f& p) {
  return {p.x, p.y, p.z, 1};
}

Bounds box(const Vec3f& lo, const Vec3f& hi) {
  Bounds result;
  result.add(lo);
  result.add(hi);
  return result;
}

Camera some_camera(float fov = 40) {
  return {{3, 2, -4}, {0.5f, -0.2f, 0.3f}, fov};
}

}  // namespace

TEST(Mat4, InverseUndoesProjectionAndView) {
  const Mat4 m = perspective(0.7f, 1.6f, 0.05f, 80) * look_at({1, 2, 3}, {-1, 0.5f, 0}, {0, 1, 0});
  const Mat4 identity = m * inverse(m);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(identity.m[i], i % 5 == 0 ? 1 : 0, 2e-4) << i;
}

TEST(Mat4, PerspectiveIsAnalytic) {
  // 90 degrees: at depth d the picture is 2 d high. Near maps to -1, far to 1, and z = 2 n f / (n + f) to 0.
  const Mat4 m = perspective(1.57079633f, 2, 1, 3);
  const auto ndc = [&](const Vec3f& p) {
    const Vec4 clip = m * point4(p);
    return Vec3f{clip.x / clip.w, clip.y / clip.w, clip.z / clip.w};
  };
  EXPECT_LT(distance_between(ndc({2, 1, -1}), {1, 1, -1}), 1e-6f);
  EXPECT_LT(distance_between(ndc({-6, -3, -3}), {-1, -1, 1}), 1e-6f);
  EXPECT_LT(distance_between(ndc({0, 0, -1.5f}), {0, 0, 0}), 1e-6f);
}

TEST(Mat4, OrthographicMapsItsBoxToTheCube) {
  const Mat4 m = orthographic(-1, 3, 2, 4, 1, 6);
  const Vec4 lo = m * Vec4{-1, 2, -1, 1}, hi = m * Vec4{3, 4, -6, 1};
  EXPECT_LT(distance_between({lo.x, lo.y, lo.z}, {-1, -1, -1}), 1e-6f);
  EXPECT_LT(distance_between({hi.x, hi.y, hi.z}, {1, 1, 1}), 1e-6f);
  EXPECT_EQ(lo.w, 1);
}

TEST(Mat4, OfATransformMovesPointsAsTheTransformDoes) {
  Transform transform;
  transform.translation = {1, -2, 0.5};
  transform.rotation = Quatd::from_axis_angle(normalized(Vec3d{1, 2, 3}), 0.8);
  transform.scale = 1.7;
  const Vec3d p{0.3, -0.4, 2};
  const Vec4 moved = to_mat4(transform) * point4(Vec3f(p));
  EXPECT_LT(distance_between({moved.x, moved.y, moved.z}, Vec3f(transform.point(p))), 1e-6f);
}

TEST(Camera, MatricesAgreeWithProject) {
  const Camera camera = some_camera();
  const int width = 640, height = 360;
  const Bounds scene = box({-1, -1, -1}, {1, 1, 1});
  const Mat4 m = camera.projection(float(width) / float(height), scene) * camera.view();
  for (const Vec3f& point : {Vec3f{0.5f, 0.2f, 0.9f}, Vec3f{-1, 1, -1}, Vec3f{1, -1, 1}}) {
    const Vec4 clip = m * point4(point);
    const auto seen = camera.project(point, width, height);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->x, (clip.x / clip.w + 1) / 2 * float(width), 1e-2);
    EXPECT_NEAR(seen->y, (1 - clip.y / clip.w) / 2 * float(height), 1e-2);
    EXPECT_NEAR(seen->depth, clip.w, 1e-4);
    EXPECT_LT(std::abs(clip.z), clip.w) << "outside the near and far planes";
  }
}

TEST(Camera, RayAndProjectAreInverse) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const float fov : {5.0f, 40.0f, 110.0f}) {
    const Camera camera = some_camera(fov);
    for (int i = 0; i < 200; ++i) {
      const float x = unit(random) * 800, y = unit(random) * 300;
      const Ray ray = camera.ray(x, y, 800, 300);
      EXPECT_NEAR(length(ray.direction), 1, 1e-6);
      const auto seen = camera.project(ray.origin + ray.direction * (0.1f + 10 * unit(random)), 800, 300);
      ASSERT_TRUE(seen);
      EXPECT_NEAR(seen->x, x, 0.02);
      EXPECT_NEAR(seen->y, y, 0.02);
    }
  }
}

TEST(Camera, NothingIsSeenBehindTheEye) {
  const Camera camera = some_camera();
  EXPECT_FALSE(camera.project(camera.from - camera.forward(), 100, 100));
  EXPECT_FALSE(camera.project(camera.from, 100, 100));
}

TEST(Camera, OrbitKeepsTheDistanceAndStopsShortOfThePoles) {
  Camera camera = some_camera();
  const float distance = camera.distance();
  const Vec3f target = camera.to;
  for (int i = 0; i < 1000; ++i) camera.orbit(0.037f, 0.011f * float(i % 7 - 3));
  EXPECT_NEAR(camera.distance(), distance, 1e-4f * distance);
  EXPECT_EQ(camera.to, target);
  camera.orbit(0, 100);
  EXPECT_NEAR(camera.distance(), distance, 1e-4f * distance);
  EXPECT_GT(camera.up().y, 0.01f) << "upside down or undefined";
  EXPECT_LT(camera.forward().y, -0.99f);
}

TEST(Camera, OrbitTurnsTheWayItSays) {
  Camera camera{{0, 0, 2}, {}};
  camera.orbit(1.57079633f, 0);
  EXPECT_LT(distance_between(camera.from, {2, 0, 0}), 1e-5f);
  camera.orbit(0, 0.52359878f);
  EXPECT_NEAR(camera.from.y, 1, 1e-5);
}

TEST(Camera, PanKeepsTheTargetUnderTheMouse) {
  Camera camera = some_camera();
  const Vec3f point = camera.to;
  const Vec3f direction = camera.forward();
  camera.pan(37, -21, 480);
  const auto seen = camera.project(point, 640, 480);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->x, 320 + 37, 1e-2);
  EXPECT_NEAR(seen->y, 240 - 21, 1e-2);
  EXPECT_LT(distance_between(camera.forward(), direction), 1e-6f);
}

TEST(Camera, ZoomScalesTheDistanceWithinItsBounds) {
  Camera camera = some_camera();
  const float distance = camera.distance();
  camera.zoom(1.25f);
  EXPECT_NEAR(camera.distance(), 1.25f * distance, 1e-5f * distance);
  for (int i = 0; i < 200; ++i) camera.zoom(0.5f);
  EXPECT_GT(camera.distance(), 0.9e-3f);
  for (int i = 0; i < 200; ++i) camera.zoom(2);
  EXPECT_LE(camera.distance(), 1.001e5f);
}

TEST(Camera, FrameFitsABoxTightlyAtAnyAspect) {
  for (const Bounds& scene :
       {box({-1, 0, -1}, {1, 0.2f, 1}), box({3, 5, -2}, {3.1f, 9, -1.9f}), box({-40, -1, -3}, {25, 2, 60})}) {
    for (const auto& [width, height] : {std::array{400, 400}, std::array{1600, 400}, std::array{300, 900}}) {
      Camera camera = some_camera(55);
      const Vec3f direction = camera.forward();
      camera.frame(scene, float(width) / float(height));
      EXPECT_LT(distance_between(camera.forward(), direction), 1e-4f);
      float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
      for (int i = 0; i < 8; ++i) {
        const auto seen =
            camera.project({(i & 1) != 0 ? scene.hi.x : scene.lo.x, (i & 2) != 0 ? scene.hi.y : scene.lo.y,
                            (i & 4) != 0 ? scene.hi.z : scene.lo.z},
                           width, height);
        ASSERT_TRUE(seen);
        left = std::min(left, seen->x / float(width));
        right = std::max(right, seen->x / float(width));
        top = std::min(top, seen->y / float(height));
        bottom = std::max(bottom, seen->y / float(height));
      }
      // Inside; and in one direction nearly from edge to edge, with equal margins on both sides.
      EXPECT_GT(std::min(left, top), 0.02f);
      EXPECT_LT(std::max(right, bottom), 0.98f);
      const bool wide = right - left > bottom - top;
      EXPECT_GT(wide ? right - left : bottom - top, 0.8f);
      EXPECT_NEAR(wide ? left + right : top + bottom, 1, 1e-2);
    }
  }
}

ExtremePoints rope(const Vec3f& begin, const Vec3f& end, float sag) {
  ExtremePoints points;
  for (int i = 0; i <= 100; ++i) {
    const float t = float(i) / 100;
    points.add(begin * (1 - t) + end * t - Vec3f{0, 4 * sag * t * (1 - t), 0}, 0.01f);
  }
  return points;
}

TEST(Camera, TurnsUntilAThinSubjectFillsThePicture) {
  const float aspect = 16.0f / 9;
  const Vec3f ends[][2] = {{{-1, 1, 0}, {1, 1, 0}},
                           {{0, 1, -1}, {0, 1, 1}},
                           {{-2, 0, -1}, {2, 0.2f, 1}},
                           {{10, 3, 10}, {10.5f, 3, 11}}};
  for (const auto& [begin, end] : ends) {
    for (const float sag : {0.0f, 0.3f}) {
      const ExtremePoints subject = rope(begin, end, sag);
      Camera camera;
      camera.turn_to_fill(subject.points(), aspect);
      camera.frame(subject.points(), aspect);
      const Fraction filled = camera.filled(subject.points(), aspect);
      EXPECT_GE(filled.width, 0.35f);
      EXPECT_GE(filled.height, 0.35f);
      EXPECT_NEAR(std::max(filled.width, filled.height), 0.88f, 0.01f);
    }
  }
}

/// A long bridge fills little of the height; from its end it would fill more, and be hidden behind itself.
TEST(Camera, ShowsALongSubjectFromItsSide) {
  ExtremePoints bridge;
  for (int i = 0; i <= 100; ++i) {
    bridge.add({0.05f * float(i), 1, -0.3f}, 0.05f);
    bridge.add({0.05f * float(i), 1, 0.3f}, 0.05f);
  }
  Camera camera;
  camera.turn_to_fill(bridge.points(), 16.0f / 9);
  EXPECT_LT(std::abs(camera.forward().x), std::abs(camera.forward().z));
}

TEST(Camera, KeepsItsDirectionWhereTurningDoesNotHelp) {
  const float aspect = 16.0f / 9;
  ExtremePoints ball;
  ball.add({3, 1, 0}, 0.5f);
  const ExtremePoints vertical = rope({0, 2, 0}, {0, 0, 0}, 0);
  for (const ExtremePoints& subject : {ball, vertical}) {
    Camera camera;
    const Vec3f before = camera.forward();
    camera.turn_to_fill(subject.points(), aspect);
    EXPECT_EQ(camera.forward(), before);
    camera.frame(subject.points(), aspect);
    EXPECT_NEAR(camera.filled(subject.points(), aspect).height, 0.88f, 0.01f);
  }
}

/// A ball of points fills the picture; its box would leave a part of it empty.
TEST(Camera, FrameFitsPointsTighterThanTheirBox) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<Vec3f> cloud;
  cloud.reserve(3000);
  for (int i = 0; i < 3000; ++i)
    cloud.push_back(normalized(Vec3f{normal(random), normal(random), normal(random)}));
  ExtremePoints points;
  for (const Vec3f& point : cloud) points.add(point);
  Camera by_points, by_box;
  by_points.frame(points.points(), 1.5f);
  by_box.frame(points.bounds(), 1.5f);
  const Fraction filled = by_points.filled(cloud, 1.5f);
  EXPECT_GT(filled.height, 0.87f);
  EXPECT_LT(filled.height, 0.88f * 1.05f);  // the cloud between the 98 directions
  EXPECT_GT(filled.height, 1.2f * by_box.filled(cloud, 1.5f).height);
}

TEST(Camera, LooksStraightDownWithoutNaN) {
  Camera camera{{1, 5, 1}, {1, 0, 1}};
  const auto seen = camera.project({1.1f, 0, 1}, 100, 100);
  ASSERT_TRUE(seen);
  EXPECT_TRUE(std::isfinite(seen->x));
  EXPECT_NEAR(length(camera.up()), 1, 1e-6);
  camera.to = camera.from;
  EXPECT_NEAR(length(camera.forward()), 1, 1e-6);
}

TEST(Camera, NearAndFarEncloseASceneTheEyeIsIn) {
  Camera camera = some_camera();
  camera.from = {0, 0.5f, 0};
  camera.to = {0, 0.5f, -1};
  const Bounds room = box({-5, 0, -5}, {5, 3, 5});
  const Mat4 m = camera.projection(1, room);
  const Vec4 wall = m * Vec4{0, 0, -5, 1}, nose = m * Vec4{0, 0, -0.01f, 1};
  EXPECT_LT(wall.z, wall.w);
  EXPECT_GT(nose.z, -nose.w);
  // A 24 bit depth buffer distinguishes millimeters at the wall.
  const Vec4 before = m * Vec4{0, 0, -4.999f, 1};
  EXPECT_GT((wall.z / wall.w - before.z / before.w) / 2 * 16777216, 1);
}

TEST(Bounds, AreEmptyUntilSomethingIsIn) {
  Bounds bounds;
  EXPECT_TRUE(bounds.empty());
  EXPECT_EQ(bounds.radius(), 0);
  bounds.add(Bounds{});
  EXPECT_TRUE(bounds.empty());
  bounds.add({1, 2, 3}, 0.5f);
  EXPECT_FALSE(bounds.empty());
  EXPECT_EQ(bounds.center(), (Vec3f{1, 2, 3}));
  EXPECT_NEAR(bounds.radius(), 0.5 * std::sqrt(3.0), 1e-6);
}

}  // namespace souple::render
