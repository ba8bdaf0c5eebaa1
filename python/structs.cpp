#include "python/structs.h"

#include "souple/scene/nearest.h"

#include <cstdio>

namespace souple::python {

namespace {

std::string readable(std::string type) {
  py::detail::clean_type_id(type);
  for (const std::string prefix : {"souple::python::", "souple::"}) {
    for (std::size_t at = type.find(prefix); at != std::string::npos; at = type.find(prefix))
      type.erase(at, prefix.size());
  }
  for (std::size_t at = type.find("::"); at != std::string::npos; at = type.find("::"))
    type.replace(at, 2, ".");
  return type;
}

/// With the module joint before it, as users write it.
std::string class_name(py::handle type) {
  const std::string name(py::str(type.attr("__qualname__"))), module(py::str(type.attr("__module__")));
  return module.ends_with(".joint") ? "joint." + name : name;
}

/// A float as few digits as tell it apart, as C++ has it: 0.4, not 0.4000000059604645.
py::object shortest(py::handle value) {
  if (value.is_none()) return py::none();
  return py::module_::import("numpy").attr("float32")(value);
}

std::string shown(py::handle value) {
  std::string text = py::repr(value).cast<std::string>();
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// Arrays in lists and dicts included, of which Python's == makes no truth.
bool equal_values(const py::object& x, const py::object& y) {
  if (py::isinstance<py::array>(x) || py::isinstance<py::array>(y))
    return py::module_::import("numpy").attr("array_equal")(x, y).cast<bool>();
  if (py::isinstance<py::list>(x) && py::isinstance<py::list>(y)) {
    const auto a = py::list(x), b = py::list(y);
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!equal_values(a[i], b[i])) return false;
    return true;
  }
  if (py::isinstance<py::dict>(x) && py::isinstance<py::dict>(y)) {
    const auto a = py::dict(x), b = py::dict(y);
    if (a.size() != b.size()) return false;
    for (const auto& [key, value] : a)
      if (!b.contains(key) || !equal_values(py::reinterpret_borrow<py::object>(value), b[key])) return false;
    return true;
  }
  return x.equal(y);
}

}  // namespace

std::string member_name(std::string_view text) {
  const std::size_t begin = text.find("member = ");
  const std::string_view path = text.substr(begin, text.find_first_of(";]", begin) - begin);
  return std::string(path.substr(path.rfind(':') + 1));
}

void throw_wrong_type(const std::string& where, const std::string& type, py::handle found) {
  throw py::type_error(where + ": expected " + type + ", found " + shown(found));
}

std::string type_words(const char* pattern, const std::type_info* const* types) {
  std::string words;
  for (const char* c = pattern; *c != 0; ++c) {
    if (*c == '{' || *c == '}') continue;
    if (*c == '%') {
      const std::type_info& type = **types++;
      const auto* const known = py::detail::get_type_info(type);
      words += known ? class_name(reinterpret_cast<PyObject*>(known->type)) : readable(type.name());
    } else {
      words += *c;
    }
  }
  return words;
}

std::string doc_name(py::handle scope, std::string_view name) {
  const std::string of_scope(py::str(scope.attr("__name__")));
  if (PyModule_Check(scope.ptr()) == 0)
    return std::string(py::str(scope.attr("__qualname__"))) + "." + std::string(name);
  const std::size_t dot = of_scope.rfind('.');
  const std::string last = dot == std::string::npos ? of_scope : of_scope.substr(dot + 1);
  return last == "joint" ? "joint." + std::string(name) : std::string(name);
}

void StructFields::add(const Field& field) {
  const auto* const kept = new Field(field);  // as long as the class
  const Address address = address_;
  const std::string where = name_ + "." + field.name;
  const py::cpp_function get([address, kept](py::handle self) { return kept->get(address(self), self); });
  py::object set = py::none();
  if (field.set)
    set = py::cpp_function([address, kept, where](py::handle self, py::handle value) {
      kept->set(address(self), value, where);
    });
  const py::handle property(reinterpret_cast<PyObject*>(&PyProperty_Type));
  type_.attr(field.name) = property(get, set, py::none(), doc(where));
  if (fields_.empty()) type_.attr("_member_types") = py::dict();
  type_.attr("_member_types")[field.name] = field.type();
  fields_.push_back(field);
}

const StructFields::Field* StructFields::find(const std::string& name) const {
  for (const Field& field : fields_)
    if (name == field.name) return &field;
  return nullptr;
}

void StructFields::set(void* object, const Field& field, py::handle value, const char* caller) const {
  field.set(object, value, (caller ? std::string(caller) + ": " : name_ + ".") + field.name);
}

void StructFields::throw_unknown(const std::string& name, const char* caller) const {
  std::vector<std::string> known;
  known.reserve(fields_.size());
  for (const Field& field : fields_) known.emplace_back(field.name);
  const std::string best = scene_format::nearest_word(name, known);
  throw py::type_error(std::string(caller ? caller : name_.c_str()) + ": no argument '" + name + "'" +
                       (best.empty() ? "" : "; did you mean '" + best + "'?"));
}

void StructFields::fill(void* object, const py::args& args, const py::kwargs& kwargs,
                        const char* caller) const {
  if (args.size() > fields_.size())
    throw py::type_error(name_ + ": at most " + std::string(py::str(py::int_(fields_.size()))) +
                         " arguments, found " + std::string(py::str(py::int_(args.size()))));
  for (std::size_t i = 0; i < args.size(); ++i) set(object, fields_[i], args[i], caller);
  for (const auto& [key, value] : kwargs) {
    const auto name = key.cast<std::string>();
    const Field* const field = find(name);
    if (field == nullptr) throw_unknown(name, caller);
    if (field < fields_.data() + args.size()) throw py::type_error(name_ + ": two values for '" + name + "'");
    set(object, *field, value, caller);
  }
}

py::str StructFields::text_of(py::handle object) const {
  py::list parts;
  for (const Field& field : fields_) {
    const py::object value = field.get(address_(object), object);
    parts.append(
        py::str("{}={}").format(field.name, field.single ? py::str(shortest(value)) : py::repr(value)));
  }
  return py::str("{}({})").format(type_.attr("__qualname__"), py::str(", ").attr("join")(parts));
}

bool StructFields::are_equal(py::handle a, py::handle b) const {
  for (const Field& field : fields_)
    if (!equal_values(field.get(address_(a), a), field.get(address_(b), b))) return false;
  return true;
}

py::tuple StructFields::values_of(py::handle object) const {
  py::list values;
  for (const Field& field : fields_) values.append(field.get(address_(object), object));
  return py::tuple(values);
}

void StructFields::add_methods() const {
  type_.attr("__repr__") = py::cpp_function([this](py::handle self) { return text_of(self); },
                                            py::name("__repr__"), py::is_method(type_));
  const auto equal = [this](py::handle self, py::handle other) -> py::object {
    if (!py::isinstance(other, type_)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(are_equal(self, other));
  };
  type_.attr("__eq__") = py::cpp_function(equal, py::name("__eq__"), py::is_method(type_));
  type_.attr("__hash__") = py::none();
}

void StructFields::add_changes() const {
  type_.attr("__reduce__") =
      py::cpp_function([this](py::handle self) { return py::make_tuple(type_, values_of(self)); },
                       py::name("__reduce__"), py::is_method(type_));
  const auto replace = [this](py::handle self, const py::kwargs& kwargs) {
    py::object copy = self.attr("__copy__")();
    fill(address_(copy), py::args(), kwargs);
    return copy;
  };
  type_.attr("replace") =
      py::cpp_function(replace, py::name("replace"), py::is_method(type_),
                       py::doc("A copy with other values for the members that are named."));
}

}  // namespace souple::python
