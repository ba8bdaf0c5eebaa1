#pragma once

namespace souple::app {

/// From now on the first SIGHUP, SIGINT, SIGTERM, SIGUSR1 or SIGXCPU is only recorded; a second one of its kind ends
/// the program immediately. Slurm sends the last two before the end of a job's time. Signals that were ignored when the program started stay ignored. SIGXFSZ is ignored: the write
/// that passes the limit of file sizes fails.
void watch_interrupts();
/// Whether a signal was recorded.
bool interrupt_requested();

}  // namespace souple::app
