#pragma once

namespace souple::app {

/// Exit codes of the program.
enum ExitCode : int {
  fine = 0,
  failed = 1,        ///< a failure outside the program, such as a full disk
  bad_input = 2,     ///< a scene, a mesh, a flag
  non_finite = 3,    ///< the simulation gave numbers that are not finite
  interrupted = 130  ///< Ctrl-C or a request to end: a checkpoint was written
};

}  // namespace souple::app
