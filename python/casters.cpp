#include "python/casters.h"

namespace souple::python {

namespace {

bool read_number(PyObject* item, double& value) {
  if (item == nullptr) {
    PyErr_Clear();
    return false;
  }
  if (is_complex(item)) return false;
  value = PyFloat_AsDouble(item);
  if (value == -1.0 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    return false;
  }
  return true;
}

}  // namespace

bool is_complex(py::handle value) {
  if (PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr())) return false;
  static PyObject* const of_numpy =
      py::object(py::module_::import("numpy").attr("complexfloating")).release().ptr();
  return PyComplex_Check(value.ptr()) || PyObject_IsInstance(value.ptr(), of_numpy) == 1;
}

bool read_numbers(py::handle source, double* values, std::size_t count) {
  PyObject* const object = source.ptr();
  if (PySequence_Check(object) == 0 || PyUnicode_Check(object) || PyBytes_Check(object) ||
      PyByteArray_Check(object))
    return false;
  if (PySequence_Size(object) != static_cast<Py_ssize_t>(count)) {
    PyErr_Clear();
    return false;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto item =
        py::reinterpret_steal<py::object>(PySequence_GetItem(object, static_cast<Py_ssize_t>(i)));
    if (!read_number(item.ptr(), values[i])) return false;
  }
  return true;
}

bool read_member(py::handle source, PyObject* enum_class, long& value) {
  if (PyUnicode_Check(source.ptr())) {
    const py::object owned = py::handle(enum_class).attr("__members__");
    if (!owned.contains(source)) return false;
    value = PyLong_AsLong(owned[source].ptr());
    return true;
  }
  const int is_member = PyObject_IsInstance(source.ptr(), enum_class);
  if (is_member != 1) {
    PyErr_Clear();
    return false;
  }
  value = PyLong_AsLong(source.ptr());
  if (PyErr_Occurred() == nullptr) return true;
  PyErr_Clear();  // a combination of flags that no long holds
  return false;
}

py::object member_of(PyObject* enum_class, long value) {
  return py::handle(enum_class)(value);
}

}  // namespace souple::python
