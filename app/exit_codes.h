#pragma once

namespace souple::app {

/// What the program tells the shell.
enum ExitCode : int {
  fine = 0,
  failed = 1,        ///< something outside failed, such as a full disk
  bad_input = 2,     ///< a scene, a mesh, a flag
  went_bad = 3,      ///< the simulation gave numbers that are not finite
  interrupted = 130  ///< Ctrl-C or a request to end: a checkpoint was written
};

}  // namespace souple::app
