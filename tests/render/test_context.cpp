// Contexts, and what is said when they cannot be had.
#include "render/context.h"
#include "render/gl/program.h"
#include "souple/error.h"

#include <cstdio>
#include <cstdlib>
#include <epoxy/gl.h>

#include <gtest/gtest.h>

namespace souple::render {
namespace {

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
    EXPECT_NO_THROW(throw_gl_errors()) << "said once";
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
    const gl::Program program("screen.vert.glsl", "resolve.frag.glsl", {"colour_map"});  // 1 is no name
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("resolve.frag.glsl"), std::string::npos) << error.what();
  }
}

// In a program of its own: EGL reads its environment once.
TEST(ContextDeathTest, SaysWhatIsMissingWithoutEgl) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto attempt = [] {
    setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent", 1);  // NOLINT(concurrency-mt-unsafe)
    try {
      const OffscreenContext context;
    } catch (const Error& error) {
      std::fprintf(stderr, "%s\n", error.what());
      std::exit(3);  // NOLINT(concurrency-mt-unsafe)
    }
    std::exit(0);  // NOLINT(concurrency-mt-unsafe)
  };
  EXPECT_EXIT(attempt(), testing::ExitedWithCode(3), "libegl-mesa0.*libgl1-mesa-dri");
}

}  // namespace
}  // namespace souple::render
