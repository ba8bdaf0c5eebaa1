#include "python/bind.h"
#include "python/enums.h"
#include "python/structs.h"
#include "souple/world/debug_draw.h"
#include "souple/world/memory.h"
#include "souple/world/profile.h"
#include "souple/world/report.h"
#include "souple/world/world.h"

namespace souple::python {

void bind_reports(py::module_& m) {
  Result<KindReport>(m, "KindReport")
      .field<&KindReport::kind>("kind")
      .field<&KindReport::count>("count")
      .field<&KindReport::largest>("largest")
      .field<&KindReport::mean>("mean")
      .field<&KindReport::largest_strain>("largest_strain");
  Result<ObjectReport>(m, "ObjectReport")
      .field<&ObjectReport::name>("name")
      .field<&ObjectReport::unbalanced>("unbalanced")
      .field<&ObjectReport::stretch>("stretch");
  Result<FluidReport>(m, "FluidReport")
      .field<&FluidReport::particles>("particles")
      .field<&FluidReport::emitted>("emitted")
      .field<&FluidReport::drained>("drained")
      .field<&FluidReport::held_back>("held_back")
      .field<&FluidReport::mean_density_error>("mean_density_error")
      .field<&FluidReport::largest_density_error>("largest_density_error")
      .field<&FluidReport::largest_pressure>("largest_pressure")
      .field<&FluidReport::fastest>("fastest")
      .field<&FluidReport::largest_step>("largest_step")
      .field<&FluidReport::iterations>("iterations")
      .field<&FluidReport::coarse_iterations>("coarse_iterations")
      .field<&FluidReport::viscosity_iterations>("viscosity_iterations")
      .field<&FluidReport::spray>("spray")
      .field<&FluidReport::foam>("foam")
      .field<&FluidReport::bubbles>("bubbles");
  Result<StepReport>(m, "StepReport")
      .field<&StepReport::step>("step")
      .field<&StepReport::time>("time")
      .field<&StepReport::substeps>("substeps")
      .field<&StepReport::iterations>("iterations")
      .field<&StepReport::milliseconds>("milliseconds")
      .field<&StepReport::particles>("particles")
      .field<&StepReport::constraints>("constraints")
      .field<&StepReport::contacts>("contacts")
      .field<&StepReport::asleep>("asleep")
      .field<&StepReport::broken_joints>("broken_joints")
      .field<&StepReport::broken_ties>("broken_ties")
      .field<&StepReport::kept_apart>("kept_apart")
      .field<&StepReport::intersections>("intersections")
      .field<&StepReport::layer_violations>("layer_violations")
      .field<&StepReport::deepest_contact>("deepest_contact")
      .field<&StepReport::largest_strain>("largest_strain")
      .field<&StepReport::fluid>("fluid")
      .field<&StepReport::kinds>("kinds")
      .field<&StepReport::objects>("objects")
      .field<&StepReport::flags>("flags")
      .field<&StepReport::bad_object>("bad_object")
      .field<&StepReport::bad_vertex>("bad_vertex")
      .field<&StepReport::message>("message")
      .def("has", &StepReport::has)
      .def("ok", &StepReport::ok)
      .def("total_milliseconds", &StepReport::total_milliseconds);
  m.def("advice", &advice, py::arg("flag"), doc("advice"));
  m.def("stage_name", &stage_name, py::arg("stage"), "The name of a stage.");
  Result<KindTime>(m, "KindTime")
      .field<&KindTime::kind>("kind")
      .field<&KindTime::count>("count")
      .field<&KindTime::seconds>("seconds");
  Result<SolveTime>(m, "SolveTime")
      .field<&SolveTime::seconds>("seconds")
      .field<&SolveTime::count>("count")
      .field<&SolveTime::mean_strain>("mean_strain")
      .field<&SolveTime::rms_strain>("rms_strain")
      .field<&SolveTime::largest_strain>("largest_strain")
      .field<&SolveTime::energy>("energy")
      .field<&SolveTime::diagnostic>("diagnostic");
  Result<MemoryReport::Part>(m, "MemoryPart")
      .field<&MemoryReport::Part::name>("name")
      .field<&MemoryReport::Part::bytes>("bytes");
  Result<MemoryReport>(m, "MemoryReport")
      .field<&MemoryReport::simulation>("simulation")
      .field<&MemoryReport::objects>("objects")
      .field<&MemoryReport::particles>("particles")
      .def("total", [](const MemoryReport& memory) {
        return MemoryReport::total(memory.simulation) + MemoryReport::total(memory.objects);
      });
  Result<World::TetStatistics>(m, "TetStatistics")
      .field<&World::TetStatistics::tets>("tets")
      .field<&World::TetStatistics::particles>("particles")
      .field<&World::TetStatistics::cell_size>("cell_size");
  Result<DebugContact>(m, "DebugContact")
      .field<&DebugContact::point>("point")
      .field<&DebugContact::normal>("normal")
      .field<&DebugContact::impulse>("impulse");
  Result<DebugParticle>(m, "DebugParticle")
      .field<&DebugParticle::position>("position")
      .field<&DebugParticle::radius>("radius")
      .field<&DebugParticle::inverse_mass>("inverse_mass")
      .field<&DebugParticle::pinned>("pinned")
      .field<&DebugParticle::object>("object");
}

}  // namespace souple::python
