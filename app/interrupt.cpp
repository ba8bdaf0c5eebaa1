#include "app/interrupt.h"

#include <csignal>

namespace souple::app {

namespace {

// The only type that a signal handler may access.
volatile std::sig_atomic_t came = 0;

extern "C" void remember(int) {
  came = 1;
}

}  // namespace

void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = remember;
  // Restores the default action for a second signal. The first one does not interrupt writing.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_came() {
  return came != 0;
}

}  // namespace souple::app
