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
    return namespace_of("positions"_a = to_array(mesh->positions), "normals"_a = to_array(mesh->normals),
                        "triangles"_a = to_array(mesh->triangles));
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
      .fields<&O::method, &O::spacing, &O::cell, &O::neighbor_radius, &O::center_smoothing, &O::kernel_radius,
              &O::isotropic_radius, &O::max_axis_ratio, &O::few_neighbors, &O::drop_radius, &O::level,
              &O::smoothing_passes, &O::smoothing>();
  py::class_<BoundSurface>(m, "FluidSurface", doc("FluidSurface"))
      .def(py::init([](const std::optional<O>& options, int threads, const py::kwargs& kwargs) {
             return std::make_unique<BoundSurface>(with_keywords(options, kwargs, "FluidSurface"), threads);
           }),
           "options"_a = py::none(), "threads"_a = 0,
           "Keywords are members of SurfaceOptions: FluidSurface(spacing=0.02).")
      .def("build", on_self(&BoundSurface::build), "positions"_a,
           "The mesh of these particles [m]: positions, normals, triangles, as arrays of their own.")
      .def("options", on_self(&BoundSurface::options), doc("FluidSurface.options"));
}

}  // namespace souple::python
