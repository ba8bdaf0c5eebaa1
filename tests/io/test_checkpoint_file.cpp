#include "io_test.h"
#include "souple/files/atomic_file.h"
#include "souple/io/checkpoint_file.h"
#include "souple/math/fnv1a.h"

namespace souple::test::test_io_checkpoint_file {

Checkpoint example() {
  Checkpoint checkpoint;
  checkpoint.version = "0.1.0";
  checkpoint.frame = 1234567890123;
  checkpoint.scene = "{\"souple\": 1}";
  checkpoint.caches = {{"cloth.pc2", 120}, {"sub/sand_0001.ply", 7}};
  for (int i = 0; i < 100; ++i) checkpoint.state.push_back(static_cast<std::byte>(i * 37));
  return checkpoint;
}

void put_number(std::string& bytes, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i));
}

/// Makes the checksums right again, as a malicious or unlucky writer would.
std::string sealed(std::string bytes) {
  put_number(bytes, 32, bytes.size() - 64);
  put_number(bytes, 40, fnv1a64(std::string_view(bytes).substr(64)));
  put_number(bytes, 56, fnv1a64(std::string_view(bytes).substr(0, 56)));
  return bytes;
}

std::string error_for(const std::string& bytes, const std::string& this_version = "0.1.0") {
  return error_of([&] { parse_checkpoint(bytes, "a.checkpoint", this_version); });
}

using CheckpointFileTest = FolderTest;

TEST_F(CheckpointFileTest, ReadsBackWhatWasWritten) {
  write_checkpoint(folder / "a.checkpoint", example());
  EXPECT_EQ(read_checkpoint(folder / "a.checkpoint", "0.1.0"), example());
  EXPECT_EQ(read_checkpoint(folder / "a.checkpoint", "0.2.0"), example())
      << "a later version reads the same format";
  EXPECT_EQ(count(), 1);
  Checkpoint empty;
  empty.version = "0.1.0";
  EXPECT_EQ(parse_checkpoint(checkpoint_bytes(empty), "a", "0.1.0"), empty);
}

TEST_F(CheckpointFileTest, ANewerVersionIsNamed) {
  Checkpoint newer = example();
  newer.version = "0.2.0";
  expect_words(error_for(checkpoint_bytes(newer)), {"was written by Souple 0.2.0, this is 0.1.0"});
  newer.version = "0.10.0";
  expect_words(error_for(checkpoint_bytes(newer), "0.9.5"), {"was written by Souple 0.10.0, this is 0.9.5"});
  std::string format_2 = checkpoint_bytes(example());
  format_2[8] = 2;
  expect_words(error_for(sealed(format_2)), {"was written by Souple 0.1.0"});
}

TEST_F(CheckpointFileTest, EveryFlippedBitIsFound) {
  const std::string good = checkpoint_bytes(example());
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
      EXPECT_THROW(parse_checkpoint(bad, "a", "0.1.0"), Error) << at;
    }
  }
}

TEST_F(CheckpointFileTest, EveryOtherLengthIsFound) {
  const std::string good = checkpoint_bytes(example());
  for (std::size_t length = 0; length < good.size() + 9; ++length) {
    if (length == good.size()) continue;
    std::string bad = good;
    bad.resize(length);
    EXPECT_THROW(parse_checkpoint(bad, "a", "0.1.0"), Error) << length;
  }
  expect_words(error_for(good.substr(0, good.size() - 1)), {"cut short"});
  expect_words(error_for(good.substr(0, 40)), {"cut short"});
  expect_words(error_for("# Blender OBJ"), {"is not a checkpoint"});
}

TEST_F(CheckpointFileTest, SizesThatLieUnderRightChecksumsAreFound) {
  const std::string good = checkpoint_bytes(example());
  // Any 8 bytes of the payload as a number that is much too large, or zero: an Error, or another checkpoint.
  for (std::size_t at = 64; at + 8 <= good.size(); ++at) {
    for (const std::uint64_t lie : {~0ull, 1ull << 63, 1ull << 40, 0ull}) {
      std::string bad = good;
      put_number(bad, at, lie);
      try {
        EXPECT_EQ(parse_checkpoint(sealed(bad), "a", "0.1.0").version, "0.1.0");
      } catch (const Error&) {
      }
    }
  }
  std::string scene_size = good;
  put_number(scene_size, 72, ~0ull);
  expect_words(error_for(sealed(scene_size)), {"its scene is said to have 18446744073709551615 bytes"});
  expect_words(error_for(sealed(good + "x")), {"follow its end"});
}

TEST_F(CheckpointFileTest, CachesStayInTheirFolder) {
  Checkpoint outside = example();
  for (const char* path : {"../cloth.pc2", "/cloth.pc2", "", "a/../../b"}) {
    outside.caches[0].path = path;
    expect_words(error_for(checkpoint_bytes(outside)), {"outside its folder"});
  }
}

TEST_F(CheckpointFileTest, AVersionIsThreeNumbers) {
  for (const char* version : {"", "1", "0.1", "0.1.x", "0.1.0.1", "0.1.0-beta", "1000000.1000000.1"}) {
    Checkpoint bad = example();
    bad.version = version;
    EXPECT_THROW(checkpoint_bytes(bad), Error) << version;
  }
}

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
  expect_error([&] { write_file_atomically(missing, "x"); }, {missing.string(), "there is no folder"});
  std::filesystem::create_directories(folder / "taken" / "inside");
  expect_error([&] { write_file_atomically(folder / "taken", "x"); }, {"cannot be renamed"});
  EXPECT_FALSE(has("taken.part"));
  expect_error([&] { read_whole_file(folder / "none"); }, {"No such file"});
  expect_error([&] { read_whole_file(folder / "taken"); }, {"is not a file"});
}

TEST_F(AtomicFileTest, AFullDiskIsAnErrorAndTheOldFileStays) {
  put("a.txt", "old");
  const std::string large(100000, 'x');
  const FileSizeLimit limit(50000);
  expect_error([&] { write_file_atomically(folder / "a.txt", large); },
               {"a.txt.part: cannot be written: File too large"});
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

}  // namespace souple::test::test_io_checkpoint_file
