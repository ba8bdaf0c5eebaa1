#pragma once

#include <chrono>
#include <exception>
#include <optional>
#include <pybind11/pybind11.h>
#include <thread>

// The GIL around long computations. When the program ends, Python ends a daemon thread that asks for the GIL by
// unwinding its stack. Functions that promise not to throw do not survive that. These guards stop such a thread; it
// ends with the process.

namespace souple::python {

[[noreturn]] inline void wait_for_the_end() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Frees the GIL while it lives.
class ReleasedGil {
 public:
  ReleasedGil() : state_(PyEval_SaveThread()) {}
  ~ReleasedGil() {
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {
      wait_for_the_end();
    }
  }
  ReleasedGil(const ReleasedGil&) = delete;
  ReleasedGil& operator=(const ReleasedGil&) = delete;

 private:
  PyThreadState* state_;
};

/// Holds the GIL while it lives, on any thread.
class HeldGil {
 public:
  HeldGil() {
    try {
      gil_.emplace();
    } catch (const std::exception&) {
      throw;
    } catch (...) {
      wait_for_the_end();
    }
  }
  HeldGil(const HeldGil&) = delete;
  HeldGil& operator=(const HeldGil&) = delete;

 private:
  std::optional<pybind11::gil_scoped_acquire> gil_;
};

}  // namespace souple::python
