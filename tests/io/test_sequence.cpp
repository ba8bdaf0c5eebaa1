#include "io_test.h"
#include "souple/io/sequence.h"

#include <stdexcept>

namespace souple::test::test_io_sequence {

using SequenceTest = FolderTest;

std::string bytes(std::span<const Vec3f> positions, std::span<const Vec3f> velocities) {
  return std::to_string(positions.size()) + " " + std::to_string(velocities.size());
}

TEST_F(SequenceTest, NamesGrowBeyondFourDigits) {
  EXPECT_EQ(frame_file_name("cloth", 1, "obj"), "cloth_0001.obj");
  EXPECT_EQ(frame_file_name("cloth", 12345, "ply"), "cloth_12345.ply");
}

TEST_F(SequenceTest, WritesAFileAFrameAndListsThem) {
  SequenceWriter writer(folder, "sand", "ply", bytes);
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
  SequenceWriter writer(folder, "a", "obj", bytes, 2);
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
  expect_says(error_of([&] { SequenceWriter(folder, "a", "obj", bytes, 2); }), "a_0002.obj");
}

TEST_F(SequenceTest, WhatIsNoSequenceIsAnError) {
  expect_says(error_of([&] { find_sequence(folder / "drive.obj"); }), "drive_0001.obj");
  EXPECT_THROW(find_sequence(folder / "drive_0001.obj"), Error);
  EXPECT_THROW(find_sequence(folder / "nowhere" / "drive_0001.obj"), Error);
  put("drive_1.obj", "");
  put("drive_0001.obj", "");
  expect_says(error_of([&] { find_sequence(folder / "drive_1.obj"); }), "same number");
}

TEST_F(SequenceTest, AFolderStandsForTheOneSequenceInIt) {
  expect_says(error_of([&] { find_sequence(folder); }), "no sequence");
  put("readme.txt", ""), put("rest.obj", ""), put("walk_0001.mtl", "");
  expect_says(error_of([&] { find_sequence(folder); }), "NAME_0001.obj");
  put("walk_10.obj", ""), put("walk_9.obj", ""), put("walk_0011.obj", "");
  const auto frames = find_sequence(folder);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].path, folder / "walk_9.obj") << "by number, not by name";
  EXPECT_EQ(frames[2].path, folder / "walk_0011.obj");
  put("run_0001.obj", "");
  const std::string said = error_of([&] { find_sequence(folder); });
  expect_says(said, "run_0001.obj");
  expect_says(said, "walk_0011.obj");
}

}  // namespace souple::test::test_io_sequence
