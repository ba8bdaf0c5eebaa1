#include "app/out_of_memory.h"

#include "app/exit_codes.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace souple::app {
namespace {

std::terminate_handler usual = nullptr;

[[noreturn]] void end() {
  if (const std::exception_ptr error = std::current_exception()) {
    try {
      std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
      say_out_of_memory();
      std::_Exit(bad_input);
    } catch (...) {
    }
  }
  if (usual != nullptr) usual();
  std::abort();
}

}  // namespace

void say_out_of_memory() {
  std::fputs("souple: out of memory: the scene is too large for this machine\n", stderr);
}

void end_when_out_of_memory() {
  usual = std::set_terminate(end);
}

}  // namespace souple::app
