#pragma once

#include "souple/error.h"

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace souple {

/// The message of the Error that the call throws; empty if it throws none.
template <class Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Expects that a text contains all `words`.
inline void expect_words(const std::string& text, std::initializer_list<std::string> words) {
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is missing in: " << text;
}

/// Expects that the call throws Error with a message that contains all `words`.
template <class Function>
void expect_error(const Function& function, std::initializer_list<std::string> words) {
  const std::string message = error_of(function);
  EXPECT_NE(message, "") << "no Error was thrown";
  expect_words(message, words);
}

}  // namespace souple
