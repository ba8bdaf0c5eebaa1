#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/world/memory.h"
#include "souple/world/profile.h"

namespace souple::python {

namespace {

StepReport step(BoundWorld& world, double dt) {
  StepReport report = world.without_gil("step", [dt](World& w) { return w.step(dt); });
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C, before the next frame
  if (report.outcome == StepOutcome::refused) throw Error(report.message);
  return report;
}

CallbackId add_callback(BoundWorld& world, const char* when, Stage stage, const py::object& function) {
  const Callback callback(&world, std::string("callback ") + when + " a stage",
                          require_callable(function, when));
  BoundWorld* const self = &world;
  const auto call = [callback, self](World&) { callback.call<void>(self); };
  World& used = world.use(when);
  return when[0] == 'b' ? used.before(stage, call) : used.after(stage, call);
}

void set_settings(BoundWorld& world, const std::optional<Settings>& settings, const py::kwargs& kwargs) {
  World& used = world.use("set_settings");
  used.set_settings(with_keywords(std::optional(settings.value_or(used.settings())), kwargs, "set_settings"));
}

void set_log(BoundWorld& world, const py::object& function) {
  if (function.is_none()) return world.use("set_log").set_log({});
  const Callback callback(&world, "log function", require_callable(function, "set_log"));
  world.use("set_log").set_log(
      [callback](LogLevel level, std::string_view words) { callback.call<void>(level, std::string(words)); });
}

void bind_measures(WorldClass& world) {
  def<&World::memory>(world);
  world
      .def(
          "time_projections",
          [](BoundWorld& self, double dt, int sweeps) {
            return self.without_gil("time_projections",
                                    [&](World& w) { return w.time_projections(dt, sweeps); });
          },
          "dt"_a, "sweeps"_a, doc("World.time_projections"))
      .def(
          "time_solve",
          [](BoundWorld& self, double dt, int iterations) {
            return self.without_gil("time_solve", [&](World& w) { return w.time_solve(dt, iterations); });
          },
          "dt"_a, "iterations"_a, doc("World.time_solve"));
}

}  // namespace

void bind_world_loop(WorldClass& world) {
  world
      .def(py::init([](const std::optional<Settings>& settings, const py::kwargs& kwargs) {
             return std::make_shared<BoundWorld>(with_keywords(settings, kwargs, "World"));
           }),
           "settings"_a = py::none(),
           "Makes an empty world: World(substeps=20), or World(settings). Keywords are members of Settings.")
      .def("step", &step, "dt"_a,
           "Advances the world by dt seconds and returns the report. Raises Error if the step was refused. "
           "The GIL is free meanwhile. What a function of yours raised is raised when the step has ended; "
           "its effect was left out.")
      .def(
          "prepare", [](BoundWorld& w) { w.without_gil("prepare", [](World& world_) { world_.prepare(); }); },
          doc("World.prepare"))
      .def("set_settings", &set_settings, "settings"_a = py::none(),
           "Replaces the settings, or changes the members that keywords name: set_settings(substeps=20).")
      .def(
          "before",
          [](BoundWorld& w, Stage stage, const py::object& f) { return add_callback(w, "before", stage, f); },
          "stage"_a, "callback"_a, "Calls callback(world) before each execution of a stage.")
      .def(
          "after",
          [](BoundWorld& w, Stage stage, const py::object& f) { return add_callback(w, "after", stage, f); },
          "stage"_a, "callback"_a, "Calls callback(world) after each execution of a stage.")
      .def("set_log", &set_log, "log"_a, doc("World.set_log"));
  def<&World::report>(world, "The report of the last step.");
  def<&World::time>(world, "Simulated time [s].");
  def<&World::settings>(world, "A copy of the settings; set_settings changes them.");
  bind_measures(world);
}

}  // namespace souple::python
