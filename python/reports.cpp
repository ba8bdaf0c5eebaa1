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
      .fields<&KindReport::kind, &KindReport::count, &KindReport::largest, &KindReport::mean,
              &KindReport::largest_strain>();
  Result<ObjectReport>(m, "ObjectReport")
      .fields<&ObjectReport::name, &ObjectReport::unbalanced, &ObjectReport::stretch>();
  Result<FluidReport>(m, "FluidReport")
      .fields<&FluidReport::particles, &FluidReport::emitted, &FluidReport::drained, &FluidReport::held_back,
              &FluidReport::mean_density_error, &FluidReport::largest_density_error,
              &FluidReport::largest_pressure, &FluidReport::fastest, &FluidReport::largest_step,
              &FluidReport::iterations, &FluidReport::coarse_iterations, &FluidReport::viscosity_iterations,
              &FluidReport::spray, &FluidReport::foam, &FluidReport::bubbles>();
  Result<StepReport>(m, "StepReport")
      .fields<&StepReport::outcome, &StepReport::step, &StepReport::time, &StepReport::substeps,
              &StepReport::iterations, &StepReport::milliseconds, &StepReport::particles,
              &StepReport::constraints, &StepReport::contacts, &StepReport::asleep,
              &StepReport::broken_joints, &StepReport::broken_ties, &StepReport::kept_apart,
              &StepReport::intersections, &StepReport::layer_violations, &StepReport::deepest_contact,
              &StepReport::largest_strain, &StepReport::fluid, &StepReport::kinds, &StepReport::objects,
              &StepReport::flags, &StepReport::bad_object, &StepReport::bad_vertex, &StepReport::message>()
      .def("has", &StepReport::has)
      .def("ok", &StepReport::ok)
      .def("total_milliseconds", &StepReport::total_milliseconds);
  m.def("advice", &advice, "flag"_a, doc("advice"));
  m.def("stage_name", &stage_name, "stage"_a, "The name of a stage.");
  Result<KindTime>(m, "KindTime").fields<&KindTime::kind, &KindTime::count, &KindTime::seconds>();
  Result<SolveTime>(m, "SolveTime")
      .fields<&SolveTime::seconds, &SolveTime::count, &SolveTime::mean_strain, &SolveTime::rms_strain,
              &SolveTime::largest_strain, &SolveTime::energy, &SolveTime::diagnostic>();
  Result<MemoryReport::Part>(m, "MemoryPart").fields<&MemoryReport::Part::name, &MemoryReport::Part::bytes>();
  Result<MemoryReport>(m, "MemoryReport")
      .fields<&MemoryReport::simulation, &MemoryReport::objects, &MemoryReport::particles>()
      .def("total", [](const MemoryReport& memory) {
        return MemoryReport::total(memory.simulation) + MemoryReport::total(memory.objects);
      });
  Result<World::TetStatistics>(m, "TetStatistics")
      .fields<&World::TetStatistics::tets, &World::TetStatistics::particles,
              &World::TetStatistics::cell_size>();
  Result<DebugContact>(m, "DebugContact")
      .fields<&DebugContact::point, &DebugContact::normal, &DebugContact::impulse>();
  Result<DebugParticle>(m, "DebugParticle")
      .fields<&DebugParticle::position, &DebugParticle::radius, &DebugParticle::inverse_mass,
              &DebugParticle::pinned, &DebugParticle::object>();
}

}  // namespace souple::python
