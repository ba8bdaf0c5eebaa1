#pragma once

namespace souple::app {

/// Exit codes of the program.
enum ExitCode : int {
  success = 0,
  failed = 1,        ///< a failure outside the program, such as a full disk
  bad_input = 2,     ///< invalid scene, mesh or option; or one that needs more memory than there is
  non_finite = 3,    ///< a value of the simulation became non-finite
  interrupted = 130  ///< Ctrl-C or a request to terminate; a checkpoint was written
};

}  // namespace souple::app
