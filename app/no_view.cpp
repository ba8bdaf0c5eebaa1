#include "app/commands.h"
#include "souple/error.h"

// Replaces view.cpp where the viewer's packages were missing.

namespace souple::app {

bool has_viewer() {
  return false;
}

int view(const ViewRequest&) {
  throw Error(
      "this program was built without its viewer: install the Debian packages libepoxy-dev libegl-dev "
      "libpng-dev "
      "libimgui-dev libglfw3-dev and build it again");
}

}  // namespace souple::app
