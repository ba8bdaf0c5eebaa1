#include "io_test.h"
#include "souple/files/atomic_file.h"
#include "souple/math/fnv1a.h"

namespace souple::test::test_io_atomic_file {

using AtomicFileTest = FolderTest;

TEST_F(AtomicFileTest, AppearsWholeAtCommit) {
  AtomicFile file(folder / "a.txt");
  file.write("one ");
  file.write("two");
  EXPECT_FALSE(has("a.txt"));
  file.commit(Sync::yes);
  EXPECT_EQ(get("a.txt"), "one two");
  EXPECT_EQ(count(), 1);
}

TEST_F(AtomicFileTest, WithoutCommitTheOldFileStaysAndNothingElse) {
  put("a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.write("new");
  }
  EXPECT_EQ(get("a.txt"), "old");
  EXPECT_EQ(count(), 1);
}

TEST_F(AtomicFileTest, ReplacesAnOldFile) {
  put("a.txt", "old and longer");
  write_file_atomically(folder / "a.txt", "new");
  EXPECT_EQ(get("a.txt"), "new");
}

TEST_F(AtomicFileTest, ErrorsNamePathAndReason) {
  const auto missing = folder / "nowhere" / "a.txt";
  const std::string no_folder = error_of([&] { write_file_atomically(missing, "x"); });
  expect_says(no_folder, missing.string());
  expect_says(no_folder, "there is no folder");
  std::filesystem::create_directories(folder / "taken" / "inside");
  const std::string is_folder = error_of([&] { write_file_atomically(folder / "taken", "x"); });
  expect_says(is_folder, "cannot be renamed");
  EXPECT_FALSE(has("taken.part"));
  expect_says(error_of([&] { read_whole_file(folder / "none"); }), "No such file");
  expect_says(error_of([&] { read_whole_file(folder / "taken"); }), "is not a file");
}

TEST_F(AtomicFileTest, AFullDiskIsAnErrorAndTheOldFileStays) {
  put("a.txt", "old");
  const std::string large(100000, 'x');
  const FileSizeLimit limit(50000);
  const std::string message = error_of([&] { write_file_atomically(folder / "a.txt", large); });
  expect_says(message, "a.txt.part: cannot be written: File too large");
  EXPECT_EQ(get("a.txt"), "old");
  EXPECT_EQ(count(), 1);
}

TEST(Fnv1a, KnownValues) {
  // From the authors' test suite.
  EXPECT_EQ(fnv1a64(""), 0xcbf29ce484222325ull);
  EXPECT_EQ(fnv1a64("a"), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(fnv1a64("foobar"), 0x85944171f73967e8ull);
  EXPECT_EQ(fnv1a64("bar", fnv1a64("foo")), fnv1a64("foobar"));
}

}  // namespace souple::test::test_io_atomic_file
