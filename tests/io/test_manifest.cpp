#include "io_test.h"
#include "souple/geometry/builders.h"
#include "souple/io/manifest.h"
#include "souple/io/manifest_writer.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <cmath>
#include <limits>
#include <unistd.h>

namespace souple::test::test_io_manifest {

RunManifest example() {
  RunManifest manifest;
  manifest.version = "0.1.0";
  manifest.complete = true;
  manifest.scene = R"({"souple":1,"objects":[{"name":"drapé","kind":"cloth"}],"gravity":[0.0,-9.81,0.0]})";
  manifest.settings = R"({"threads":2})";
  manifest.frame_rate = 24;
  manifest.frames = 3;
  manifest.objects = {{"drapé", "cloth", {{"obj", "cloth.obj", 0}, {"pc2", "cloth.pc2", 3}}, 4, 2},
                      {"sand", "grains", {}, 9, 0}};
  manifest.notes = {"\"sand\" changes its topology\nand is written as obj"};
  manifest.reports = {{1, 1 / 24.0, {{"contacts", 12}, {"largest_strain", 0.1}}, {}, {{"solve", 1.25}}},
                      {3, 0.125, {{"residual", 1e-300}}, {"strain"}, {{"solve", 1.5}, {"collide", 0.1}}}};
  return manifest;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The error that a manifest gives when `from` stands as `to` in it.
std::string error_when(const std::string& from, const std::string& to) {
  const std::string text = replaced(manifest_text(example()), from, to);
  return error_of([&] { parse_manifest(text, "run.json"); });
}

using ManifestTest = FolderTest;

TEST_F(ManifestTest, IsReadWithoutItsReports) {
  RunManifest written = example();
  written.scene = R"({"reports":[1],"timings":2})";  // keys of the scene are not those of the manifest
  write_manifest(folder, written);
  const RunManifest read = read_manifest_without_reports(folder);
  EXPECT_TRUE(read.reports.empty());
  EXPECT_EQ(read.scene, written.scene);
  EXPECT_EQ(read.objects, written.objects);
  EXPECT_EQ(read.frames, written.frames);
  put("run.json", "[]");
  EXPECT_THROW(read_manifest_without_reports(folder), Error);
}

TEST_F(ManifestTest, ReadsBackWhatWasWritten) {
  const RunManifest written = example();
  write_manifest(folder, written);
  EXPECT_EQ(count(), 1);
  for (const auto& path : {folder, folder / "run.json"}) {
    const RunManifest read = read_manifest(path);
    EXPECT_EQ(read.version, written.version);
    EXPECT_EQ(read.complete, written.complete);
    EXPECT_EQ(read.scene, written.scene);
    EXPECT_EQ(read.settings, written.settings);
    EXPECT_EQ(read.frame_rate, written.frame_rate);
    EXPECT_EQ(read.frames, written.frames);
    EXPECT_EQ(read.objects, written.objects);
    EXPECT_EQ(read.notes, written.notes);
    ASSERT_EQ(read.reports.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read.reports[i].frame, written.reports[i].frame);
      EXPECT_EQ(read.reports[i].time, written.reports[i].time);
      EXPECT_EQ(read.reports[i].values, written.reports[i].values);
      EXPECT_EQ(read.reports[i].flags, written.reports[i].flags);
      EXPECT_EQ(read.reports[i].milliseconds, written.reports[i].milliseconds);
    }
  }
}

TEST_F(ManifestTest, AnEmptyRun) {
  const RunManifest read = parse_manifest(manifest_text({}), "run.json");
  EXPECT_EQ(read.scene, "");
  EXPECT_EQ(read.frames, 0u);
  EXPECT_TRUE(read.objects.empty());
}

TEST_F(ManifestTest, NotFiniteIsNull) {
  RunManifest manifest = example();
  manifest.reports[0].values[0].second = std::numeric_limits<double>::infinity();
  const RunManifest read = parse_manifest(manifest_text(manifest), "run.json");
  EXPECT_TRUE(std::isnan(read.reports[0].values[0].second));
}

TEST_F(ManifestTest, OnlyOneLineDependsOnTheClock) {
  RunManifest slower = example();
  slower.reports[1].milliseconds[0].second = 99;
  const auto without_timings = [](const std::string& text) {
    const auto at = text.find("\n\"timings\"");
    return text.substr(0, at) + text.substr(text.find('\n', at + 1));
  };
  EXPECT_NE(manifest_text(example()), manifest_text(slower));
  EXPECT_EQ(without_timings(manifest_text(example())), without_timings(manifest_text(slower)));
}

TEST_F(ManifestTest, ErrorsNameThePlace) {
  expect_words(error_when("\"frames\": 3", "\"frames\": -3"), {"run.json.frames: expected a whole number"});
  expect_words(error_when("\"frames\": 3", "\"frames\": 2"),
               {"run.json.reports[1].frame: 3 is not one of the 2"});
  expect_words(error_when("cloth.pc2", "../cloth.pc2"), {"run.json.objects[0].files[1].path"});
  expect_words(error_when("cloth.pc2", "/cloth.pc2"), {"leads out of the folder"});
  expect_words(error_when("\"points\":4", "\"points\":4.5"), {"objects[0].topology.points"});
  expect_words(error_when("\"kind\":\"grains\",", ""), {"objects[1]: has no \"kind\""});
  expect_words(error_when("\"notes\"", "\"nodes\""), {"\"nodes\", which is not known"});
  expect_words(error_when("\"complete\": true", "\"complete\": 1"), {"expected true or false"});
  expect_words(error_when("\"frame\":3,\"time\"", "\"frame\":1,\"time\""), {"not later"});
  expect_words(error_when("\"frame\":3,\"mill", "\"frame\":2,\"mill"), {"has no report"});
  expect_words(error_when("24.0", "0.0"), {"run.json.frame_rate"});
  expect_words(error_when("24.0", "1e999"), {"run.json"});
  expect_words(error_when("\"souple_run\": 1", "\"souple_run\": 2"),
               {"was written by Souple 0.1.0 in format 2"});
}

TEST_F(ManifestTest, WhatIsNoManifestIsAnError) {
  for (const char* text : {"", "{", "[]", "null", "{}", "\xff\xfe", "{\"souple_run\": \"1\"}", "1e999"})
    EXPECT_THROW(parse_manifest(text, "run.json"), Error) << text;
  const std::string deep(1000000, '[');
  expect_error([&] { parse_manifest(deep, "run.json"); }, {"nested deeper"});
  expect_error([&] { read_manifest(folder); }, {"run.json"});
}

TEST_F(ManifestTest, WhatCannotBeWrittenLeavesTheOldFile) {
  write_manifest(folder, example());
  const std::string before = get("run.json");
  RunManifest bad = example();
  bad.scene = "{not json";
  expect_error([&] { write_manifest(folder, bad); }, {"the scene of a run"});
  bad = example();
  bad.objects[0].name = "\xff";
  EXPECT_THROW(write_manifest(folder, bad), Error);
  EXPECT_EQ(get("run.json"), before);
  EXPECT_EQ(count(), 1);
}

RunManifest head() {
  RunManifest manifest;
  manifest.version = "0.1.0";
  manifest.scene = R"({"souple":1})";
  manifest.objects = {{"flag", "cloth", {{"pc2", "flag.pc2", 3}}, 4, 2}};
  return manifest;
}

FrameReport report_of(std::uint64_t frame) {
  FrameReport report{
      frame, 0.1 * static_cast<double>(frame), {{"contacts", 3}}, {"deep_contact"}, {{"solve", 1.5}}};
  if (frame % 3 == 0) report.milliseconds.clear();
  if (frame % 50 == 0) report.values.emplace_back(std::string(100000, 'x'), 1);  // longer than any buffer
  return report;
}

using ManifestWriterTest = FolderTest;

/// However many reports there are, run.json has the text that manifest_text gives.
TEST_F(ManifestWriterTest, WritesTheTextOfTheManifest) {
  ManifestWriter writer(folder);
  RunManifest manifest = head();
  writer.save(manifest);
  EXPECT_TRUE(get("run.json") == manifest_text(manifest));
  for (std::uint64_t frame = 1; frame <= 1000; ++frame) {
    writer.add(report_of(frame));
    manifest.reports.push_back(report_of(frame));
    manifest.frames = frame;
    if (frame % 250 != 0 && frame > 2) continue;
    writer.save(manifest);
    EXPECT_TRUE(get("run.json") == manifest_text(manifest)) << frame;
  }
  writer.release();
  EXPECT_EQ(count(), 1);
}

TEST_F(ManifestWriterTest, DropsAFrameThatFailed) {
  ManifestWriter writer(folder);
  RunManifest manifest = head();
  for (const std::uint64_t frame : {1u, 2u, 3u}) writer.add(report_of(frame));
  writer.save(manifest);
  writer.drop_after(3);  // nothing
  writer.drop_after(2);
  manifest.reports = {report_of(1), report_of(2)};
  writer.save(manifest);
  EXPECT_EQ(get("run.json"), manifest_text(manifest));
  FrameReport other = report_of(3);
  other.time = 7;
  writer.add(other);
  manifest.reports.push_back(other);
  writer.save(manifest);
  EXPECT_EQ(get("run.json"), manifest_text(manifest));
}

/// Where files may not grow further, adding a report fails, and run.json can still be written without it.
TEST_F(ManifestWriterTest, DescribesTheFramesBeforeTheDiskIsFull) {
  for (const std::uint64_t bytes : {3000u, 20000u, 100000u}) {
    ManifestWriter writer(folder);
    RunManifest manifest = head();
    const FileSizeLimit limit(bytes);
    std::uint64_t frame = 0;
    std::string why;
    try {
      writer.expect(manifest);
      for (;;) {
        FrameReport report = report_of(frame + 1);
        report.values.resize(1);
        writer.add(report);
        manifest.reports.push_back(std::move(report));
        manifest.frames = ++frame;
      }
    } catch (const Error& error) {
      why = error.what();
    }
    expect_words(why, {"File too large"});
    writer.drop_after(frame);
    if (bytes < 4000) {
      EXPECT_EQ(frame, 0u);
      continue;
    }
    EXPECT_GT(frame, bytes / 300);
    writer.save(manifest);
    EXPECT_TRUE(get("run.json") == manifest_text(manifest)) << frame;
  }
}

TEST_F(ManifestWriterTest, LeavesNothingWhenItFails) {
  { ManifestWriter(folder).add(report_of(1)); }
  EXPECT_EQ(count(), 0);
}

#if defined(__linux__) && !defined(SOUPLE_SANITIZED)
std::size_t resident_bytes() {
  std::size_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Reports are kept on the disk: they took kilobytes of memory a frame.
TEST_F(ManifestWriterTest, MemoryDoesNotGrowWithTheFrames) {
  World world({.substeps = 1, .threads = 1});
  world.add_cloth(grid(3, 3, 1));
  Recorder recorder(world, folder / "out");
  const auto record = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      world.step(1.0 / 60);
      recorder.capture();
    }
    return resident_bytes();
  };
  const std::size_t before = record(1000), after = record(9000);
  EXPECT_LT(after, before + std::size_t{9000} * 50) << "more than 50 bytes a frame";
  recorder.finish();
  EXPECT_EQ(read_manifest(folder / "out").reports.size(), 10000u);
}
#endif

}  // namespace souple::test::test_io_manifest
