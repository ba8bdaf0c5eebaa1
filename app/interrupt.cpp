#include "app/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace souple::app {

namespace {

// The only type that a signal handler may access.
volatile std::sig_atomic_t signal_received = 0;

extern "C" void record_signal(int) {
  signal_received = 1;
}

/// Records a signal, unless the caller had it ignored: `nohup` ignores SIGHUP, a shell without job control
/// SIGINT of what it starts in the background.
void watch(int signal, const struct sigaction& action) {
  struct sigaction inherited = {};
  if (sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN) return;
  sigaction(signal, &action, nullptr);
}

}  // namespace

void watch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = record_signal;
  // A second signal finds the default action again. Interrupted writes to files continue after the first.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXCPU}) watch(signal, action);
  // A write past the limit of file sizes then fails like one to a full disk, instead of ending the program.
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupt_requested() {
  return signal_received != 0;
}

}  // namespace souple::app
