# Packages for python/: pybind11, and the headers of the system's Python, which NumPy is installed for. An interpreter
# that stands before it in PATH, such as one of pyenv, is not the system's: Python_EXECUTABLE names another one. Targets
# Python::Module and pybind11::headers.
include(FindPackageHandleStandardArgs)

if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python QUIET COMPONENTS Interpreter Development.Module)
set(PYBIND11_NOPYTHON ON)
find_package(pybind11 2.10 QUIET)

find_package_handle_standard_args(SouplePython REQUIRED_VARS Python_EXECUTABLE Python_Development.Module_FOUND pybind11_FOUND)
