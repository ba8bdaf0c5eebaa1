#pragma once

#include <stdexcept>
#include <string>

namespace souple {

/// What the public API throws. The message says what is wrong, where, what was expected and what to change.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace souple
