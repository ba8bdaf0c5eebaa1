#pragma once

#include "python/arrays.h"
#include "souple/math/mat3.h"
#include "souple/math/quaternion.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstddef>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <utility>

// How vectors, rotations and enumerations pass between C++ and Python. Every file of python/ includes this, so that all agree.

namespace souple::python {

/// Reads `count` numbers of a sequence; false if it is none of them.
bool read_numbers(py::handle source, double* values, std::size_t count);

/// Whether it is a complex number, of Python or NumPy.
bool is_complex(py::handle value);

/// A types.SimpleNamespace: what a struct that is only read becomes.
template <class... Members>
py::object namespace_of(Members&&... members) {
  return py::module_::import("types").attr("SimpleNamespace")(std::forward<Members>(members)...);
}

/// The Python class of an enumeration: an enum.IntEnum.
template <class E>
inline PyObject* enum_class = nullptr;

/// The value of a member of `enum_class`, or of its name; false if it is neither.
bool read_member(py::handle source, PyObject* enum_class, long& value);
py::object member_of(PyObject* enum_class, long value);

}  // namespace souple::python

namespace pybind11::detail {

template <class T>
struct type_caster<souple::Vec3<T>> {
  PYBIND11_TYPE_CASTER(souple::Vec3<T>, const_name("Tuple[float, float, float]"));

  bool load(handle source, bool) {
    double x[3];
    if (!souple::python::read_numbers(source, x, 3)) return false;
    value = {static_cast<T>(x[0]), static_cast<T>(x[1]), static_cast<T>(x[2])};
    return true;
  }
  static handle cast(const souple::Vec3<T>& v, return_value_policy, handle) {
    return make_tuple(v.x, v.y, v.z).release();
  }
};

template <class T>
struct type_caster<souple::Quaternion<T>> {
  PYBIND11_TYPE_CASTER(souple::Quaternion<T>, const_name("Tuple[float, float, float, float]"));

  bool load(handle source, bool) {
    double x[4];
    if (!souple::python::read_numbers(source, x, 4)) return false;
    value = {static_cast<T>(x[0]), static_cast<T>(x[1]), static_cast<T>(x[2]), static_cast<T>(x[3])};
    return true;
  }
  static handle cast(const souple::Quaternion<T>& q, return_value_policy, handle) {
    return make_tuple(q.x, q.y, q.z, q.w).release();
  }
};

/// As a list of rows.
template <>
struct type_caster<souple::Mat3d> {
  PYBIND11_TYPE_CASTER(souple::Mat3d, const_name("Sequence[Tuple[float, float, float]]"));

  bool load(handle source, bool convert) {
    make_caster<std::array<souple::Vec3d, 3>> rows;
    if (!rows.load(source, convert)) return false;
    const auto& row = static_cast<std::array<souple::Vec3d, 3>&>(rows);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) value(r, c) = row[static_cast<std::size_t>(r)][c];
    return true;
  }
  static handle cast(const souple::Mat3d& m, return_value_policy policy, handle parent) {
    std::array<souple::Vec3d, 3> rows;
    for (int r = 0; r < 3; ++r) rows[static_cast<std::size_t>(r)] = {m(r, 0), m(r, 1), m(r, 2)};
    return make_caster<std::array<souple::Vec3d, 3>>::cast(rows, policy, parent);
  }
};

template <class E>
struct enum_caster {
  static handle cast(E value, return_value_policy, handle) {
    return souple::python::member_of(souple::python::enum_class<E>, static_cast<long>(value)).release();
  }
  bool load(handle source, bool) {
    long number = 0;
    if (!souple::python::read_member(source, souple::python::enum_class<E>, number)) return false;
    value = static_cast<E>(number);
    return true;
  }
  template <class T>
  using cast_op_type = E;
  operator E() const { return value; }
  E value{};
};

}  // namespace pybind11::detail

/// Declares how an enumeration passes; enums.cpp makes its class.
#define SOUPLE_PYTHON_ENUM(Type, python_name)                      \
  template <>                                                      \
  struct pybind11::detail::type_caster<Type> : enum_caster<Type> { \
    static constexpr auto name = const_name(python_name);          \
  }
