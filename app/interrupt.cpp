#include "app/interrupt.h"

#include <csignal>

namespace souple::app {

namespace {

// The only type that a signal handler may access.
volatile std::sig_atomic_t signal_received = 0;

extern "C" void record_signal(int) {
  signal_received = 1;
}

}  // namespace

void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = record_signal;
  // A second signal finds the default action again. Interrupted writes to files continue after the first.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested() {
  return signal_received != 0;
}

}  // namespace souple::app
