#pragma once

#include <stdexcept>
#include <string>

namespace souple {

/// The exception of the public API. Its message gives the error, its location, the expected value and the
/// remedy.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace souple
