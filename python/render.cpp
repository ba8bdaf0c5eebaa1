#include "python/bind.h"
#include "python/bound_world.h"
#include "render/context.h"
#include "render/display.h"
#include "render/extreme_points.h"
#include "render/image.h"
#include "render/renderer.h"
#include "render/subject.h"

#include <algorithm>
#include <filesystem>
#include <pybind11/stl/filesystem.h>

namespace souple::python {

namespace {

/// Where a picture is taken from; empty: all objects are framed.
struct View {
  std::optional<Vec3f> from, to;
  float fov;
};

render::ExtremePoints extent_of(const render::Subject& subject) {
  render::ExtremePoints extent;
  for (const render::Body& body : subject.bodies)
    for (const Vec3f& x : body.positions) extent.add(x, body.radius);
  return extent;
}

render::Camera camera_of(const View& view, const render::Subject& subject, float aspect) {
  render::Camera camera;
  camera.from = view.from.value_or(camera.from);
  camera.to = view.to.value_or(camera.to);
  camera.fov = view.fov;
  if (!(camera.fov > 1 && camera.fov < 170)) throw Error("render: fov is out of (1, 170) degrees");
  if (!is_finite(camera.from) || !is_finite(camera.to) || camera.from == camera.to)
    throw Error("render: expected two different points for camera_from and camera_to");
  if (view.from || view.to) return camera;
  const render::ExtremePoints extent = extent_of(subject);
  camera.turn_to_fill(extent.points(), aspect);
  camera.frame(extent.points(), aspect);
  return camera;
}

render::Image picture_of(const World& world, const View& view, int width, int height, int samples) {
  const render::OffscreenContext context;
  render::Renderer renderer;
  render::SubjectDrawing drawing;
  const render::Subject subject = render::subject_of(world);
  const render::Camera camera =
      camera_of(view, subject, static_cast<float>(width) / static_cast<float>(height));
  render::RenderOptions options;
  options.samples = samples;
  options.focus = camera.distance();
  return renderer.picture(drawing.update(subject, {}), camera, options, width, height);
}

py::array picture(BoundWorld& world, int width, int height, const std::optional<Vec3f>& from,
                  const std::optional<Vec3f>& to, float fov, int samples) {
  if (width < 1 || width > 8192 || height < 1 || height > 8192)
    throw Error("render: expected a width and a height from 1 to 8192 pixels");
  if (samples < 1 || samples > 1024) throw Error("render: expected 1 to 1024 samples");
  const View view{from, to, fov};
  const render::Image image = world.without_gil(
      "render", [&](const World& w) { return picture_of(w, view, width, height, samples); });
  const std::vector<py::ssize_t> shape{height, width, 4};
  return py::array(py::dtype("u1"), shape, image.pixels.data());
}

void write_png(const std::filesystem::path& file, const py::array& any) {
  if (any.dtype().kind() != 'u' || any.itemsize() != 1)
    throw Error("write_png: expected an array of bytes (uint8), found one of type " +
                py::str(any.dtype()).cast<std::string>());
  const py::array_t<std::uint8_t, py::array::c_style> pixels(any);
  if (pixels.ndim() != 3 || pixels.shape(2) != 4)
    throw Error("write_png: expected an array of shape (height, width, 4)");
  render::Image image(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
  std::copy_n(pixels.data(), image.pixels.size(), image.pixels.begin());
  render::write_png(file.string(), image);
}

}  // namespace

void bind_render(py::module_& m) {
  m.def("render", &picture, "world"_a, "width"_a = 640, "height"_a = 360, "camera_from"_a = py::none(),
        "camera_to"_a = py::none(), "fov"_a = 40, "samples"_a = 16,
        "Draws a world without window or screen: an array of bytes, (height, width, 4), R, G, B, A as in a "
        "PNG. Without a "
        "camera [m] all objects are framed.");
  m.def("write_png", &write_png, "file"_a, "pixels"_a, "Writes an opaque PNG of such an array.");
}

}  // namespace souple::python
