#pragma once

#include "souple/error.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace souple {

/// Calls `read` and expects an Error whose message contains all `parts`.
template <class Read>
void expect_error(Read read, std::initializer_list<const char*> parts) {
  try {
    read();
  } catch (const Error& error) {
    for (const char* part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << error.what() << "\nlacks " << part;
    }
    return;
  }
  ADD_FAILURE() << "no Error was thrown";
}

/// The bytes of numbers in the given order.
template <class... T>
std::string bytes_of(bool big_endian, T... values) {
  std::string out;
  const auto append = [&](auto value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    // The tests' machines are little-endian.
    if (big_endian) std::reverse(bytes, bytes + sizeof(value));
    out.append(bytes, sizeof(value));
  };
  (append(values), ...);
  return out;
}

}  // namespace souple
