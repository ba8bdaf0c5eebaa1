#include "app/check_pictures.h"
#include "app/commands.h"
#include "app/last_picture.h"
#include "app/sweep/sheet.h"
#include "souple/error.h"

// Replaces render.cpp, last_picture.cpp, sweep/sheet.cpp and check_pictures.cpp where the packages for render/ were missing.

namespace souple::app {

namespace {

[[noreturn]] void refuse() {
  throw Error(
      "this program was built without pictures: install the Debian packages libepoxy-dev libegl-dev "
      "libpng-dev "
      "libimgui-dev and build it again");
}

}  // namespace

struct LastPicture::Impl {};

LastPicture::LastPicture(const std::filesystem::path&, const PictureLook&) {
  refuse();
}

LastPicture::~LastPicture() = default;

void LastPicture::write(const World&, const SceneDescription&) {
  refuse();
}

bool write_sheet(const Sweep&) {
  return false;
}

int render_frames(const RenderRequest&) {
  refuse();
}

void check_pictures(const SceneDescription&) {}

std::string picture_support() {
  return "pictures: no (not built in)\nfilms: no (not built in)\n";
}

}  // namespace souple::app
