#include "python/bind.h"
#include "python/bound_world.h"
#include "souple/simd/instruction_set.h"
#include "souple/version.h"

namespace souple::python {

namespace {

void bind_error(py::module_& m) {
  static py::exception<Error> error(m, "Error", PyExc_RuntimeError);
  error.attr("__module__") = "souple";
  error.attr("__doc__") = doc("Error");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      // Texts of files may not be UTF-8.
      const std::string_view words = e.what();
      const auto text = py::reinterpret_steal<py::object>(
          PyUnicode_DecodeUTF8(words.data(), static_cast<Py_ssize_t>(words.size()), "replace"));
      PyErr_SetObject(error.ptr(), text.ptr());
    } catch (PythonFailure& e) {
      e.restore();
    }
  });
}

void bind_world(py::module_& m) {
  WorldClass world(m, "World", doc("World"));
  bind_world_loop(world);
  bind_world_objects(world);
  bind_world_arrays(world);
  bind_world_state(world);
  bind_world_joints(world);
  bind_world_constraints(world);
  bind_world_colliders(world);
  bind_world_queries(world);
  world.def(
      "remove", [](BoundWorld& self, CallbackId id) { self.use("remove").remove(id); }, "callback"_a,
      doc("World.remove"));
}

/// Names in messages and pickles are those that users import.
void rename_classes(py::handle m) {
  for (const auto& item : m.attr("__dict__").cast<py::dict>())
    if (PyType_Check(item.second.ptr())) item.second.attr("__module__") = "souple";
}

}  // namespace

PYBIND11_MODULE(_souple, m) {
  m.doc() = "The compiled part of souple.";
  bind_error(m);
  bind_enums(m);
  bind_handles(m);
  bind_settings(m);
  bind_materials(m);
  bind_meshes(m);
  bind_shapes(m);
  bind_objects(m);
  bind_joints(m);
  bind_ties(m);
  bind_queries(m);
  bind_reports(m);
  bind_constraints(m);
  bind_world(m);
  bind_scene(m);
  bind_recorder(m);
  bind_surface(m);
  bind_render(m);
  m.attr("__version__") = version;
  m.def(
      "instruction_set", [] { return std::string(simd_name()); }, "The instruction set that kernels use.");
  rename_classes(m);
}

}  // namespace souple::python
