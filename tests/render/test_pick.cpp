#include "gl_test.h"
#include "ray_balls.h"
#include "souple/geometry/builders.h"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace souple::render {

namespace {

constexpr int width = 320, height = 240;

class PickTest : public GlTest {};

Camera a_camera() {
  return camera_at({1.2f, 1.5f, 2.8f}, {0, 0.1f, 0}, 50);
}

/// A wavy sheet at a position.
struct Sheet {
  Sheet() : mesh(grid(40, 30, 2)) {
    for (const Vec3d& x : mesh.positions) {
      positions.push_back({float(x.x), float(0.2 * std::sin(4 * x.x) * std::cos(3 * x.z)), float(x.z)});
    }
    pose.translation = {0.1, 0.2, -0.3};
    pose.rotation = Quatd::from_axis_angle(normalized(Vec3d{1, 2, 0.5}), 0.4);
    pose.scale = 1.3;
  }
  Surface surface() const {
    Surface surface;
    surface.key = 1;
    surface.positions = positions;
    surface.triangles = mesh.triangles;
    surface.pose = pose;
    surface.pick = 5;
    return surface;
  }
  Vec3f world(std::uint32_t vertex) const { return Vec3f(pose.point(Vec3d(positions[vertex]))); }

  TriangleMesh mesh;
  std::vector<Vec3f> positions;
  Transform pose;
};

/// First intersection of a ray with the sheet (Moeller and Trumbore 1997).
std::optional<Vec3d> intersect(const Sheet& sheet, const Ray& ray) {
  std::optional<Vec3d> best;
  double least = std::numeric_limits<double>::max();
  const Vec3d origin(ray.origin), direction(ray.direction);
  for (const Triangle& triangle : sheet.mesh.triangles) {
    const Vec3d a(sheet.world(triangle[0])), e1 = Vec3d(sheet.world(triangle[1])) - a,
                                             e2 = Vec3d(sheet.world(triangle[2])) - a;
    const Vec3d p = cross(direction, e2), s = origin - a, q = cross(s, e1);
    const double determinant = dot(e1, p);
    const double u = dot(s, p) / determinant, v = dot(direction, q) / determinant,
                 t = dot(e2, q) / determinant;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0) || t >= least) continue;
    least = t;
    best = origin + direction * t;
  }
  return best;
}

}  // namespace

TEST_F(PickTest, TheParticleUnderThePixelForAThousandPixels) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<Vec3f> centers;
  std::vector<Ball> balls;
  const float radius = 0.06f;
  for (int i = 0; i < 600; ++i) {
    centers.push_back({place(random), 0.5f * place(random), place(random)});
    balls.push_back({Vec3d(centers.back()), double(radius)});
  }
  DrawList list;  // with the ground, which cannot be picked
  list.spheres.push_back({.key = 1, .centers = centers, .radius = radius, .pick = 42});
  const Camera camera = a_camera();
  const PickImage image = renderer().pick_image(list, camera, width, height);
  std::uniform_int_distribution<int> column(0, width - 1), row(0, height - 1);
  int hits = 0;
  for (int checked = 0; checked < 1000;) {
    const int x = column(random), y = row(random);
    const std::optional<int> ball = unambiguous_ball(balls, camera, x, y, width, height, 0.5);
    if (!ball) continue;
    ++checked;
    const Picked picked = renderer().pick(list, camera, x, y, width, height);
    const auto i = std::size_t(y * width + x);
    ASSERT_EQ(picked.pick, *ball < 0 ? 0u : 42u) << x << " " << y;
    ASSERT_EQ(image.pick[i], picked.pick);
    if (*ball < 0) continue;
    ++hits;
    ASSERT_EQ(picked.element, std::uint32_t(*ball)) << x << " " << y;
    ASSERT_EQ(image.element[i], picked.element);
    const BallHit hit = cast(balls, camera, x + 0.5, y + 0.5, width, height);
    ASSERT_LT(length(Vec3d(picked.point) - hit.point), 1e-3);
    ASSERT_NEAR(double(image.depth[i]), hit.depth, 1e-3);
  }
  EXPECT_GT(hits, 150);
}

TEST_F(PickTest, TheVertexNearestToThePointUnderThePixel) {
  const Sheet sheet;
  DrawList list;
  list.surfaces.push_back(sheet.surface());
  const Camera camera = a_camera();
  const PickImage image = renderer().pick_image(list, camera, width, height);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> column(0, width - 1), row(0, height - 1);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const int x = column(random), y = row(random);
    const auto point = intersect(sheet, camera.ray(float(x) + 0.5f, float(y) + 0.5f, width, height));
    const Picked picked = renderer().pick(list, camera, x, y, width, height);
    EXPECT_EQ(image.element[std::size_t(y * width + x)], picked.element);
    if (!point || picked.pick == 0) continue;
    // Where a fold hides another one, a pixel may show either.
    if (length(Vec3d(picked.point) - *point) > 1e-2) continue;
    ++hits;
    EXPECT_LT(length(Vec3d(picked.point) - *point), 2e-3);
    double least = std::numeric_limits<double>::max();
    for (std::uint32_t v = 0; v < sheet.positions.size(); ++v) {
      least = std::min(least, length(Vec3d(sheet.world(v)) - *point));
    }
    EXPECT_LT(length(Vec3d(sheet.world(picked.element)) - *point), least + 2e-3);
  }
  EXPECT_GT(hits, 60);
}

TEST_F(PickTest, WhatCannotBePickedIsTransparentAndNothingIsNothing) {
  const Sheet sheet;
  DrawList list;
  list.surfaces.push_back(sheet.surface());
  const Camera camera = a_camera();
  const auto at = camera.project(sheet.world(sheet.mesh.triangles[500][0]), width, height);
  const auto pick = [&](int x, int y) { return renderer().pick(list, camera, x, y, width, height).pick; };
  EXPECT_EQ(pick(int(at->x), int(at->y)), 5u);
  EXPECT_EQ(pick(0, 0), 0u);
  for (const auto& [x, y] : {std::pair{-1, 5}, std::pair{5, -1}, std::pair{width, 5}, std::pair{5, height}}) {
    EXPECT_EQ(pick(x, y), 0u);
  }
  list.surfaces[0].pick = 0;
  EXPECT_EQ(pick(int(at->x), int(at->y)), 0u);
  EXPECT_EQ(renderer().pick(DrawList{}, camera, 0, 0, 1, 1).pick, 0u);
}

}  // namespace souple::render
