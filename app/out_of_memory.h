#pragma once

namespace souple::app {

/// One line on standard error. Allocates nothing.
void say_out_of_memory();

/// Memory or threads may run out in code that may not throw, such as the initializers and destructors of libraries. The
/// process then ends with one line and exit code 2, not with SIGABRT. Files that were not complete stay as .part, as
/// after a kill.
void end_when_out_of_memory();

/// Call before the first use of OpenGL. If the process has a limit of memory, a crash ends it with one line and exit
/// code 2. Mesa's drivers use memory that allocations did not give them, or call exit().
void expect_driver_crashes();

/// Call before main() returns: exit() is a crash until then.
void expect_return();

}  // namespace souple::app
