#pragma once

#include "render/context.h"
#include "render/renderer.h"
#include "render/srgb.h"
#include "souple/geometry/triangle_mesh.h"

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render {

/// Light of a byte in sRGB, in [0, 1].
inline double linear(int byte) {
  return double(linear_of_srgb(float(byte) / 255));
}

inline double mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

/// Standard deviation.
inline double deviation(std::span<const double> values) {
  const double middle = mean(values);
  double sum = 0;
  for (const double value : values) sum += (value - middle) * (value - middle);
  return std::sqrt(sum / double(values.size()));
}

inline Camera camera_at(const Vec3f& from, const Vec3f& to, float fov) {
  return {from, to, fov};
}

/// A static mesh as a surface; spans refer to this object.
class Solid {
 public:
  explicit Solid(const TriangleMesh& mesh) : triangles_(mesh.triangles) {
    for (const Vec3d& x : mesh.positions) {
      positions_.emplace_back(x);
      normals_.push_back(normalized(positions_.back()));
    }
  }
  /// `smooth`: normals point away from the origin, as on a ball.
  Surface surface(std::uint64_t key, bool smooth, const Vec3d& at, const Color& color) const {
    Surface s;
    s.key = key;
    s.positions = positions_;
    if (smooth) s.normals = normals_;
    s.triangles = triangles_;
    s.pose.translation = at;
    s.look.color = s.look.second = color;
    s.pick = std::uint32_t(key);
    return s;
  }
  std::span<const Vec3f> positions() const { return positions_; }

 private:
  std::vector<Vec3f> positions_, normals_;
  std::vector<Triangle> triangles_;
};

/// Fixture for drawing tests: one context and renderer for a whole suite; an OpenGL error fails a test.
class GlTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    context_ = std::make_unique<OffscreenContext>();
    watch_gl_errors();
    renderer_ = std::make_unique<Renderer>();
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    context_.reset();
  }
  void TearDown() override { EXPECT_NO_THROW(throw_gl_errors()); }

  static Renderer& renderer() { return *renderer_; }
  /// One sample through each pixel's center, with only direct light from sun and sky.
  static RenderOptions plain() { return {.shadows = false, .ambient_occlusion = false, .samples = 1}; }
  static DrawList without_ground() {
    DrawList list;
    list.ground.shown = false;
    return list;
  }

 private:
  static inline std::unique_ptr<OffscreenContext> context_;
  static inline std::unique_ptr<Renderer> renderer_;
};

}  // namespace souple::render
