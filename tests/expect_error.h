#pragma once

#include "souple/error.h"

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace souple {

/// Expects that the call throws Error with a message that contains all `words`.
template <class Function>
void expect_error(const Function& function, std::initializer_list<std::string> words) {
  try {
    function();
  } catch (const Error& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "'" << word << "' is missing in: " << error.what();
    return;
  }
  ADD_FAILURE() << "no Error was thrown";
}

}  // namespace souple
