#pragma once

#include <emscripten/emscripten.h>
#include <exception>
#include <new>
#include <string>

// How JavaScript calls C++: plain functions of numbers and pointers. An exception becomes a sentence, which JavaScript
// takes with souple_error after each call and throws again.

namespace souple::web {

/// The sentence of the call that failed; empty: none has.
inline std::string& last_error() {
  static std::string text;
  return text;
}

/// Calls f; returns 0 or nullptr if it throws.
template <class F>
auto guarded(const F& f) -> decltype(f()) {
  try {
    return f();
  } catch (const std::bad_alloc&) {
    last_error() = "out of memory: the browser gives no more; open a smaller scene";
  } catch (const std::exception& error) {
    last_error() = error.what();
  }
  return decltype(f())();
}

/// The bytes stay until the next text is kept.
inline const char* keep(std::string text) {
  static std::string kept;
  kept = std::move(text);
  return kept.c_str();
}

}  // namespace souple::web

#define SOUPLE_CALL extern "C" EMSCRIPTEN_KEEPALIVE
