#include "souple/io/pc2.h"

#include "souple/error.h"
#include "souple/files/atomic_file.h"
#include "souple/files/endian.h"
#include "souple/io/point_cache_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/core.h>

namespace souple {

namespace {

constexpr ByteOrder pc2_order = ByteOrder::little;
constexpr std::uint64_t pc2_header_size = 32;
constexpr std::uint64_t frame_count_offset = 28;
constexpr char pc2_magic[12] = "POINTCACHE2";

struct Pc2Header {
  std::uint64_t points;
  float start_frame;
  float sample_rate;
  std::uint64_t frames;
};

std::array<std::byte, pc2_header_size> encode_pc2(const Pc2Header& header) {
  std::array<std::byte, pc2_header_size> bytes{};
  std::memcpy(bytes.data(), pc2_magic, sizeof pc2_magic);
  store<pc2_order>(&bytes[12], std::uint32_t{1});
  store<pc2_order>(&bytes[16], static_cast<std::uint32_t>(header.points));
  store<pc2_order>(&bytes[20], header.start_frame);
  store<pc2_order>(&bytes[24], header.sample_rate);
  store<pc2_order>(&bytes[28], static_cast<std::uint32_t>(header.frames));
  return bytes;
}

/// Reads the header and rejects impossible values; callers check the file's size.
Pc2Header read_pc2_header(ByteSource& source) {
  std::array<std::byte, pc2_header_size> bytes{};
  if (source.size() >= pc2_header_size) source.read(0, bytes);
  if (std::memcmp(bytes.data(), pc2_magic, sizeof pc2_magic) != 0)
    throw Error(source.name() +
                ": is not a PC2 file: it does not begin with POINTCACHE2 and a header of 32 bytes");
  const auto version = load<pc2_order, std::uint32_t>(&bytes[12]);
  if (version != 1)
    throw Error(fmt::format("{}: is PC2 version {}, only version 1 is known", source.name(), version));
  const Pc2Header header{load<pc2_order, std::uint32_t>(&bytes[16]), load<pc2_order, float>(&bytes[20]),
                         load<pc2_order, float>(&bytes[24]), load<pc2_order, std::uint32_t>(&bytes[28])};
  point_cache::check_header(source.name(), {header.points, header.frames});
  if (!std::isfinite(header.start_frame) || !std::isfinite(header.sample_rate) || !(header.sample_rate > 0))
    throw Error(source.name() +
                ": its start frame or sample rate is not a usable number; expected a rate > 0");
  return header;
}

std::uint64_t frames_that_fit(std::uint64_t size, std::uint64_t points) {
  return (size - pc2_header_size) / (12 * points);
}

}  // namespace

Pc2Writer::Pc2Writer(std::filesystem::path path, std::uint64_t points, const Options& options)
    : points_(point_cache::check_points(path.string(), points)),
      path_(std::move(path)),
      file_(part_path(path_), File::Mode::create) {
  file_.write(0, encode_pc2({points, options.start_frame, options.sample_rate, 0}));
  file_.flush();
}

Pc2Writer::Pc2Writer(std::filesystem::path path, File file, std::uint64_t points, std::uint64_t frames)
    : points_(points), path_(std::move(path)), file_(std::move(file)), frames_(frames) {}

Pc2Writer Pc2Writer::resume(const std::filesystem::path& path, std::uint64_t points,
                            std::uint64_t keep_frames) {
  const auto part = part_path(path);
  const auto& existing = std::filesystem::exists(part) ? part : path;
  {
    ByteSource source(existing);
    const Pc2Header header = read_pc2_header(source);
    const std::uint64_t frames = std::min(header.frames, frames_that_fit(source.size(), header.points));
    point_cache::check_resume(source.name(), {header.points, frames}, points, keep_frames);
  }
  if (existing == path) rename_file(path, part);
  Pc2Writer writer(path, File(part, File::Mode::update), points, keep_frames);
  writer.write_frame_count();
  writer.file_.truncate(pc2_header_size + 12 * points * keep_frames);
  return writer;
}

void Pc2Writer::write_frame_count() {
  std::array<std::byte, 4> count;
  store<pc2_order>(count.data(), static_cast<std::uint32_t>(frames_));
  file_.write(frame_count_offset, count);
  file_.flush();
}

void Pc2Writer::append(std::span<const Vec3f> positions) {
  point_cache::check_append(path_.string(), {points_, frames_}, open_, positions.size());
  buffer_.resize(12 * positions.size());
  const auto bytes = std::as_writable_bytes(std::span(buffer_));
  store_points<pc2_order>(bytes.data(), positions);
  file_.write(pc2_header_size + 12 * points_ * frames_, bytes);
  // Writes the count after its frame: a killed run leaves no incomplete frame.
  file_.flush();
  ++frames_;
  write_frame_count();
}

void Pc2Writer::finish() {
  if (!open_) return;
  file_.truncate(pc2_header_size + 12 * points_ * frames_);  // removes the part of a failed frame
  file_.close();
  rename_file(file_.path(), path_);
  open_ = false;
}

void Pc2Writer::discard() {
  if (!open_) return;
  open_ = false;
  file_.abandon();
  std::error_code ignored;
  std::filesystem::remove(file_.path(), ignored);
}

Pc2Reader::Pc2Reader(ByteSource source) : Pc2Reader(std::move(source), false) {}

Pc2Reader Pc2Reader::of_part(ByteSource source) {
  return {std::move(source), true};
}

Pc2Reader::Pc2Reader(ByteSource source, bool is_part) : source_(std::move(source)) {
  const Pc2Header header = read_pc2_header(source_);
  if (!is_part)
    point_cache::check_size(source_.name(), {header.points, header.frames}, source_.size() - pc2_header_size);
  points_ = header.points;
  frames_ = std::min(header.frames, frames_that_fit(source_.size(), header.points));
  start_frame_ = header.start_frame;
  sample_rate_ = header.sample_rate;
}

void Pc2Reader::read(std::uint64_t frame, std::span<Vec3f> positions) {
  point_cache::check_read(source_.name(), {points_, frames_}, frame, positions.size());
  buffer_.resize(12 * positions.size());
  const auto bytes = std::as_writable_bytes(std::span(buffer_));
  source_.read(pc2_header_size + frame * bytes.size(), bytes);
  load_points<pc2_order>(bytes.data(), positions);
}

}  // namespace souple
