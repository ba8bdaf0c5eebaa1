#include "io_test.h"
#include "souple/geometry/builders.h"
#include "souple/io/manifest_writer.h"
#include "souple/io/recorder.h"
#include "souple/world/world.h"

#include <unistd.h>

namespace souple::test::test_io_manifest_writer {

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
    expect_says(why, "File too large");
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

}  // namespace souple::test::test_io_manifest_writer
