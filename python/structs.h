#pragma once

#include "python/casters.h"
#include "python/docs.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// C++'s plain structs as Python classes: keyword arguments with the same names and defaults.

namespace souple::python {

/// The name of a member in the text that g++ and clang have for a template of it: "... [member = &Sphere::center]".
std::string member_name(std::string_view text);

/// The name of a member in C++.
template <auto member>
const char* name_of() {
  static const std::string name = member_name(__PRETTY_FUNCTION__);
  return name.c_str();
}

/// Throws TypeError: "WHERE: expected TYPE, found VALUE".
[[noreturn]] void throw_wrong_type(const std::string& where, const std::string& type, py::handle found);

/// The name of a C++ type as Python has it, from the text that pybind11 has for it.
std::string type_words(const char* pattern, const std::type_info* const* types);

/// Python's name of a value's type.
template <class M>
std::string python_type() {
  constexpr auto pattern = py::detail::make_caster<M>::name;
  static constexpr auto types = decltype(pattern)::types();
  return type_words(pattern.text, types.data());
}

template <class M>
inline constexpr bool is_bound_class =
    std::is_base_of_v<py::detail::type_caster_generic, py::detail::make_caster<M>>;
template <class M>
struct OptionalValue : std::false_type {};
template <class M>
struct OptionalValue<std::optional<M>> : std::true_type {
  using Type = M;
};

/// Whether pybind11 would convert the value to an M and lose a part of it: 3.7 as an integer, bytes as a text.
template <class M>
bool loses_in(py::handle value) {
  if constexpr (OptionalValue<M>::value)
    return !value.is_none() && loses_in<typename OptionalValue<M>::Type>(value);
  else if constexpr (std::is_same_v<M, std::string>)
    return !PyUnicode_Check(value.ptr());
  else if constexpr (std::is_integral_v<M> && !std::is_same_v<M, bool>)
    return PyIndex_Check(value.ptr()) == 0;
  else if constexpr (std::is_floating_point_v<M>)
    return is_complex(value);
  else if constexpr (is_bound_class<M>)
    return value.is_none();
  else
    return false;
}

template <class M>
M from_python(py::handle value, const std::string& where) {
  if (loses_in<M>(value)) throw_wrong_type(where, python_type<M>(), value);
  py::detail::make_caster<M> caster;
  try {
    if (caster.load(value, true)) return py::detail::cast_op<M>(std::move(caster));
  } catch (const py::reference_cast_error&) {  // None in a list or a variant
  } catch (const std::exception& error) {
    throw py::value_error(where + ": " + error.what());
  }
  throw_wrong_type(where, python_type<M>(), value);
}

/// The object of a Python instance. Throws TypeError for None, another class, or an instance that __init__ has not made.
template <class T>
T* instance_of(py::handle h) {
  if (!py::isinstance<T>(h)) throw_wrong_type("self", python_type<T>(), h);
  auto* const instance = reinterpret_cast<py::detail::instance*>(h.ptr());
  if (instance->get_value_and_holder().value_ptr() == nullptr)
    throw py::type_error("expected " + python_type<T>() + ", found an object that __init__ has not made");
  return h.cast<T*>();
}

/// A member function for def() that refuses None as its object.
template <class C, class R, class... A>
auto on_self(R (C::*function)(A...)) {
  return [function](C& self, A... arguments) -> R { return (self.*function)(std::forward<A>(arguments)...); };
}
template <class C, class R, class... A>
auto on_self(R (C::*function)(A...) const) {
  return [function](const C& self, A... arguments) -> R {
    return (self.*function)(std::forward<A>(arguments)...);
  };
}
template <class Function>
auto on_self(Function function) {
  return function;
}

/// A member in Python: a reference into its owner where it is a class, so that settings.wind.gust = 1 has its effect.
template <class M>
py::object member_to_python(M& member, py::handle owner) {
  using py::return_value_policy;
  if constexpr (OptionalValue<M>::value) {
    if (!member) return py::none();
    return member_to_python(*member, owner);
  } else if constexpr (is_bound_class<M>) {
    return py::cast(&member, return_value_policy::reference_internal, owner);
  } else {
    return py::cast(member, return_value_policy::copy);
  }
}

/// The members of a struct, without its type.
class StructFields {
 public:
  struct Field {
    const char* name;
    py::object (*get)(void* object, py::handle owner);
    void (*set)(void* object, py::handle value, const std::string& where);
    bool single;  ///< of type float: as few digits as tell it apart
    std::string (*type)();
  };
  using Address = void* (*)(py::handle);

  StructFields(const py::object& type, std::string name, Address address)
      : type_(type), name_(std::move(name)), address_(address) {}
  /// Adds a member and the attribute of the class, and its type to the attribute _member_types, which stubs are made of.
  void add(const Field& field);
  /// Sets members from keyword arguments, or from arguments in the order of declaration. Throws TypeError in words.
  void fill(void* object, const py::args& args, const py::kwargs& kwargs, const char* caller = nullptr) const;
  /// __repr__ and __eq__.
  void add_methods() const;
  /// replace, and what pickles need.
  void add_changes() const;

 private:
  const Field* find(const std::string& name) const;
  void set(void* object, const Field& field, py::handle value, const char* caller) const;
  [[noreturn]] void throw_unknown(const std::string& name, const char* caller) const;
  py::str text_of(py::handle object) const;
  bool are_equal(py::handle a, py::handle b) const;
  py::tuple values_of(py::handle object) const;

  py::object type_;  // kept for ever, like the class
  std::string name_;
  Address address_;
  std::vector<Field> fields_;
};

template <class T>
inline StructFields* fields_of = nullptr;

/// Declares a struct that functions return: its members are only read. Result<Hit>(m, "Hit").fields<&Hit::found>()...
template <class T>
class Result {
 public:
  Result(py::handle scope, const char* name) : class_(scope, name, doc(doc_name(scope, name))) {
    fields_of<T> = new StructFields(class_, doc_name(scope, name),
                                    [](py::handle h) -> void* { return instance_of<T>(h); });
    fields_of<T>->add_methods();
  }
  /// Members under their names in C++.
  template <auto... members>
  Result& fields() {
    (add<members>(name_of<members>(), nullptr), ...);
    return *this;
  }
  template <class Function>
  Result& def(const char* name, Function function) {
    class_.def(name, on_self(function),
               doc((std::string(py::str(class_.attr("__qualname__"))) + "." + name).c_str()));
    return *this;
  }
  py::class_<T>& python_class() { return class_; }

 protected:
  template <auto member>
  using Type = std::remove_reference_t<decltype(std::declval<T&>().*member)>;
  template <auto member>
  void add(const char* name, decltype(StructFields::Field::set) set) {
    using M = Type<member>;
    fields_of<T>->add({name,
                       [](void* object, py::handle owner) {
                         return member_to_python(static_cast<T*>(object)->*member, owner);
                       },
                       set, std::is_same_v<M, float> || std::is_same_v<M, std::optional<float>>,
                       &python_type<M>});
  }

 private:
  py::class_<T> class_;
};

/// Declares a struct that users make: Struct<Sphere>(m, "Sphere").fields<&Sphere::center, &Sphere::radius>().
template <class T>
class Struct : public Result<T> {
 public:
  Struct(py::handle scope, const char* name) : Result<T>(scope, name) {
    this->python_class()
        .def(py::init([](const py::args& args, const py::kwargs& kwargs) {
          auto value = std::make_unique<T>();
          fields_of<T>->fill(value.get(), args, kwargs);
          return value;
        }))
        .def("__copy__", [](const T& value) { return value; })
        .def("__deepcopy__", [](const T& value, const py::object&) { return value; });
    fields_of<T>->add_changes();
  }
  template <auto... members>
  Struct& fields() {
    (field<members>(name_of<members>()), ...);
    return *this;
  }
  template <auto member>
  Struct& field(const char* name) {
    this->template add<member>(name, [](void* object, py::handle value, const std::string& where) {
      static_cast<T*>(object)->*member = from_python<typename Result<T>::template Type<member>>(value, where);
    });
    return *this;
  }
};

/// Options that a function takes as a struct, as keywords, or as both: keywords then replace members of the struct.
template <class T>
T with_keywords(const std::optional<T>& given, const py::kwargs& kwargs, const char* function) {
  T options = given.value_or(T{});
  fields_of<T>->fill(&options, py::args(), kwargs, function);
  return options;
}

}  // namespace souple::python
