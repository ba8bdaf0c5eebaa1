#include "souple/io/recorder_names.h"

#include <filesystem>

#include <gtest/gtest.h>

namespace souple::test::test_io_recorder_names {

TEST(RecorderNames, NoNameLeadsOutOfTheFolder) {
  const std::string control("a\nb\0c\x7f", 6);
  for (const std::string& name : {std::string("../../etc/passwd"), std::string(".."), std::string("."),
                                  std::string("/root"), std::string("a\\b"), std::string("c:"), std::string(),
                                  std::string("..\\.."), control, std::string("~/x")}) {
    const std::string safe = safe_file_name(name);
    EXPECT_FALSE(safe.empty()) << name;
    EXPECT_EQ(std::filesystem::path(safe).filename(), safe) << name;
    EXPECT_NE(safe.front(), '.') << name;
    for (const char c : safe) EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) << name;
  }
  EXPECT_EQ(safe_file_name("flag"), "flag");
  EXPECT_EQ(safe_file_name("été"), "été");
}

/// A very long name is cut between two characters, never inside one.
TEST(RecorderNames, LongNamesAreCut) {
  std::string longest = "x";
  for (int i = 0; i < 200; ++i) longest += "é";
  const std::string safe = safe_file_name(longest);
  EXPECT_EQ(safe.size(), 99u);
  EXPECT_EQ(longest.compare(0, safe.size(), safe), 0);
}

TEST(RecorderNames, NamesThatBecomeTheSameDiffer) {
  FileNames names;
  EXPECT_EQ(names.add("a/b"), "a_b");
  EXPECT_EQ(names.add("a_b"), "a_b-2");
  EXPECT_EQ(names.add("A_B"), "A_B-3");
  EXPECT_EQ(names.add("a_b-2"), "a_b-2-2");
}

/// The rest mesh of "ball_0007" would be a frame of the sequence "ball".
TEST(RecorderNames, NoNameLooksLikeAFrame) {
  EXPECT_EQ(safe_file_name("ball_0007"), "ball_0007_");
  EXPECT_EQ(safe_file_name("ball_07"), "ball_07");
}

}  // namespace souple::test::test_io_recorder_names
