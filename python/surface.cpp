#include "python/bind.h"
#include "python/enums.h"
#include "python/gil.h"
#include "python/structs.h"
#include "souple/error.h"
#include "souple/surface/fluid_surface.h"

#include <string>
#include <vector>

namespace souple::python {

namespace {

int checked_threads(int threads) {
  constexpr int most = 1024;  // as Settings::threads
  if (threads < 0 || threads > most)
    throw Error(py::str("FluidSurface: threads is {}, expected 0 (all processors) to {}")
                    .format(threads, most)
                    .cast<std::string>());
  return threads;
}

/// A surface, and the threads that compute it.
class BoundSurface {
 public:
  BoundSurface(const SurfaceOptions& options, int threads)
      : surface_(options), threads_(make_threads(Threading::automatic, checked_threads(threads))) {}
  py::object build(std::span<const Vec3f> given) {
    const std::vector<Vec3f> positions(given.begin(), given.end());  // another thread may change the caller's
    if (busy_) throw Error("FluidSurface.build: another thread is in build of this surface");
    busy_ = true;
    const SurfaceMesh* mesh = nullptr;
    try {
      const ReleasedGil released;
      mesh = &surface_.build(positions, *threads_);
    } catch (...) {
      busy_ = false;
      throw;
    }
    busy_ = false;
    return namespace_of(py::arg("positions") = to_array(mesh->positions),
                        py::arg("normals") = to_array(mesh->normals),
                        py::arg("triangles") = to_array(mesh->triangles));
  }
  const SurfaceOptions& options() const { return surface_.options(); }

 private:
  FluidSurface surface_;
  std::unique_ptr<Threads> threads_;
  bool busy_ = false;
};

}  // namespace

void bind_surface(py::module_& m) {
  using O = SurfaceOptions;
  Struct<O>(m, "SurfaceOptions")
      .field<&O::method>("method")
      .field<&O::spacing>("spacing")
      .field<&O::cell>("cell")
      .field<&O::neighbor_radius>("neighbor_radius")
      .field<&O::center_smoothing>("center_smoothing")
      .field<&O::kernel_radius>("kernel_radius")
      .field<&O::isotropic_radius>("isotropic_radius")
      .field<&O::max_axis_ratio>("max_axis_ratio")
      .field<&O::few_neighbors>("few_neighbors")
      .field<&O::drop_radius>("drop_radius")
      .field<&O::level>("level")
      .field<&O::smoothing_passes>("smoothing_passes")
      .field<&O::smoothing>("smoothing");
  py::class_<BoundSurface>(m, "FluidSurface", doc("FluidSurface"))
      .def(py::init([](const std::optional<O>& options, int threads, const py::kwargs& kwargs) {
             return std::make_unique<BoundSurface>(with_keywords(options, kwargs, "FluidSurface"), threads);
           }),
           py::arg("options") = py::none(), py::arg("threads") = 0,
           "Keywords are members of SurfaceOptions: FluidSurface(spacing=0.02).")
      .def("build", on_self(&BoundSurface::build), py::arg("positions"),
           "The mesh of these particles [m]: positions, normals, triangles, as arrays of their own.")
      .def("options", on_self(&BoundSurface::options), doc("FluidSurface.options"));
}

}  // namespace souple::python
