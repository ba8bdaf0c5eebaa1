#include "app/out_of_memory.h"

#include "app/exit_codes.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <sys/resource.h>
#include <system_error>
#include <unistd.h>

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
    } catch (const std::system_error& refused) {
      if (refused.code() == std::errc::resource_unavailable_try_again) {
        std::fputs(
            "souple: the system refuses to start a thread: raise the limit of processes (ulimit -u) or of "
            "memory (ulimit -v)\n",
            stderr);
        std::_Exit(bad_input);
      }
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
  if (std::get_terminate() != end) usual = std::set_terminate(end);
}

namespace {

bool main_returns = false;

extern "C" void end_after_crash(int) {
  constexpr char words[] =
      "souple: the program crashed under a limit of memory (ulimit -v), as OpenGL drivers do when memory is "
      "refused: raise the limit\n";
  const auto written = write(STDERR_FILENO, words, sizeof words - 1);
  _exit(written < 0 ? failed : bad_input);
}

}  // namespace

void expect_driver_crashes() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  struct sigaction action = {};
  action.sa_handler = end_after_crash;
  sigemptyset(&action.sa_mask);
  for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGILL}) sigaction(crash, &action, nullptr);
  std::atexit([] {
    if (!main_returns) end_after_crash(0);
  });
}

void expect_return() {
  main_returns = true;
}

#if defined(__linux__) && !defined(SOUPLE_SANITIZED)
namespace {

// Before the initializers of libraries: log4cplus, which OpenVDB needs, starts threads in its own.
[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)() = end_when_out_of_memory;

}  // namespace
#endif

}  // namespace souple::app
