#pragma once

#include "souple/files/file.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace souple::test {

/// A test with a temporary folder, initially empty and removed at the end.
class FolderTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(testing::TempDir()) /
             (std::string("souple_") + info->test_suite_name() + "_" + info->name());
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// Writes a file; returns its path.
  std::filesystem::path put(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }
  std::string get(const std::string& name) const { return read_whole_file(folder / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder / name); }
  /// Number of files in the folder.
  int count() const {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files += entry.is_regular_file();
    return files;
  }

  std::filesystem::path folder;
};

}  // namespace souple::test
