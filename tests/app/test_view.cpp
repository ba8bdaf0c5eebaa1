#include "tests/app/offscreen_viewer.h"
#include "tests/expect_error.h"

#include <gtest/gtest.h>

namespace souple::viewer {
namespace {

std::filesystem::path shipped(const char* name) {
  return std::filesystem::path(SOUPLE_SOURCE_DIR "/scenes") / (std::string(name) + ".json");
}

TEST(View, Look) {
  OffscreenViewer view(shipped("curtain"), 1440, 900);
  view.pictures(150);
  std::filesystem::create_directories(SOUPLE_SOURCE_DIR "/out");
  render::write_png(SOUPLE_SOURCE_DIR "/out/view.png", view.image());
}

}  // namespace
}  // namespace souple::viewer
