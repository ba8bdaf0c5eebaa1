#pragma once

#include "souple/files/atomic_file.h"
#include "souple/files/file.h"
#include "souple/io/manifest.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace souple {

/// Writes the run.json of a folder again and again while a run adds frames. It reserves the disk space of the next
/// run.json frame by frame. A disk that fills up then stops the run at a frame that run.json can still describe. The
/// reserved space is run.json.part, which the destructor removes. Reports are also kept on the disk, in a file without
/// a name that ends with the process. So memory does not grow with the frames.
class ManifestWriter {
 public:
  explicit ManifestWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Reserves space for a run.json that begins as `head` would: call it when objects, files or notes were added.
  /// Throws Error on a full disk. Ignores the reports of `head`.
  void expect(const RunManifest& head);
  /// Adds the report of a frame and reserves its space. Throws Error on a full disk.
  void add(const FrameReport& report);
  /// Removes the last report if its frame is after `frame`. Call it at most once after `add`.
  void drop_after(std::uint64_t frame);
  /// Writes run.json: `head`, with the reports added so far. Throws Error on failure. Writes nothing if the last
  /// call wrote the same.
  void save(const RunManifest& head);
  /// Gives the reserved space back: no frames follow.
  void release();

 private:
  /// A text and what compact_json makes of it, until the text changes.
  struct Embedded {
    std::string given, compact = "null";
    const std::string& of(const std::string& text, const char* what);
  };
  std::string head_text(const RunManifest& head);
  void reserve();
  void reserve_lines(std::uint64_t bytes);
  void for_each_line(const std::function<void(std::string_view, std::string_view)>& each);

  std::filesystem::path folder_;
  Embedded scene_, settings_;
  std::optional<File> lines_;  // of each frame two: its texts
  std::uint64_t line_bytes_ = 0, count_ = 0;
  std::uint64_t last_frame_ = 0, bytes_before_last_ = 0;
  std::uint64_t head_bytes_ = 0;  // expected, with a margin for numbers that grow
  std::unique_ptr<AtomicFile> next_;
  std::uint64_t reserved_ = 0, reserved_lines_ = 0;  // bytes of next_ and of lines_
  std::string saved_head_;
  std::uint64_t saved_bytes_ = 0;  // of lines_
};

}  // namespace souple
