#pragma once

#include "souple/error.h"

namespace souple {

/// An output cannot be written: the disk is full, a folder is missing or read-only, too many files are open. The
/// program `souple` then ends with another exit code than for bad input.
class WriteError : public Error {
 public:
  using Error::Error;
};

}  // namespace souple
