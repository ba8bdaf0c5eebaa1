#pragma once

namespace souple::app {

/// From now on the first SIGINT or SIGTERM is only remembered; a second one ends the program at once.
void watch_interrupts();
/// Whether one has come.
bool interrupt_came();

}  // namespace souple::app
