#pragma once

#include "souple/mesh_files/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace souple {

/// A test of formats that assimp reads.
class AssimpTest : public test::FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    if (!mesh_import_has_assimp()) GTEST_SKIP() << "built without assimp";
  }
};

struct BadText {
  std::string text;
  std::initializer_list<std::string> words;  ///< of the message
};

/// Expects that reading throws Error for each text.
template <class Read>
void expect_bad(const Read& read, std::initializer_list<BadText> cases) {
  for (const BadText& bad : cases) {
    SCOPED_TRACE(bad.text);
    expect_error([&] { read(bad.text); }, bad.words);
  }
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
