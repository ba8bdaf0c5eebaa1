#include "python/arrays.h"

#include "souple/error.h"

#include <string>

namespace souple::python {

namespace {

std::string text_of(py::handle value) {
  return py::str(value).cast<std::string>();
}

std::string shape_words(const py::array& array) {
  return text_of(array.attr("shape"));
}

std::string expected_shape(int columns) {
  return columns == 0 ? "(n,)" : "(n, " + text_of(py::int_(columns)) + ")";
}

void check_shape(const py::array& array, int columns) {
  const bool fits = columns == 0 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == columns;
  if (fits) return;
  throw Error("expected an array of shape " + expected_shape(columns) + ", found shape " +
              shape_words(array));
}

void check_type(const py::array& array, bool whole) {
  const char kind = array.dtype().kind();
  const bool fits = kind == 'i' || kind == 'u' || (!whole && (kind == 'f' || kind == 'b'));
  if (fits) return;
  throw Error(std::string("expected an array of ") + (whole ? "whole numbers" : "numbers") +
              ", found one of type " + text_of(array.dtype()));
}

void check_indices(const py::array& array) {
  if (array.dtype().kind() == 'u' && array.itemsize() <= 4) return;
  const py::int_ least(array.attr("min")()), most(array.attr("max")());
  for (const py::int_& number : {least, most})
    if (number.attr("__lt__")(0).cast<bool>() || number.attr("__gt__")(0xffffffffu).cast<bool>())
      throw Error("expected indices from 0 to 4294967295, found " + text_of(number));
}

bool may_be_numbers(py::handle source) {
  if (py::isinstance<py::array>(source)) return true;
  if (py::isinstance<py::str>(source) || PyBytes_Check(source.ptr()) || PyDict_Check(source.ptr()))
    return false;
  return PySequence_Check(source.ptr()) != 0 || py::hasattr(source, "__array__");
}

}  // namespace

py::object numbers_of(py::handle source, const char* type, int columns) {
  if (!may_be_numbers(source)) return py::none();
  py::object found;
  try {
    found = py::module_::import("numpy").attr("asarray")(source);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    throw Error(std::string("expected an array of numbers: ") + text_of(error.value()));
  }
  auto array = py::reinterpret_borrow<py::array>(found);
  if (array.size() == 0 && array.ndim() == 1) {
    return py::array(py::dtype(type),
                     columns == 0 ? std::vector<py::ssize_t>{0} : std::vector<py::ssize_t>{0, columns});
  }
  const bool whole = type[0] == 'u';
  check_shape(array, columns);
  check_type(array, whole);
  if (whole && array.size() > 0) check_indices(array);
  return py::module_::import("numpy").attr("ascontiguousarray")(array, py::arg("dtype") = type);
}

py::array copied_array(const void* data, std::size_t rows, const char* type, int columns) {
  const auto count = static_cast<py::ssize_t>(rows);
  std::vector<py::ssize_t> shape{count};
  if (columns > 0) shape.push_back(columns);
  py::array array(py::dtype(type), shape, rows == 0 ? nullptr : data);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::array view_of(const void* data, std::size_t rows, const char* type, int columns, const py::object& base) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  if (columns > 0) shape.push_back(columns);
  py::array array(py::dtype(type), shape, data, base);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace souple::python
