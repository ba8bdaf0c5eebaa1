#pragma once

#include <cstdio>
#include <cstdlib>

namespace souple::detail {

[[noreturn]] inline void assertion_failed(const char* meaning, const char* condition, const char* file,
                                          int line) {
  std::fprintf(stderr, "%s:%d: a broken invariant: %s (%s)\n", file, line, meaning, condition);
  std::abort();
}

}  // namespace souple::detail

/// Checks an invariant of the code where NDEBUG is not defined, as in debug and sanitizer builds. A broken invariant is
/// printed and ends the program. In release builds the condition is compiled and never evaluated. An error that a user
/// can cause is no invariant: it throws Error.
#ifdef NDEBUG
#define SOUPLE_ASSERT(condition, meaning) static_cast<void>(false && (condition))
#else
#define SOUPLE_ASSERT(condition, meaning) \
  ((condition) ? static_cast<void>(0)     \
               : ::souple::detail::assertion_failed(meaning, #condition, __FILE__, __LINE__))
#endif
