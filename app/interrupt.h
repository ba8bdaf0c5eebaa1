#pragma once

namespace souple::app {

/// From now on the first SIGINT or SIGTERM is only recorded; a second one ends the program immediately.
void watch_interrupts();
/// Whether a signal was recorded.
bool interrupt_requested();

}  // namespace souple::app
