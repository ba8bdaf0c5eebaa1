#include "souple/io/manifest_writer.h"

#include "souple/error.h"

#include <utility>

namespace souple {

namespace {

constexpr std::size_t piece_bytes = 1u << 16;
/// Of a line in run.json: separators and indentation.
constexpr std::uint64_t bytes_between = 8;

std::uint64_t bytes_of(const ReportText& text) {
  return text.report.size() + text.timing.size() + bytes_between;
}

/// The length of a head whose counts of frames may grow to any number.
std::uint64_t longest(const std::string& text, const RunManifest& head) {
  constexpr std::uint64_t digits = 20, rest = 256;
  std::uint64_t files = 0;
  for (const ManifestObject& object : head.objects) files += object.files.size();
  return text.size() + digits * files + rest;
}

}  // namespace

void ManifestWriter::expect(const RunManifest& head) {
  head_bytes_ = longest(manifest_head(head), head);
  reserve();
}

void ManifestWriter::add(const FrameReport& report) {
  lines_.push_back({report.frame, report_text(report)});
  line_bytes_ += bytes_of(lines_.back().text);
  reserve();
}

void ManifestWriter::drop_after(std::uint64_t frame) {
  for (; !lines_.empty() && lines_.back().frame > frame; lines_.pop_back())
    line_bytes_ -= bytes_of(lines_.back().text);
  if (lines_.size() < saved_lines_) saved_head_.clear();
}

// More than is needed, in proportion: a run of n frames reserves log(n) times.
void ManifestWriter::reserve() {
  const std::uint64_t needed = head_bytes_ + line_bytes_;
  if (needed <= reserved_) return;
  if (!next_) next_ = std::make_unique<AtomicFile>(folder_ / "run.json");
  const std::uint64_t wanted = needed + needed / 16 + 4096;
  next_->reserve(wanted);
  reserved_ = wanted;
}

void ManifestWriter::save(const RunManifest& head) {
  std::string text = manifest_head(head);
  if (text == saved_head_ && lines_.size() == saved_lines_) return;
  reserved_ = 0;
  const std::unique_ptr<AtomicFile> file =
      next_ ? std::move(next_) : std::make_unique<AtomicFile>(folder_ / "run.json");
  std::string piece = text;
  write_reports(
      [&](const auto& each) {
        for (const Line& line : lines_) each(line.text.report, line.text.timing);
      },
      [&](std::string_view part) {
        piece += part;
        if (piece.size() < piece_bytes) return;
        file->write(piece);
        piece.clear();
      });
  file->write(piece);
  file->commit();
  saved_head_ = std::move(text);
  saved_lines_ = lines_.size();
  head_bytes_ = longest(saved_head_, head);
  try {
    reserve();
  } catch (const Error&) {
    // The disk is full: run.json is written, and the next frame fails.
  }
}

void ManifestWriter::release() {
  next_.reset();
  reserved_ = 0;
}

}  // namespace souple
