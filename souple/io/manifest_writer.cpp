#include "souple/io/manifest_writer.h"

#include "souple/error.h"

#include <algorithm>
#include <span>
#include <system_error>
#include <utility>

namespace souple {

namespace {

constexpr std::size_t piece_bytes = 1u << 16;
/// Bytes of separators and indentation of a frame in run.json.
constexpr std::uint64_t bytes_between = 8;

/// In proportion to what is needed: a run of n frames reserves log(n) times.
std::uint64_t with_margin(std::uint64_t bytes) {
  return bytes + bytes / 16 + 4096;
}

/// A file that only this process knows: the system removes it when the process ends, however it ends.
File unnamed_file(const std::filesystem::path& path) {
  File file(path, File::Mode::create);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  return file;
}

/// The length of a head whose counts of frames may grow to any number.
std::uint64_t longest(const std::string& text, const RunManifest& head) {
  constexpr std::uint64_t digits = 20, rest = 256;
  std::uint64_t files = 0;
  for (const ManifestObject& object : head.objects) files += object.files.size();
  return text.size() + digits * files + rest;
}

}  // namespace

const std::string& ManifestWriter::Embedded::of(const std::string& text, const char* what) {
  if (text == given) return compact;
  std::string made = compact_json(text, what);
  given = text;
  compact = std::move(made);
  return compact;
}

std::string ManifestWriter::head_text(const RunManifest& head) {
  return manifest_head(head, scene_.of(head.scene, scene_name), settings_.of(head.settings, settings_name));
}

void ManifestWriter::expect(const RunManifest& head) {
  head_bytes_ = longest(head_text(head), head);
  reserve();
}

void ManifestWriter::add(const FrameReport& report) {
  const ReportText text = report_text(report);
  const std::string lines = text.report + "\n" + text.timing + "\n";
  if (!lines_) lines_.emplace(unnamed_file(folder_ / "run.json.reports"));
  // A failed write would leave its bytes in the buffer of the file, and every later access would fail like it.
  reserve_lines(line_bytes_ + lines.size());
  lines_->write(line_bytes_, std::as_bytes(std::span(lines)));
  lines_->flush();
  last_frame_ = report.frame;
  bytes_before_last_ = line_bytes_;
  line_bytes_ += lines.size();
  ++count_;
  reserve();
}

void ManifestWriter::drop_after(std::uint64_t frame) {
  if (last_frame_ <= frame) return;
  last_frame_ = frame;
  line_bytes_ = bytes_before_last_;
  --count_;
  if (line_bytes_ < saved_bytes_) saved_head_.clear();
}

void ManifestWriter::for_each_line(const std::function<void(std::string_view, std::string_view)>& each) {
  std::string text;
  for (std::uint64_t at = 0; at < line_bytes_;) {
    const std::size_t kept = text.size();
    const auto read = static_cast<std::size_t>(std::min<std::uint64_t>(piece_bytes, line_bytes_ - at));
    text.resize(kept + read);
    lines_->read(at, std::as_writable_bytes(std::span(text)).subspan(kept));
    at += read;
    std::string_view left = text;
    for (;;) {
      const std::size_t report = left.find('\n');
      const std::size_t timing = report == left.npos ? left.npos : left.find('\n', report + 1);
      if (timing == left.npos) break;
      each(left.substr(0, report), left.substr(report + 1, timing - report - 1));
      left.remove_prefix(timing + 1);
    }
    text.erase(0, text.size() - left.size());
  }
}

void ManifestWriter::reserve_lines(std::uint64_t bytes) {
  if (bytes <= reserved_lines_) return;
  lines_->reserve(with_margin(bytes));
  reserved_lines_ = with_margin(bytes);
}

void ManifestWriter::reserve() {
  const std::uint64_t needed = head_bytes_ + line_bytes_ + bytes_between * count_;
  if (needed <= reserved_) return;
  if (!next_) next_ = std::make_unique<AtomicFile>(folder_ / "run.json");
  next_->reserve(with_margin(needed));
  reserved_ = with_margin(needed);
}

void ManifestWriter::save(const RunManifest& head) {
  std::string text = head_text(head);
  if (text == saved_head_ && line_bytes_ == saved_bytes_) return;
  reserved_ = 0;
  const std::unique_ptr<AtomicFile> file =
      next_ ? std::move(next_) : std::make_unique<AtomicFile>(folder_ / "run.json");
  std::string piece = text;
  write_reports([&](const auto& each) { for_each_line(each); },
                [&](std::string_view part) {
                  piece += part;
                  if (piece.size() < piece_bytes) return;
                  file->write(piece);
                  piece.clear();
                });
  file->write(piece);
  file->commit();
  saved_head_ = std::move(text);
  saved_bytes_ = line_bytes_;
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
