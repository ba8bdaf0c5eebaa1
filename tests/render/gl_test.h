#pragma once

#include "render/context.h"
#include "render/renderer.h"

#include <memory>

#include <gtest/gtest.h>

namespace souple::render {

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
