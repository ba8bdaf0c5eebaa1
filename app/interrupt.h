#pragma once

namespace souple::app {

/// Installs handlers: the first SIGINT or SIGTERM is only recorded, a second one ends the program
/// immediately.
void watch_interrupts();
/// Whether a signal was recorded.
bool interrupt_came();

}  // namespace souple::app
