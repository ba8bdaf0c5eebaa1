#include "io_test.h"
#include "souple/io/mdd.h"
#include "souple/io/pc2.h"
#include "souple/io/sequence.h"

#include <cstring>
#include <stdexcept>

namespace souple::test::test_io_point_caches {

// The two formats through one pair of hands, for the tests that hold for both.
struct Pc2 {
  using Writer = Pc2Writer;
  using Reader = Pc2Reader;
  static constexpr const char* name = "cloth.pc2";
  static Writer create(const std::filesystem::path& path, std::uint64_t points, std::uint64_t) {
    return Pc2Writer(path, points);
  }
  static Writer resume(const std::filesystem::path& path, std::uint64_t points, std::uint64_t keep,
                       std::uint64_t) {
    return Pc2Writer::resume(path, points, keep);
  }
  static void append(Writer& writer, int frame, std::size_t points) {
    writer.append(frame_of(points, frame));
  }
};

struct Mdd {
  using Writer = MddWriter;
  using Reader = MddReader;
  static constexpr const char* name = "cloth.mdd";
  static Writer create(const std::filesystem::path& path, std::uint64_t points, std::uint64_t planned) {
    return MddWriter(path, points, planned);
  }
  static Writer resume(const std::filesystem::path& path, std::uint64_t points, std::uint64_t keep,
                       std::uint64_t planned) {
    return MddWriter::resume(path, points, keep, planned);
  }
  static void append(Writer& writer, int frame, std::size_t points) {
    writer.append(frame / 24.0, frame_of(points, frame));
  }
};

template <class Format>
class PointCache : public FolderTest {
 protected:
  std::filesystem::path path() const { return folder / Format::name; }
  std::string part() const { return std::string(Format::name) + ".part"; }

  void append(typename Format::Writer& writer, int first, int last) const {
    for (int frame = first; frame <= last; ++frame) Format::append(writer, frame, points);
  }
  /// The bytes of a run of `frames` that nothing disturbed.
  std::string undisturbed(int frames, std::uint64_t planned) const {
    const auto other = folder / "undisturbed";
    auto writer = Format::create(other, points, planned);
    append(writer, 1, frames);
    writer.finish();
    const std::string bytes = read_whole_file(other);
    std::filesystem::remove(other);
    return bytes;
  }

  std::size_t points = 7;
};

using Formats = testing::Types<Pc2, Mdd>;
TYPED_TEST_SUITE(PointCache, Formats);

TYPED_TEST(PointCache, ReadsBackWhatWasWrittenInAnyOrder) {
  auto writer = TypeParam::create(this->path(), this->points, 5);
  this->append(writer, 1, 5);
  EXPECT_FALSE(this->has(TypeParam::name));
  writer.finish();
  EXPECT_EQ(this->count(), 1);
  typename TypeParam::Reader reader(this->path());
  ASSERT_EQ(reader.frames(), 5u);
  ASSERT_EQ(reader.points(), this->points);
  std::vector<Vec3f> positions(this->points);
  for (const int frame : {3, 1, 5, 2, 4}) {
    reader.read(static_cast<std::uint64_t>(frame - 1), positions);
    EXPECT_EQ(positions, frame_of(this->points, frame));
  }
}

TYPED_TEST(PointCache, OnePointAndNoFrames) {
  this->points = 1;
  auto writer = TypeParam::create(this->path(), 1, 10);
  writer.finish();
  EXPECT_EQ(typename TypeParam::Reader(this->path()).frames(), 0u);
  auto again = TypeParam::create(this->path(), 1, 10);
  this->append(again, 1, 1);
  again.finish();
  typename TypeParam::Reader reader(this->path());
  std::vector<Vec3f> position(1);
  reader.read(0, position);
  EXPECT_EQ(position, frame_of(1, 1));
}

TYPED_TEST(PointCache, AnEarlyOrLateEndLeavesTheSameBytesAsAPlannedOne) {
  const std::string planned = this->undisturbed(6, 6);
  for (const std::uint64_t plan : {0u, 2u, 100u}) EXPECT_EQ(this->undisturbed(6, plan), planned) << plan;
}

TYPED_TEST(PointCache, ResumeGivesTheBytesOfARunThatNeverStopped) {
  const std::string whole = this->undisturbed(9, 9);
  for (const bool finished : {true, false}) {
    for (const int keep : {0, 1, 4}) {
      // Frames 5 and 6 were written after the checkpoint, and differ: nothing of them may stay.
      auto writer = TypeParam::create(this->path(), this->points, 9);
      this->append(writer, 1, 4);
      this->append(writer, 105, 106);
      if (finished) writer.finish();
      auto resumed = TypeParam::resume(this->path(), this->points, static_cast<std::uint64_t>(keep), 9);
      EXPECT_FALSE(this->has(TypeParam::name)) << "what is not complete must not look so";
      EXPECT_EQ(resumed.frames(), static_cast<std::uint64_t>(keep));
      this->append(resumed, keep + 1, 9);
      resumed.finish();
      EXPECT_EQ(this->get(TypeParam::name), whole) << finished << " " << keep;
      EXPECT_EQ(this->count(), 1);
      std::filesystem::remove(this->path());
    }
  }
}

TYPED_TEST(PointCache, AFrameThatTheDiskRefusedCanBeWrittenAgain) {
  this->points = 5000;
  const std::string whole = this->undisturbed(3, 3);
  auto writer = TypeParam::create(this->path(), this->points, 3);
  this->append(writer, 1, 1);
  {
    const FileSizeLimit limit(90000);
    EXPECT_THROW(this->append(writer, 2, 2), Error);
  }
  EXPECT_EQ(writer.frames(), 1u);
  this->append(writer, 2, 3);
  writer.finish();
  EXPECT_EQ(this->get(TypeParam::name), whole);
}

TYPED_TEST(PointCache, AFullDiskLeavesTheFramesBefore) {
  this->points = 5000;
  const std::string two = this->undisturbed(2, 3);
  auto writer = TypeParam::create(this->path(), this->points, 3);
  this->append(writer, 1, 2);
  {
    const FileSizeLimit limit(150000);
    EXPECT_THROW(this->append(writer, 3, 3), Error);
  }
  writer.finish();
  EXPECT_EQ(this->get(TypeParam::name), two);
}

TYPED_TEST(PointCache, AKilledRunIsTakenUpFromItsPart) {
  // Killed in the middle of a frame: bytes beyond the last whole frame.
  {
    auto writer = TypeParam::create(this->path(), this->points, 9);
    this->append(writer, 1, 5);
  }
  this->put(this->part(), this->get(this->part()) + "half a frame");
  auto resumed = TypeParam::resume(this->path(), this->points, 5, 9);
  this->append(resumed, 6, 9);
  resumed.finish();
  EXPECT_EQ(this->get(TypeParam::name), this->undisturbed(9, 9));
}

TYPED_TEST(PointCache, FramesThatResumeCutOffAreGoneForGood) {
  {
    auto writer = TypeParam::create(this->path(), this->points, 9);
    this->append(writer, 1, 6);
  }
  TypeParam::resume(this->path(), this->points, 2, 9);  // and killed at once
  expect_error([&] { TypeParam::resume(this->path(), this->points, 3, 9); }, {"holds 2 frames"});
}

TYPED_TEST(PointCache, ResumeRefusesWhatDoesNotFit) {
  EXPECT_THROW(TypeParam::resume(this->path(), this->points, 0, 9), Error);
  auto writer = TypeParam::create(this->path(), this->points, 9);
  this->append(writer, 1, 3);
  writer.finish();
  expect_error([&] { TypeParam::resume(this->path(), this->points, 4, 9); }, {"holds 3 frames"});
  expect_error([&] { TypeParam::resume(this->path(), this->points + 1, 3, 9); }, {"holds 7 points"});
  EXPECT_EQ(typename TypeParam::Reader(this->path()).frames(), 3u) << "a refused resume changes nothing";
}

TYPED_TEST(PointCache, AFrameOfAnotherSizeIsAnErrorAndLeavesNoTrace) {
  auto writer = TypeParam::create(this->path(), this->points, 2);
  this->append(writer, 1, 1);
  expect_error([&] { TypeParam::append(writer, 2, this->points + 1); }, {"sequence"});
  this->append(writer, 2, 2);
  writer.finish();
  EXPECT_EQ(this->get(TypeParam::name), this->undisturbed(2, 2));
  EXPECT_THROW(this->append(writer, 3, 3), Error);
  EXPECT_THROW(TypeParam::create(this->path(), 0, 2), Error);
  EXPECT_THROW(TypeParam::create(this->path(), 1ull << 31, 2), Error);
  EXPECT_EQ(this->count(), 1) << "a refused writer leaves no .part";
}

TYPED_TEST(PointCache, DiscardLeavesTheOldFile) {
  this->put(TypeParam::name, "old");
  auto writer = TypeParam::create(this->path(), this->points, 2);
  this->append(writer, 1, 2);
  writer.discard();
  EXPECT_EQ(this->get(TypeParam::name), "old");
  EXPECT_EQ(this->count(), 1);
}

TYPED_TEST(PointCache, EveryLengthButTheRightOneIsAnError) {
  const std::string good = this->undisturbed(3, 3);
  for (std::size_t length = 0; length <= good.size() + 8; ++length) {
    std::string bytes = good;
    bytes.resize(length);
    const auto open = [&] { typename TypeParam::Reader(ByteSource(bytes, "bad")); };
    if (length == good.size())
      EXPECT_NO_THROW(open());
    else
      EXPECT_THROW(open(), Error) << length;
  }
}

TYPED_TEST(PointCache, CountsThatLieAreErrors) {
  const std::string good = this->undisturbed(3, 3);
  // Both formats hold their counts within the first 32 bytes; no such number may be believed.
  for (std::size_t at = 0; at + 4 <= 32; at += 4) {
    for (const std::uint32_t lie : {0u, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0x00010000u}) {
      std::string bytes = good;
      std::memcpy(&bytes[at], &lie, 4);
      try {
        typename TypeParam::Reader reader(ByteSource(bytes, "bad"));
        EXPECT_EQ(reader.points() * reader.frames(), this->points * 3);
      } catch (const Error&) {
      }
    }
  }
}

TYPED_TEST(PointCache, ReadingPastTheEndIsAnError) {
  typename TypeParam::Reader reader(ByteSource(this->undisturbed(3, 3), "cache"));
  std::vector<Vec3f> positions(this->points);
  EXPECT_THROW(reader.read(3, positions), Error);
  positions.pop_back();
  EXPECT_THROW(reader.read(0, positions), Error);
}

using Bytes = std::vector<int>;

Bytes bytes_of(const std::string& text) {
  Bytes bytes;
  for (const char c : text) bytes.push_back(static_cast<unsigned char>(c));
  return bytes;
}

class PointCacheLayout : public FolderTest {
 protected:
  const std::vector<Vec3f> one_point = {{1.0f, -2.0f, 0.15625f}};  // 3f800000 c0000000 3e200000
};

TEST_F(PointCacheLayout, Pc2IsLittleEndian) {
  Pc2Writer writer(folder / "a.pc2", 1, {.start_frame = 1.0f, .sample_rate = 0.5f});
  writer.append(one_point);
  writer.finish();
  Bytes expected = bytes_of(std::string("POINTCACHE2\0", 12));
  const Bytes rest = {1, 0, 0,    0,    1, 0, 0, 0,    0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 1, 0, 0, 0,  // header
                      0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0x20, 0x3e};  // x, y, z
  expected.insert(expected.end(), rest.begin(), rest.end());
  EXPECT_EQ(bytes_of(get("a.pc2")), expected);
  Pc2Reader reader(folder / "a.pc2");
  EXPECT_EQ(reader.start_frame(), 1.0f);
  EXPECT_EQ(reader.sample_rate(), 0.5f);
}

TEST_F(PointCacheLayout, MddIsBigEndian) {
  MddWriter writer(folder / "a.mdd", 1, 2);
  writer.append(0.5, one_point);
  writer.append(1.0, one_point);
  writer.finish();
  const Bytes point = {0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0, 0x3e, 0x20, 0, 0};
  Bytes expected = {0, 0, 0, 2, 0, 0, 0, 1, 0x3f, 0, 0, 0, 0x3f, 0x80, 0, 0};
  expected.insert(expected.end(), point.begin(), point.end());
  expected.insert(expected.end(), point.begin(), point.end());
  EXPECT_EQ(bytes_of(get("a.mdd")), expected);
  EXPECT_EQ(MddReader(folder / "a.mdd").times(), (std::vector<float>{0.5f, 1.0f}));
}

TEST_F(PointCacheLayout, APartOfPc2IsWholeAfterEachFrame) {
  Pc2Writer writer(folder / "a.pc2", 1);
  for (std::uint64_t frames = 0; frames < 3; ++frames) {
    EXPECT_EQ(Pc2Reader(folder / "a.pc2.part").frames(), frames);
    writer.append(one_point);
  }
  const Pc2Writer resumed = Pc2Writer::resume(folder / "a.pc2", 1, 1);
  EXPECT_EQ(Pc2Reader(folder / "a.pc2.part").frames(), 1u);
}

using SequenceTest = FolderTest;

std::string counts_text(std::span<const Vec3f> positions, std::span<const Vec3f> velocities) {
  return std::to_string(positions.size()) + " " + std::to_string(velocities.size());
}

TEST_F(SequenceTest, NamesGrowBeyondFourDigits) {
  EXPECT_EQ(frame_file_name("cloth", 1, "obj"), "cloth_0001.obj");
  EXPECT_EQ(frame_file_name("cloth", 12345, "ply"), "cloth_12345.ply");
}

TEST_F(SequenceTest, WritesAFileAFrameAndListsThem) {
  SequenceWriter writer(folder, "sand", "ply", counts_text);
  writer.append(frame_of(3, 1), frame_of(3, 2));
  writer.append(frame_of(4, 1), {});
  writer.finish();
  EXPECT_EQ(count(), 2);
  EXPECT_EQ(get("sand_0001.ply"), "3 3");
  EXPECT_EQ(get("sand_0002.ply"), "4 0");
  put("sand_0010.ply", "");
  put("sand_0003.obj", "another format");
  put("wet_sand_0003.ply", "another object");
  const auto frames = find_sequence(folder / "sand_0001.ply");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2].number, 10u);
  EXPECT_EQ(frames[2].path, folder / "sand_0010.ply");
}

TEST_F(SequenceTest, AFailedFrameLeavesNothing) {
  SequenceWriter writer(folder, "sand", "ply",
                        [](auto, auto) -> std::string { throw std::runtime_error("no"); });
  EXPECT_THROW(writer.append(frame_of(1, 1), {}), std::runtime_error);
  EXPECT_EQ(count(), 0);
  EXPECT_EQ(writer.frames(), 0u);
}

TEST_F(SequenceTest, ResumeKeepsAndFinishRemovesTheRestOfALongerRun) {
  for (int frame = 1; frame <= 9; ++frame) put("a_000" + std::to_string(frame) + ".obj", "old");
  put("a_7.obj", "not ours");
  SequenceWriter writer(folder, "a", "obj", counts_text, 2);
  writer.append(frame_of(5, 1), {});
  EXPECT_EQ(writer.frames(), 3u);
  writer.finish();
  EXPECT_EQ(get("a_0002.obj"), "old");
  EXPECT_EQ(get("a_0003.obj"), "5 0");
  EXPECT_FALSE(has("a_0004.obj"));
  EXPECT_EQ(get("a_7.obj"), "not ours");
  EXPECT_EQ(count(), 4);
}

TEST_F(SequenceTest, ResumeNeedsItsFrames) {
  put("a_0001.obj", "old");
  expect_error([&] { SequenceWriter(folder, "a", "obj", counts_text, 2); }, {"a_0002.obj"});
}

TEST_F(SequenceTest, WhatIsNoSequenceIsAnError) {
  expect_error([&] { find_sequence(folder / "drive.obj"); }, {"drive_0001.obj"});
  EXPECT_THROW(find_sequence(folder / "drive_0001.obj"), Error);
  EXPECT_THROW(find_sequence(folder / "nowhere" / "drive_0001.obj"), Error);
  put("drive_1.obj", "");
  put("drive_0001.obj", "");
  expect_error([&] { find_sequence(folder / "drive_1.obj"); }, {"same number"});
}

TEST_F(SequenceTest, AFolderStandsForTheOneSequenceInIt) {
  expect_error([&] { find_sequence(folder); }, {"no sequence"});
  put("readme.txt", ""), put("rest.obj", ""), put("walk_0001.mtl", "");
  expect_error([&] { find_sequence(folder); }, {"NAME_0001.obj"});
  put("walk_10.obj", ""), put("walk_9.obj", ""), put("walk_0011.obj", "");
  const auto frames = find_sequence(folder);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].path, folder / "walk_9.obj") << "by number, not by name";
  EXPECT_EQ(frames[2].path, folder / "walk_0011.obj");
  put("run_0001.obj", "");
  expect_error([&] { find_sequence(folder); }, {"run_0001.obj", "walk_0011.obj"});
}

}  // namespace souple::test::test_io_point_caches
