#pragma once

#include "souple/files/atomic_file.h"
#include "souple/io/manifest.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace souple {

/// Writes the run.json of a folder again and again while a run adds frames. It reserves the disk space of the next
/// run.json frame by frame, so that a disk that fills up stops the run at a frame that run.json can still describe.
/// The reserved space is run.json.part, which the destructor removes.
class ManifestWriter {
 public:
  explicit ManifestWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Reserves space for a run.json that begins as `head` would: call it when objects, files or notes were added.
  /// Throws Error on a full disk. Ignores the reports of `head`.
  void expect(const RunManifest& head);
  /// Adds the report of a frame and reserves its space. Throws Error on a full disk.
  void add(const FrameReport& report);
  /// Removes the reports of all frames after `frame`.
  void drop_after(std::uint64_t frame);
  /// Writes run.json: `head`, with the reports added so far. Throws Error on failure. Writes nothing if the last
  /// call wrote the same.
  void save(const RunManifest& head);
  /// Gives the reserved space back: no frames follow.
  void release();

 private:
  struct Line {
    std::uint64_t frame;
    ReportText text;
  };
  void reserve();

  std::filesystem::path folder_;
  std::vector<Line> lines_;
  std::uint64_t line_bytes_ = 0;  // of all lines in run.json
  std::uint64_t head_bytes_ = 0;  // expected, with a margin for numbers that grow
  std::unique_ptr<AtomicFile> next_;
  std::uint64_t reserved_ = 0;  // bytes of next_
  std::string saved_head_;
  std::uint64_t saved_lines_ = 0;
};

}  // namespace souple
