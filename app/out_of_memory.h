#pragma once

namespace souple::app {

/// One line on standard error. Allocates nothing.
void say_out_of_memory();

/// Where memory runs out in code that may not throw, such as the destructors of libraries, the process ends with that
/// line and exit code 2, not with SIGABRT. Files that were not complete stay as .part, as after a kill.
void end_when_out_of_memory();

}  // namespace souple::app
