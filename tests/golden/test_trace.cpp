#include "tests/expect_error.h"
#include "tests/io/io_test.h"
#include "trace.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace souple::test::test_golden_trace {

using TraceFile = FolderTest;

/// Codes of one frame of a duck and a ring, one per number.
FrameCodes frame(int duck_x, int duck_v, int ring_x, int ring_v) {
  const auto code = [](int number) { return fmt::format("{:02}", number); };
  return {{"duck", "positions", code(duck_x)},
          {"duck", "velocities", code(duck_v)},
          {"ring", "positions", code(ring_x)},
          {"ring", "velocities", code(ring_v)}};
}

std::vector<FrameCodes> three_frames() {
  return {frame(10, 11, 12, 13), frame(20, 21, 22, 23), frame(30, 31, 32, 33)};
}

Trace trace_of(const std::vector<FrameCodes>& frames) {
  Trace trace;
  for (const FrameCodes& codes : frames) append(trace, codes);
  return trace;
}

/// Compares these frames, one after another.
std::optional<Difference> first_difference_of(const Trace& trace, const std::vector<FrameCodes>& frames) {
  std::size_t asked = 0;
  return first_difference(trace, static_cast<int>(frames.size()), [&] { return frames.at(asked++); });
}

TEST(CodeOf, IsTwoCharactersWhateverTheNumber) {
  const std::vector<Vec3f> values(1000, Vec3f{1, 2, 3});
  EXPECT_EQ(code_of({}).size(), 2u);
  EXPECT_EQ(code_of(values).size(), 2u);
  EXPECT_EQ(code_of(values), code_of(values));
  EXPECT_NE(code_of(values), code_of(std::span(values).first(999)));
}

TEST(CodeOf, SeesEveryBitOfEveryNumberAlmostAlways) {
  // 12 bits miss one difference in 4096: of 960 flipped bits, more than 4 missed has a chance of 1e-5.
  std::vector<Vec3f> values(10, Vec3f{0.1f, -2, 3e5f});
  const std::string code = code_of(values);
  const auto bytes = std::as_writable_bytes(std::span(values));
  int missed = 0;
  for (std::byte& byte : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      const std::byte before = byte;
      byte ^= std::byte{1} << bit;
      missed += code_of(values) == code;
      byte = before;
    }
  }
  EXPECT_LE(missed, 4) << "of " << 8 * bytes.size();
}

TEST_F(TraceFile, ComesBackAsItWas) {
  const Trace trace = trace_of(three_frames());
  EXPECT_EQ(trace.frames(), 3);
  write_trace(folder / "trace" / "pond.txt", trace);
  EXPECT_EQ(get("trace/pond.txt"),
            "duck positions 102030\nduck velocities 112131\nring positions 122232\nring velocities 132333\n");
  EXPECT_EQ(trace_text(read_trace(folder / "trace" / "pond.txt")), trace_text(trace));
}

TEST_F(TraceFile, IsLeftAloneWhenItSaysTheSame) {
  const auto file = folder / "pond.txt";
  write_trace(file, trace_of(three_frames()));
  const auto long_ago = std::filesystem::last_write_time(file) - std::chrono::hours(1);
  std::filesystem::last_write_time(file, long_ago);
  write_trace(file, trace_of(three_frames()));
  EXPECT_EQ(std::filesystem::last_write_time(file), long_ago);
  write_trace(file, trace_of({frame(1, 2, 3, 4)}));
  EXPECT_NE(std::filesystem::last_write_time(file), long_ago);
}

TEST(TraceText, KeepsNamesWithSpaces) {
  const std::string text = "my duck positions AB\nmy duck velocities +/\n";
  EXPECT_EQ(trace_text(parse_trace(text, "pond.txt")), text);
}

TEST(TraceText, DamageIsAnErrorThatSaysWhere) {
  const auto damaged = [](const std::string& text, const std::string& what) {
    expect_error([&] { parse_trace(text, "pond.txt"); }, {"pond.txt", what});
  };
  const std::string good = "a positions ABCD\na velocities ABCD\n";
  EXPECT_EQ(parse_trace(good, "pond.txt").frames(), 2);
  damaged("", "is empty");
  damaged("a positions ABCD\na velocities ABCD", "line 2: is cut off");
  damaged("a positions ABCD\n", "ends before");
  damaged("a positions ABCD\na velocities AB\n", "line 2: has 1 frames, the first line 2");
  damaged("a positions ABC\n", "line 1: has 3 characters");
  damaged("a positions AB?D\n", "line 1: has a code that is not base64");
  damaged("a positions ABCD\nb velocities ABCD\n", "line 2: is not the velocities of \"a\"");
  damaged("a forces ABCD\n", "line 1: is not the positions");
  damaged("positions ABCD\n", "line 1: is not an object");
  damaged(good + good, "line 3: gives positions of \"a\" again");
  damaged(good + "\n", "line 3: is not an object");
}

TEST(TraceObjects, MayNotChangeFromFrameToFrame) {
  Trace trace = trace_of(three_frames());
  FrameCodes codes = frame(1, 2, 3, 4);
  codes[2].object = "crate";
  expect_error([&] { append(trace, codes); }, {"stay the same"});
  expect_error([&] { append(trace, {}); }, {"stay the same"});
  EXPECT_EQ(trace.frames(), 3);
}

TEST(TraceObjects, AddedAndRemovedOnesAreNamed) {
  const Trace trace = trace_of(three_frames());
  FrameCodes codes = frame(10, 11, 12, 13);
  EXPECT_EQ(changes_of_objects(trace, codes), "");
  codes[2].object = codes[3].object = "crate";
  EXPECT_EQ(changes_of_objects(trace, codes), "added: \"crate\"; removed: \"ring\"");
  EXPECT_EQ(changes_of_objects(trace, {}), "removed: \"duck\", \"ring\"");
  EXPECT_FALSE(difference_in(trace, 1, codes)) << "what both have is the same";
}

TEST(FirstDifference, IsNoneInTheSameFrames) {
  EXPECT_FALSE(first_difference_of(trace_of(three_frames()), three_frames()));
}

TEST(FirstDifference, NamesFrameAndQuantities) {
  std::vector<FrameCodes> frames = three_frames();
  frames[1][1].code = "zz";
  frames[2] = frame(1, 2, 3, 4);
  const auto difference = first_difference_of(trace_of(three_frames()), frames);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference_text(*difference),
            "first differs in frame 2: velocities of \"duck\" (1 of 4 quantities); frame 1 agrees");
}

TEST(FirstDifference, TellsOfTheFirstAndOfLaterFrames) {
  std::vector<FrameCodes> frames = three_frames();
  frames[2][0].code = frames[2][1].code = "zz";
  EXPECT_EQ(difference_text(*first_difference_of(trace_of(three_frames()), frames)),
            "first differs in frame 3: positions of \"duck\", velocities of \"duck\" (2 of 4 quantities); "
            "frames 1-2 agree");
  frames[0][3].code = "zz";
  EXPECT_EQ(difference_text(*first_difference_of(trace_of(three_frames()), frames)),
            "first differs in frame 1: velocities of \"ring\" (1 of 4 quantities)");
}

TEST(FirstDifference, StopsThere) {
  std::vector<FrameCodes> frames = three_frames();
  frames[0][0].code = "zz";
  int asked = 0;
  first_difference(trace_of(three_frames()), 3, [&] { return frames.at(static_cast<std::size_t>(asked++)); });
  EXPECT_EQ(asked, 1);
}

TEST(FirstDifference, OfAFrameThatTheTraceLacksIsAnError) {
  const Trace trace = trace_of(three_frames());
  expect_error([&] { difference_in(trace, 4, {}); }, {"no frame 4"});
  expect_error([&] { difference_in(trace, 0, {}); }, {"no frame 0"});
}

}  // namespace souple::test::test_golden_trace
