#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/math/transform.h"

namespace souple::python {

namespace {

void bind_fluid_settings(py::module_& m) {
  Struct<FoamRange>(m, "FoamRange").fields<&FoamRange::low, &FoamRange::high>();
  using P = FoamParameters;
  Struct<P>(m, "FoamParameters")
      .fields<&P::max_particles, &P::trapped_air_rate, &P::wave_crest_rate, &P::trapped_air, &P::wave_crest,
              &P::energy, &P::life, &P::longest_life, &P::buoyancy, &P::drag, &P::spray_neighbors,
              &P::bubble_neighbors>();
  using F = FluidSettings;
  Struct<F>(m, "FluidSettings")
      .fields<&F::kernel, &F::iterations, &F::tolerance, &F::compressibility, &F::artificial_pressure,
              &F::foam>();
}

void bind_transform(py::module_& m) {
  using T = Transform;
  Struct<T>(m, "Transform")
      .fields<&T::translation, &T::rotation, &T::scale>()
      .def("point", &T::point)
      .def("direction", &T::direction);
  m.def(
      "from_axis_angle",
      [](const Vec3d& axis, double angle) { return Quatd::from_axis_angle(normalized(axis), angle); },
      "axis"_a, "angle"_a, "The rotation (x, y, z, w) by `angle` radians about an axis of any length.");
  m.def("from_euler_xyz", &Quatd::from_euler_xyz, "angles"_a, doc("Quaternion.from_euler_xyz"));
}

}  // namespace

void bind_settings(py::module_& m) {
  bind_transform(m);
  bind_fluid_settings(m);
  using W = Wind;
  Struct<W>(m, "Wind").fields<&W::velocity, &W::gust, &W::gust_period, &W::air_density>();
  Struct<Sleeping>(m, "Sleeping").fields<&Sleeping::enabled, &Sleeping::speed, &Sleeping::seconds>();
  using V = SolverSettings;
  Struct<V>(m, "SolverSettings").fields<&V::kind, &V::sweep, &V::relaxation, &V::chebyshev, &V::colors>();
  using S = Settings;
  Struct<S>(m, "Settings")
      .fields<&S::substeps, &S::iterations, &S::mode, &S::integrator, &S::gravity, &S::wind, &S::drag,
              &S::measure_residuals, &S::seed, &S::solver, &S::fluid, &S::sleeping, &S::detection,
              &S::segment_test, &S::threads, &S::threading>();
}

}  // namespace souple::python
