// Contexts, and the messages when none can be created.
#include "render/context.h"
#include "render/gl/program.h"
#include "render/renderer.h"
#include "souple/error.h"

#include <cstdio>
#include <cstdlib>
#include <epoxy/gl.h>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render::test_render_context {

TEST(Context, IsWhatWasAskedFor) {
  {
    const OffscreenContext context(Api::es3);
    EXPECT_NE(context_description().find("OpenGL ES 3"), std::string::npos);
  }
  const OffscreenContext context(Api::gl33);
  EXPECT_EQ(context_description().find("OpenGL ES"), std::string::npos);
}

TEST(Context, CountsErrors) {
  for (const Api api : {Api::es3, Api::gl33}) {
    const OffscreenContext context(api);
    watch_gl_errors();
    EXPECT_NO_THROW(throw_gl_errors());
    glEnable(0xdead);
    EXPECT_THROW(throw_gl_errors(), Error);
    EXPECT_NO_THROW(throw_gl_errors()) << "reported once";
  }
}

TEST(Context, NamesAShaderThatIsMissing) {
  const OffscreenContext context;
  try {
    const gl::Program program("screen.vert.glsl", "there_is_none.glsl");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("there_is_none.glsl"), std::string::npos);
  }
}

TEST(Context, NamesAShaderThatDoesNotCompile) {
  const OffscreenContext context;
  try {
    // color_map becomes 1, not a valid name.
    const gl::Program program("screen.vert.glsl", "resolve.frag.glsl", {"color_map"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("resolve.frag.glsl"), std::string::npos) << error.what();
  }
}

// The bytes of a small picture of several samples, summed so that their order matters.
std::string picture_hash() {
  const OffscreenContext context;
  Renderer renderer;
  const std::vector<Vec3f> centers{{0, 0.5f, 0}, {0.6f, 0.3f, 0.2f}};
  DrawList list;
  list.spheres.emplace_back().centers = centers;
  list.spheres.back().radius = 0.3f;
  std::uint32_t hash = 0;
  for (const std::uint8_t byte : renderer.picture(list, Camera{}, {.samples = 3}, 64, 48).pixels) {
    hash = 31 * hash + byte;
  }
  return "picture " + std::to_string(hash);
}

// Draws in a separate process, since drivers read their environment once; writes the result to stderr.
[[noreturn]] void draw_with(const char* variable, const char* value) {
  setenv(variable, value, 1);  // NOLINT(concurrency-mt-unsafe)
  std::string outcome;
  try {
    outcome = picture_hash();
  } catch (const Error& error) {
    outcome = error.what();
  }
  std::fprintf(stderr, "%s\n", outcome.c_str());
  std::exit(3);  // NOLINT(concurrency-mt-unsafe)
}

class ContextDeathTest : public testing::Test {
 protected:
  ContextDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(ContextDeathTest, SaysWhatIsMissingWithoutEgl) {
  EXPECT_EXIT(draw_with("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent"), testing::ExitedWithCode(3),
              "libegl-mesa0.*libgl1-mesa-dri");
}

TEST_F(ContextDeathTest, NamesAnExtensionThatIsMissing) {
  EXPECT_EXIT(draw_with("MESA_EXTENSION_OVERRIDE", "-GL_EXT_color_buffer_float"), testing::ExitedWithCode(3),
              "EXT_color_buffer_float.*libgl1-mesa-dri");
}

// Samples are then summed alternately into two buffers.
TEST_F(ContextDeathTest, DrawsTheSameWithoutBlendingOfFloats) {
  // The child process runs this test from its start, and must not have drawn before it sets the variable.
  const char* const expected = "SOUPLE_TEST_EXPECTED_PICTURE";
  if (std::getenv(expected) == nullptr)
    setenv(expected, picture_hash().c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EXIT(draw_with("MESA_EXTENSION_OVERRIDE", "-GL_EXT_float_blend"), testing::ExitedWithCode(3),
              std::getenv(expected));
}

}  // namespace souple::render::test_render_context
