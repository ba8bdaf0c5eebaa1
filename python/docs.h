#pragma once

#include <pybind11/pybind11.h>
#include <string>
#include <string_view>

namespace souple::python {

/// The comment of a declaration in C++'s public headers: "World.step", "ClothMaterial.friction", "grid". Empty if there is
/// none. header_docs.py collects them when the module is built.
const char* doc(std::string_view name);

/// "Name" in a module, "Class.Name" in a class.
std::string doc_name(pybind11::handle scope, std::string_view name);

}  // namespace souple::python
