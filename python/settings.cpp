#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/math/transform.h"

namespace souple::python {

namespace {

void bind_fluid_settings(py::module_& m) {
  Struct<FoamRange>(m, "FoamRange").field<&FoamRange::low>("low").field<&FoamRange::high>("high");
  using P = FoamParameters;
  Struct<P>(m, "FoamParameters")
      .field<&P::max_particles>("max_particles")
      .field<&P::trapped_air_rate>("trapped_air_rate")
      .field<&P::wave_crest_rate>("wave_crest_rate")
      .field<&P::trapped_air>("trapped_air")
      .field<&P::wave_crest>("wave_crest")
      .field<&P::energy>("energy")
      .field<&P::life>("life")
      .field<&P::longest_life>("longest_life")
      .field<&P::buoyancy>("buoyancy")
      .field<&P::drag>("drag")
      .field<&P::spray_neighbors>("spray_neighbors")
      .field<&P::bubble_neighbors>("bubble_neighbors");
  using F = FluidSettings;
  Struct<F>(m, "FluidSettings")
      .field<&F::kernel>("kernel")
      .field<&F::iterations>("iterations")
      .field<&F::tolerance>("tolerance")
      .field<&F::compressibility>("compressibility")
      .field<&F::artificial_pressure>("artificial_pressure")
      .field<&F::foam>("foam");
}

void bind_transform(py::module_& m) {
  using T = Transform;
  Struct<T>(m, "Transform")
      .field<&T::translation>("translation")
      .field<&T::rotation>("rotation")
      .field<&T::scale>("scale")
      .def("point", &T::point)
      .def("direction", &T::direction);
  m.def(
      "from_axis_angle",
      [](const Vec3d& axis, double angle) { return Quatd::from_axis_angle(normalized(axis), angle); },
      py::arg("axis"), py::arg("angle"),
      "The rotation (x, y, z, w) by `angle` radians about an axis of any length.");
  m.def("from_euler_xyz", &Quatd::from_euler_xyz, py::arg("angles"), doc("Quaternion.from_euler_xyz"));
}

}  // namespace

void bind_settings(py::module_& m) {
  bind_transform(m);
  bind_fluid_settings(m);
  using W = Wind;
  Struct<W>(m, "Wind")
      .field<&W::velocity>("velocity")
      .field<&W::gust>("gust")
      .field<&W::gust_period>("gust_period")
      .field<&W::air_density>("air_density");
  Struct<Sleeping>(m, "Sleeping")
      .field<&Sleeping::enabled>("enabled")
      .field<&Sleeping::speed>("speed")
      .field<&Sleeping::seconds>("seconds");
  using V = SolverSettings;
  Struct<V>(m, "SolverSettings")
      .field<&V::kind>("kind")
      .field<&V::sweep>("sweep")
      .field<&V::relaxation>("relaxation")
      .field<&V::chebyshev>("chebyshev")
      .field<&V::colors>("colors");
  using S = Settings;
  Struct<S>(m, "Settings")
      .field<&S::substeps>("substeps")
      .field<&S::iterations>("iterations")
      .field<&S::mode>("mode")
      .field<&S::integrator>("integrator")
      .field<&S::gravity>("gravity")
      .field<&S::wind>("wind")
      .field<&S::drag>("drag")
      .field<&S::measure_residuals>("measure_residuals")
      .field<&S::seed>("seed")
      .field<&S::solver>("solver")
      .field<&S::fluid>("fluid")
      .field<&S::sleeping>("sleeping")
      .field<&S::detection>("detection")
      .field<&S::segment_test>("segment_test")
      .field<&S::threads>("threads")
      .field<&S::threading>("threading");
}

}  // namespace souple::python
