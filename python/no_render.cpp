#include "python/bind.h"
#include "souple/error.h"

namespace souple::python {

void bind_render(py::module_& m) {
  const auto refuse = [](const py::args&, const py::kwargs&) {
    throw Error(
        "render: this build of souple has no renderer; build it where libepoxy-dev, libegl-dev, libpng-dev "
        "and "
        "libimgui-dev are installed");
  };
  m.def("render", refuse, "Not in this build.");
  m.def("write_png", refuse, "Not in this build.");
}

}  // namespace souple::python
