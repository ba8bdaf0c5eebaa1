#pragma once

#include "souple/geometry/tet_mesh.h"
#include "souple/geometry/triangle_mesh.h"
#include "souple/math/vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <pybind11/numpy.h>
#include <span>
#include <vector>

// NumPy arrays in and out.

namespace souple::python {

namespace py = pybind11;

/// The numbers that a C++ element consists of: their type as NumPy writes it, and how many there are in a row. 0: the
/// array has one dimension. Null: not an element of arrays.
struct RowType {
  const char* type = nullptr;
  int columns = 0;
};
template <class T>
inline constexpr RowType row;
template <>
inline constexpr RowType row<Vec3f>{"f4", 3};
template <>
inline constexpr RowType row<Vec3d>{"f8", 3};
template <>
inline constexpr RowType row<Triangle>{"u4", 3};
template <>
inline constexpr RowType row<Tet>{"u4", 4};
template <>
inline constexpr RowType row<std::array<float, 2>>{"f4", 2};
template <>
inline constexpr RowType row<float>{"f4", 0};
template <>
inline constexpr RowType row<double>{"f8", 0};
template <>
inline constexpr RowType row<std::uint32_t>{"u4", 0};

/// `source` as a C-contiguous array of this type with `columns` numbers a row. None if it is neither an array nor a
/// sequence, so that another overload may take it. Throws Error where the shape or the type does not fit: numbers of any
/// type become floats, only whole numbers become indices.
py::object numbers_of(py::handle source, const char* type, int columns);

/// A read-only array that holds a copy.
py::array copied_array(const void* data, std::size_t rows, const char* type, int columns);

template <class T>
py::array to_array(std::span<const T> values) {
  return copied_array(values.data(), values.size(), row<T>.type, row<T>.columns);
}
template <class T>
py::array to_array(const std::vector<T>& values) {
  return to_array(std::span<const T>(values));
}

/// A view of numbers that `base` keeps alive; read-only.
py::array view_of(const void* data, std::size_t rows, const char* type, int columns, const py::object& base);

}  // namespace souple::python

namespace pybind11::detail {

/// The memory of an array that fits, or of a converted copy.
template <class T>
struct type_caster<std::span<const T>> {
  PYBIND11_TYPE_CASTER(std::span<const T>, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    numbers_ =
        souple::python::numbers_of(source, souple::python::row<T>.type, souple::python::row<T>.columns);
    if (numbers_.is_none()) return false;
    const auto array = reinterpret_borrow<pybind11::array>(numbers_);
    value = {static_cast<const T*>(array.data()), static_cast<std::size_t>(array.shape(0))};
    return true;
  }
  static handle cast(const std::span<const T>& values, return_value_policy, handle) {
    return souple::python::to_array(values).release();
  }

 private:
  object numbers_;
};

template <class T>
requires(souple::python::row<T>.type != nullptr) struct type_caster<std::vector<T>> {
  PYBIND11_TYPE_CASTER(std::vector<T>, const_name("numpy.ndarray"));

  bool load(handle source, bool convert) {
    type_caster<std::span<const T>> span;
    if (!span.load(source, convert)) return false;
    const std::span<const T> values = span;
    value.assign(values.begin(), values.end());
    return true;
  }
  static handle cast(const std::vector<T>& values, return_value_policy, handle) {
    return souple::python::to_array(values).release();
  }
};

}  // namespace pybind11::detail
