#include "souple/objects/handles.h"

#include "python/bind.h"
#include "python/structs.h"
#include "souple/fluid/emitter.h"
#include "souple/objects/tie_options.h"

namespace souple::python {

namespace {

template <class Id>
void handle(py::module_& m, const char* name, const char* text) {
  const std::string type = name;
  py::class_<Id>(m, name, text)
      .def_readonly("value", &Id::value)
      .def("__eq__",
           [](const Id& a, const py::object& b) {
             return py::isinstance<Id>(b) && a.value == b.cast<Id>().value;
           })
      .def("__copy__", [](const Id& id) { return id; })
      .def("__deepcopy__", [](const Id& id, const py::object&) { return id; })
      .def("__hash__", [](const Id& id) { return py::hash(py::int_(id.value)); })
      .def("__repr__", [type](const Id& id) { return py::str("<{} {}>").format(type, id.value); });
}

}  // namespace

void bind_handles(py::module_& m) {
  handle<ObjectId>(m, "ObjectId", doc("ObjectId"));
  handle<ColliderId>(m, "ColliderId", "Handle of a collider, like that of an object.");
  handle<JointId>(m, "JointId", "Handle of a joint, like that of an object.");
  handle<TieId>(m, "TieId", doc("TieId"));
  handle<EmitterId>(m, "EmitterId", "Handle of an emitter, like that of an object.");
  handle<DrainId>(m, "DrainId", "Handle of a drain, like that of an object.");
  handle<ProjectorId>(m, "ProjectorId", "Handle of constraints that were added, like that of an object.");
  handle<CallbackId>(m, "CallbackId", doc("CallbackId"));
  handle<ForceFieldId>(m, "ForceFieldId", "Handle of a force field, like that of an object.");
}

}  // namespace souple::python
